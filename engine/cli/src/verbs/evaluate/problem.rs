//! Alpha vectors that were solved from a `.pomdp` file, judged on trials of that problem.

use std::path::{Path, PathBuf};

use pubs_solve::{TrialOptions, TrialSummary, simulate};
use serde::Serialize;

use super::{Arguments, alpha, has_end, tell};
use crate::failure::Failure;
use crate::{Ended, exit, pomdp_file};

/// One policy's figures, as `--json` has them.
#[derive(Serialize)]
struct Report {
    policy: PathBuf,
    problem: String,
    seed: u64,
    trials: usize,
    mean_reward: f64,
    mean_reward_se: f64,
    mean_discounted_reward: f64,
    mean_discounted_reward_se: f64,
    mean_steps: f64,
    time_outs: usize,
    /// The bounds that the solver gave on the discounted reward.
    lower: f64,
    upper: f64,
}

pub(super) fn run(arguments: &Arguments, file: &Path) -> Ended {
    let of_objects = [
        (arguments.goal.is_some(), "--goal"),
        (arguments.no_shield, "--no-shield"),
        (!arguments.inputs.is_empty(), "--inputs"),
        (
            arguments.frequency.belief_frequency.is_some(),
            "--belief-frequency",
        ),
        (!arguments.layers.set.is_empty(), "--set"),
    ];
    if let Some((_, option)) = of_objects.iter().find(|(given, _)| *given) {
        return Err(Failure::invalid(format!(
            "{option} is for objects; {} is a problem of its own",
            file.display()
        )));
    }
    let pomdp = pomdp_file::load(file)?;
    let mut reports = Vec::new();
    for path in &arguments.policies {
        if has_end(path, "onnx") {
            return Err(Failure::incompatible(format!(
                "{} is a policy network, which reads the belief of an object; {} takes alpha vectors (.json), as `solve` writes them",
                path.display(),
                file.display()
            )));
        }
        let policy = alpha::read(path)?;
        policy
            .check_problem(&pomdp)
            .map_err(|error| Failure::incompatible(format!("{}: {error}", path.display())))?;
        let options = TrialOptions {
            trials: arguments.trials as usize,
            max_steps: arguments.max_steps as usize,
            seed: arguments.seed,
        };
        let found = simulate(&pomdp, &policy, &options);
        reports.push(report(path, &policy, found, arguments.seed));
    }
    tell(&reports, arguments.json, text)?;
    Ok(exit::DONE)
}

fn report(path: &Path, policy: &pubs_solve::AlphaPolicy, found: TrialSummary, seed: u64) -> Report {
    let (lower, upper) = policy.bounds();
    Report {
        policy: path.to_owned(),
        problem: policy.problem().to_owned(),
        seed,
        trials: found.trials,
        mean_reward: found.reward.mean,
        mean_reward_se: found.reward.standard_error,
        mean_discounted_reward: found.discounted.mean,
        mean_discounted_reward_se: found.discounted.standard_error,
        mean_steps: found.steps.mean,
        time_outs: found.trials - found.ended,
        lower,
        upper,
    }
}

fn text(report: &Report) -> String {
    format!(
        "{}: {}, {} trials\n\
         reward             {:.4} ± {:.4}\n\
         discounted reward  {:.4} ± {:.4} (the solver's bounds: {:.4} to {:.4})\n\
         steps              {:.1}\n\
         cut off            {} (a problem without an end goes on)",
        report.policy.display(),
        report.problem,
        report.trials,
        report.mean_reward,
        report.mean_reward_se,
        report.mean_discounted_reward,
        report.mean_discounted_reward_se,
        report.lower,
        report.upper,
        report.mean_steps,
        report.time_outs,
    )
}
