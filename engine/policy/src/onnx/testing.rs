//! Files as other trainers might write them, for the tests.

use super::number::{element, graph, model, node, opset, tensor, value_info};
use super::wire::Writer;

/// `y [batch, 3] = x [batch, 2] · w [2, 3]`, every weight `value`, with one thing odd.
#[derive(Debug, Clone, Copy)]
pub struct Foreign {
    pub opset: u64,
    pub batch: Option<u64>,
    pub domain: &'static str,
    pub outputs: usize,
    pub element: u64,
    pub weights: u64,
    pub missing: usize,
    pub listed: bool,
    pub elsewhere: bool,
    pub value: f32,
}

impl Default for Foreign {
    fn default() -> Self {
        Self {
            opset: 17,
            batch: None,
            domain: "",
            outputs: 1,
            element: element::FLOAT,
            weights: element::FLOAT,
            missing: 0,
            listed: false,
            elsewhere: false,
            value: 0.25,
        }
    }
}

/// The bytes of such a file.
pub fn foreign(kind: Foreign) -> Vec<u8> {
    Writer::message(|m| {
        m.number(model::IR_VERSION, 8);
        m.nested(model::OPSET_IMPORT, |m| {
            m.number(opset::VERSION, kind.opset)
        });
        m.nested(model::GRAPH, |m| {
            m.nested(graph::NODE, |m| {
                m.bytes(node::INPUT, "x");
                m.bytes(node::INPUT, "w");
                m.bytes(node::OUTPUT, "y");
                m.bytes(node::OPERATOR, "MatMul");
                m.bytes(node::DOMAIN, kind.domain);
            });
            m.nested(graph::INITIALIZER, |m| weights(m, kind));
            m.nested(graph::INPUT, |m| value(m, "x", 2, kind));
            (0..kind.outputs).for_each(|_| m.nested(graph::OUTPUT, |m| value(m, "y", 3, kind)));
        });
    })
}

fn weights(m: &mut Writer, kind: Foreign) {
    m.bytes(tensor::DIMS, [2, 3]);
    m.number(tensor::DATA_TYPE, kind.weights);
    m.bytes(tensor::NAME, "w");
    let mut bytes = [kind.value; 6].map(f32::to_le_bytes).concat();
    bytes.truncate(24 - kind.missing);
    m.bytes(
        if kind.listed {
            tensor::FLOAT_DATA
        } else {
            tensor::RAW_DATA
        },
        bytes,
    );
    if kind.elsewhere {
        m.number(tensor::DATA_LOCATION, 1);
    }
}

fn value(m: &mut Writer, name: &str, width: u64, kind: Foreign) {
    m.bytes(value_info::NAME, name);
    m.nested(value_info::TYPE, |m| {
        m.nested(value_info::TENSOR_TYPE, |m| {
            m.number(value_info::ELEMENT_TYPE, kind.element);
            m.nested(value_info::SHAPE, |m| {
                m.nested(value_info::DIM, |m| match kind.batch {
                    Some(size) => m.number(value_info::DIM_VALUE, size),
                    None => m.bytes(value_info::DIM_PARAM, "n"),
                });
                m.nested(value_info::DIM, |m| m.number(value_info::DIM_VALUE, width));
            });
        });
    });
}
