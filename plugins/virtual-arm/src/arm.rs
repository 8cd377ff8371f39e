//! The arm: a tool that follows commanded velocities and cannot be pushed aside.

use nalgebra::{UnitQuaternion, Vector3};

use crate::world::ArmLimits;

/// Weighs angular against linear speed, so that turns have bounds too: m/s per rad/s.
const TURN_LEVER_M: f64 = 0.1;

/// Below this the arm has arrived at the commanded velocity, m/s.
const ARRIVED_M_S: f64 = 1e-9;

/// Linear and angular velocity, base axes at the tool origin (m/s, rad/s).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Velocity {
    /// m/s.
    pub linear: Vector3<f64>,
    /// rad/s.
    pub angular: Vector3<f64>,
}

impl Velocity {
    /// One measure of both parts, m/s.
    fn speed(&self) -> f64 {
        self.linear.norm().max(self.angular.norm() * TURN_LEVER_M)
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            linear: self.linear * factor,
            angular: self.angular * factor,
        }
    }

    fn plus(&self, other: &Self, factor: f64) -> Self {
        Self {
            linear: self.linear + other.linear * factor,
            angular: self.angular + other.angular * factor,
        }
    }
}

/// What the arm is about to do.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Intent {
    /// Takes on this velocity, with lag.
    Follow(Velocity),
    /// Slows down evenly to rest.
    Ramp,
}

/// The tool and how it moves.
#[derive(Debug, Clone)]
pub struct Arm {
    limits: ArmLimits,
    stop_deceleration_m_s2: f64,
    intent: Intent,
    /// Tool origin, base frame, m.
    pub position_m: Vector3<f64>,
    /// Tool in base.
    pub orientation: UnitQuaternion<f64>,
    /// Present velocity.
    pub velocity: Velocity,
}

impl Arm {
    /// An arm at rest.
    pub fn new(
        limits: ArmLimits,
        stop_deceleration_m_s2: f64,
        position_m: Vector3<f64>,
        orientation: UnitQuaternion<f64>,
    ) -> Self {
        let velocity = Velocity::default();
        Self {
            limits,
            stop_deceleration_m_s2,
            intent: Intent::Ramp,
            position_m,
            orientation,
            velocity,
        }
    }

    /// Takes on a velocity.
    pub fn follow(&mut self, velocity: Velocity) {
        self.intent = Intent::Follow(velocity);
    }

    /// Slows down to rest at the stop deceleration.
    pub fn ramp_to_rest(&mut self) {
        self.intent = Intent::Ramp;
    }

    /// Whether it follows a command.
    pub fn is_following(&self) -> bool {
        self.intent != Intent::Ramp
    }

    /// Whether it stands still and will until the next command.
    pub fn is_at_rest(&self) -> bool {
        !self.is_following() && self.velocity == Velocity::default()
    }

    /// One step of time.
    pub fn step(&mut self, step_s: f64) {
        self.velocity = match self.intent {
            Intent::Follow(goal) => self.towards(goal, step_s),
            Intent::Ramp => self.slower(step_s),
        };
        self.position_m += self.velocity.linear * step_s;
        if self.velocity.angular != Vector3::zeros() {
            self.orientation =
                UnitQuaternion::from_scaled_axis(self.velocity.angular * step_s) * self.orientation;
        }
    }

    /// First-order lag within the bound on acceleration.
    fn towards(&self, goal: Velocity, step_s: f64) -> Velocity {
        let missing = goal.plus(&self.velocity, -1.0);
        let distance = missing.speed();
        if distance < ARRIVED_M_S {
            return goal;
        }
        let by_lag = step_s / (step_s + self.limits.lag_s);
        let by_acceleration = self.limits.acceleration_m_s2 * step_s / distance;
        self.velocity.plus(&missing, by_lag.min(by_acceleration))
    }

    fn slower(&self, step_s: f64) -> Velocity {
        let speed = self.velocity.speed();
        let left = speed - self.stop_deceleration_m_s2 * step_s;
        if left <= 0.0 {
            Velocity::default()
        } else {
            self.velocity.scaled(left / speed)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.00025;

    fn arm(lag_s: f64, acceleration_m_s2: f64) -> Arm {
        let limits = ArmLimits {
            lag_s,
            acceleration_m_s2,
            position_noise_m: 0.0,
        };
        Arm::new(limits, 5.0, Vector3::zeros(), UnitQuaternion::identity())
    }

    fn run(arm: &mut Arm, seconds: f64) {
        for _ in 0..(seconds / STEP_S).round() as usize {
            arm.step(STEP_S);
        }
    }

    #[test]
    fn ramp_takes_speed_over_deceleration_and_half_their_product_of_way() {
        let mut arm = arm(0.0, 1e6);
        arm.follow(Velocity {
            linear: Vector3::new(0.15, 0.0, 0.0),
            angular: Vector3::zeros(),
        });
        arm.step(STEP_S);
        let from = arm.position_m.x;
        arm.ramp_to_rest();
        run(&mut arm, 0.0295);
        assert!(!arm.is_at_rest(), "still moving just before v/a = 30 ms");
        run(&mut arm, 0.0007);
        assert!(arm.is_at_rest(), "at rest after v/a = 30 ms");
        let way = arm.position_m.x - from;
        assert!(
            (way - 0.00225).abs() < 3e-5,
            "v²/2a = 2.25 mm, went {way} m"
        );
    }

    #[test]
    fn jump_command_is_bounded_by_the_arms_acceleration() {
        let mut arm = arm(0.0, 10.0);
        arm.follow(Velocity {
            linear: Vector3::new(0.0, 0.15, 0.0),
            angular: Vector3::zeros(),
        });
        run(&mut arm, 0.010);
        let speed = arm.velocity.linear.y;
        assert!(
            (speed - 0.1).abs() < 1e-6,
            "10 m/s² for 10 ms is 0.1 m/s, got {speed}"
        );
    }

    #[test]
    fn lag_leaves_one_over_e_after_its_time_constant() {
        let mut arm = arm(0.020, 1e6);
        arm.follow(Velocity {
            linear: Vector3::new(0.1, 0.0, 0.0),
            angular: Vector3::zeros(),
        });
        run(&mut arm, 0.020);
        let left = 1.0 - arm.velocity.linear.x / 0.1;
        assert!(
            (left - (-1f64).exp()).abs() < 0.005,
            "1/e should be missing, {left} is"
        );
    }

    #[test]
    fn turning_about_base_z_takes_tool_x_to_base_y() {
        let mut arm = arm(0.0, 1e6);
        arm.follow(Velocity {
            linear: Vector3::zeros(),
            angular: Vector3::new(0.0, 0.0, 1.0),
        });
        run(&mut arm, std::f64::consts::FRAC_PI_2);
        let x = arm.orientation * Vector3::x();
        assert!(
            (x - Vector3::y()).norm() < 1e-3,
            "tool x points along {x:?}"
        );
    }
}
