//! An evaluation as a person reads it.

use pubs_core::Joint;

use super::Report;

/// Figures one below the other; with several policies, each under its name.
pub(super) fn text(joint: &Joint, report: &Report, named: bool) -> String {
    let found = &report.evaluation;
    let error = found
        .figures
        .mean_goal_error
        .map_or_else(|| "–".to_owned(), |error| joint.display(error));
    let head = if named {
        format!("{}\n", report.policy.display())
    } else {
        String::new()
    };
    let coverage = found.figures.coverage_90.map_or_else(
        || "no belief".to_owned(),
        |share| {
            format!(
                "90 % interval held the true state in {:.1} %",
                100.0 * share
            )
        },
    );
    format!(
        "{head}{}, goal {}, {} trials, shield {}\n\
         reward             {:.4} ± {:.4}\n\
         discounted reward  {:.4} ± {:.4}\n\
         success            {:.2} %\n\
         safety violations  {}\n\
         time-outs          {}\n\
         failed stops       {}\n\
         goal error         {error} (mean of the stops)\n\
         steps              {:.1}\n\
         {coverage}\n\
         {:.2} s, {:.0} trials/s on {}",
        report.object,
        report.goal,
        found.figures.trials,
        if report.shield { "on" } else { "off" },
        found.figures.mean_reward,
        found.figures.mean_reward_se,
        found.figures.mean_discounted_reward,
        found.figures.mean_discounted_reward_se,
        100.0 * found.figures.success_rate,
        found.figures.safety_violations,
        found.figures.time_outs,
        found.figures.failed_stops,
        found.figures.mean_steps,
        found.time_s,
        found.trials_per_s,
        found.vector_unit,
    )
}
