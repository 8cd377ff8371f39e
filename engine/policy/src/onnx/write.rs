//! Writes a network as an ONNX model.

use std::collections::BTreeMap;

use super::number::{attribute, element, entry, graph, model, node, opset, tensor, value_info};
use super::wire::Writer;
use super::{BATCH, INPUT, OUTPUT, STATE_INPUT, STATE_OUTPUT, recurrent};
use crate::{Dense, Network};

/// The version of the file format written: read by everything since ONNX 1.10.
pub const IR_VERSION: u64 = 8;
/// The version of the operators written.
pub const OPSET: u64 = 17;

/// Everything of the model but its metadata. `network` must pass [`Network::check`].
pub(crate) fn model(network: &Network) -> Vec<u8> {
    Writer::message(|m| {
        m.number(model::IR_VERSION, IR_VERSION);
        m.bytes(model::PRODUCER_NAME, "pubs-engine");
        m.bytes(model::PRODUCER_VERSION, env!("CARGO_PKG_VERSION"));
        m.nested(model::GRAPH, |m| graph(m, network));
        m.nested(model::OPSET_IMPORT, |m| {
            m.bytes(opset::DOMAIN, "");
            m.number(opset::VERSION, OPSET);
        });
    })
}

/// The metadata, to stand behind [`model`].
pub(crate) fn metadata(entries: &BTreeMap<String, String>) -> Vec<u8> {
    Writer::message(|m| {
        for (key, value) in entries {
            m.nested(model::METADATA, |m| {
                m.bytes(entry::KEY, key);
                m.bytes(entry::VALUE, value);
            });
        }
    })
}

fn graph(m: &mut Writer, network: &Network) {
    nodes(m, network);
    m.bytes(graph::NAME, "policy");
    initializers(m, network);
    m.nested(graph::INPUT, |m| value(m, INPUT, network.inputs.len()));
    let state = network.state_width();
    if state > 0 {
        m.nested(graph::INPUT, |m| value(m, STATE_INPUT, state));
    }
    m.nested(graph::OUTPUT, |m| value(m, OUTPUT, network.actions()));
    if state > 0 {
        m.nested(graph::OUTPUT, |m| value(m, STATE_OUTPUT, state));
    }
}

/// Sub and Mul scale the inputs; LSTM layers follow where there are any, then Gemm and Tanh take turns.
fn nodes(m: &mut Writer, network: &Network) {
    let scaled = if network.lstm.is_empty() {
        "values0"
    } else {
        "scaled"
    };
    operator(m, "Sub", &[INPUT, "offset"], &["centred"], &[]);
    operator(m, "Mul", &["centred", "scale"], &[scaled], &[]);
    let mut values = scaled.to_owned();
    if !network.lstm.is_empty() {
        values = recurrent::nodes(m, &network.lstm, &values);
    }
    let last = network.layers.len() - 1;
    for layer in 0..=last {
        let (weights, bias) = (format!("weights{layer}"), format!("bias{layer}"));
        let inputs = [&values, &weights, &bias];
        let transposed = [("transB", 1)];
        if layer == last {
            operator(m, "Gemm", &inputs, &[OUTPUT], &transposed);
        } else {
            let sums = format!("sums{layer}");
            operator(m, "Gemm", &inputs, &[&sums], &transposed);
            values = format!("values{}", layer + 1);
            operator(m, "Tanh", &[&sums], &[&values], &[]);
        }
    }
}

/// The attribute of operators that work along a row.
pub(super) fn axis_1() -> (&'static str, u64) {
    ("axis", 1)
}

/// A node named for its kind and first output, with attributes that are whole numbers.
pub(super) fn operator(
    m: &mut Writer,
    kind: &str,
    inputs: &[impl AsRef<str>],
    outputs: &[impl AsRef<str>],
    attributes: &[(&str, u64)],
) {
    m.nested(graph::NODE, |m| {
        for input in inputs {
            m.bytes(node::INPUT, input.as_ref());
        }
        for output in outputs {
            m.bytes(node::OUTPUT, output.as_ref());
        }
        m.bytes(node::NAME, format!("{kind}_{}", outputs[0].as_ref()));
        m.bytes(node::OPERATOR, kind);
        for (name, value) in attributes {
            m.nested(node::ATTRIBUTE, |m| {
                m.bytes(attribute::NAME, name);
                m.number(attribute::INTEGER, *value);
                m.number(attribute::TYPE, attribute::TYPE_INTEGER);
            });
        }
    });
}

fn initializers(m: &mut Writer, network: &Network) {
    let width = [network.inputs.len()];
    let offset: Vec<f32> = network
        .inputs
        .iter()
        .map(|feature| feature.offset as f32)
        .collect();
    let scale: Vec<f32> = network
        .inputs
        .iter()
        .map(|feature| feature.scale as f32)
        .collect();
    initializer(m, "offset", &width, &offset);
    initializer(m, "scale", &width, &scale);
    recurrent::initializers(m, &network.lstm);
    for (
        layer,
        Dense {
            inputs,
            outputs,
            weights,
            bias,
        },
    ) in network.layers.iter().enumerate()
    {
        initializer(m, &format!("weights{layer}"), &[*outputs, *inputs], weights);
        initializer(m, &format!("bias{layer}"), &[*outputs], bias);
    }
}

pub(super) fn initializer(m: &mut Writer, name: &str, shape: &[usize], values: &[f32]) {
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    stored(m, name, shape, element::FLOAT, &bytes);
}

/// A list of sizes, for operators that ask for one.
pub(super) fn whole_numbers(m: &mut Writer, name: &str, values: &[i64]) {
    let bytes: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    stored(m, name, &[values.len()], element::INT64, &bytes);
}

fn stored(m: &mut Writer, name: &str, shape: &[usize], data_type: u64, bytes: &[u8]) {
    m.nested(graph::INITIALIZER, |m| {
        shape
            .iter()
            .for_each(|size| m.number(tensor::DIMS, *size as u64));
        m.number(tensor::DATA_TYPE, data_type);
        m.bytes(tensor::NAME, name);
        m.bytes(tensor::RAW_DATA, bytes);
    });
}

fn value(m: &mut Writer, name: &str, width: usize) {
    m.bytes(value_info::NAME, name);
    m.nested(value_info::TYPE, |m| {
        m.nested(value_info::TENSOR_TYPE, |m| {
            m.number(value_info::ELEMENT_TYPE, element::FLOAT);
            m.nested(value_info::SHAPE, |m| {
                m.nested(value_info::DIM, |m| m.bytes(value_info::DIM_PARAM, BATCH));
                m.nested(value_info::DIM, |m| {
                    m.number(value_info::DIM_VALUE, width as u64)
                });
            });
        });
    });
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::common::{WIDTHS, network};
    use crate::onnx::wire::Fields;

    #[test]
    fn a_perceptron_is_written_as_ever() {
        let bytes = model(&network(1, &WIDTHS));
        let mut fields = Fields::new(&bytes, "model").map(Result::unwrap);
        let graph = fields.find(|field| field.number == model::GRAPH).unwrap();
        assert_eq!(
            crate::sha256_hex(graph.raw),
            "e49a5070bb84358daecaafcdbdf031152b66316cd5ae68409080195dab4c1719"
        );
    }
}
