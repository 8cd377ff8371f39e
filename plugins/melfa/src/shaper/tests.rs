//! Ramps against their closed form, and bounds under whatever is asked.

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;

const CYCLE_S: f64 = 0.0035;
const JERK: Bounds = Bounds {
    linear: 500.0,
    angular: 1800.0,
};
const ACCELERATION: Bounds = Bounds {
    linear: 5.0,
    angular: 18.0,
};

fn linear(x: f64) -> Motion {
    Motion {
        linear: Vector3::new(x, 0.0, 0.0),
        angular: Vector3::zeros(),
    }
}

/// Cycles until the velocity is `to`, and the distance travelled meanwhile.
fn ramp(shaper: &mut Shaper, to: &Motion) -> (usize, f64) {
    let mut distance = 0.0;
    for cycle in 1..10_000 {
        distance += shaper.step(to, &ACCELERATION).linear.x * CYCLE_S;
        if shaper.velocity() == to && shaper.acceleration.is_zero() {
            return (cycle, distance);
        }
    }
    panic!("never arrived at {to:?}");
}

/// Time of a change of velocity by v: v/a + a/J where the acceleration has a plateau (v ≥ a²/J),
/// 2√(v/J) where it has not; the mean velocity meanwhile is half of v, since the ramp is symmetric.
fn closed_form(speed: f64) -> (f64, f64) {
    let (a, jerk) = (ACCELERATION.linear, JERK.linear);
    let duration = if speed >= a * a / jerk {
        speed / a + a / jerk
    } else {
        2.0 * (speed / jerk).sqrt()
    };
    (duration, 0.5 * speed * duration)
}

#[test]
fn ramps_take_the_time_and_the_way_of_the_closed_form() {
    // a²/J = 0.05 m/s: with and without a plateau.
    for speed in [0.01, 0.03, 0.05, 0.15, 0.25] {
        let (duration, distance) = closed_form(speed);
        let mut shaper = Shaper::new(CYCLE_S, JERK);
        let up = ramp(&mut shaper, &linear(speed));
        let down = ramp(&mut shaper, &Motion::default());
        for (name, (cycles, travelled)) in [("up", up), ("down", down)] {
            let took = cycles as f64 * CYCLE_S;
            assert!(
                (took - duration).abs() <= 3.0 * CYCLE_S,
                "{name} to {speed} m/s took {took:.4} s, closed form {duration:.4} s"
            );
            assert!(
                (travelled - distance).abs() <= 2.0 * CYCLE_S * speed,
                "{name} to {speed} m/s went {travelled:.6} m, closed form {distance:.6} m"
            );
        }
        assert!(shaper.is_at_rest());
    }
}

#[test]
fn a_ramp_does_not_pass_what_is_wanted() {
    let mut shaper = Shaper::new(CYCLE_S, JERK);
    let mut greatest: f64 = 0.0;
    for _ in 0..200 {
        greatest = greatest.max(shaper.step(&linear(0.15), &ACCELERATION).linear.x);
    }
    assert!(greatest <= 0.15 + 1e-12, "went {greatest} m/s");
    let mut least = greatest;
    for _ in 0..200 {
        least = least.min(shaper.step(&Motion::default(), &ACCELERATION).linear.x);
    }
    assert!(least >= -1e-12, "a stop ran backwards: {least} m/s");
}

fn random_motion(source: &mut Xoshiro256PlusPlus, size: f64) -> Motion {
    let mut part = |size: f64| Vector3::from_fn(|_, _| source.random_range(-size..=size));
    Motion {
        linear: part(size),
        angular: part(4.0 * size),
    }
}

#[test]
fn bounds_hold_whatever_is_asked() {
    let mut source = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut shaper = Shaper::new(CYCLE_S, JERK);
    let (mut before, mut rate_before) = (Motion::default(), Motion::default());
    for _ in 0..2_000 {
        let wanted = match source.random_range(0..4) {
            0 => Motion::default(),
            _ => random_motion(&mut source, 0.2),
        };
        for _ in 0..source.random_range(1..40) {
            let velocity = shaper.step(&wanted, &ACCELERATION);
            let rate = velocity.plus(&before, -1.0).scaled(1.0 / CYCLE_S);
            let jerk = rate.plus(&rate_before, -1.0).scaled(1.0 / CYCLE_S);
            let slack = 1.0 + 1e-6;
            for (name, found, bound) in [
                ("acceleration", rate.linear.norm(), ACCELERATION.linear),
                (
                    "angular acceleration",
                    rate.angular.norm(),
                    ACCELERATION.angular,
                ),
                ("jerk", jerk.linear.norm(), JERK.linear),
                ("angular jerk", jerk.angular.norm(), JERK.angular),
            ] {
                assert!(found <= bound * slack, "{name} {found}, bound {bound}");
            }
            (before, rate_before) = (velocity, rate);
        }
    }
}

#[test]
fn linear_and_angular_part_keep_step() {
    // Round a hinge at 0.32 m: the turn is the travel over the radius, at every moment.
    let wanted = Motion {
        linear: Vector3::new(0.15, 0.0, 0.0),
        angular: Vector3::new(0.0, 0.0, 0.15 / 0.32),
    };
    let mut shaper = Shaper::new(CYCLE_S, JERK);
    for cycle in 0..60 {
        let to = if cycle < 30 {
            wanted
        } else {
            Motion::default()
        };
        let velocity = shaper.step(&to, &ACCELERATION);
        let off = velocity.angular.z - velocity.linear.x / 0.32;
        assert!(off.abs() < 1e-12, "cycle {cycle}: off by {off} rad/s");
    }
}

#[test]
fn what_lags_behind_comes_to_rest() {
    let mut shaper = Shaper::new(CYCLE_S, JERK);
    ramp(&mut shaper, &linear(0.15));
    shaper.lag_behind((-0.35f64).exp());
    let left = shaper.velocity().linear.x;
    assert!((left - 0.15 * (-0.35f64).exp()).abs() < 1e-12, "{left}");
    shaper.lag_behind(1e-9);
    assert!(shaper.is_at_rest());
}
