//! What a policy does over mean and entropy.

use pubs_draw::document::Figure;
use pubs_policy::{Contract, Goal};
use serde_json::Value;

use super::{TrainingInput, TrainingPageError, figure};
use crate::asked::Asked;
use crate::reproduce::Heatmap;
use crate::reproduce::figures::heatmap;
use crate::reproduce::numbers::decimal;

/// Goals at which a policy for every goal is asked, as fractions of the range: the paper's.
const GOALS: [f64; 3] = [0.0, 0.5, 1.0];

/// One heatmap per goal; none of a policy that reads something else than the belief.
pub(super) fn figures(input: &TrainingInput<'_>) -> Result<Vec<Figure>, TrainingPageError> {
    let contract = input.contract;
    let fit = Asked::is_fit(input.file.inputs()) && contract.state.is_none();
    let Some(object) = Object::of(contract).filter(|_| fit) else {
        return Ok(Vec::new());
    };
    let goals = match contract.goal {
        Goal::Fixed { value, .. } => vec![value],
        Goal::Every => GOALS
            .map(|fraction| object.lower + fraction * (object.upper - object.lower))
            .to_vec(),
    };
    let mut policy = input.file.open(input.runtime)?;
    let mut figures = Vec::new();
    for goal in goals {
        let asked = Asked {
            limits: [object.lower, object.upper],
            goal,
            stop: object.stop,
        };
        let answers = asked.of(&mut policy, input.file.inputs())?;
        let map = Heatmap {
            task: contract.object.clone(),
            title: format!("Choices for the goal {}", object.shown(goal)),
            unit: object.unit.to_owned(),
            mean: answers
                .mean
                .iter()
                .map(|mean| mean * object.factor)
                .collect(),
            entropy: answers.entropy,
            action: answers.action,
            actions: contract.actions.clone(),
            goal: goal * object.factor,
        };
        let caption =
            "The action chosen for each mean and entropy of the belief, without the shield.";
        figures.push(figure(heatmap(&map)?, caption));
    }
    Ok(figures)
}

/// What the contract's task says of the object.
struct Object {
    lower: f64,
    upper: f64,
    stop: usize,
    unit: &'static str,
    factor: f64,
}

impl Object {
    /// `None` where the task is not one of this engine's.
    fn of(contract: &Contract) -> Option<Self> {
        let task: Value = serde_json::from_str(&contract.task).ok()?;
        let joint = &task["joint"];
        let (lower, upper) = (joint["lower"].as_f64()?, joint["upper"].as_f64()?);
        let stops = |action: &Value| action["mode"] == "stop";
        let stop = task["actions"].as_array()?.iter().position(stops)?;
        let (unit, factor) = match joint["type"].as_str()? {
            "revolute" => ("deg", 1_f64.to_degrees()),
            "prismatic" => ("cm", 100.0),
            _ => ("", 1.0),
        };
        let drawable = lower < upper && stop < contract.actions.len();
        drawable.then_some(Self {
            lower,
            upper,
            stop,
            unit,
            factor,
        })
    }

    fn shown(&self, state: f64) -> String {
        let number = decimal(state * self.factor, 1);
        format!("{number} {}", self.unit).trim_end().to_owned()
    }
}
