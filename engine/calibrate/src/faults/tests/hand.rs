//! What a hand that moves a slide or a hinge feels: a recording with nothing wrong.

use nalgebra::{UnitQuaternion, Vector3};
use pubs_core::belief::BeliefSettings;
use pubs_core::controller::Control;
use pubs_core::joint::Geometry;
use pubs_core::reward::{Reward, Shape};
use pubs_core::shield::Shield;
use pubs_core::task::{ObservationTable, PolicySettings};
use pubs_core::{Action, Joint, JointKind, Mode, Motion, Task};
use pubs_plugin::{DriverStatus, JointType, Reading};
use pubs_run::recording::{Done, FORMAT_VERSION, Frame, Header, Recording};

/// Handle travel from limit to limit, m.
const TRAVEL_M: f64 = 0.12;
pub const RADIUS_M: f64 = 0.3;
/// Rows at a limit: 0.3 s.
pub const BLOCKED_ROWS: usize = 31;
pub const ACTIONS: [&str; 5] = ["stop", "safe_open", "safe_close", "high_open", "high_close"];
/// Tool axes: the tool points at the object and backs away, so the motion is along −z.
const OPENING: [f64; 3] = [0.0, 0.0, -1.0];
fn geometry() -> Geometry {
    Geometry {
        opening_direction: Vector3::from(OPENING),
        up_direction: Vector3::y(),
        motion_threshold_m: 0.0005,
    }
}

/// 12 cm.
pub fn slide() -> Task {
    task(
        JointKind::Prismatic {
            geometry: geometry(),
        },
        TRAVEL_M,
    )
}

/// 0.4 rad at 0.3 m, so 12 cm as well.
pub fn hinge() -> Task {
    let kind = JointKind::Revolute {
        radius_m: RADIUS_M,
        geometry: geometry(),
        hinge_direction: Vector3::x(),
    };
    task(kind, TRAVEL_M / RADIUS_M)
}

fn task(kind: JointKind, upper: f64) -> Task {
    let moving = |name: &str, mode, displacement| Action {
        name: name.to_owned(),
        motion: Motion::Move {
            mode,
            displacement,
            observations: 3,
        },
    };
    Task {
        name: "closet".to_owned(),
        sensor: Some("wrist".to_owned()),
        joint: Joint {
            kind,
            lower: 0.0,
            upper,
            start: (0.0, upper),
        },
        default_goal: None,
        actions: vec![
            Action {
                name: "stop".to_owned(),
                motion: Motion::Stop,
            },
            moving("safe_open", Mode::Safe, 0.01),
            moving("safe_close", Mode::Safe, -0.01),
            moving("high_open", Mode::HighForce, 0.03),
            moving("high_close", Mode::HighForce, -0.03),
        ],
        stop: 0,
        control: Some(Control {
            rate_hz: 100.0,
            safe_speed_m_s: 0.05,
            high_speed_m_s: 0.15,
            force_threshold_n: 15.0,
            force_limit_n: 60.0,
            acceleration_m_s2: 1.0,
            stop_deceleration_m_s2: 5.0,
            contact_stiffness_n_per_m: 5000.0,
        }),
        belief: BeliefSettings {
            particles: 300,
            rate_hz: 30.0,
            tempering: 1.0,
            reading_spacing: 0.0,
            force_bias: None,
        },
        policy: PolicySettings {
            rate_hz: 10.0,
            layers: vec![64],
            shield: Shield {
                mass: 0.001,
                flattening: 0.3,
            },
        },
        reward: Reward {
            shape: Shape::Proximity,
            goal_tolerance: 0.1,
            goal: 1.0,
            failed_stop: -1.0,
            safety_violation: -1.0,
            time: -0.001,
            discount: 0.99,
        },
        driver: None,
        observation: ObservationTable {
            model: "segments".to_owned(),
            bias_sd_n: 0.0,
            correlation: 0.0,
            table: serde_json::Value::Null,
        },
    }
}

/// Moves a handle and writes down what a sensor would feel.
struct Hand {
    hinged: bool,
    frames: Vec<Frame>,
    travelled_m: f64,
    noise: u64,
}

impl Hand {
    /// Between −0.5 and 0.5, the same in every run.
    fn noise(&mut self) -> f64 {
        self.noise = self
            .noise
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.noise >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    /// The tool held askew in the base, turning with a door.
    fn pose(&self) -> ([f64; 3], [f64; 4]) {
        let askew = UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1);
        let (grasp, opening) = (Vector3::new(0.5, -0.2, 0.4), askew * Vector3::from(OPENING));
        let (position, orientation) = if self.hinged {
            let hinge = askew * Vector3::x();
            let turn = UnitQuaternion::from_scaled_axis(
                opening.cross(&hinge) * (self.travelled_m / RADIUS_M),
            );
            let centre = grasp + hinge * RADIUS_M;
            (centre + turn * (grasp - centre), turn * askew)
        } else {
            (grasp + opening * self.travelled_m, askew)
        };
        (position.into(), orientation.coords.into())
    }

    fn row(&mut self, action: usize, demonstration: u32, speed_m_s: f64, along_n: f64) {
        let (position_m, orientation_xyzw) = self.pose();
        let sign = if action.is_multiple_of(2) { -1.0 } else { 1.0 };
        let force_n = OPENING.map(|part| part * sign * along_n + self.noise());
        self.frames.push(Frame {
            reading: Reading {
                time_ns: 5_000_000_000 + self.frames.len() as u64 * 10_000_000,
                position_m,
                orientation_xyzw,
                force_n,
                torque_nm: [0.0; 3],
                status: DriverStatus::Ready,
            },
            action,
            demonstration,
            speed_m_s,
            settled: true,
            truth: None,
        });
    }

    fn travel(&mut self, action: usize, demonstration: u32, to_m: f64, speed_m_s: f64) {
        let way_m = to_m - self.travelled_m;
        let steps = (way_m.abs() / (speed_m_s * 0.01)).round() as usize;
        for _ in 0..steps {
            self.travelled_m += way_m / steps as f64;
            self.row(action, demonstration, speed_m_s * way_m.signum(), 3.0);
        }
    }

    fn blocked(&mut self, action: usize, demonstration: u32) {
        for _ in 0..BLOCKED_ROWS {
            self.row(action, demonstration, 0.0, 16.0);
        }
    }
}

/// Two demonstrations of each action, with nothing wrong.
pub fn recording(hinged: bool) -> Recording {
    let mut hand = Hand {
        hinged,
        frames: Vec::new(),
        travelled_m: 0.0,
        noise: 1,
    };
    let mut done = Vec::new();
    for demonstration in 1..=2 {
        hand.travel(1, demonstration, TRAVEL_M, 0.05);
        hand.blocked(1, demonstration);
        hand.travel(2, demonstration, 0.0, 0.05);
        hand.blocked(2, demonstration);
        hand.travel(3, demonstration, 0.8 * TRAVEL_M, 0.15);
        hand.travel(4, demonstration, 0.2 * TRAVEL_M, 0.15);
        hand.travel(2, 0, 0.0, 0.05);
        done.extend(ACTIONS[1..].iter().map(|&action| Done {
            action: action.to_owned(),
            demonstration,
        }));
    }
    let joint = if hinged {
        JointType::Revolute
    } else {
        JointType::Prismatic
    };
    Recording {
        header: Header {
            format: FORMAT_VERSION,
            engine: "0.1.0".to_owned(),
            object: "closet".to_owned(),
            joint,
            sensor: "wrist".to_owned(),
            actions: ACTIONS.map(str::to_owned).to_vec(),
            rate_hz: 100.0,
            seed: 7,
        },
        frames: hand.frames,
        done,
        loss: None,
    }
}
