//! The part of a graph that LSTM layers make, in plain operators.
//!
//! The LSTM operator would be shorter, but both runtimes set up a loop over time for it, which a
//! policy that takes one step per call pays for and does not need.

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

/// One product for all four gates: what comes in and h stand side by side, and so do the weights.
fn step(m: &mut Writer, layer: usize, values: &str) {
    let own = |name: &str| format!("{name}{layer}");
    let node = |m: &mut Writer, kind, inputs: [&str; 2], output: &str| {
        operator(m, kind, &inputs.map(own), &[own(output)], &[]);
    };
    let activation = |m: &mut Writer, kind, input: &str, output: &str| {
        operator(m, kind, &[own(input)], &[own(output)], &[]);
    };
    let hidden = own("hidden");
    operator(
        m,
        "Concat",
        &[values, &hidden],
        &[own("joined")],
        &[axis_1()],
    );
    let product = ["joined", "lstm_weights", "lstm_bias"].map(own);
    operator(m, "Gemm", &product, &[own("gates")], &[("transB", 1)]);
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
        let shape = [4 * layer.width, layer.inputs + layer.width];
        initializer(m, &format!("lstm_weights{index}"), &shape, &joined(layer));
        initializer(m, &format!("lstm_bias{index}"), &shape[..1], &layer.bias);
    }
}

/// `[4 * width][inputs + width]`.
fn joined(layer: &LstmCell) -> Vec<f32> {
    let of_input = layer.weights_input.chunks_exact(layer.inputs);
    let of_hidden = layer.weights_hidden.chunks_exact(layer.width);
    of_input
        .zip(of_hidden)
        .flat_map(|(input, hidden)| input.iter().chain(hidden))
        .copied()
        .collect()
}
