//! The inputs that a policy file names, found in what the object at hand can give.

use pubs_core::Input;
use pubs_core::belief::Model;
use pubs_policy::FeatureName;

/// A reading that the object's observation model does not have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the policy reads the channel `{channel}`; the observation model has {}; read one of these", known.join(", "))]
pub struct UnknownChannel {
    channel: String,
    known: Vec<String>,
}

/// Resolves the names of a policy's inputs.
///
/// # Errors
/// Where a policy reads a channel that the model does not have.
pub fn resolve(names: &[FeatureName], model: &dyn Model) -> Result<Vec<Input>, UnknownChannel> {
    names.iter().map(|name| input(name, model)).collect()
}

fn input(name: &FeatureName, model: &dyn Model) -> Result<Input, UnknownChannel> {
    Ok(match name {
        FeatureName::MeanState => Input::MeanState,
        FeatureName::Entropy => Input::Entropy,
        FeatureName::MeanMinusGoal => Input::MeanMinusGoal,
        FeatureName::Goal => Input::Goal,
        FeatureName::RandomEntropy => Input::RandomEntropy,
        FeatureName::Reading(channel) => Input::Reading(place(channel, model)?),
    })
}

fn place(channel: &str, model: &dyn Model) -> Result<usize, UnknownChannel> {
    let channels = model.channels();
    let found = channels.iter().position(|known| known.name == channel);
    found.ok_or_else(|| UnknownChannel {
        channel: channel.to_owned(),
        known: channels.iter().map(|known| known.name.clone()).collect(),
    })
}
