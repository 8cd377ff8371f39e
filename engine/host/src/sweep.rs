//! One look at all of a model before it is used.

use pubs_plugin::{Channel, ChannelKind, ModelSetup, Support, Transitions};

use crate::call::Failure;
use crate::{HostError, ModelInstance};

/// States looked at per action.
const STATES: usize = 257;

/// Asks every action's answer at states from limit to limit and checks each value. Returns whether
/// the model is Gaussian.
pub(crate) fn sweep(model: &ModelInstance, setup: &ModelSetup) -> Result<bool, HostError> {
    let mut gaussian = None;
    for (action, described) in setup.actions.iter().enumerate() {
        let (before, after) = states(setup, described.displacement);
        let transitions = Transitions {
            action,
            before: &before,
            after: &after,
        };
        let answered = match moments(model, transitions)? {
            Support::Given => true,
            // Nothing is observed after an action that ends the episode; an answer is not needed.
            Support::Absent if described.stop => continue,
            Support::Absent => {
                density(model, transitions)?;
                false
            }
        };
        if *gaussian.get_or_insert(answered) != answered {
            let text = "moments are given for some actions and absent for others; a model is Gaussian or it is not";
            return Err(model.failed("moments", action, STATES, Failure::Value(text.to_owned())));
        }
    }
    Ok(gaussian.unwrap_or(true))
}

/// States from limit to limit, and where the action takes them.
pub(crate) fn states(setup: &ModelSetup, displacement: f64) -> (Vec<f32>, Vec<f32>) {
    let joint = &setup.joint;
    let state = |index: usize| {
        let state = joint.lower + (joint.upper - joint.lower) * index as f64 / (STATES - 1) as f64;
        if joint.integer { state.round() } else { state }
    };
    let before = (0..STATES).map(|index| state(index) as f32).collect();
    let moved = |index| (state(index) + displacement).clamp(joint.lower, joint.upper) as f32;
    (before, (0..STATES).map(moved).collect())
}

fn moments(model: &ModelInstance, transitions: Transitions<'_>) -> Result<Support, HostError> {
    let cells = model.channels().len() * transitions.after.len();
    // What the plugin forgets to fill stays NaN and is found.
    let (mut mean, mut sigma) = (vec![f32::NAN; cells], vec![f32::NAN; cells]);
    let support = model.moments(transitions, &mut mean, &mut sigma)?;
    if support == Support::Given {
        model.check_finite(transitions.action, transitions.after, &mean, &sigma)?;
    }
    Ok(support)
}

/// A model without moments must sample, and find its own samples possible.
fn density(model: &ModelInstance, transitions: Transitions<'_>) -> Result<(), HostError> {
    let (channels, count, action) = (
        model.channels().len(),
        transitions.after.len(),
        transitions.action,
    );
    let fault =
        |function, text: String| model.failed(function, action, count, Failure::Value(text));
    let absent = |function| {
        fault(
            function,
            "absent, as `moments` is; a model that is not Gaussian must provide it".to_owned(),
        )
    };
    // A spread of quantiles, the same each time.
    let normals: Vec<f32> = (0..channels * count)
        .map(|index| ((index * 37 % 41) as f32 - 20.0) / 10.0)
        .collect();
    let mut observations = vec![f32::NAN; channels * count];
    if model.sample(transitions, &normals, &mut observations)? == Support::Absent {
        return Err(absent("sample"));
    }
    if let Some(text) = bad_observation(model.channels(), transitions.after, &observations) {
        return Err(fault("sample", text));
    }
    let mut log_likelihood = vec![f32::NAN; count];
    for own in [0, count / 2, count - 1] {
        let observation: Vec<f32> = (0..channels)
            .map(|channel| observations[channel * count + own])
            .collect();
        log_likelihood.fill(f32::NAN);
        if model.log_likelihood(transitions, &observation, &mut log_likelihood)? == Support::Absent
        {
            return Err(absent("log_likelihood"));
        }
        if let Some(at) = log_likelihood
            .iter()
            .position(|value| value.is_nan() || *value == f32::INFINITY)
        {
            let (value, state) = (log_likelihood[at], transitions.after[at]);
            return Err(fault(
                "log_likelihood",
                format!("{value} at state {state}; expected a finite number or -inf"),
            ));
        }
        if log_likelihood[own] == f32::NEG_INFINITY {
            let text = format!(
                "the model calls {observation:?} impossible at state {}, where it drew it",
                transitions.after[own]
            );
            return Err(fault("log_likelihood", text));
        }
    }
    Ok(())
}

/// The first moment that breaks the contract, in words.
pub(crate) fn bad_moment(
    channels: &[Channel],
    states: &[f32],
    mean: &[f32],
    sigma: &[f32],
) -> Option<String> {
    let count = states.len();
    for (c, channel) in channels.iter().enumerate() {
        for (i, state) in states.iter().enumerate() {
            let (Some(mean), Some(sigma)) = (mean.get(c * count + i), sigma.get(c * count + i))
            else {
                continue;
            };
            let place = format_args!("channel `{}` at state {state}", channel.name);
            match channel.kind {
                ChannelKind::Gaussian if !mean.is_finite() => {
                    return Some(format!("mean {mean} of {place}; expected a finite number"));
                }
                ChannelKind::Gaussian if !(sigma.is_finite() && *sigma > 0.0) => {
                    return Some(format!(
                        "sigma {sigma} of {place}; expected a finite number above 0"
                    ));
                }
                ChannelKind::Bernoulli if !(0.0..=1.0).contains(mean) => {
                    return Some(format!("probability {mean} of {place}; expected 0 to 1"));
                }
                _ => {}
            }
        }
    }
    None
}

/// The first component of an observation that breaks the contract, in words.
pub(crate) fn bad_observation(
    channels: &[Channel],
    states: &[f32],
    observations: &[f32],
) -> Option<String> {
    let count = states.len();
    for (channel, values) in channels.iter().zip(observations.chunks(count.max(1))) {
        let fits = |value: &f32| match channel.kind {
            ChannelKind::Gaussian => value.is_finite(),
            ChannelKind::Bernoulli => *value == 0.0 || *value == 1.0,
        };
        if let Some(at) = values.iter().position(|value| !fits(value)) {
            let (value, state) = (values[at], states[at]);
            let rule = match channel.kind {
                ChannelKind::Gaussian => "a finite number",
                ChannelKind::Bernoulli => "0 or 1",
            };
            return Some(format!(
                "{value} in channel `{}` at state {state}; expected {rule}",
                channel.name
            ));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rule_of_the_moments_is_checked() {
        let channel = |name: &str, kind| Channel {
            name: name.to_owned(),
            kind,
        };
        let channels = [
            channel("f_d", ChannelKind::Gaussian),
            channel("m_p", ChannelKind::Bernoulli),
        ];
        let check =
            |mean: [f32; 4], sigma: [f32; 4]| bad_moment(&channels, &[0.0, 0.5], &mean, &sigma);
        let good_sigma = [1.0, 1.0, f32::NAN, 0.0];
        assert_eq!(
            check([5.0, -5.0, 0.0, 1.0], good_sigma),
            None,
            "sigma of a Bernoulli channel is not read"
        );
        let cases = [
            (
                [f32::NAN, 0.0, 0.0, 0.0],
                good_sigma,
                "mean NaN of channel `f_d` at state 0;",
            ),
            (
                [0.0, f32::INFINITY, 0.0, 0.0],
                good_sigma,
                "mean inf of channel `f_d` at state 0.5",
            ),
            (
                [0.0; 4],
                [1.0, 0.0, 1.0, 1.0],
                "sigma 0 of channel `f_d` at state 0.5",
            ),
            ([0.0; 4], [-1.0, 1.0, 1.0, 1.0], "sigma -1 of"),
            ([0.0; 4], [f32::NAN, 1.0, 1.0, 1.0], "sigma NaN of"),
            (
                [0.0, 0.0, 1.5, 0.0],
                good_sigma,
                "probability 1.5 of channel `m_p` at state 0;",
            ),
            (
                [0.0, 0.0, 0.0, f32::NAN],
                good_sigma,
                "probability NaN of channel `m_p` at state 0.5",
            ),
        ];
        for (mean, sigma, expected) in cases {
            let text = check(mean, sigma).unwrap_or_default();
            assert!(
                text.starts_with(expected),
                "`{text}` should begin `{expected}`"
            );
        }
    }

    #[test]
    fn each_rule_of_an_observation_is_checked() {
        let channel = |name: &str, kind| Channel {
            name: name.to_owned(),
            kind,
        };
        let channels = [
            channel("f_d", ChannelKind::Gaussian),
            channel("m_p", ChannelKind::Bernoulli),
        ];
        let check = |observations: [f32; 4]| bad_observation(&channels, &[0.0, 0.5], &observations);
        assert_eq!(check([-3.0, 2.0, 0.0, 1.0]), None);
        assert!(check([0.0, f32::NAN, 0.0, 1.0]).is_some());
        assert!(check([0.0, 0.0, 0.5, 1.0]).is_some());
    }
}
