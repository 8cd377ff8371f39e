//! The reward, eq. (1) and (2), and what counts as a safety violation.

use crate::{Action, Joint};

/// How the goal-proximity reward falls with distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// 1 − |s − s_g|/ε_g inside the goal region, eq. (2).
    Proximity,
    /// Full reward anywhere in the goal region.
    Flat,
}

/// The weights of eq. (1). Penalties are negative numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reward {
    /// Shape of R_g.
    pub shape: Shape,
    /// ε_g, half the width of the goal region (rad, m or plain).
    pub goal_tolerance: f64,
    /// Weight of R_g.
    pub goal: f64,
    /// R_f: stopping outside the goal region.
    pub failed_stop: f64,
    /// R_s: a high-force action that would leave the limits.
    pub safety_violation: f64,
    /// R_t: each policy step.
    pub time: f64,
    /// γ.
    pub discount: f64,
}

impl Reward {
    /// Whether `state` is in the goal region G.
    pub fn in_goal_region(&self, state: f64, goal: f64) -> bool {
        (state - goal).abs() <= self.goal_tolerance
    }

    /// R_g + R_f of stopping at `state`; the time penalty is apart.
    pub fn of_stop(&self, state: f64, goal: f64) -> f64 {
        if !self.in_goal_region(state, goal) {
            return self.failed_stop;
        }
        match self.shape {
            Shape::Flat => self.goal,
            Shape::Proximity if self.goal_tolerance == 0.0 => self.goal,
            Shape::Proximity => self.goal * (1.0 - (state - goal).abs() / self.goal_tolerance),
        }
    }
}

/// Whether `action` at the true state is a safety violation: high force with s + Δs outside S.
pub fn violates_safety(joint: &Joint, action: &Action, state: f64) -> bool {
    action.is_high_force() && !joint.contains(state + action.displacement())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mode;
    use crate::action::Motion;
    use crate::joint::JointKind;

    fn reward(shape: Shape) -> Reward {
        Reward {
            shape,
            goal_tolerance: 10.0,
            goal: 1.0,
            failed_stop: -1.0,
            safety_violation: -1.0,
            time: -0.001,
            discount: 0.99,
        }
    }

    #[test]
    fn stop_reward_follows_equation_2() {
        let cases = [
            (Shape::Proximity, 50.0, 1.0),
            (Shape::Proximity, 45.0, 0.5),
            (Shape::Proximity, 57.5, 0.25),
            (Shape::Proximity, 60.0, 0.0),
            (Shape::Proximity, 60.1, -1.0),
            (Shape::Flat, 60.0, 1.0),
            (Shape::Flat, 39.9, -1.0),
        ];
        for (shape, state, expected) in cases {
            let found = reward(shape).of_stop(state, 50.0);
            assert!(
                (found - expected).abs() < 1e-12,
                "{shape:?} at {state}: {found}, expected {expected}"
            );
        }
    }

    #[test]
    fn only_high_force_past_a_limit_violates_safety() {
        let joint = Joint {
            kind: JointKind::Abstract { integer: false },
            lower: 0.0,
            upper: 10.0,
            start: (0.0, 10.0),
        };
        let moving = |mode, displacement| Action {
            name: String::new(),
            motion: Motion::Move {
                mode,
                displacement,
                observations: 1,
            },
        };
        let cases = [
            (Mode::HighForce, 2.0, 7.9, false),
            (Mode::HighForce, 2.0, 8.0, false),
            (Mode::HighForce, 2.0, 8.1, true),
            (Mode::HighForce, -2.0, 1.9, true),
            (Mode::Safe, 2.0, 9.9, false),
        ];
        for (mode, displacement, state, expected) in cases {
            let found = violates_safety(&joint, &moving(mode, displacement), state);
            assert_eq!(found, expected, "{mode:?} by {displacement} at {state}");
        }
    }
}
