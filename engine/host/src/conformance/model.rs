//! The checks of an observation model.

use pubs_plugin::{ChannelKind, GridTransitions, ModelSetup, Support, Transitions};

use crate::call::Failure;
use crate::conformance::{ConformanceReport, bad_input, density, setup};
use crate::{HostError, ModelInstance, ModelPlugin, sweep};

/// How far the grid's answers may be from the others, in sigma, as share of sigma, in probability.
const GRID_TOLERANCE: f32 = 0.01;

/// Rounds that each of two threads asks everything.
const ROUNDS: usize = 20;

pub(super) fn check(
    report: &mut ConformanceReport,
    plugin: &ModelPlugin,
    own: Option<&ModelSetup>,
) {
    let general = setup::door(plugin.plugin().name());
    let setup = own.unwrap_or(&general);
    if let (Some(create), Some(destroy)) = (plugin.table.create, plugin.table.destroy) {
        report.record("bad setup", bad_input::garbage_setups(create, destroy));
    }
    let Some(mut model) = report.made("create", plugin.create_unswept(setup), own.is_none()) else {
        return;
    };
    report.record("channels", Ok(channels(&model)));
    match sweep::sweep(&model, setup) {
        Ok(gaussian) => {
            model.gaussian = gaussian;
            let kind = if gaussian {
                "moments of every action"
            } else {
                "likelihoods and samples of every action"
            };
            report.record(
                "values",
                Ok(format!("{kind} within their bounds from limit to limit")),
            );
        }
        Err(error) => {
            report.record("values", Err(error.to_string()));
            return;
        }
    }
    if model.gaussian {
        grid(report, &model, setup);
    }
    let density = if model.gaussian {
        engine_forms_it()
    } else {
        density::check(&model, setup)
    };
    report.record("density", density);
    report.record("determinism", determinism(plugin, &model, setup));
    report.record("threads", threads(&model, setup));
    report.record("bad arguments", bad_arguments(&model, setup));
}

fn engine_forms_it() -> Result<String, String> {
    Ok("Gaussian: the engine forms it from the moments".to_owned())
}

fn channels(model: &ModelInstance) -> String {
    let named = model.channels().iter().map(|channel| match channel.kind {
        ChannelKind::Gaussian => format!("{} (Gaussian)", channel.name),
        ChannelKind::Bernoulli => format!("{} (0 or 1)", channel.name),
    });
    named.collect::<Vec<_>>().join(", ")
}

/// `moments_grid` against `moments`.
fn grid(report: &mut ConformanceReport, model: &ModelInstance, setup: &ModelSetup) {
    let mut given = 0;
    for (action, described) in setup.actions.iter().enumerate() {
        match grid_of(model, setup, action, described.displacement) {
            Ok(Support::Given) => given += 1,
            Ok(Support::Absent) => {}
            Err(text) => {
                report.record("moments_grid", Err(text));
                return;
            }
        }
    }
    let total = setup.actions.len();
    let detail = match given {
        0 => "absent, which is allowed".to_owned(),
        _ => format!("agrees with moments, {given} of {total} actions"),
    };
    report.record("moments_grid", Ok(detail));
}

fn grid_of(
    model: &ModelInstance,
    setup: &ModelSetup,
    action: usize,
    displacement: f64,
) -> Result<Support, String> {
    let (lower, upper) = (setup.joint.lower, setup.joint.upper);
    let spacing = setup.belief.spacing as f32;
    let count = setup.belief.particles as usize;
    // Not on the limit, so that no rounding decides which side of it a point is.
    let first = lower as f32 + 0.3 * spacing;
    let grid = GridTransitions {
        action,
        before: first,
        after: first + displacement as f32,
        spacing,
        count,
    };
    let cells = model.channels().len() * count;
    let (mut mean, mut sigma) = (vec![f32::NAN; cells], vec![f32::NAN; cells]);
    let support = model
        .moments_grid(grid, &mut mean, &mut sigma)
        .map_err(in_words)?;
    if support == Support::Absent {
        return Ok(support);
    }
    let state = |start: f32| {
        (0..count)
            .map(|i| start + i as f32 * spacing)
            .collect::<Vec<f32>>()
    };
    let (before, after) = (state(grid.before), state(grid.after));
    let (mut mean_one, mut sigma_one) = (vec![f32::NAN; cells], vec![f32::NAN; cells]);
    let transitions = Transitions {
        action,
        before: &before,
        after: &after,
    };
    model
        .moments(transitions, &mut mean_one, &mut sigma_one)
        .map_err(in_words)?;
    let inside = |state: f32| f64::from(state) >= lower && f64::from(state) <= upper;
    for (c, channel) in model.channels().iter().enumerate() {
        for i in (0..count).filter(|i| inside(before[*i]) && inside(after[*i])) {
            let at = c * count + i;
            let (scale, compare_sigma) = match channel.kind {
                ChannelKind::Gaussian => (sigma_one[at], true),
                ChannelKind::Bernoulli => (1.0, false),
            };
            let near = |a: f32, b: f32| (a - b).abs() <= GRID_TOLERANCE * scale;
            if !near(mean[at], mean_one[at]) || compare_sigma && !near(sigma[at], sigma_one[at]) {
                return Err(format!(
                    "action {action}, channel `{}`, state {} to {}: moments_grid gives {} and {}, moments {} and {}",
                    channel.name,
                    before[i],
                    after[i],
                    mean[at],
                    sigma[at],
                    mean_one[at],
                    sigma_one[at]
                ));
            }
        }
    }
    Ok(Support::Given)
}

/// Everything a model says about the states from limit to limit, as bits.
fn all_answers(model: &ModelInstance, setup: &ModelSetup) -> Result<Vec<u32>, HostError> {
    let channels = model.channels().len();
    let mut bits = Vec::new();
    for (action, described) in setup.actions.iter().enumerate() {
        let (before, after) = sweep::states(setup, described.displacement);
        let transitions = Transitions {
            action,
            before: &before,
            after: &after,
        };
        let cells = channels * after.len();
        let (mut first, mut second) = (vec![0.0; cells], vec![0.0; cells]);
        if model.gaussian {
            model.moments(transitions, &mut first, &mut second)?;
        } else {
            let normals: Vec<f32> = (0..cells)
                .map(|index| (index % 7) as f32 / 3.0 - 1.0)
                .collect();
            model.sample(transitions, &normals, &mut first)?;
            let observation: Vec<f32> = (0..channels)
                .map(|channel| first[channel * after.len()])
                .collect();
            model.log_likelihood(transitions, &observation, &mut second[..after.len()])?;
        }
        bits.extend(first.iter().chain(&second).map(|value| value.to_bits()));
    }
    Ok(bits)
}

fn determinism(
    plugin: &ModelPlugin,
    model: &ModelInstance,
    setup: &ModelSetup,
) -> Result<String, String> {
    let first = all_answers(model, setup).map_err(in_words)?;
    if all_answers(model, setup).map_err(in_words)? != first {
        return Err("the same question, asked twice of one instance, got two answers".to_owned());
    }
    let mut twin = plugin.create_unswept(setup).map_err(in_words)?;
    twin.gaussian = model.gaussian;
    if all_answers(&twin, setup).map_err(in_words)? != first {
        return Err("two instances of the same setup and seed answer differently".to_owned());
    }
    Ok("the same bits twice, and from a second instance".to_owned())
}

fn threads(model: &ModelInstance, setup: &ModelSetup) -> Result<String, String> {
    let alone = all_answers(model, setup).map_err(in_words)?;
    let ask =
        || (0..ROUNDS).all(|_| all_answers(model, setup).is_ok_and(|answers| answers == alone));
    let agreed = std::thread::scope(|scope| {
        let threads = [scope.spawn(ask), scope.spawn(ask)];
        threads.map(|thread| thread.join().unwrap_or(false))
    });
    match agreed {
        [true, true] => Ok(format!(
            "two threads on one instance, {ROUNDS} rounds, the same bits"
        )),
        _ => Err("two threads on one instance got other answers than one alone".to_owned()),
    }
}

/// Past the host's own checks: no states at all, and an action that does not exist.
fn bad_arguments(model: &ModelInstance, setup: &ModelSetup) -> Result<String, String> {
    let none = model.moments_unchecked(0, &[], &[], &mut [], &mut []);
    if let Err(failure @ (Failure::Panic(_) | Failure::Status(_))) = none {
        return Err(format!("moments of no states: {failure}"));
    }
    let (state, cells) = ([setup.joint.lower as f32], model.channels().len());
    let (mut mean, mut sigma) = (vec![0.0; cells], vec![0.0; cells]);
    let beyond = setup.actions.len();
    match model.moments_unchecked(beyond, &state, &state, &mut mean, &mut sigma) {
        Err(Failure::Error(_)) => {}
        Ok(Support::Absent) if !model.gaussian => {}
        Ok(_) => {
            return Err(format!(
                "moments of action {beyond}, which does not exist, are answered; expected an error"
            ));
        }
        Err(failure) => {
            return Err(format!(
                "moments of action {beyond}, which does not exist: {failure}"
            ));
        }
    }
    Ok("no states and an action that does not exist, each answered by a status".to_owned())
}

fn in_words(error: HostError) -> String {
    error.to_string()
}
