//! A policy at work: belief features in, logits out, an action chosen.

use std::path::Path;

use ort::session::Session;
use ort::value::TensorRef;

use crate::{FeatureName, PolicyError, PolicyFile, Runtime};

/// How the rows of inputs and logits lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub features: usize,
    pub actions: usize,
    /// The file takes one row at a time.
    pub single_rows: bool,
}

/// An open policy, for one thread; open the [`PolicyFile`] again for another.
#[derive(Debug)]
pub struct Policy {
    session: Session,
    layout: Layout,
}

/// A policy that gave no logits. Stop the arm.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RunError {
    /// The caller's rows do not fit.
    #[error("{values} values are not {batch} rows of {features} inputs")]
    Length {
        /// Values given.
        values: usize,
        /// Rows said.
        batch: usize,
        /// Inputs per row.
        features: usize,
    },
    /// NaN or infinity came in.
    #[error("input {feature} of row {row} is {value}")]
    Input {
        /// Which row.
        row: usize,
        /// Which input of it.
        feature: usize,
        /// What it was.
        value: f32,
    },
    /// NaN or infinity came out.
    #[error("the logit of action {action} in row {row} is {value}")]
    Logit {
        /// Which row.
        row: usize,
        /// Which action.
        action: usize,
        /// What it was.
        value: f32,
    },
    /// The runtime failed.
    #[error("the runtime failed: {0}")]
    Runtime(String),
}

impl Policy {
    pub(crate) fn new(session: Session, layout: Layout) -> Self {
        Self { session, layout }
    }

    /// Reads, checks and opens a file that carries a contract.
    ///
    /// # Errors
    /// As [`PolicyFile::read`] and [`PolicyFile::open`].
    pub fn load(path: &Path, runtime: &Runtime) -> Result<Self, PolicyError> {
        PolicyFile::read(path)?.open(runtime)
    }

    /// Reads, checks and opens a file of another trainer.
    ///
    /// # Errors
    /// As [`PolicyFile::read_foreign`] and [`PolicyFile::open`].
    pub fn load_foreign(
        path: &Path,
        runtime: &Runtime,
        inputs: &[FeatureName],
        actions: usize,
    ) -> Result<Self, PolicyError> {
        PolicyFile::read_foreign(path, inputs, actions)?.open(runtime)
    }

    /// The number of inputs per row.
    #[must_use]
    pub fn features(&self) -> usize {
        self.layout.features
    }

    /// The number of logits per row.
    #[must_use]
    pub fn actions(&self) -> usize {
        self.layout.actions
    }

    /// Runs `batch` rows: `inputs` is `[batch][features]` in SI, `out` becomes `[batch][actions]`.
    ///
    /// # Errors
    /// Where a number on either side is not finite, the rows do not fit or the runtime fails; `out`
    /// is then empty.
    pub fn logits(
        &mut self,
        inputs: &[f32],
        batch: usize,
        out: &mut Vec<f32>,
    ) -> Result<(), RunError> {
        out.clear();
        self.check_inputs(inputs, batch)?;
        if batch == 0 {
            return Ok(());
        }
        let rows_at_once = if self.layout.single_rows { 1 } else { batch };
        for rows in inputs.chunks_exact(rows_at_once * self.layout.features) {
            if let Err(fault) = self.run(rows, rows_at_once, out) {
                out.clear();
                return Err(fault);
            }
        }
        let faulty = out.iter().position(|logit| !logit.is_finite());
        faulty.map_or(Ok(()), |at| Err(self.logit_fault(at, out)))
    }

    fn check_inputs(&self, inputs: &[f32], batch: usize) -> Result<(), RunError> {
        let features = self.layout.features;
        if batch.checked_mul(features) != Some(inputs.len()) {
            return Err(RunError::Length {
                values: inputs.len(),
                batch,
                features,
            });
        }
        match inputs.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(at) => Err(RunError::Input {
                row: at / features,
                feature: at % features,
                value: inputs[at],
            }),
        }
    }

    fn run(&mut self, rows: &[f32], count: usize, out: &mut Vec<f32>) -> Result<(), RunError> {
        let failed = |fault: ort::Error| RunError::Runtime(fault.to_string());
        let tensor =
            TensorRef::from_array_view(([count, self.layout.features], rows)).map_err(failed)?;
        let outputs = self.session.run(ort::inputs![tensor]).map_err(failed)?;
        let (shape, logits) = outputs[0].try_extract_tensor::<f32>().map_err(failed)?;
        let wanted = [count as i64, self.layout.actions as i64];
        if **shape != wanted {
            return Err(RunError::Runtime(format!(
                "logits of shape {:?}, not {wanted:?}",
                &**shape
            )));
        }
        out.extend_from_slice(logits);
        Ok(())
    }

    fn logit_fault(&self, at: usize, out: &mut Vec<f32>) -> RunError {
        let (row, action) = (at / self.layout.actions, at % self.layout.actions);
        let value = out[at];
        out.clear();
        RunError::Logit { row, action, value }
    }
}

/// The action with the largest logit among those allowed; `stop` always is, and of equal ones the
/// lowest index wins.
///
/// A NaN is never chosen; where nothing else is left, `stop` is.
#[must_use]
pub fn choose(logits: &[f32], stop: usize, allowed: impl Fn(usize) -> bool) -> usize {
    let mut best: Option<usize> = None;
    for (action, logit) in logits.iter().enumerate() {
        let permitted = action == stop || allowed(action);
        if permitted && !logit.is_nan() && best.is_none_or(|best| *logit > logits[best]) {
            best = Some(action);
        }
    }
    best.unwrap_or(stop)
}

#[cfg(test)]
mod tests {
    use super::choose;

    #[test]
    fn choice_by_hand() {
        let all = [true; 4];
        let only_last = [false, false, false, true];
        let none = [false; 4];
        type Case = (&'static str, [f32; 4], usize, [bool; 4], usize);
        let cases: [Case; 8] = [
            ("largest", [0.0, 3.0, 2.0, 1.0], 0, all, 1),
            (
                "largest is masked",
                [0.0, 3.0, 2.0, 4.0],
                0,
                [true, true, true, false],
                1,
            ),
            ("tie goes to the lowest", [1.0, 2.0, 2.0, 2.0], 0, all, 1),
            (
                "stop is never masked",
                [5.0, 3.0, 2.0, 1.0],
                0,
                only_last,
                0,
            ),
            (
                "stop is worse than what is left",
                [0.0, 3.0, 2.0, 1.0],
                0,
                only_last,
                3,
            ),
            ("only stop is left", [-9.0, 3.0, 2.0, 1.0], 0, none, 0),
            ("stop elsewhere", [9.0, 3.0, 2.0, 1.0], 2, none, 2),
            (
                "NaN is not chosen",
                [f32::NAN, 1.0, f32::NAN, 0.5],
                0,
                all,
                1,
            ),
        ];
        for (name, logits, stop, mask, expected) in cases {
            assert_eq!(
                choose(&logits, stop, |action| mask[action]),
                expected,
                "{name}"
            );
        }
        assert_eq!(choose(&[f32::NAN; 4], 3, |_| true), 3, "all NaN");
    }
}
