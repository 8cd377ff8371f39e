//! An arm that is its own dummy twin, a model that misbehaves, and a policy that always wants the
//! same action.

use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use nalgebra::Vector3;
use pubs_core::belief::{BeliefSettings, Model, ModelError};
use pubs_core::controller::Control;
use pubs_core::joint::Geometry;
use pubs_core::reward::{Reward, Shape};
use pubs_core::shield::Shield;
use pubs_core::task::{ObservationTable, PolicySettings};
use pubs_core::{Action, Joint, JointKind, Mode, Motion, Task};
use pubs_plugin::{Channel, ChannelKind, DriverStatus, Reading, Support, Transitions, Twist};
use pubs_policy::{Contract, Dense, Existing, Feature, FeatureName, Network, Reference, Runtime};
use pubs_run::clock::now_ns;
use pubs_run::{Actor, Arm, ArmError};

pub const SECOND: u64 = 1_000_000_000;
/// When the dummy's trouble begins, after the start.
pub const TROUBLE_AT_S: f64 = 1.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trouble {
    None,
    ReadFails,
    CommandFails,
    ReportsFault,
    ReadingsStop,
    ForceSpike,
    LeavesPath,
    Jumps,
    ReadPanics,
    ReadHangs,
}

/// What happened to the arm, seen from outside.
#[derive(Debug, Default)]
pub struct Log {
    /// (time, commanded speed along the slide).
    pub commands: Vec<(f64, f64)>,
    /// How often the driver was told to come to rest.
    pub stops: u32,
}

/// A slide along base +y that follows every twist exactly.
pub struct Dummy {
    trouble: Trouble,
    log: Arc<Mutex<Log>>,
    virtual_ns: Option<u64>,
    start_ns: u64,
    last_ns: u64,
    position: [f64; 3],
    speed: f64,
    truth: Option<f64>,
    frozen: Option<Reading>,
}

impl Dummy {
    pub fn new(trouble: Trouble, truth: Option<f64>, log: &Arc<Mutex<Log>>) -> Self {
        let start_ns = now_ns();
        Self {
            trouble,
            log: Arc::clone(log),
            virtual_ns: None,
            start_ns,
            last_ns: start_ns,
            position: [0.5, 0.0, 0.3],
            speed: 0.0,
            truth,
            frozen: None,
        }
    }

    fn now(&self) -> u64 {
        self.virtual_ns.unwrap_or_else(now_ns)
    }

    fn is_in_trouble(&self, trouble: Trouble) -> bool {
        self.trouble == trouble
            && self.now().saturating_sub(self.start_ns) as f64 * 1e-9 > TROUBLE_AT_S
    }

    /// Sideways, slowly enough to be no jump: 3 mm per control period up to 21 mm.
    fn drift_m(&self) -> f64 {
        if !self.is_in_trouble(Trouble::LeavesPath) {
            return 0.0;
        }
        let time_s = (self.now() - self.start_ns) as f64 * 1e-9;
        (0.3 * (time_s - TROUBLE_AT_S)).min(0.021)
    }

    fn reading(&mut self) -> Reading {
        let now = self.now();
        self.position[1] += self.speed * (now - self.last_ns) as f64 * 1e-9;
        self.last_ns = now;
        let mut position_m = self.position;
        position_m[0] += self.drift_m();
        position_m[1] += if self.is_in_trouble(Trouble::Jumps) {
            0.05
        } else {
            0.0
        };
        Reading {
            time_ns: now,
            position_m,
            orientation_xyzw: [0.0, 0.0, 0.0, 1.0],
            force_n: [
                0.0,
                if self.is_in_trouble(Trouble::ForceSpike) {
                    58.0
                } else {
                    2.0
                },
                0.0,
            ],
            torque_nm: [0.0; 3],
            status: if self.is_in_trouble(Trouble::ReportsFault) {
                DriverStatus::Fault
            } else {
                DriverStatus::Ready
            },
        }
    }
}

impl Arm for Dummy {
    fn read(&mut self) -> Result<Reading, ArmError> {
        assert!(!self.is_in_trouble(Trouble::ReadPanics), "the dummy panics");
        if self.is_in_trouble(Trouble::ReadHangs) {
            std::thread::sleep(Duration::from_secs(3));
        }
        if self.is_in_trouble(Trouble::ReadFails) {
            return Err(ArmError("the link is gone".to_owned()));
        }
        let reading = self.reading();
        if self.is_in_trouble(Trouble::ReadingsStop) {
            return Ok(*self.frozen.get_or_insert(reading));
        }
        Ok(reading)
    }

    fn command(&mut self, twist: Twist, _expires_ns: u64) -> Result<(), ArmError> {
        if self.is_in_trouble(Trouble::CommandFails) {
            return Err(ArmError("the command was refused".to_owned()));
        }
        self.speed = twist.linear_m_s[1];
        let time_s = (self.now() - self.start_ns) as f64 * 1e-9;
        self.log.lock().unwrap().commands.push((time_s, self.speed));
        Ok(())
    }

    fn tare(&mut self) -> Result<(), ArmError> {
        Ok(())
    }

    fn stop(&mut self) -> Result<(), ArmError> {
        self.speed = 0.0;
        self.log.lock().unwrap().stops += 1;
        Ok(())
    }

    fn advance_to(&mut self, time_ns: u64) -> Result<(), ArmError> {
        if self.virtual_ns.is_none() {
            self.start_ns = time_ns;
            self.last_ns = time_ns;
        }
        self.virtual_ns = Some(time_ns);
        Ok(())
    }

    fn truth(&mut self) -> Option<f64> {
        self.truth.map(|start| start + self.position[1])
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModelTrouble {
    None,
    Panics,
    Hangs,
    NotANumber,
    Impossible,
}

/// 2 N everywhere.
pub struct Even {
    trouble: ModelTrouble,
    channels: Vec<Channel>,
    calls: AtomicU32,
}

impl Even {
    pub fn new(trouble: ModelTrouble) -> Arc<Self> {
        let channels = vec![Channel {
            name: "f_d".to_owned(),
            kind: ChannelKind::Gaussian,
        }];
        Arc::new(Self {
            trouble,
            channels,
            calls: AtomicU32::new(0),
        })
    }
}

impl Model for Even {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn moments(
        &self,
        _: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, ModelError> {
        let late = self.calls.fetch_add(1, Ordering::Relaxed) > 20;
        mean.fill(2.0);
        sigma.fill(0.5);
        match self.trouble {
            ModelTrouble::Panics if late => panic!("the model panics"),
            ModelTrouble::Hangs if late => std::thread::sleep(Duration::from_secs(60)),
            ModelTrouble::NotANumber if late => mean.fill(f32::NAN),
            ModelTrouble::Impossible if late => mean.fill(500.0),
            _ => {}
        }
        Ok(Support::Given)
    }
}

pub fn task() -> Task {
    let geometry = Geometry {
        opening_direction: Vector3::y(),
        up_direction: Vector3::z(),
        motion_threshold_m: 0.0005,
    };
    let moving = |name: &str, mode, displacement| Action {
        name: name.to_owned(),
        motion: Motion::Move {
            mode,
            displacement,
            observations: 3,
        },
    };
    Task {
        name: "slide".to_owned(),
        sensor: None,
        joint: Joint {
            kind: JointKind::Prismatic { geometry },
            lower: 0.0,
            upper: 0.3,
            start: (0.0, 0.3),
        },
        default_goal: None,
        actions: vec![
            Action {
                name: "stop".to_owned(),
                motion: Motion::Stop,
            },
            moving("safe_open", Mode::Safe, 0.005),
            moving("high_open", Mode::HighForce, 0.015),
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
            particles: 100,
            rate_hz: 30.0,
            tempering: 1.0,
            reading_spacing: 0.0,
            force_bias: None,
        },
        policy: PolicySettings {
            rate_hz: 10.0,
            layers: vec![4],
            shield: Shield {
                mass: 0.001,
                flattening: 0.3,
            },
        },
        reward: Reward {
            shape: Shape::Proximity,
            goal_tolerance: 0.02,
            goal: 1.0,
            failed_stop: -1.0,
            safety_violation: -1.0,
            time: -0.001,
            discount: 0.99,
        },
        driver: None,
        observation: ObservationTable {
            model: "even".to_owned(),
            bias_sd_n: 0.0,
            correlation: 0.0,
            table: serde_json::Value::Null,
        },
    }
}

/// A policy that always wants the same action.
pub fn always(action: usize, folder: &Path, model: &dyn Model) -> Actor {
    let feature = |name, upper| Feature {
        name,
        unit: "1".to_owned(),
        lower: 0.0,
        upper,
        offset: 0.0,
        scale: 1.0,
    };
    let inputs = vec![
        feature(FeatureName::MeanState, 0.3),
        feature(FeatureName::Entropy, 1.0),
    ];
    let bias: Vec<f32> = (0..3)
        .map(|index| f32::from(u8::from(index == action)))
        .collect();
    let network = Network {
        inputs: inputs.clone(),
        lstm: Vec::new(),
        layers: vec![Dense {
            inputs: 2,
            outputs: 3,
            weights: vec![0.0; 6],
            bias: bias.clone(),
        }],
    };
    let task = serde_json::json!({});
    let contract = Contract {
        format_version: pubs_policy::FORMAT_VERSION,
        object: "slide".to_owned(),
        task_hash: pubs_policy::task_hash(&task),
        task: pubs_policy::canonical_json(&task),
        observation_hash: String::new(),
        goal: pubs_policy::Goal::Fixed {
            value: 0.15,
            fraction: 0.5,
        },
        tolerance: 0.02,
        inputs,
        actions: vec![
            "stop".to_owned(),
            "safe_open".to_owned(),
            "high_open".to_owned(),
        ],
        shield: None,
        discount: 0.99,
        policy_rate_hz: 10.0,
        seed: 0,
        steps: 0,
        recipe: "none".to_owned(),
        evaluation_reward: 0.0,
        engine_version: "test".to_owned(),
        method: pubs_policy::Method::Pubs,
        state: None,
    };
    let runtime = Runtime::tract().unwrap();
    let reference = Reference {
        inputs: &[0.1, 0.5],
        logits: &bias,
        steps: 1,
    };
    let path = folder.join(format!("{action}.onnx"));
    let file = pubs_policy::write(
        &path,
        &network,
        &contract,
        reference,
        &runtime,
        Existing::Replace,
    )
    .unwrap();
    Actor::open(&file, &runtime, model).unwrap()
}
