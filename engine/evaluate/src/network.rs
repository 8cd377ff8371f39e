//! From the trainer's network to the policy file's: names, units, ranges and scaling of inputs.

use pubs_core::belief::{Model, ModelError};
use pubs_core::{Input, Task};
use pubs_plugin::{ChannelKind, Transitions};
use pubs_policy::{Feature, FeatureName};
use pubs_train::{InputRange, InputScaling};

/// States at which the range of a reading is found.
const PROBED_STATES: usize = 101;

/// The inputs of a policy, named and scaled as the recipe wants them.
///
/// # Errors
/// Where the observation model cannot say what its readings are like.
pub fn features(
    task: &Task,
    model: &dyn Model,
    inputs: &[Input],
    range: InputRange,
) -> Result<Vec<Feature>, ModelError> {
    let inputs = inputs.iter();
    inputs
        .map(|&input| feature(task, model, input, range))
        .collect()
}

/// Offsets and scales alone, for the trainer.
pub fn scaling(features: &[Feature]) -> InputScaling {
    InputScaling {
        offset: features.iter().map(|f| f.offset as f32).collect(),
        scale: features.iter().map(|f| f.scale as f32).collect(),
    }
}

fn feature(
    task: &Task,
    model: &dyn Model,
    input: Input,
    range: InputRange,
) -> Result<Feature, ModelError> {
    let joint = &task.joint;
    let (offset, scale) = range.of(task);
    let (offset, scale) = (f64::from(offset), f64::from(scale));
    let state = |name| Feature {
        name,
        unit: joint.unit().to_owned(),
        lower: joint.lower,
        upper: joint.upper,
        offset,
        scale,
    };
    Ok(match input {
        Input::MeanState => state(FeatureName::MeanState),
        Input::Goal => state(FeatureName::Goal),
        Input::Entropy => share(FeatureName::Entropy),
        Input::RandomEntropy => share(FeatureName::RandomEntropy),
        // In halves of the range, whatever range the mean is scaled to.
        Input::MeanMinusGoal => Feature {
            name: FeatureName::MeanMinusGoal,
            unit: joint.unit().to_owned(),
            lower: -joint.range(),
            upper: joint.range(),
            offset: 0.0,
            scale: f64::from(2.0 / joint.range() as f32),
        },
        Input::Reading(channel) => reading(task, model, channel)?,
    })
}

/// A number from 0 to 1, as it is.
fn share(name: FeatureName) -> Feature {
    Feature {
        name,
        unit: "1".to_owned(),
        lower: 0.0,
        upper: 1.0,
        offset: 0.0,
        scale: 1.0,
    }
}

/// A force is brought to the order of 1 by the largest mean that the model knows of it.
fn reading(task: &Task, model: &dyn Model, channel: usize) -> Result<Feature, ModelError> {
    let described = &model.channels()[channel];
    let name = FeatureName::Reading(described.name.clone());
    if described.kind == ChannelKind::Bernoulli {
        return Ok(share(name));
    }
    let largest = largest_mean(task, model, channel)?;
    let unit = if task.control.is_some() { "N" } else { "1" };
    Ok(Feature {
        name,
        unit: unit.to_owned(),
        lower: -largest,
        upper: largest,
        offset: 0.0,
        scale: f64::from((1.0 / largest) as f32),
    })
}

fn largest_mean(task: &Task, model: &dyn Model, channel: usize) -> Result<f64, ModelError> {
    let joint = &task.joint;
    let states: Vec<f32> = (0..PROBED_STATES)
        .map(|index| joint.at_fraction(index as f64 / (PROBED_STATES - 1) as f64) as f32)
        .collect();
    let size = model.channels().len() * PROBED_STATES;
    let (mut mean, mut sigma) = (vec![0.0; size], vec![0.0; size]);
    let mut largest = 0.0_f32;
    for (action, _) in task.movements() {
        let transitions = Transitions {
            action,
            before: &states,
            after: &states,
        };
        model.moments(transitions, &mut mean, &mut sigma)?;
        let means = &mean[channel * PROBED_STATES..(channel + 1) * PROBED_STATES];
        largest = means
            .iter()
            .fold(largest, |most, mean| most.max(mean.abs()));
    }
    // A channel without moments, or without force, is taken as it is.
    Ok(if largest > 0.0 {
        f64::from(largest)
    } else {
        1.0
    })
}
