//! Every way out ends in a ramped stop: an arm that is its own dummy twin, and everything that can
//! go wrong with it, in lockstep and in real time.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
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
use pubs_policy::{
    Contract, Dense, Existing, Feature, FeatureName, Network, Policy, Reference, Runtime,
};
use pubs_run::clock::now_ns;
use pubs_run::{Arm, ArmError, GoalPlan, Outcome, RunOptions, RunReport, run};

const SECOND: u64 = 1_000_000_000;
/// When the dummy's trouble begins, after the start.
const TROUBLE_AT_S: f64 = 1.0;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Trouble {
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
struct Log {
    /// (time, commanded speed along the slide).
    commands: Vec<(f64, f64)>,
    stops: u32,
}

/// A slide along base +y that follows every twist exactly.
struct Dummy {
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
    fn new(trouble: Trouble, truth: Option<f64>, log: &Arc<Mutex<Log>>) -> Self {
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
enum ModelTrouble {
    None,
    Panics,
    Hangs,
    NotANumber,
    Impossible,
}

/// 2 N everywhere.
struct Even {
    trouble: ModelTrouble,
    channels: Vec<Channel>,
    calls: std::sync::atomic::AtomicU32,
}

impl Even {
    fn new(trouble: ModelTrouble) -> Arc<Self> {
        let channels = vec![Channel {
            name: "f_d".to_owned(),
            kind: ChannelKind::Gaussian,
        }];
        Arc::new(Self {
            trouble,
            channels,
            calls: std::sync::atomic::AtomicU32::new(0),
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
            ModelTrouble::Hangs if late => std::thread::sleep(Duration::from_secs(1)),
            ModelTrouble::NotANumber if late => mean.fill(f32::NAN),
            ModelTrouble::Impossible if late => mean.fill(500.0),
            _ => {}
        }
        Ok(Support::Given)
    }
}

fn task() -> Task {
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
fn always(action: usize, folder: &Path) -> Policy {
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
    };
    let runtime = Runtime::tract().unwrap();
    let reference = Reference {
        inputs: &[0.1, 0.5],
        logits: &bias,
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
    file.open(&runtime).unwrap()
}

struct Case {
    action: usize,
    arm: Trouble,
    model: ModelTrouble,
    truth: Option<f64>,
    lockstep: bool,
    interrupt_after: Option<Duration>,
}

impl Case {
    fn new(arm: Trouble, lockstep: bool) -> Self {
        Self {
            action: 1,
            arm,
            model: ModelTrouble::None,
            truth: None,
            lockstep,
            interrupt_after: None,
        }
    }

    fn run(&self) -> (RunReport, Log) {
        let folder = tempfile::tempdir().unwrap();
        let log = Arc::new(Mutex::new(Log::default()));
        let interrupt = Arc::new(AtomicBool::new(false));
        if let Some(after) = self.interrupt_after {
            let interrupt = Arc::clone(&interrupt);
            std::thread::spawn(move || {
                std::thread::sleep(after);
                interrupt.store(true, Ordering::Release);
            });
        }
        let options = RunOptions {
            goals: vec![GoalPlan {
                state: 0.15,
                policy: 0,
            }],
            shield: None,
            max_steps: 20,
            lockstep: self.lockstep,
            seed: 1,
            interrupt,
        };
        let arm = Box::new(Dummy::new(self.arm, self.truth, &log));
        let policies = vec![always(self.action, folder.path())];
        let model: Arc<dyn Model> = Even::new(self.model);
        let report = run(
            &Arc::new(task()),
            arm,
            model,
            policies,
            &options,
            &mut |_| {},
        )
        .unwrap();
        let log = std::mem::take(&mut *log.lock().unwrap());
        (report, log)
    }
}

/// The commanded speed falls by no more than the deceleration of a stop allows, to rest.
fn assert_ramped_stop(log: &Log, name: &str) {
    assert!(log.stops >= 1, "{name}: the driver was never told to stop");
    let last = log.commands.last().map_or(0.0, |&(_, speed)| speed);
    assert_eq!(last, 0.0, "{name}: left with a command of {last} m/s");
    for pair in log.commands.windows(2) {
        let [(_, before), (time, after)] = [pair[0], pair[1]];
        let step = before.abs() - after.abs();
        assert!(
            step <= 5.0 / 100.0 + 1e-9,
            "{name}: from {before} to {after} m/s in one period at {time} s"
        );
    }
}

#[test]
fn trouble_in_lockstep_ends_in_a_ramped_stop() {
    let cases = [
        (Trouble::ReadFails, Outcome::Fault, "the link is gone"),
        (Trouble::ReportsFault, Outcome::Fault, "reports a fault"),
        (Trouble::ReadingsStop, Outcome::SafetyStop, "ms old"),
        (Trouble::ForceSpike, Outcome::SafetyStop, "force 58.0 N"),
        (
            Trouble::LeavesPath,
            Outcome::SafetyStop,
            "21.0 mm off the path",
        ),
        (Trouble::Jumps, Outcome::SafetyStop, "between two readings"),
    ];
    for (trouble, outcome, words) in cases {
        let (report, log) = Case {
            action: 2,
            ..Case::new(trouble, true)
        }
        .run();
        let name = format!("{trouble:?}");
        assert_eq!(report.outcome, outcome, "{name}: {report:?}");
        let reason = report.reason.unwrap_or_default();
        assert!(
            reason.contains(words),
            "{name}: `{words}` is missing in: {reason}"
        );
        assert_eq!(report.guard_stops, 1, "{name}");
        assert_ramped_stop(&log, &name);
        let fastest = log
            .commands
            .iter()
            .map(|&(_, speed)| speed)
            .fold(0.0, f64::max);
        assert!(
            (fastest - 0.15).abs() < 1e-9,
            "{name}: it never moved at full speed ({fastest} m/s)"
        );
        let stopped_at = log
            .commands
            .iter()
            .find(|&&(time, speed)| time > TROUBLE_AT_S && speed == 0.0);
        let stopped_s = stopped_at.map_or(f64::INFINITY, |&(time, _)| time - TROUBLE_AT_S);
        assert!(
            stopped_s < 0.2,
            "{name}: at rest only {stopped_s} s after the trouble"
        );
    }
}

#[test]
fn a_refused_command_is_the_end() {
    let (report, log) = Case::new(Trouble::CommandFails, true).run();
    assert_eq!(report.outcome, Outcome::Fault);
    assert!(
        report
            .reason
            .unwrap_or_default()
            .contains("the command was refused")
    );
    assert!(log.stops >= 1, "the driver was never told to stop");
}

#[test]
fn a_belief_that_breaks_down_stops_the_arm() {
    let cases = [
        (ModelTrouble::NotANumber, "not a number"),
        (ModelTrouble::Impossible, "no particle can explain"),
    ];
    for (model, words) in cases {
        let (report, log) = Case {
            model,
            ..Case::new(Trouble::None, true)
        }
        .run();
        let reason = report.reason.unwrap_or_default();
        assert_eq!(report.outcome, Outcome::Fault, "{model:?}: {reason}");
        assert!(
            reason.contains(words),
            "{model:?}: `{words}` is missing in: {reason}"
        );
        assert_ramped_stop(&log, &format!("{model:?}"));
    }
}

#[test]
fn a_violation_by_the_true_state_is_a_safety_stop() {
    // 15 mm per step, about 10 mm less at the start: the last step that fits ends near 0.295 m,
    // the next would pass 0.3 m, and the ramp to rest takes 3 mm at most.
    let (report, log) = Case {
        action: 2,
        truth: Some(0.247),
        ..Case::new(Trouble::None, true)
    }
    .run();
    assert_eq!(report.outcome, Outcome::SafetyStop, "{report:?}");
    assert_eq!(report.safety_violations, Some(1));
    assert_eq!(
        report.guard_stops, 0,
        "a violation is not a stop by the guard"
    );
    assert!(
        report.true_state.unwrap() < 0.3,
        "it left the limits: {:?}",
        report.true_state
    );
    assert_ramped_stop(&log, "violation");
}

#[test]
fn a_policy_that_never_stops_times_out() {
    let (report, log) = Case::new(Trouble::None, true).run();
    assert_eq!(report.outcome, Outcome::TimedOut);
    assert_eq!(report.policy_steps, 20);
    assert_eq!(
        report.safety_violations, None,
        "nobody knows the true state"
    );
    assert_ramped_stop(&log, "time-out");
}

#[test]
fn a_stop_is_judged_where_the_arm_rests() {
    for (truth, outcome) in [(0.15, Outcome::Reached), (0.25, Outcome::Missed)] {
        let (report, _) = Case {
            action: 0,
            truth: Some(truth),
            ..Case::new(Trouble::None, true)
        }
        .run();
        assert_eq!(report.outcome, outcome, "{report:?}");
        assert_eq!(report.policy_steps, 1);
    }
}

#[test]
fn lockstep_repeats_byte_for_byte() {
    let case = Case {
        truth: Some(0.1),
        ..Case::new(Trouble::None, true)
    };
    let [first, second] =
        [case.run(), case.run()].map(|(report, _)| serde_json::to_string(&report).unwrap());
    assert_eq!(first, second);
}

#[test]
fn trouble_in_real_time_ends_in_a_stop() {
    let live = |arm, model, interrupt_after| Case {
        model,
        interrupt_after,
        ..Case::new(arm, false)
    };
    let soon = Some(Duration::from_millis(700));
    let cases = [
        (
            "a panic in the driver",
            live(Trouble::ReadPanics, ModelTrouble::None, None),
            Outcome::Fault,
            "the dummy panics",
        ),
        (
            "a panic in the model",
            live(Trouble::None, ModelTrouble::Panics, None),
            Outcome::Fault,
            "the model panics",
        ),
        (
            "a hung model",
            live(Trouble::None, ModelTrouble::Hangs, None),
            Outcome::SafetyStop,
            "no sign of life from the filter",
        ),
        (
            "an interrupt",
            live(Trouble::None, ModelTrouble::None, soon),
            Outcome::SafetyStop,
            "interrupted",
        ),
        (
            "a lost link",
            live(Trouble::ReadFails, ModelTrouble::None, None),
            Outcome::Fault,
            "the link is gone",
        ),
    ];
    for (name, case, outcome, words) in cases {
        let (report, log) = case.run();
        let reason = report.reason.unwrap_or_default();
        assert_eq!(report.outcome, outcome, "{name}: {reason}");
        assert!(
            reason.contains(words),
            "{name}: `{words}` is missing in: {reason}"
        );
        assert!(log.stops >= 1, "{name}: the driver was never told to stop");
    }
}

#[test]
fn a_hung_driver_is_given_up() {
    let (report, _) = Case::new(Trouble::ReadHangs, false).run();
    assert_eq!(report.outcome, Outcome::SafetyStop);
    let reason = report.reason.unwrap_or_default();
    assert!(
        reason.contains("no sign of life from the controller"),
        "{reason}"
    );
    assert!(
        report.time_s < 5.0 && report.time_s * 1e9 < 5.0 * SECOND as f64,
        "{} s",
        report.time_s
    );
}
