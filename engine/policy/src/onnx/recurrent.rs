//! The part of a graph that LSTM layers make, in plain operators.
//!
//! The LSTM operator takes as long in ONNX Runtime and a quarter less in tract (33 against 42 µs
//! for one row of one layer of 256), but comes with an axis of time, directions and an order of
//! gates of its own; a policy takes one step per call, ten times a second.

use super::wire::Writer;
use super::write::{axis_1, initializer, operator, whole_numbers};
use super::{STATE_INPUT, STATE_OUTPUT};
use crate::LstmCell;

/// Takes the state apart, layer after layer into h and c, and puts the next one together. The
/// values named `input` go in; gives the name of those that come out.
pub fn nodes(m: &mut Writer, layers: &[LstmCell], input: &str) -> String {
    let parts = names(layers.len(), ["hidden", "cell"]);
    operator(
        m,
        "Split",
        &[STATE_INPUT, "state_parts"],
        &parts,
        &[axis_1()],
    );
    let mut values = input.to_owned();
    for layer in 0..layers.len() {
        step(m, layer, &values);
        values = format!("next_hidden{layer}");
    }
    let next = names(layers.len(), ["next_hidden", "next_cell"]);
    operator(m, "Concat", &next, &[STATE_OUTPUT], &[axis_1()]);
    values
}

fn names(layers: usize, parts: [&str; 2]) -> Vec<String> {
    let of_layer = |layer| parts.map(|part| format!("{part}{layer}"));
    (0..layers).flat_map(of_layer).collect()
}

/// All four gates at once: what comes in times its weights, then h times its own on top.
fn step(m: &mut Writer, layer: usize, values: &str) {
    let own = |name: &str| format!("{name}{layer}");
    let node = |m: &mut Writer, kind, inputs: [&str; 2], output: &str| {
        operator(m, kind, &inputs.map(own), &[own(output)], &[]);
    };
    let activation = |m: &mut Writer, kind, input: &str, output: &str| {
        operator(m, kind, &[own(input)], &[own(output)], &[]);
    };
    let of_input = [values.to_owned(), own("weights_input"), own("bias_gates")];
    let transposed = [("transB", 1)];
    operator(m, "Gemm", &of_input, &[own("gates_input")], &transposed);
    let of_hidden = ["hidden", "weights_hidden", "gates_input"].map(own);
    operator(m, "Gemm", &of_hidden, &[own("gates")], &transposed);
    let gates = ["input_sums", "forget_sums", "candidate_sums", "output_sums"].map(own);
    operator(m, "Split", &[own("gates")], &gates, &[axis_1()]);
    activation(m, "Sigmoid", "input_sums", "input_gate");
    activation(m, "Sigmoid", "forget_sums", "forget_gate");
    activation(m, "Tanh", "candidate_sums", "candidate");
    activation(m, "Sigmoid", "output_sums", "output_gate");
    node(m, "Mul", ["forget_gate", "cell"], "kept");
    node(m, "Mul", ["input_gate", "candidate"], "added");
    node(m, "Add", ["kept", "added"], "next_cell");
    activation(m, "Tanh", "next_cell", "bent_cell");
    node(m, "Mul", ["output_gate", "bent_cell"], "next_hidden");
}

/// The weights as they stand in the layers, and the widths of h and c in the state.
pub fn initializers(m: &mut Writer, layers: &[LstmCell]) {
    if layers.is_empty() {
        return;
    }
    let parts: Vec<i64> = layers
        .iter()
        .flat_map(|layer| [layer.width as i64; 2])
        .collect();
    whole_numbers(m, "state_parts", &parts);
    for (index, layer) in layers.iter().enumerate() {
        let (gates, name) = (4 * layer.width, |name: &str| format!("{name}{index}"));
        let input = [gates, layer.inputs];
        initializer(m, &name("weights_input"), &input, &layer.weights_input);
        let hidden = [gates, layer.width];
        initializer(m, &name("weights_hidden"), &hidden, &layer.weights_hidden);
        initializer(m, &name("bias_gates"), &[gates], &layer.bias);
    }
}
