//! ONNX files: the little of protobuf and of the format that a policy needs.

pub mod read;
mod recurrent;
mod tensor;
#[cfg(test)]
pub(crate) mod testing;
mod wire;
pub mod write;

pub use read::{Model, ValueInfo};
pub use write::{IR_VERSION, OPSET};

/// The name of the graph's input, `[batch, features]`.
pub const INPUT: &str = "belief";
/// The name of the graph's output, `[batch, actions]`.
pub const OUTPUT: &str = "logits";
/// The name of a recurrent graph's second input, `[batch, state_width]`, laid out as
/// [`State`](crate::State) says: LSTM layer by LSTM layer h, then c.
pub const STATE_INPUT: &str = "state_in";
/// The name of a recurrent graph's second output, laid out as [`STATE_INPUT`]: the state of the
/// next step.
pub const STATE_OUTPUT: &str = "state_out";
/// The name of the dimension that a caller chooses.
pub const BATCH: &str = "batch";

/// Field numbers of `ModelProto` and its parts, from `onnx.proto`.
mod number {
    pub mod model {
        pub const IR_VERSION: u32 = 1;
        pub const PRODUCER_NAME: u32 = 2;
        pub const PRODUCER_VERSION: u32 = 3;
        pub const GRAPH: u32 = 7;
        pub const OPSET_IMPORT: u32 = 8;
        pub const METADATA: u32 = 14;
        pub const FUNCTIONS: u32 = 25;
    }
    pub mod opset {
        pub const DOMAIN: u32 = 1;
        pub const VERSION: u32 = 2;
    }
    pub mod entry {
        pub const KEY: u32 = 1;
        pub const VALUE: u32 = 2;
    }
    pub mod graph {
        pub const NODE: u32 = 1;
        pub const NAME: u32 = 2;
        pub const INITIALIZER: u32 = 5;
        pub const INPUT: u32 = 11;
        pub const OUTPUT: u32 = 12;
        pub const SPARSE_INITIALIZER: u32 = 15;
    }
    pub mod node {
        pub const INPUT: u32 = 1;
        pub const OUTPUT: u32 = 2;
        pub const NAME: u32 = 3;
        pub const OPERATOR: u32 = 4;
        pub const ATTRIBUTE: u32 = 5;
        pub const DOMAIN: u32 = 7;
    }
    pub mod attribute {
        pub const NAME: u32 = 1;
        pub const INTEGER: u32 = 3;
        pub const TENSOR: u32 = 5;
        pub const TYPE: u32 = 20;
        pub const TYPE_INTEGER: u64 = 2;
    }
    pub mod tensor {
        pub const DIMS: u32 = 1;
        pub const DATA_TYPE: u32 = 2;
        pub const FLOAT_DATA: u32 = 4;
        pub const NAME: u32 = 8;
        pub const RAW_DATA: u32 = 9;
        pub const DOUBLE_DATA: u32 = 10;
        pub const DATA_LOCATION: u32 = 14;
    }
    pub mod value_info {
        pub const NAME: u32 = 1;
        pub const TYPE: u32 = 2;
        pub const TENSOR_TYPE: u32 = 1;
        pub const ELEMENT_TYPE: u32 = 1;
        pub const SHAPE: u32 = 2;
        pub const DIM: u32 = 1;
        pub const DIM_VALUE: u32 = 1;
        pub const DIM_PARAM: u32 = 2;
    }
    pub mod element {
        pub const FLOAT: u64 = 1;
        pub const INT32: u64 = 6;
        pub const INT64: u64 = 7;
        pub const BOOL: u64 = 9;
        pub const DOUBLE: u64 = 11;
    }
}
