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
            let cure = match kind {
                "input" => "name as many inputs as it has columns",
                _ => "give the object that it was made for",
            };
            Err(Fault::Shape(format!(
                "has an {kind} {name:?} of shape {found}, not [batch, {width}]; {cure}"
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use std::collections::BTreeMap;

    fn value(name: &str, batch: Option<u64>, width: u64) -> ValueInfo {
        ValueInfo {
            name: name.to_owned(),
            float32: true,
            shape: Some(vec![batch, Some(width)]),
        }
    }

    /// Two inputs, three actions and a state of four.
    fn recurrent() -> Model {
        Model {
            ir_version: 8,
            opset: 17,
            metadata: BTreeMap::new(),
            inputs: vec![value(INPUT, None, 2), value(STATE_INPUT, None, 4)],
            outputs: vec![value(OUTPUT, None, 3), value(STATE_OUTPUT, None, 4)],
            weights_sha256: String::new(),
            model_sha256: String::new(),
            not_finite: None,
        }
    }

    #[test]
    fn a_state_reads_by_name() {
        let wanted = Layout {
            features: 2,
            actions: 3,
            state: 4,
            single_rows: false,
        };
        let mut model = recurrent();
        assert_eq!(Layout::of_ours(&model, 2, 3, 4).unwrap(), wanted);
        model.inputs.reverse();
        model.outputs.reverse();
        assert_eq!(Layout::of_ours(&model, 2, 3, 4).unwrap(), wanted);
    }

    #[test]
    fn a_state_that_is_malformed_is_refused() {
        type Spoil = fn(&mut Model);
        let cases: [(Spoil, &str); 11] = [
            (|m| _ = m.inputs.pop(), "has no input named \"state_in\""),
            (
                |m| m.inputs[1].name = "state".into(),
                "has no input named \"state_in\"",
            ),
            (|m| _ = m.outputs.pop(), "has no output named \"state_out\""),
            (
                |m| m.inputs[1].shape = Some(vec![None, Some(8)]),
                "has an input \"state_in\" of shape [any, 8], not [batch, 4]",
            ),
            (
                |m| m.outputs[1].shape = Some(vec![None, Some(2)]),
                "has an output \"state_out\" of shape [any, 2], not [batch, 4]",
            ),
            (
                |m| m.inputs[1].shape = Some(vec![Some(1), None, Some(4)]),
                "has an input \"state_in\" of shape [1, any, 4], not [batch, 4]",
            ),
            (
                |m| m.inputs[1].shape = None,
                "has an input \"state_in\" of shape unknown",
            ),
            (
                |m| m.inputs[1].float32 = false,
                "has an input \"state_in\" that is not float32",
            ),
            (
                |m| m.inputs[1].shape = Some(vec![Some(1), Some(4)]),
                "has inputs of different numbers of rows",
            ),
            (
                |m| m.inputs.push(value("mask", None, 1)),
                "has 3 inputs [\"belief\", \"state_in\", \"mask\"], not \"belief\" and \"state_in\" alone",
            ),
            (
                |m| m.outputs.push(value("value", None, 1)),
                "has 3 outputs [\"logits\", \"state_out\", \"value\"], not",
            ),
        ];
        for (spoil, part) in cases {
            let mut model = recurrent();
            spoil(&mut model);
            let fault = Layout::of_ours(&model, 2, 3, 4).unwrap_err().to_string();
            assert!(fault.contains(part), "{fault:?} lacks {part:?}");
        }
    }

    #[test]
    fn a_state_that_nobody_speaks_of_is_refused() {
        let fault = Layout::of_ours(&recurrent(), 2, 3, 0).unwrap_err();
        assert_eq!(
            fault.to_string(),
            "has 2 inputs [\"belief\", \"state_in\"], not one"
        );
        let fault = Layout::of_foreign(&recurrent(), 2, 3).unwrap_err();
        let part = "a policy of another trainer that carries a state is not supported";
        assert!(fault.to_string().contains(part), "{fault}");
    }
}
