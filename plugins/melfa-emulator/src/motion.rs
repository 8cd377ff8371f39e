//! The joints: following, holding, and the controller's own stop.
//!
//! A stop slows all joints down evenly and together, so that the arm keeps its direction: in the
//! time that the joint which needs longest takes from its present speed at its greatest
//! acceleration ([`ACCELERATION_RAD_S2`]), times the option `--stop-scale`.

use pubs_melfa_protocol::arm::{ACCELERATION_RAD_S2, RANGE_RAD, SPEED_RAD_S};

/// A joint may exceed its speed by this factor: the rounding of packets is no fault.
const SPEED_TOLERANCE: f64 = 1.001;

/// What the joints are doing.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Drive {
    /// Standing, or going where they are told each cycle.
    Free,
    /// Slowing down from these speeds (rad/s), of which a share is left.
    Stopping {
        rates: [f64; 6],
        left: f64,
        share_per_s: f64,
    },
}

/// The six joints.
#[derive(Debug, Clone)]
pub struct Motion {
    cycle_s: f64,
    stop_scale: f64,
    joints: [f64; 6],
    before: [f64; 6],
    drive: Drive,
}

/// A joint that would have to be too fast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooFast {
    /// Its number, from 1.
    pub joint: usize,
    /// How fast, rad/s.
    pub speed_rad_s: f64,
}

impl Motion {
    /// At rest.
    pub fn new(joints: [f64; 6], cycle_s: f64, stop_scale: f64) -> Self {
        Self {
            cycle_s,
            stop_scale,
            joints,
            before: joints,
            drive: Drive::Free,
        }
    }

    /// Where the joints are, rad.
    pub fn joints(&self) -> &[f64; 6] {
        &self.joints
    }

    /// Where they were a cycle ago.
    pub fn before(&self) -> &[f64; 6] {
        &self.before
    }

    /// Their speeds over the last cycle, rad/s.
    pub fn rates(&self) -> [f64; 6] {
        std::array::from_fn(|joint| (self.joints[joint] - self.before[joint]) / self.cycle_s)
    }

    /// Whether a stop is under way.
    pub fn is_stopping(&self) -> bool {
        self.drive != Drive::Free
    }

    /// Whether no joint has moved in the last cycle.
    pub fn is_at_rest(&self) -> bool {
        !self.is_stopping() && self.joints == self.before
    }

    /// Begins to slow down, if anything moves.
    pub fn stop(&mut self) {
        if self.is_stopping() || self.is_at_rest() {
            return;
        }
        let rates = self.rates();
        let times =
            (0..6).map(|joint| rates[joint].abs() / (ACCELERATION_RAD_S2[joint] * self.stop_scale));
        let duration_s = times.fold(self.cycle_s, f64::max);
        self.drive = Drive::Stopping {
            rates,
            left: 1.0,
            share_per_s: 1.0 / duration_s,
        };
    }

    /// A cycle towards these joints.
    ///
    /// # Errors
    ///
    /// Where a joint would be too fast; nothing has moved then, and the cycle is still to come.
    pub fn follow(&mut self, next: [f64; 6]) -> Result<(), TooFast> {
        for joint in 0..6 {
            let speed_rad_s = (next[joint] - self.joints[joint]).abs() / self.cycle_s;
            if speed_rad_s > SPEED_RAD_S[joint] * SPEED_TOLERANCE {
                return Err(TooFast {
                    joint: joint + 1,
                    speed_rad_s,
                });
            }
        }
        self.go(next);
        Ok(())
    }

    /// A cycle without a target: slows down or stands.
    pub fn coast(&mut self) {
        let Drive::Stopping {
            rates,
            left,
            share_per_s,
        } = &mut self.drive
        else {
            self.go(self.joints);
            return;
        };
        let from = *left;
        *left = (from - *share_per_s * self.cycle_s).max(0.0);
        // The mean share over the cycle; the last one may end within it.
        let moving_s = (from - *left) / *share_per_s;
        let mean_s = 0.5 * (from + *left) * moving_s;
        let next = std::array::from_fn(|joint| {
            let range = RANGE_RAD[joint];
            (self.joints[joint] + rates[joint] * mean_s).clamp(-range, range)
        });
        if *left == 0.0 {
            self.drive = Drive::Free;
        }
        self.go(next);
    }

    fn go(&mut self, next: [f64; 6]) {
        self.before = self.joints;
        self.joints = next;
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const CYCLE_S: f64 = 0.0035;

    #[test]
    fn stop_takes_speed_over_acceleration_and_keeps_the_direction() {
        let mut motion = Motion::new([0.0; 6], CYCLE_S, 1.0);
        // 0.6 rad/s of J1 at 6 rad/s² is 100 ms; J5 with 0.3 rad/s is slowed as long.
        for cycle in 1..=20 {
            let way = f64::from(cycle) * CYCLE_S;
            motion
                .follow([0.6 * way, 0.0, 0.0, 0.0, -0.3 * way, 0.0])
                .unwrap();
        }
        let from = *motion.joints();
        motion.stop();
        let mut cycles = 0;
        while motion.is_stopping() {
            let before = motion.rates()[0];
            motion.coast();
            cycles += 1;
            let slower = (before - motion.rates()[0]) / CYCLE_S;
            assert!(slower < 6.0 * 1.01, "slowed by {slower} rad/s²");
        }
        assert_eq!(cycles, 29, "100 ms are 28.6 cycles");
        // v²/2a.
        let way = [0, 4].map(|joint| motion.joints()[joint] - from[joint]);
        assert!((way[0] - 0.03).abs() < 1e-9, "J1 went {} rad", way[0]);
        assert!((way[1] + 0.015).abs() < 1e-9, "J5 went {} rad", way[1]);
        motion.coast();
        assert!(motion.is_at_rest());
    }

    #[test]
    fn joint_that_would_be_too_fast_is_named_and_does_not_move() {
        let mut motion = Motion::new([0.0; 6], CYCLE_S, 1.0);
        // 197 °/s of J4 is 0.690 degrees a cycle.
        let degrees = |degrees: f64| [0.0, 0.0, 0.0, degrees.to_radians(), 0.0, 0.0];
        motion.follow(degrees(0.689)).unwrap();
        let fault = motion.follow(degrees(0.689 + 0.692)).unwrap_err();
        assert_eq!(fault.joint, 4);
        assert!((fault.speed_rad_s - 3.451).abs() < 0.01, "{fault:?}");
        assert_eq!(*motion.joints(), degrees(0.689));
    }
}
