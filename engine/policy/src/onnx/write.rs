//! Writes a network as an ONNX model.

use std::collections::BTreeMap;

use super::number::{attribute, element, entry, graph, model, node, opset, tensor, value_info};
use super::wire::Writer;
use super::{BATCH, INPUT, OUTPUT};
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
    m.nested(graph::OUTPUT, |m| value(m, OUTPUT, network.actions()));
}

/// Sub and Mul scale the inputs; then Gemm and Tanh take turns.
fn nodes(m: &mut Writer, network: &Network) {
    operator(m, "Sub", &[INPUT, "offset"], "centred", false);
    operator(m, "Mul", &["centred", "scale"], "values0", false);
    let last = network.layers.len() - 1;
    for layer in 0..=last {
        let (weights, bias) = (format!("weights{layer}"), format!("bias{layer}"));
        let inputs = [&format!("values{layer}"), weights.as_str(), &bias];
        if layer == last {
            operator(m, "Gemm", &inputs, OUTPUT, true);
        } else {
            let sums = format!("sums{layer}");
            operator(m, "Gemm", &inputs, &sums, true);
            operator(m, "Tanh", &[&sums], &format!("values{}", layer + 1), false);
        }
    }
}

fn operator(m: &mut Writer, kind: &str, inputs: &[&str], output: &str, transposed_weights: bool) {
    m.nested(graph::NODE, |m| {
        inputs.iter().for_each(|input| m.bytes(node::INPUT, input));
        m.bytes(node::OUTPUT, output);
        m.bytes(node::NAME, format!("{kind}_{output}"));
        m.bytes(node::OPERATOR, kind);
        if transposed_weights {
            m.nested(node::ATTRIBUTE, |m| {
                m.bytes(attribute::NAME, "transB");
                m.number(attribute::INTEGER, 1);
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

fn initializer(m: &mut Writer, name: &str, shape: &[usize], values: &[f32]) {
    m.nested(graph::INITIALIZER, |m| {
        shape
            .iter()
            .for_each(|size| m.number(tensor::DIMS, *size as u64));
        m.number(tensor::DATA_TYPE, element::FLOAT);
        m.bytes(tensor::NAME, name);
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect();
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
