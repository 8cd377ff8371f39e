//! The force sensor: what is measured of a true wrench.

use std::f64::consts::TAU;

use nalgebra::Vector3;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::plant::Wrench;
use crate::world::SensorModel;

/// A sensor that samples at every tick, read or not, so its noise depends on time alone.
#[derive(Debug, Clone)]
pub struct Sensor {
    model: SensorModel,
    noise: Xoshiro256PlusPlus,
    offsets: Xoshiro256PlusPlus,
    bias_n: Vector3<f64>,
    drift_n_per_s: Vector3<f64>,
    since_tare_s: f64,
    correlated_n: Vector3<f64>,
    filtered: Wrench,
    sample: Wrench,
}

impl Sensor {
    /// A tared sensor that has long seen `wrench` (tool axes).
    pub fn new(model: SensorModel, seed: u64, wrench: Wrench) -> Self {
        let mut noise = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut offsets = noise.clone();
        offsets.jump();
        let correlated_n = normals(&mut noise) * model.correlated_n;
        let mut sensor = Self {
            model,
            noise,
            offsets,
            bias_n: Vector3::zeros(),
            drift_n_per_s: Vector3::zeros(),
            since_tare_s: 0.0,
            correlated_n,
            filtered: wrench,
            sample: wrench,
        };
        sensor.tare();
        sensor.tick(0.0, 0.0, wrench);
        sensor
    }

    /// Draws what a tare leaves behind. It takes the sensor's own offset away, never the force
    /// that the grasp has at that moment: a real tare is done before the contact.
    pub fn tare(&mut self) {
        self.bias_n = normals(&mut self.offsets) * self.model.bias_sd_n;
        self.drift_n_per_s = normals(&mut self.offsets) * (self.model.drift_n_per_minute / 60.0);
        self.since_tare_s = 0.0;
    }

    /// Takes a sample, `step_s` and `travel_m` of the tool after the one before.
    pub fn tick(&mut self, step_s: f64, travel_m: f64, wrench: Wrench) {
        let model = self.model;
        self.since_tare_s += step_s;
        let kept = (-TAU * model.bandwidth_hz * step_s).exp();
        let kept = if kept.is_nan() { 0.0 } else { kept };
        self.filtered.force = wrench.force + (self.filtered.force - wrench.force) * kept;
        self.filtered.torque = wrench.torque + (self.filtered.torque - wrench.torque) * kept;
        if model.correlated_n > 0.0 {
            let faded = (-(step_s / model.correlation_s + travel_m / model.correlation_m)).exp();
            let fresh = model.correlated_n * (1.0 - faded * faded).sqrt();
            self.correlated_n = self.correlated_n * faded + normals(&mut self.noise) * fresh;
        }
        let force = self.filtered.force
            + self.bias_n
            + model.offset_n
            + self.drift_n_per_s * self.since_tare_s
            + self.correlated_n
            + normals(&mut self.noise) * model.white_n;
        self.sample.force = force.map(|component| quantised(component, model.quantum_n));
        self.sample.torque =
            self.filtered.torque + normals(&mut self.noise) * model.torque_white_nm;
    }

    /// The newest sample.
    pub fn sample(&self) -> Wrench {
        self.sample
    }
}

fn quantised(value: f64, quantum: f64) -> f64 {
    if quantum > 0.0 {
        (value / quantum).round() * quantum
    } else {
        value
    }
}

/// Three standard normals.
pub(crate) fn normals(source: &mut Xoshiro256PlusPlus) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(source))
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUIET: SensorModel = SensorModel {
        white_n: 0.0,
        correlated_n: 0.0,
        correlation_m: f64::INFINITY,
        correlation_s: f64::INFINITY,
        bias_sd_n: 0.0,
        drift_n_per_minute: 0.0,
        quantum_n: 0.0,
        bandwidth_hz: f64::INFINITY,
        torque_white_nm: 0.0,
        offset_n: Vector3::new(0.0, 0.0, 0.0),
    };

    fn samples(model: SensorModel, count: usize, travel_m: f64) -> Vec<f64> {
        let mut sensor = Sensor::new(model, 3, Wrench::default());
        let mut take = || {
            sensor.tick(0.001, travel_m, Wrench::default());
            sensor.sample().force.x
        };
        (0..count).map(|_| take()).collect()
    }

    fn moments(values: &[f64], lag: usize) -> (f64, f64) {
        let count = (values.len() - lag) as f64;
        let variance = values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
        let product = values
            .iter()
            .zip(&values[lag..])
            .map(|(a, b)| a * b)
            .sum::<f64>()
            / count;
        (variance.sqrt(), product / variance)
    }

    #[test]
    fn noises_have_their_size_and_correlation() {
        let (sd, correlation) = moments(
            &samples(
                SensorModel {
                    white_n: 0.3,
                    ..QUIET
                },
                100_000,
                0.0,
            ),
            1,
        );
        assert!((sd - 0.3).abs() < 0.005, "white noise has sd {sd}");
        assert!(
            correlation.abs() < 0.02,
            "white noise is correlated by {correlation}"
        );
        let model = SensorModel {
            correlated_n: 0.2,
            correlation_m: 0.015,
            ..QUIET
        };
        let (sd, correlation) = moments(&samples(model, 400_000, 0.001), 15);
        assert!((sd - 0.2).abs() < 0.02, "correlated noise has sd {sd}");
        assert!(
            (correlation - (-1f64).exp()).abs() < 0.06,
            "1/e after 15 mm, found {correlation}"
        );
    }

    #[test]
    fn low_pass_lets_one_minus_one_over_e_through_after_its_time_constant() {
        let model = SensorModel {
            bandwidth_hz: 1000.0 / TAU / 10.0,
            ..QUIET
        };
        let mut sensor = Sensor::new(model, 1, Wrench::default());
        let step = Wrench {
            force: Vector3::new(10.0, 0.0, 0.0),
            torque: Vector3::zeros(),
        };
        (0..10).for_each(|_| sensor.tick(0.001, 0.0, step));
        let seen = sensor.sample().force.x;
        assert!(
            (seen - 10.0 * (1.0 - (-1f64).exp())).abs() < 1e-9,
            "saw {seen} N"
        );
    }

    #[test]
    fn output_is_a_whole_number_of_steps() {
        for value in samples(
            SensorModel {
                white_n: 1.0,
                quantum_n: 0.05,
                ..QUIET
            },
            100,
            0.0,
        ) {
            let steps = value / 0.05;
            assert!(
                (steps - steps.round()).abs() < 1e-9,
                "{value} is {steps} steps of 0.05"
            );
        }
    }
}
