//! The numbers of an evaluation, and where they come from.

use std::path::Path;

use pubs_draw::document::Table;

use super::judged::Judged;
use crate::report::text::{or_nothing, yes_or_no};
use crate::reproduce::numbers::{decimal, percent};

/// The unit in which a person reads the states, and how many of them are in one of the JSON's.
pub(super) fn factor_of(one: &Judged) -> (&'static str, f64) {
    match one.unit.as_deref() {
        Some("rad") => ("deg", 1_f64.to_degrees()),
        Some("m") => ("cm", 100.0),
        _ => ("", 1.0),
    }
}

/// Rewards in one table, how trials ended in another: neither is wide.
pub(super) fn numbers(judged: &[Judged]) -> Vec<Table> {
    let estimate = |mean: f64, se: f64| format!("{} ± {}", decimal(mean, 4), decimal(se, 4));
    let count = |count: Option<u64>| or_nothing(count, |count| count.to_string());
    let mut rewards = Table::new(&[
        "",
        "policy",
        "goal",
        "reward ± se",
        "discounted ± se",
        "steps",
    ]);
    let mut ends = Table::new(&[
        "",
        "trials",
        "success",
        "violations",
        "time-outs",
        "failed stops",
        "goal error",
        "coverage of 90 %",
        "recovered",
    ]);
    for (number, one) in (1..).zip(judged) {
        rewards.push([
            i32::to_string(&number),
            one.name(),
            or_nothing(one.goal.clone(), |goal| goal),
            estimate(one.mean_reward, one.mean_reward_se),
            estimate(one.mean_discounted_reward, one.mean_discounted_reward_se),
            or_nothing(one.mean_steps, |steps| decimal(steps, 1)),
        ]);
        let (unit, factor) = factor_of(one);
        let error = or_nothing(one.mean_goal_error, |error| {
            let number = decimal(error * factor, 3);
            format!("{number} {unit}").trim_end().to_owned()
        });
        ends.push([
            i32::to_string(&number),
            one.trials.to_string(),
            or_nothing(one.success_rate, percent),
            count(one.safety_violations),
            count(one.time_outs),
            count(one.failed_stops),
            error,
            or_nothing(one.coverage_90, percent),
            count(one.recovered_trials),
        ]);
    }
    vec![rewards, ends]
}

pub(super) fn provenance(source: &Path, judged: &[Judged]) -> Vec<Table> {
    let mut table = Table::new(&[
        "",
        "policy",
        "object",
        "shield",
        "seed",
        "run by",
        "vector unit",
        "time, s",
    ]);
    for (number, one) in (1..).zip(judged) {
        table.push([
            i32::to_string(&number),
            one.policy.clone(),
            one.subject(),
            or_nothing(one.shield, yes_or_no),
            one.seed.to_string(),
            or_nothing(one.runtime.clone(), |runtime| runtime),
            or_nothing(one.vector_unit.clone(), |unit| unit),
            or_nothing(one.time_s, |time_s| decimal(time_s, 2)),
        ]);
    }
    let source = if source.as_os_str() == "-" {
        "standard input".to_owned()
    } else {
        source.display().to_string()
    };
    vec![Table::pairs([("JSON", source)]), table]
}
