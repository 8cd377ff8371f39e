//! The numbers of a training, and where they come from.

use pubs_draw::document::{Block, Details, Field, Table};
use pubs_policy::Goal;

use super::TrainingInput;
use crate::evaluation::Figures;
use crate::learning::LearningCurves;
use crate::report::text::or_nothing;
use crate::reproduce::numbers::{decimal, percent};

pub(super) fn numbers(input: &TrainingInput<'_>) -> Vec<Block> {
    let contract = input.contract;
    let mut blocks = Vec::new();
    if let Some(curves) = input.curves {
        blocks.push(Block::Subheading("Seeds".to_owned()));
        blocks.push(Block::Table(seeds(curves)));
    }
    let shield = or_nothing(contract.shield, |shield| {
        format!("mass {}, flattening {}", shield.mass, shield.flattening)
    });
    let goal = match contract.goal {
        Goal::Every => "every".to_owned(),
        Goal::Fixed { value, fraction } => format!("{value} (fraction {fraction})"),
    };
    blocks.push(Block::Subheading("Policy".to_owned()));
    blocks.push(Block::Table(Table::pairs([
        ("goal, rad, m or plain", goal),
        ("tolerance, rad, m or plain", contract.tolerance.to_string()),
        (
            "mean reward in its evaluation",
            decimal(contract.evaluation_reward, 4),
        ),
        ("steps of training", contract.steps.to_string()),
        ("discount per step", contract.discount.to_string()),
        (
            "policy steps per second",
            contract.policy_rate_hz.to_string(),
        ),
        ("shield", shield),
        ("actions", contract.actions.join(", ")),
    ])));
    let mut inputs = Table::new(&["input", "unit", "from", "to"]);
    for input in &contract.inputs {
        inputs.push([
            input.name.to_string(),
            input.unit.clone(),
            input.lower.to_string(),
            input.upper.to_string(),
        ]);
    }
    blocks.push(Block::Table(inputs));
    blocks
}

fn seeds(curves: &LearningCurves) -> Table {
    let mut table = Table::new(&[
        "seed",
        "trials",
        "discounted reward",
        "reward",
        "success",
        "violations",
        "time-outs",
        "failed stops",
    ]);
    let row = |name: String, found: &Figures, bold: bool| {
        let estimate = |mean: f64, se: f64| format!("{} ± {}", decimal(mean, 3), decimal(se, 3));
        let fields = [
            name,
            found.trials.to_string(),
            estimate(
                found.mean_discounted_reward,
                found.mean_discounted_reward_se,
            ),
            estimate(found.mean_reward, found.mean_reward_se),
            percent(found.success_rate),
            found.safety_violations.to_string(),
            found.time_outs.to_string(),
            found.failed_stops.to_string(),
        ];
        fields.map(|text| Field::bold_if(text, bold)).to_vec()
    };
    for curve in &curves.seeds {
        let kept = curve.seed == curves.best;
        table
            .rows
            .push(row(curve.seed.to_string(), &curve.selection, kept));
    }
    let fresh = format!("{}, fresh trials", curves.best);
    table.rows.push(row(fresh, &curves.evaluation, true));
    table
}

pub(super) fn provenance(input: &TrainingInput<'_>) -> Vec<Block> {
    let contract = input.contract;
    let curves = match input.curves {
        Some(_) => LearningCurves::file_of(input.file.path())
            .display()
            .to_string(),
        None => "not kept".to_owned(),
    };
    let table = Table::pairs([
        ("policy", input.file.path().display().to_string()),
        ("learning curves", curves),
        ("format", contract.format_version.to_string()),
        ("engine", contract.engine_version.clone()),
        ("object", contract.object.clone()),
        ("method", contract.method.to_string()),
        ("recipe", contract.recipe.clone()),
        ("seed", contract.seed.to_string()),
        ("sha256 of its weights", input.file.sha256().to_owned()),
        ("task hash", contract.task_hash.clone()),
        ("observation hash", contract.observation_hash.clone()),
    ]);
    let task = serde_json::from_str::<serde_json::Value>(&contract.task)
        .and_then(|task| serde_json::to_string_pretty(&task));
    let details = Block::Details(Details {
        summary: "The task that it was trained for".to_owned(),
        text: task.unwrap_or_else(|_| contract.task.clone()),
    });
    vec![Block::Table(table), details]
}
