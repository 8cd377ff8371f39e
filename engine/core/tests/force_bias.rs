//! The filter whose particles carry a force bias, against the joint density of all readings.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;
#[path = "common/hump.rs"]
mod hump;

use std::sync::Arc;

use hump::{Hump, entropy_of_places, mean, probability, sigma, story};
use nalgebra::{DMatrix, DVector};
use pubs_core::Task;
use pubs_core::belief::{BeliefError, Filter, ForceBias, Model, ModelError, Update};
use pubs_core::vector::VectorUnit;
use pubs_plugin::{Channel, Support, Transitions};

const OPEN: usize = 1;
const CLOSE: usize = 2;

fn door(particles: usize, tempering: f64, bias: ForceBias) -> Task {
    let mut task = common::door(particles);
    task.belief.tempering = tempering;
    task.belief.force_bias = Some(bias);
    task
}

fn bias(offset_sd_n: f64, offset_walk_n: f64, friction_sd_n: f64) -> ForceBias {
    ForceBias {
        offset_sd_n,
        offset_walk_n,
        friction_sd_n,
    }
}

/// A reading of f_d under one hypothesis.
#[derive(Clone)]
struct Reading {
    residual: f64,
    sigma: f64,
    /// −1 while closing, else 1.
    sign: f64,
}

/// ln ∫ Π_k N(z_k; μ_k + h_k o_k + f, σ_k²)^τ p(o, f) do df, but for what is the same at every
/// particle. o is a random walk, so the residuals are jointly normal with covariance h_j h_k (sd² +
/// walk² · min(j, k)) + friction²; and N(…, σ²)^τ is a normal of variance σ²/τ times a factor that
/// grows as σ^(1 − τ).
fn log_density_of(readings: &[Reading], tempering: f64, bias: ForceBias) -> f64 {
    let count = readings.len();
    let covariance = DMatrix::from_fn(count, count, |j, k| {
        let offset = bias.offset_sd_n.powi(2) + bias.offset_walk_n.powi(2) * (j.min(k) + 1) as f64;
        let common = readings[j].sign * readings[k].sign * offset + bias.friction_sd_n.powi(2);
        let own = readings[j].sigma.powi(2) / tempering;
        common + if j == k { own } else { 0.0 }
    });
    let residuals = DVector::from_iterator(count, readings.iter().map(|reading| reading.residual));
    let cholesky = covariance.cholesky().unwrap();
    let ln_root: f64 = cholesky.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
    let factors: f64 = readings.iter().map(|reading| reading.sigma.ln()).sum();
    (1.0 - tempering) * factors - ln_root - 0.5 * residuals.dot(&cholesky.solve(&residuals))
}

/// One particle of the brute-force posterior.
#[derive(Clone, Default)]
struct Hypothesis {
    state: f64,
    readings: Vec<Reading>,
    log_of_moved: f64,
}

impl Hypothesis {
    fn follow(&mut self, displacement: f64, force: f32, moved: bool) {
        let of_moved = probability(self.state);
        self.log_of_moved += if moved { of_moved } else { 1.0 - of_moved }.ln();
        self.state = (self.state + displacement).clamp(0.0, 2.0);
        self.readings.push(Reading {
            residual: f64::from(force) - mean(self.state),
            sigma: sigma(self.state),
            sign: if displacement < 0.0 { -1.0 } else { 1.0 },
        });
    }
}

#[test]
fn posterior_agrees_with_the_joint_density_of_all_readings() {
    const PARTICLES: usize = 100;
    let cases = [
        (1.0, bias(0.4, 0.0, 0.0)),
        (1.0, bias(0.0, 0.0, 0.5)),
        (0.25, bias(0.1, 0.05, 0.3)),
        (0.5, bias(2.0, 0.02, 1.0)),
    ];
    for (tempering, bias) in cases {
        let task = door(PARTICLES, tempering, bias);
        for unit in VectorUnit::available() {
            let mut filter = Filter::on(unit, &task, Arc::new(Hump::new(true, true)));
            let spacing = 2.0 / (PARTICLES - 1) as f64;
            let at = |index| Hypothesis {
                state: spacing * index as f64,
                ..Hypothesis::default()
            };
            let mut hypotheses: Vec<Hypothesis> = (0..PARTICLES).map(at).collect();
            for (step, (displacement, force, moved)) in story().into_iter().enumerate() {
                let action = if displacement < 0.0 { CLOSE } else { OPEN };
                let update = filter
                    .update(action, displacement, &[force, f32::from(u8::from(moved))])
                    .unwrap();
                assert_eq!(update, Update::Weighed, "step {step} called impossible");
                for hypothesis in &mut hypotheses {
                    hypothesis.follow(displacement, force, moved);
                }
                if step % 15 == 0 || step > 90 {
                    let case = format!("{unit}, tempering {tempering}, {bias:?}, step {step}");
                    compare(&filter, &hypotheses, tempering, bias, &case);
                }
            }
        }
    }
}

fn compare(
    filter: &Filter,
    hypotheses: &[Hypothesis],
    tempering: f64,
    bias: ForceBias,
    case: &str,
) {
    let log = |hypothesis: &Hypothesis| {
        hypothesis.log_of_moved + log_density_of(&hypothesis.readings, tempering, bias)
    };
    let logs: Vec<f64> = hypotheses.iter().map(log).collect();
    let states: Vec<f64> = hypotheses.iter().map(|h| h.state).collect();
    let max = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = logs.iter().map(|log| (log - max).exp()).collect();
    let total: f64 = weights.iter().sum();
    let mean = weights.iter().zip(&states).map(|(w, s)| w * s).sum::<f64>() / total;
    let entropy = entropy_of_places(&states, &weights) / (hypotheses.len() as f64).ln();
    let found = filter.summary();
    assert!(
        (found.mean - mean).abs() < 5e-4 && (found.entropy - entropy).abs() < 2e-3,
        "{case}: found {found:?}, expected mean {mean}, entropy {entropy}"
    );
}

#[test]
fn without_a_bias_to_speak_of_it_is_the_plain_filter() {
    let mut plain_task = common::door(300);
    plain_task.belief.tempering = 0.25;
    let model = || Arc::new(Hump::new(true, true));
    let mut plain = Filter::new(&plain_task, model());
    let mut biased = Filter::new(&door(300, 0.25, bias(0.0, 0.0, 0.0)), model());
    for (step, (displacement, force, moved)) in story().into_iter().enumerate() {
        let observation = [force, f32::from(u8::from(moved))];
        plain.update(OPEN, displacement, &observation).unwrap();
        biased.update(OPEN, displacement, &observation).unwrap();
        let (plain, biased) = (plain.summary(), biased.summary());
        assert!(
            (plain.mean - biased.mean).abs() < 1e-4
                && (plain.entropy - biased.entropy).abs() < 1e-4,
            "step {step}: {plain:?} without biases, {biased:?} with biases of 0 N"
        );
    }
}

#[test]
fn what_a_reading_is_off_by_is_not_taken_for_another_place() {
    // From 1.2 rad on the force rises by 2 N/rad only, so 1 N too much looks like half a radian.
    // To and fro, an offset adds to f_d and takes from it, and friction adds always.
    let holds_truth = |task: &Task, offset: f64, friction: f64| {
        let mut filter = Filter::new(task, Arc::new(Hump::new(true, true)));
        let mut state = 1.2;
        for displacement in [0.01; 15].into_iter().chain([-0.01; 15]) {
            state += displacement;
            let (action, sign) = if displacement < 0.0 {
                (CLOSE, -1.0)
            } else {
                (OPEN, 1.0)
            };
            let felt = (mean(state) + sign * offset + friction) as f32;
            filter.update(action, displacement, &[felt, 1.0]).unwrap();
        }
        let (from, to) = filter.interval(0.9);
        from <= state && state <= to
    };
    let plain = common::door(300);
    let offset = door(300, 1.0, bias(1.0, 0.0, 0.0));
    let friction = door(300, 1.0, bias(0.0, 0.0, 1.0));
    let cases = [
        ("nothing", &plain, 0.0, 0.0, true),
        ("nothing", &plain, 0.0, 1.0, false),
        ("an offset", &offset, 1.0, 0.0, true),
        ("an offset", &offset, 0.0, 1.0, false),
        ("friction", &friction, 0.0, 1.0, true),
    ];
    for (expecting, task, offset_n, friction_n, expected) in cases {
        assert_eq!(
            holds_truth(task, offset_n, friction_n),
            expected,
            "whether the 90 % interval of a filter that expects {expecting} holds the truth where \
             the offset is {offset_n} N and friction {friction_n} N more"
        );
    }
}

/// The hump, but what is expected under one action is not a number.
struct NotANumber(Hump);

impl NotANumber {
    const ACTION: usize = 3;
}

impl Model for NotANumber {
    fn channels(&self) -> &[Channel] {
        self.0.channels()
    }

    fn moments(
        &self,
        on: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        let action = on.action;
        let support = self.0.moments(on, mean, sigma)?;
        if action == Self::ACTION {
            mean[0] = f32::NAN;
        }
        Ok(support)
    }
}

#[test]
fn a_failed_update_leaves_the_biases_as_they_were() {
    let task = door(300, 0.25, bias(0.5, 0.02, 0.3));
    let model = || Arc::new(NotANumber(Hump::new(false, true)));
    let (mut disturbed, mut twin) = (Filter::new(&task, model()), Filter::new(&task, model()));
    for (step, (displacement, force, moved)) in story().into_iter().take(40).enumerate() {
        let observation = [force, f32::from(u8::from(moved))];
        let error = disturbed
            .update(NotANumber::ACTION, displacement, &observation)
            .expect_err("no likelihood can come of this");
        assert!(matches!(error, BeliefError::NotANumber { .. }), "{error}");
        disturbed.update(OPEN, displacement, &observation).unwrap();
        twin.update(OPEN, displacement, &observation).unwrap();
        // A failed update normalises again, which moves a last digit.
        let apart = disturbed.log_weights().iter().zip(twin.log_weights());
        let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-3, "step {step}: log weights {apart} apart");
    }
}

#[test]
fn a_model_without_moments_is_refused() {
    let mut filter = Filter::new(
        &door(300, 1.0, bias(0.5, 0.0, 0.0)),
        Arc::new(Hump::new(false, false)),
    );
    let error = filter.update(OPEN, 0.0, &[1.0, 1.0]).unwrap_err();
    assert!(error.to_string().contains("moments"), "{error}");
}
