//! A policy at work: belief features in, logits out, an action chosen.

use std::path::Path;

use ort::session::Session;
use ort::value::{DynValue, TensorRef};

use crate::layout::Layout;
use crate::onnx::{INPUT, OUTPUT, STATE_INPUT, STATE_OUTPUT};
use crate::{FeatureName, PolicyError, PolicyFile, Runtime};

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
    /// A recurrent policy was run as a perceptron.
    #[error("the policy carries a state of {width} numbers from step to step, and none was given")]
    Recurrent {
        /// Numbers per row.
        width: usize,
    },
    /// The caller's rows of state do not fit.
    #[error("a state of {values} numbers is not {batch} rows of {width}")]
    StateLength {
        /// Numbers given.
        values: usize,
        /// Rows said.
        batch: usize,
        /// Numbers per row.
        width: usize,
    },
    /// NaN or infinity in the state, whether it came in or out.
    #[error("number {number} of the state of row {row} is {value}")]
    State {
        /// Which row.
        row: usize,
        /// Which number of it.
        number: usize,
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

    /// Numbers that a row carries from step to step; 0 for a perceptron.
    #[must_use]
    pub fn state_width(&self) -> usize {
        self.layout.state
    }

    /// Runs `batch` rows through a perceptron: `inputs` is `[batch][features]` in SI, `out` becomes
    /// `[batch][actions]`.
    ///
    /// # Errors
    /// Where a number on either side is not finite, the rows do not fit or the runtime fails; `out`
    /// is then empty. A recurrent policy is run by [`Policy::logits_with_state`].
    pub fn logits(
        &mut self,
        inputs: &[f32],
        batch: usize,
        out: &mut Vec<f32>,
    ) -> Result<(), RunError> {
        let width = self.layout.state;
        if width > 0 {
            out.clear();
            return Err(RunError::Recurrent { width });
        }
        self.logits_with_state(inputs, batch, &mut [], out)
    }

    /// Takes one step of `batch` episodes, with any policy.
    ///
    /// `inputs` is `[batch][features]` in SI, `out` becomes `[batch][actions]`. `state` is
    /// `[batch][state_width]`, empty for a perceptron: all zeros in the row of an episode that
    /// begins, and afterwards what its next step wants. [`State`](crate::State) says how it lies.
    ///
    /// # Errors
    /// Where a number on either side is not finite, the rows do not fit or the runtime fails; `out`
    /// is then empty and `state` as it was.
    pub fn logits_with_state(
        &mut self,
        inputs: &[f32],
        batch: usize,
        state: &mut [f32],
        out: &mut Vec<f32>,
    ) -> Result<(), RunError> {
        out.clear();
        self.check_inputs(inputs, batch)?;
        self.check_state(state, batch)?;
        let mut next = Vec::with_capacity(state.len());
        let result = self.run_all(inputs, batch, state, out, &mut next);
        match result.and_then(|()| self.check_outputs(out, &next)) {
            Ok(()) => state.copy_from_slice(&next),
            Err(fault) => {
                out.clear();
                return Err(fault);
            }
        }
        Ok(())
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
        let fault = |(row, feature, value)| RunError::Input {
            row,
            feature,
            value,
        };
        not_finite(inputs, features).map(fault).map_or(Ok(()), Err)
    }

    fn check_state(&self, state: &[f32], batch: usize) -> Result<(), RunError> {
        let width = self.layout.state;
        if batch.checked_mul(width) != Some(state.len()) {
            return Err(RunError::StateLength {
                values: state.len(),
                batch,
                width,
            });
        }
        let fault = |(row, number, value)| RunError::State { row, number, value };
        not_finite(state, width).map(fault).map_or(Ok(()), Err)
    }

    fn check_outputs(&self, logits: &[f32], state: &[f32]) -> Result<(), RunError> {
        let of_logit = |(row, action, value)| RunError::Logit { row, action, value };
        let of_state = |(row, number, value)| RunError::State { row, number, value };
        let logit = not_finite(logits, self.layout.actions).map(of_logit);
        let fault = logit.or_else(|| not_finite(state, self.layout.state).map(of_state));
        fault.map_or(Ok(()), Err)
    }

    fn run_all(
        &mut self,
        inputs: &[f32],
        batch: usize,
        state: &[f32],
        out: &mut Vec<f32>,
        next: &mut Vec<f32>,
    ) -> Result<(), RunError> {
        let at_once = if self.layout.single_rows {
            1
        } else {
            batch.max(1)
        };
        let (features, width) = (self.layout.features, self.layout.state);
        for (index, rows) in inputs.chunks_exact(at_once * features).enumerate() {
            let state = &state[index * at_once * width..][..at_once * width];
            self.run(rows, state, at_once, out, next)?;
        }
        Ok(())
    }

    fn run(
        &mut self,
        rows: &[f32],
        state: &[f32],
        count: usize,
        out: &mut Vec<f32>,
        next: &mut Vec<f32>,
    ) -> Result<(), RunError> {
        let Layout {
            features,
            actions,
            state: width,
            ..
        } = self.layout;
        let tensor = |values, width| TensorRef::from_array_view(([count, width], values));
        let rows = tensor(rows, features).map_err(failed)?;
        if width == 0 {
            // Files of other trainers have their own names.
            let outputs = self.session.run(ort::inputs![rows]).map_err(failed)?;
            return append("logits", &outputs[0], [count, actions], out);
        }
        let state = tensor(state, width).map_err(failed)?;
        let inputs = ort::inputs![INPUT => rows, STATE_INPUT => state];
        let outputs = self.session.run(inputs).map_err(failed)?;
        append("logits", &outputs[OUTPUT], [count, actions], out)?;
        append("a state", &outputs[STATE_OUTPUT], [count, width], next)
    }
}

fn failed(fault: ort::Error) -> RunError {
    RunError::Runtime(fault.to_string())
}

/// Adds a tensor's values to `to`, where it has the shape that it should have.
fn append(
    what: &str,
    from: &DynValue,
    wanted: [usize; 2],
    to: &mut Vec<f32>,
) -> Result<(), RunError> {
    let (shape, values) = from.try_extract_tensor::<f32>().map_err(failed)?;
    if **shape != wanted.map(|size| size as i64) {
        return Err(RunError::Runtime(format!(
            "{what} of shape {:?}, not {wanted:?}",
            &**shape
        )));
    }
    to.extend_from_slice(values);
    Ok(())
}

/// The first number that is NaN or infinite: its row, its place there, itself.
fn not_finite(values: &[f32], width: usize) -> Option<(usize, usize, f32)> {
    let at = values.iter().position(|value| !value.is_finite())?;
    Some((at / width, at % width, values[at]))
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
