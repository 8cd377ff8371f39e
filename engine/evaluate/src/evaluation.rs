//! Many trials of one policy, summed up.

use std::sync::Arc;
use std::time::Instant;

use pubs_core::Task;
use pubs_core::belief::Model;
use pubs_core::shield::Shield;
use pubs_core::vector::VectorUnit;
use pubs_policy::{PolicyFile, Runtime};
use pubs_run::inputs::resolve;
use pubs_train::surrogate::Stopped;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::decider::{Decider, NetworkDecider};
use crate::goal_errors::GoalErrors;
use crate::statistics::Sample;
use crate::trial::{BATCH, Trial, TrialError, TrialOptions, run_batch};

/// Which goal the trials have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GoalChoice {
    /// This state (rad, m or plain).
    One(f64),
    /// Drawn anew for each trial, as in training.
    Drawn,
}

/// How to evaluate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EvaluationOptions {
    /// Number of trials.
    pub trials: u64,
    /// Their goal.
    pub goal: GoalChoice,
    /// Cap on policy steps.
    pub max_steps: u32,
    /// Mask of high-force actions; `None` is the paper's way.
    pub shield: Option<Shield>,
    /// Seed of the trials: the same trials for every policy.
    pub seed: u64,
    /// Threads; `None`: all cores.
    pub threads: Option<usize>,
}

/// The figures of trials. States in rad, m or plain; field names are those of `--json` and of
/// stored cells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// How many.
    pub trials: u64,
    /// Mean sum of rewards.
    pub mean_reward: f64,
    /// Its standard error.
    pub mean_reward_se: f64,
    /// Mean Σ γ^t R_t.
    pub mean_discounted_reward: f64,
    /// Its standard error.
    pub mean_discounted_reward_se: f64,
    /// Share that stopped in the goal region.
    pub success_rate: f64,
    /// High-force actions that would have left the limits.
    pub safety_violations: u64,
    /// Trials that reached the cap.
    pub time_outs: u64,
    /// Stops outside the goal region, and trials in which the belief broke down.
    pub failed_stops: u64,
    /// Mean |s − s_g| of the trials that stopped; null where none did.
    pub mean_goal_error: Option<f64>,
    /// Mean policy steps.
    pub mean_steps: f64,
    /// Share of trials at whose end the belief's 90 % interval held the true state; null where
    /// there is no belief.
    pub coverage_90: Option<f64>,
}

/// The figures, and how they were come by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evaluation {
    /// What was found.
    #[serde(flatten)]
    pub figures: Figures,
    /// Trials in which the belief's recovery rule acted.
    pub recovered_trials: u64,
    /// How the goal errors of the trials that stopped are spread.
    pub goal_errors: GoalErrors,
    /// The vector unit on which the last bits depend.
    pub vector_unit: String,
    /// Wall time, s.
    pub time_s: f64,
    /// Trials per second of wall time.
    pub trials_per_s: f64,
}

/// Why an evaluation failed.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// The policy file cannot be run.
    #[error("{0}")]
    Open(String),
    /// A trial failed.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// Threads could not be made.
    #[error("cannot start {threads} threads: {message}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system said.
        message: String,
    },
    /// No trials were asked for.
    #[error("0 trials give no figures; ask for at least 1")]
    NoTrials,
}

/// A policy that is judged, opened once per thread.
pub trait Contestant: Sync {
    /// Opens it for the object at hand.
    ///
    /// # Errors
    /// Where it cannot be run, or reads what the object does not give.
    fn open(&self, task: &Task, model: &dyn Model) -> Result<Box<dyn Decider + '_>, EvaluateError>;
}

/// A policy file and what runs it.
#[derive(Debug, Clone, Copy)]
pub struct NetworkContestant<'a> {
    /// The file.
    pub file: &'a PolicyFile,
    /// The runtime.
    pub runtime: &'a Runtime,
}

impl Contestant for NetworkContestant<'_> {
    fn open(&self, task: &Task, model: &dyn Model) -> Result<Box<dyn Decider + '_>, EvaluateError> {
        let refused = |error: &dyn std::error::Error| EvaluateError::Open(error.to_string());
        let inputs = resolve(self.file.inputs(), model).map_err(|error| refused(&error))?;
        let policy = self
            .file
            .open(self.runtime)
            .map_err(|error| refused(&error))?;
        Ok(Box::new(NetworkDecider::new(policy, inputs, task.stop)))
    }
}

/// Runs randomised trials of a policy.
///
/// # Errors
/// [`EvaluateError`].
pub fn evaluate(
    task: &Arc<Task>,
    model: &Arc<dyn Model>,
    contestant: &dyn Contestant,
    options: &EvaluationOptions,
) -> Result<Evaluation, EvaluateError> {
    if options.trials == 0 {
        return Err(EvaluateError::NoTrials);
    }
    let begun = Instant::now();
    let trial_options = TrialOptions {
        goal: match options.goal {
            GoalChoice::One(state) => Some(state),
            GoalChoice::Drawn => None,
        },
        max_steps: options.max_steps,
        shield: options.shield,
        seed: options.seed,
    };
    let run = || {
        let batches = options.trials.div_ceil(BATCH);
        (0..batches)
            .into_par_iter()
            .map_init(
                || contestant.open(task, model.as_ref()),
                |decider, batch| -> Result<Vec<Trial>, EvaluateError> {
                    let decider = decider
                        .as_mut()
                        .map_err(|error| EvaluateError::Open(error.to_string()))?;
                    let first = batch * BATCH;
                    let count = BATCH.min(options.trials - first);
                    Ok(run_batch(
                        task,
                        model,
                        decider.as_mut(),
                        &trial_options,
                        first,
                        count,
                    )?)
                },
            )
            .collect::<Result<Vec<_>, _>>()
    };
    let trials = match options.threads {
        None => run()?,
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| EvaluateError::Threads {
                threads,
                message: error.to_string(),
            })?
            .install(run)?,
    };
    Ok(sum_up(
        trials.iter().flatten(),
        GoalErrors::of(task),
        begun.elapsed().as_secs_f64(),
    ))
}

fn sum_up<'t>(
    trials: impl Iterator<Item = &'t Trial>,
    mut goal_errors: GoalErrors,
    time_s: f64,
) -> Evaluation {
    let (mut reward, mut discounted, mut steps) =
        (Sample::default(), Sample::default(), Sample::default());
    let (mut goal_error, mut covered) = (Sample::default(), Sample::default());
    let [
        mut reached,
        mut missed,
        mut violated,
        mut time_outs,
        mut recovered,
    ] = [0; 5];
    for trial in trials {
        reward.add(trial.reward);
        discounted.add(trial.discounted_reward);
        steps.add(f64::from(trial.steps));
        if let Some(held) = trial.covered {
            covered.add(f64::from(u8::from(held)));
        }
        recovered += u64::from(trial.recoveries > 0);
        if matches!(trial.stopped, Some(Stopped::Reached | Stopped::Missed)) {
            goal_error.add(trial.goal_error);
            goal_errors.add(trial.goal_error);
        }
        *match trial.stopped {
            Some(Stopped::Reached) => &mut reached,
            Some(Stopped::Missed | Stopped::Lost) => &mut missed,
            Some(Stopped::Violated) => &mut violated,
            None => &mut time_outs,
        } += 1;
    }
    let count = reward.count();
    let figures = Figures {
        trials: count,
        mean_reward: reward.mean().unwrap_or(0.0),
        mean_reward_se: reward.standard_error().unwrap_or(0.0),
        mean_discounted_reward: discounted.mean().unwrap_or(0.0),
        mean_discounted_reward_se: discounted.standard_error().unwrap_or(0.0),
        success_rate: reached as f64 / count as f64,
        safety_violations: violated,
        time_outs,
        failed_stops: missed,
        mean_goal_error: goal_error.mean(),
        mean_steps: steps.mean().unwrap_or(0.0),
        coverage_90: covered.mean(),
    };
    Evaluation {
        figures,
        recovered_trials: recovered,
        goal_errors,
        vector_unit: VectorUnit::best().to_string(),
        time_s,
        trials_per_s: count as f64 / time_s,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_by_hand() {
        let trial = |reward, stopped, goal_error, covered| Trial {
            reward,
            discounted_reward: reward / 2.0,
            stopped,
            steps: 10,
            goal_error,
            covered: Some(covered),
            recoveries: 0,
        };
        let trials = [
            trial(0.8, Some(Stopped::Reached), 0.1, true),
            trial(-1.0, Some(Stopped::Missed), 0.5, false),
            trial(-1.0, Some(Stopped::Violated), 9.0, true),
            trial(-0.2, None, 9.0, true),
        ];
        let evaluation = sum_up(trials.iter(), GoalErrors::new(2.0, 0.2), 2.0);
        let found = evaluation.figures;
        assert!((found.mean_reward + 0.35).abs() < 1e-12, "{found:?}");
        assert!(
            (found.mean_discounted_reward + 0.175).abs() < 1e-12,
            "{found:?}"
        );
        assert_eq!(
            (
                found.success_rate,
                found.coverage_90,
                evaluation.trials_per_s
            ),
            (0.25, Some(0.75), 2.0)
        );
        assert_eq!(
            (found.safety_violations, found.time_outs, found.failed_stops),
            (1, 1, 1)
        );
        let counts = &evaluation.goal_errors.counts;
        assert_eq!(
            (counts[0], counts[2], counts.iter().sum::<u64>()),
            (1, 1, 2)
        );
        let error = found.mean_goal_error.unwrap_or(f64::NAN);
        assert!(
            (error - 0.3).abs() < 1e-12,
            "only stops have a goal error: {error}"
        );
    }
}
