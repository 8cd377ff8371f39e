//! Moving the target: within the limits of speed, acceleration, jerk and joints, and never away
//! from the arm.

use nalgebra::Isometry3;
use pubs_melfa_protocol::Pose;

use super::Cycle;
use crate::board::Board;
use crate::fault::Fault;
use crate::frames::Frames;
use crate::motion::Phase;
use crate::mxt::Snapshot;
use crate::target::{apart, moved, written};
use crate::twist::Motion;

/// A command this near to where the arm is counts as the command that holds it there: m and rad.
const NEAR: (f64, f64) = (0.004, 0.02);

/// A command this near to the target sent last is that target: m and rad.
const SAME: (f64, f64) = (2e-6, 2e-5);

/// Where the arm shall be.
pub(super) struct Aim {
    /// The tool, engine's base.
    pub pose: Isometry3<f64>,
    /// As it was sent last.
    pub sent: Pose,
}

impl Aim {
    /// Where the controller holds the arm now: its own command where that is near the feedback, so
    /// that not even the servo's droop makes a step; else the feedback.
    pub(super) fn at(snapshot: &Snapshot, frames: &Frames) -> Self {
        let held = snapshot.filtered.filter(|filtered| {
            let (metres, radians) = apart(&filtered.isometry(), &snapshot.isometry());
            metres < NEAR.0 && radians < NEAR.1
        });
        let sent = held.unwrap_or(snapshot.pose);
        Self {
            pose: frames.to_engine(&sent.isometry()),
            sent,
        }
    }
}

impl Cycle {
    /// As much of `velocity` as the limits of speed and joints allow.
    pub(super) fn allowed(&self, board: &mut Board, velocity: &Motion) -> Motion {
        let speed = &self.settings.speed;
        let within = velocity.scaled(velocity.factor_within(speed.linear, speed.angular));
        if within.is_zero() {
            return within;
        }
        match self.joint_factor(&within) {
            Ok((factor, _)) => within.scaled(factor),
            Err(reason) => {
                board.fail(Fault::driver(reason));
                Motion::default()
            }
        }
    }

    /// The factor that the joints allow, and the share of their limits that would be left with it.
    /// 1 where the controller does not tell its joints.
    fn joint_factor(&self, velocity: &Motion) -> Result<(f64, f64), String> {
        let Some(joints) = &self.latest.joints else {
            return Ok((1.0, 0.0));
        };
        let frames = &self.settings.frames;
        let turned = Motion {
            linear: frames.turned_to_controller(&velocity.linear),
            angular: frames.turned_to_controller(&velocity.angular),
        };
        let tool = frames.to_engine(&self.latest.isometry());
        let guard = &self.settings.joint_guard;
        match guard.allow(joints, &frames.tool_origin(&tool), &turned) {
            Ok(allowed) => Ok((allowed.factor, allowed.share * allowed.factor)),
            Err(blocked) => Err(blocked.to_string()),
        }
    }

    /// Moves the target on by one cycle.
    pub(super) fn advance(&mut self, board: &mut Board, wanted: &Motion, now_ns: u64) {
        self.back_to_what_came_through(board, now_ns);
        let settings = &self.settings;
        let bounds = match self.phase {
            Phase::Following => &settings.acceleration,
            _ => &settings.stop,
        };
        let velocity = self.shaper.step(wanted, bounds);
        self.still = if velocity.is_zero() {
            self.still.saturating_add(1)
        } else {
            0
        };
        // A ramp to rest goes on whatever the joints say: there is nothing better to do.
        let (factor, share) = self.joint_factor(&velocity).unwrap_or((1.0, 0.0));
        let step = velocity.scaled(factor);
        let stats = &mut board.stats;
        stats.step_m = stats.step_m.max(step.linear.norm() * settings.cycle_s);
        stats.joint_share = stats.joint_share.max(share);
        let Some(aim) = &mut self.aim else {
            return;
        };
        if !velocity.is_zero() {
            aim.pose = moved(&aim.pose, &step, settings.cycle_s);
            let pose = settings.frames.to_controller(&aim.pose);
            aim.sent = written(&pose, &aim.sent, &self.latest.pose, &settings.writing);
        }
        let arm = settings.frames.to_engine(&self.latest.isometry());
        let (metres, radians) = apart(&aim.pose, &arm);
        self.check_lead(board, metres, radians);
    }

    /// Where no replies come, the monitor may tell that the targets do not come through either: the
    /// command that the controller has stands, though newer ones were sent. The arm has come to rest
    /// on it, so the target goes back to it: what was not carried out is not caught up.
    fn back_to_what_came_through(&mut self, board: &Board, now_ns: u64) {
        let settings = &self.settings;
        if self.silence_ns(now_ns) <= settings.silent_ns {
            return;
        }
        let (Some(aim), Some(commanded)) = (&self.aim, &board.commanded) else {
            return;
        };
        let cycle_ns = settings.cycle_ns();
        let told_ns = now_ns.saturating_sub(commanded.time_ns);
        let stands_ns = commanded.time_ns.saturating_sub(commanded.since_ns);
        let (metres, radians) = apart(&commanded.pose.isometry(), &aim.sent.isometry());
        let differs = metres > SAME.0 || radians > SAME.1;
        let near = metres < NEAR.0 && radians < NEAR.1;
        if told_ns < 2 * cycle_ns && stands_ns > cycle_ns + cycle_ns / 2 && differs && near {
            self.lag_behind(stands_ns);
            if let Some(aim) = &mut self.aim {
                aim.pose = self.settings.frames.to_engine(&commanded.pose.isometry());
                aim.sent = commanded.pose;
            }
        }
    }

    /// The target must not run away from an arm that does not follow.
    fn check_lead(&self, board: &mut Board, metres: f64, radians: f64) {
        let settings = &self.settings;
        let velocity = self.shaper.velocity();
        let most_m = settings.lead.linear + velocity.linear.norm() * settings.filter_s;
        let most_rad = settings.lead.angular + velocity.angular.norm() * settings.filter_s;
        if metres > 0.5 * most_m || radians > 0.5 * most_rad {
            board.state_wanted = true;
        }
        if metres > most_m || radians > most_rad {
            board.fail(Fault::driver(format!(
                "the arm does not follow: it is {:.1} mm and {:.1}° behind its target (contact stop, override below 100 %, \
                 or a load that is too high?)",
                metres * 1e3,
                radians.to_degrees()
            )));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    #[test]
    fn the_target_begins_at_the_command_near_the_arm_or_at_the_arm() {
        let frames = Frames::new(&Params::default());
        let at = |x: f32| Pose {
            position_mm: [x, 0.0, 300.0],
            ..Pose::default()
        };
        let cases = [
            ("the servo droops", Some(at(400.5)), 400.5),
            ("the arm was moved by hand", Some(at(450.0)), 400.0),
            ("no command is told", None, 400.0),
        ];
        for (name, filtered, expected) in cases {
            let snapshot = Snapshot {
                time_ns: 0,
                pose: at(400.0),
                joints: None,
                filtered,
            };
            let aim = Aim::at(&snapshot, &frames);
            assert_eq!(aim.sent.position_mm[0], expected, "{name}");
            assert!((aim.pose.translation.vector.x - f64::from(expected) * 1e-3).abs() < 1e-9);
        }
    }
}
