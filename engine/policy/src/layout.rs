//! How the rows of a policy's tensors lie, checked against what its graph declares.

use crate::Fault;
use crate::onnx::{INPUT, Model, OUTPUT, STATE_INPUT, STATE_OUTPUT, ValueInfo};

/// Widths of the rows that go in and come out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub features: usize,
    pub actions: usize,
    /// Numbers carried from step to step; 0 for a perceptron.
    pub state: usize,
    /// The file takes one row at a time.
    pub single_rows: bool,
}

impl Layout {
    /// Of a file of this engine, whose tensors have the names that it gives them.
    pub fn of_ours(
        model: &Model,
        features: usize,
        actions: usize,
        state: usize,
    ) -> Result<Self, Fault> {
        if state == 0 {
            named(&model.inputs, INPUT, "input")?;
            named(&model.outputs, OUTPUT, "output")?;
            return Self::of_pair(model, features, actions);
        }
        let outputs = [(OUTPUT, actions), (STATE_OUTPUT, state)];
        two(&model.outputs, "output", outputs)?;
        let inputs = [(INPUT, features), (STATE_INPUT, state)];
        let rows = two(&model.inputs, "input", inputs)?;
        Self::new(features, actions, state, rows)
    }

    /// Of a file of another trainer, whose tensors may have any names.
    pub fn of_foreign(model: &Model, features: usize, actions: usize) -> Result<Self, Fault> {
        if model.inputs.len() > 1 {
            let found = counted(&model.inputs, "input");
            return Err(Fault::Shape(format!(
                "has {found}, not one; a policy of another trainer that carries a state is not supported"
            )));
        }
        Self::of_pair(model, features, actions)
    }

    /// One tensor goes in, one comes out.
    fn of_pair(model: &Model, features: usize, actions: usize) -> Result<Self, Fault> {
        let rows = sole(&model.inputs, "input", features)?;
        sole(&model.outputs, "output", actions)?;
        Self::new(features, actions, 0, rows)
    }

    fn new(
        features: usize,
        actions: usize,
        state: usize,
        rows: Option<u64>,
    ) -> Result<Self, Fault> {
        if features == 0 || actions == 0 {
            return Err(Fault::Shape(
                "needs at least one input and one action".into(),
            ));
        }
        Ok(Self {
            features,
            actions,
            state,
            single_rows: rows == Some(1),
        })
    }
}

fn named<'a>(values: &'a [ValueInfo], name: &str, kind: &str) -> Result<&'a ValueInfo, Fault> {
    values
        .iter()
        .find(|value| value.name == name)
        .ok_or_else(|| Fault::Shape(format!("has no {kind} named {name:?}")))
}

/// The only value; gives the batch where the file fixes it.
fn sole(values: &[ValueInfo], kind: &str, width: usize) -> Result<Option<u64>, Fault> {
    let [value] = values else {
        return Err(Fault::Shape(format!(
            "has {}, not one",
            counted(values, kind)
        )));
    };
    rows(value, kind, width)
}

/// The only two values, by name and width; gives the batch where the file fixes it.
fn two(values: &[ValueInfo], kind: &str, wanted: [(&str, usize); 2]) -> Result<Option<u64>, Fault> {
    let mut batches = [None; 2];
    for (batch, (name, width)) in batches.iter_mut().zip(wanted) {
        *batch = rows(named(values, name, kind)?, kind, width)?;
    }
    if values.len() != 2 {
        let [(first, _), (second, _)] = wanted;
        let found = counted(values, kind);
        return Err(Fault::Shape(format!(
            "has {found}, not {first:?} and {second:?} alone"
        )));
    }
    if batches[0] != batches[1] {
        return Err(Fault::Shape(format!(
            "has {kind}s of different numbers of rows"
        )));
    }
    Ok(batches[0])
}

fn counted(values: &[ValueInfo], kind: &str) -> String {
    let names: Vec<&str> = values.iter().map(|value| value.name.as_str()).collect();
    format!("{} {kind}s {names:?}", names.len())
}

/// float32 and `[batch, width]`; gives the batch where the file fixes it.
fn rows(value: &ValueInfo, kind: &str, width: usize) -> Result<Option<u64>, Fault> {
    let name = &value.name;
    if !value.float32 {
        return Err(Fault::Shape(format!(
            "has an {kind} {name:?} that is not float32"
        )));
    }
    match value.shape.as_deref() {
        Some([batch, columns]) if columns.is_none_or(|columns| columns == width as u64) => {
            match batch {
                None | Some(1) => Ok(*batch),
                Some(rows) => Err(Fault::Shape(format!(
                    "takes {rows} rows at once, not one or any number"
                ))),
            }
        }
        shape => {
            let found = shape.map_or("unknown".to_owned(), described);
            Err(Fault::Shape(format!(
                "has an {kind} {name:?} of shape {found}, not [batch, {width}]"
            )))
        }
    }
}

fn described(shape: &[Option<u64>]) -> String {
    let sizes: Vec<String> = shape
        .iter()
        .map(|size| size.map_or("any".to_owned(), |size| size.to_string()))
        .collect();
    format!("[{}]", sizes.join(", "))
}
