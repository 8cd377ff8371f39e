//! From the engine's staircase of velocities to one that the arm can follow: bounded in
//! acceleration and jerk, linear and angular, in cycles of fixed length.
//!
//! Both parts change by one common factor, so that a tool that goes round a hinge turns as far as
//! it travels while it speeds up and slows down. Within the bounds the acceleration is the one from
//! which, lowered by q = J·dt each cycle, the velocity ends exactly at the wanted one: from
//! a = m·q + r (m whole, r < q) it still changes by dt·(m(m+1)/2·q + (m+1)·r).

use crate::twist::Motion;

/// Bounds of the linear and the angular part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// m/s² or m/s³.
    pub linear: f64,
    /// rad/s² or rad/s³.
    pub angular: f64,
}

/// Velocity and acceleration of the target.
#[derive(Debug, Clone)]
pub struct Shaper {
    cycle_s: f64,
    jerk: Bounds,
    velocity: Motion,
    acceleration: Motion,
}

impl Shaper {
    /// At rest.
    pub fn new(cycle_s: f64, jerk: Bounds) -> Self {
        Self {
            cycle_s,
            jerk,
            velocity: Motion::default(),
            acceleration: Motion::default(),
        }
    }

    /// Present velocity.
    pub fn velocity(&self) -> &Motion {
        &self.velocity
    }

    /// Whether it stands still and nothing changes.
    pub fn is_at_rest(&self) -> bool {
        self.velocity.is_zero() && self.acceleration.is_zero()
    }

    /// One cycle towards `wanted`; returns the velocity to hold during it.
    pub fn step(&mut self, wanted: &Motion, acceleration: &Bounds) -> Motion {
        let missing = wanted.plus(&self.velocity, -1.0);
        let factor = self
            .rate(missing.linear.norm(), acceleration.linear, self.jerk.linear)
            .min(self.rate(
                missing.angular.norm(),
                acceleration.angular,
                self.jerk.angular,
            ));
        let change = missing.scaled(factor).plus(&self.acceleration, -1.0);
        let kept = change.factor_within(
            self.jerk.linear * self.cycle_s,
            self.jerk.angular * self.cycle_s,
        );
        self.acceleration = self.acceleration.plus(&change, kept);
        self.velocity = self.velocity.plus(&self.acceleration, self.cycle_s);
        self.settle(wanted);
        self.velocity
    }

    /// Acceleration per missing velocity, 1/s.
    fn rate(&self, missing: f64, acceleration: f64, jerk: f64) -> f64 {
        if missing == 0.0 {
            return 1.0 / self.cycle_s;
        }
        let step = jerk * self.cycle_s;
        let sum = missing / self.cycle_s;
        let whole = (0.5 * ((1.0 + 8.0 * sum / step).sqrt() - 1.0)).floor();
        let rest = (sum - 0.5 * whole * (whole + 1.0) * step) / (whole + 1.0);
        (whole * step + rest).min(acceleration) / missing
    }

    /// Rounding is not motion: what is left of it at the end of a ramp is dropped.
    fn settle(&mut self, wanted: &Motion) {
        let left = wanted.plus(&self.velocity, -1.0);
        if left.linear.norm() < ROUNDING && left.angular.norm() < ROUNDING {
            self.velocity = *wanted;
        }
    }

    /// The arm has slowed down by itself, since no new target came: so does the velocity.
    pub fn lag_behind(&mut self, factor: f64) {
        self.velocity = self.velocity.scaled(factor);
        self.acceleration = self.acceleration.scaled(factor);
        let (v, a) = (&self.velocity, &self.acceleration);
        let size = [v.linear, v.angular, a.linear, a.angular].map(|part| part.norm());
        if size.iter().all(|size| *size < AT_REST) {
            self.rest();
        }
    }

    /// The arm stands.
    pub fn rest(&mut self) {
        self.velocity = Motion::default();
        self.acceleration = Motion::default();
    }
}

/// m/s or rad/s that are nothing but rounding.
const ROUNDING: f64 = 1e-12;

/// m/s, rad/s and their rates below which nothing moves that a controller could tell.
const AT_REST: f64 = 1e-6;

#[cfg(test)]
mod tests;
