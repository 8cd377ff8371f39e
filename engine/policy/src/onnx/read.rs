//! Reads back what must be known of a model before a runtime may have it.
//!
//! Runtimes are lenient: one loads a file with flipped bits, another takes any operator set and
//! lets tanh swallow NaN weights. So the file is taken apart here first, strictly.

use std::collections::BTreeMap;

use sha2::{Digest, Sha256};

use super::number::{attribute, element, entry, graph, model, node, opset, value_info};
use super::tensor::Tensor;
use super::wire::{Field, Fields};
use crate::hash::hex;

/// A model, read but not run.
#[derive(Debug, Clone)]
pub struct Model {
    /// Version of the file format.
    pub ir_version: u64,
    /// Version of the standard operators.
    pub opset: u64,
    /// Notes by key.
    pub metadata: BTreeMap<String, String>,
    /// The graph's inputs.
    pub inputs: Vec<ValueInfo>,
    /// The graph's outputs.
    pub outputs: Vec<ValueInfo>,
    /// Over the initializers in order: names, shapes, types, values.
    pub weights_sha256: String,
    /// Over every byte of the file but the metadata.
    pub model_sha256: String,
    /// The first weight that is NaN or infinite, described.
    pub not_finite: Option<String>,
}

/// An input or output as the graph declares it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ValueInfo {
    /// Its name.
    pub name: String,
    /// Whether it is a tensor of float32.
    pub float32: bool,
    /// Sizes of its dimensions, `None` where the caller chooses; `None` where nothing is declared.
    pub shape: Option<Vec<Option<u64>>>,
}

impl Model {
    /// Takes a file apart.
    ///
    /// # Errors
    /// What is wrong with it, to stand after the file's name.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        if bytes.is_empty() {
            return Err("it is empty".into());
        }
        let mut reader = Reader::default();
        let mut whole = Sha256::new();
        for field in Fields::new(bytes, "model") {
            let field = field?;
            if field.number != model::METADATA {
                whole.update(field.raw);
            }
            reader.model_field(&field)?;
        }
        reader.finish(&hex(&whole.finalize()))
    }
}

#[derive(Default)]
struct Reader {
    ir_version: Option<u64>,
    opset: Option<u64>,
    metadata: BTreeMap<String, String>,
    graph: Option<Graph>,
}

#[derive(Default)]
struct Graph {
    inputs: Vec<ValueInfo>,
    outputs: Vec<ValueInfo>,
    nodes: usize,
    weights: Sha256,
    not_finite: Option<String>,
}

impl Reader {
    fn model_field(&mut self, field: &Field) -> Result<(), String> {
        match field.number {
            model::IR_VERSION => once(
                &mut self.ir_version,
                field.number()?,
                "file format versions",
            ),
            // Protobuf would merge two graphs into one that neither sum nor author knows.
            model::GRAPH => once(&mut self.graph, Graph::read(field.bytes()?)?, "graphs"),
            model::OPSET_IMPORT => self.opset_import(field.bytes()?),
            model::METADATA => self.metadata_entry(field.bytes()?),
            model::FUNCTIONS => {
                Err("it defines functions of its own; export it with them inlined".into())
            }
            _ => Ok(()),
        }
    }

    fn opset_import(&mut self, bytes: &[u8]) -> Result<(), String> {
        let (mut domain, mut version) = ("", 0);
        for field in Fields::new(bytes, "operator set") {
            let field = field?;
            match field.number {
                opset::DOMAIN => domain = field.text()?,
                opset::VERSION => version = field.number()?,
                _ => {}
            }
        }
        if standard(domain) {
            once(&mut self.opset, version, "operator sets")
        } else {
            Ok(())
        }
    }

    fn metadata_entry(&mut self, bytes: &[u8]) -> Result<(), String> {
        let (mut key, mut value) = ("", "");
        for field in Fields::new(bytes, "metadata") {
            let field = field?;
            match field.number {
                entry::KEY => key = field.text()?,
                entry::VALUE => value = field.text()?,
                _ => {}
            }
        }
        match self.metadata.insert(key.to_owned(), value.to_owned()) {
            None => Ok(()),
            Some(_) => Err(format!("its metadata has {key:?} twice")),
        }
    }

    fn finish(self, model_sha256: &str) -> Result<Model, String> {
        let missing = |what: &str| format!("it has no {what}, so it is not a whole ONNX model");
        let graph = self.graph.ok_or_else(|| missing("graph"))?;
        if graph.nodes == 0 {
            return Err("its graph computes nothing".into());
        }
        Ok(Model {
            ir_version: self
                .ir_version
                .ok_or_else(|| missing("file format version"))?,
            opset: self.opset.ok_or_else(|| missing("operator set"))?,
            metadata: self.metadata,
            inputs: graph.inputs,
            outputs: graph.outputs,
            weights_sha256: hex(&graph.weights.finalize()),
            model_sha256: model_sha256.to_owned(),
            not_finite: graph.not_finite,
        })
    }
}

impl Graph {
    fn read(bytes: &[u8]) -> Result<Self, String> {
        let mut read = Self::default();
        for field in Fields::new(bytes, "graph") {
            let field = field?;
            match field.number {
                graph::NODE => read.node(field.bytes()?)?,
                graph::INITIALIZER => {
                    let tensor = Tensor::read(field.bytes()?)?;
                    tensor.hash(&mut read.weights);
                    read.look_at(&tensor);
                }
                graph::SPARSE_INITIALIZER => {
                    return Err("it holds sparse tensors; export it with dense ones".into());
                }
                graph::INPUT => read.inputs.push(value_info(field.bytes()?)?),
                graph::OUTPUT => read.outputs.push(value_info(field.bytes()?)?),
                _ => {}
            }
        }
        Ok(read)
    }

    fn look_at(&mut self, tensor: &Tensor) {
        if self.not_finite.is_none() {
            self.not_finite = tensor.not_finite();
        }
    }

    fn node(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.nodes += 1;
        let (mut operator, mut domain) = ("", "");
        for field in Fields::new(bytes, "node") {
            let field = field?;
            match field.number {
                node::OPERATOR => operator = field.text()?,
                node::DOMAIN => domain = field.text()?,
                node::ATTRIBUTE => self.attribute(field.bytes()?)?,
                node::INPUT | node::OUTPUT | node::NAME => _ = field.text()?,
                _ => {}
            }
        }
        if standard(domain) {
            return Ok(());
        }
        Err(format!(
            "its operator {operator} belongs to {domain:?}; only the standard operators are run"
        ))
    }

    /// Constants may hold weights too.
    fn attribute(&mut self, bytes: &[u8]) -> Result<(), String> {
        for field in Fields::new(bytes, "attribute") {
            let field = field?;
            if field.number == attribute::TENSOR {
                self.look_at(&Tensor::read(field.bytes()?)?);
            }
        }
        Ok(())
    }
}

fn standard(domain: &str) -> bool {
    matches!(domain, "" | "ai.onnx")
}

fn once<T>(slot: &mut Option<T>, value: T, what: &str) -> Result<(), String> {
    if slot.is_some() {
        return Err(format!("it has two {what}"));
    }
    *slot = Some(value);
    Ok(())
}

fn value_info(bytes: &[u8]) -> Result<ValueInfo, String> {
    let mut read = ValueInfo {
        name: String::new(),
        float32: false,
        shape: None,
    };
    for field in Fields::new(bytes, "value") {
        let field = field?;
        match field.number {
            value_info::NAME => read.name = field.text()?.to_owned(),
            value_info::TYPE => value_type(field.bytes()?, &mut read)?,
            _ => {}
        }
    }
    Ok(read)
}

fn value_type(bytes: &[u8], read: &mut ValueInfo) -> Result<(), String> {
    for field in Fields::new(bytes, "type") {
        let field = field?;
        if field.number != value_info::TENSOR_TYPE {
            continue;
        }
        for field in Fields::new(field.bytes()?, "tensor type") {
            let field = field?;
            match field.number {
                value_info::ELEMENT_TYPE => read.float32 = field.number()? == element::FLOAT,
                value_info::SHAPE => read.shape = Some(shape(field.bytes()?)?),
                _ => {}
            }
        }
    }
    Ok(())
}

fn shape(bytes: &[u8]) -> Result<Vec<Option<u64>>, String> {
    let mut sizes = Vec::new();
    for field in Fields::new(bytes, "shape") {
        let field = field?;
        if field.number == value_info::DIM {
            sizes.push(dimension(field.bytes()?)?);
        }
    }
    Ok(sizes)
}

fn dimension(bytes: &[u8]) -> Result<Option<u64>, String> {
    let mut size = None;
    for field in Fields::new(bytes, "dimension") {
        let field = field?;
        if field.number == value_info::DIM_VALUE {
            size = Some(field.number()?);
        }
    }
    Ok(size)
}
