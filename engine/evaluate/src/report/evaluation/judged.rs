//! The JSON of an evaluation, read back.

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use crate::goal_errors::GoalErrors;

/// One policy's figures; what one kind of evaluation does not have is `None`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Judged {
    /// The policy's file.
    pub policy: String,
    /// The object, or...
    pub object: Option<String>,
    /// ...the problem, of alpha vectors that were judged on their own.
    pub problem: Option<String>,
    /// Unit of joint states: `rad`, `m` or `1`.
    pub unit: Option<String>,
    /// `every`, or a fraction of the range.
    pub goal: Option<String>,
    /// Whether high-force actions were masked.
    pub shield: Option<bool>,
    /// Of the trials.
    pub seed: u64,
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
    pub success_rate: Option<f64>,
    /// Trials that ended in a safety violation.
    pub safety_violations: Option<u64>,
    /// Trials that reached the cap.
    pub time_outs: Option<u64>,
    /// Stops outside the goal region.
    pub failed_stops: Option<u64>,
    /// Mean |s − s_g| of the stops.
    pub mean_goal_error: Option<f64>,
    /// How these are spread.
    pub goal_errors: Option<GoalErrors>,
    /// Mean policy steps.
    pub mean_steps: Option<f64>,
    /// Share of trials whose belief held the true state.
    pub coverage_90: Option<f64>,
    /// Trials in which the belief was started afresh.
    pub recovered_trials: Option<u64>,
    /// The vector unit on which the last bits depend.
    pub vector_unit: Option<String>,
    /// What ran the policy.
    pub runtime: Option<String>,
    /// Wall time, s.
    pub time_s: Option<f64>,
}

/// Why a JSON is no evaluation, in words.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NotJudged(String);

/// The figures of one policy or of several.
///
/// # Errors
/// Where the JSON is not what `evaluate --json` prints.
pub fn read(text: &str) -> Result<Vec<Judged>, NotJudged> {
    let no_json = |error: serde_json::Error| NotJudged(format!("no JSON: {error}"));
    let value: Value = serde_json::from_str(text).map_err(no_json)?;
    let all = match value.get("evaluations") {
        Some(Value::Array(all)) => all.clone(),
        _ => vec![value],
    };
    if all.is_empty() {
        return Err(NotJudged("it holds the figures of no policy".to_owned()));
    }
    let judged: Vec<Judged> = all
        .into_iter()
        .map(serde_json::from_value)
        .collect::<Result<_, _>>()
        .map_err(|error| NotJudged(format!("not what `evaluate --json` prints: {error}")))?;
    judged.iter().try_for_each(Judged::check)?;
    Ok(judged)
}

impl Judged {
    /// The object or the problem.
    pub fn subject(&self) -> String {
        let subject = self.object.as_ref().or(self.problem.as_ref());
        subject
            .cloned()
            .unwrap_or_else(|| "an unnamed object".to_owned())
    }

    /// The policy's name, less its folder.
    pub fn name(&self) -> String {
        let stem = Path::new(&self.policy).file_stem();
        stem.map_or_else(
            || self.policy.clone(),
            |stem| stem.to_string_lossy().into_owned(),
        )
    }

    /// Trials that stopped in the goal region.
    pub fn successes(&self) -> Option<u64> {
        self.success_rate
            .map(|share| (share * self.trials as f64).round() as u64)
    }

    fn check(&self) -> Result<(), NotJudged> {
        let shares = [self.success_rate, self.coverage_90];
        let bad = |share: &&f64| !(0.0..=1.0).contains(*share);
        if let Some(share) = shares.iter().flatten().find(bad) {
            return Err(NotJudged(format!(
                "a share of {share} is not one from 0 to 1"
            )));
        }
        if self.trials == 0 {
            return Err(NotJudged("it holds figures of no trials".to_owned()));
        }
        let ends = [self.safety_violations, self.time_outs, self.failed_stops];
        if let Some(count) = ends.iter().flatten().find(|count| **count > self.trials) {
            return Err(NotJudged(format!("{count} of {} trials", self.trials)));
        }
        match &self.goal_errors {
            Some(errors) if !errors.is_drawable() => {
                Err(NotJudged("\"goal_errors\" has no bins".to_owned()))
            }
            _ => Ok(()),
        }
    }
}
