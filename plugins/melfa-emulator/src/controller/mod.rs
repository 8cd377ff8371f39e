//! The controller: its state, and what a control cycle does.

mod packets;
mod program;
mod status;
mod stops;

pub use packets::Asked;

use std::collections::{BTreeMap, VecDeque};

use crate::alarm::Alarm;
use crate::external::External;
use crate::measure::Measure;
use crate::motion::Motion;
use crate::options::{Grasp, Mode, Posture};
use crate::scene::Scene;
use crate::signals::Signals;
use crate::store::Store;
use crate::task::Task;
use crate::views::Views;

/// How many alarms `ERRORRD` remembers.
const REMEMBERED_ALARMS: usize = 32;

/// Output that closes the hand.
const HAND_OUTPUT: u16 = 900;

/// Fingers that close farther than this from the handle miss it, m.
const FINGERS_M: f64 = 0.02;

/// Slower than this a tool does not close its fingers by itself, m/s.
const GRASPING_SPEED_M_S: f64 = 0.0005;

/// Settings that do not change while the controller runs.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Control cycle, s.
    pub cycle_s: f64,
    /// Cycles without a packet before an alarm; -1: never.
    pub mxtout: i32,
    /// What posture flags are worth.
    pub posture: Posture,
    /// From the order to the servo being on, s.
    pub servo_delay_s: f64,
    /// Data type id of the force sensor in the monitor.
    pub sensor_id: u16,
    /// When the fingers close.
    pub grasp: Grasp,
}

/// The servo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Servo {
    /// Off.
    Off,
    /// It will be on in this time, s.
    TurningOn(f64),
    /// On.
    On,
}

/// The controller and the arm that it moves.
#[derive(Debug, Clone)]
pub struct Controller {
    settings: Settings,
    /// Time since the start, s: a whole number of cycles.
    pub time_s: f64,
    /// Cycles since the start.
    pub cycles: u64,
    /// Position of the mode switch.
    pub mode: Mode,
    /// The servo.
    pub servo: Servo,
    servo_off_at_rest: bool,
    /// The present alarm.
    pub alarm: Option<Alarm>,
    /// The newest alarms, newest last.
    pub past_alarms: VecDeque<Alarm>,
    /// The button is pressed.
    pub emergency_stop: bool,
    /// The connection that has the operation right.
    pub operation_right: Option<u64>,
    /// Set and told, but it does not scale external control.
    pub override_percent: u32,
    /// Programs.
    pub store: Store,
    /// Slot 1.
    pub task: Task,
    /// While the program is at an `Mxt` line.
    pub external: Option<External>,
    /// The joints.
    pub motion: Motion,
    /// What they carry.
    pub scene: Scene,
    /// Input signals.
    pub inputs: Signals,
    /// Output signals.
    pub outputs: Signals,
    /// Variables that a client has set.
    pub variables: BTreeMap<String, String>,
    /// What truly happens.
    pub measure: Measure,
}

impl Controller {
    /// At rest, with nothing selected.
    pub fn new(settings: Settings, joints: [f64; 6], stop_scale: f64, scene: Scene) -> Self {
        let mut controller = Self {
            settings,
            time_s: 0.0,
            cycles: 0,
            mode: Mode::Auto,
            servo: Servo::Off,
            servo_off_at_rest: false,
            alarm: None,
            past_alarms: VecDeque::new(),
            emergency_stop: false,
            operation_right: None,
            override_percent: 100,
            store: Store::default(),
            task: Task::new(),
            external: None,
            motion: Motion::new(joints, settings.cycle_s, stop_scale),
            measure: Measure::new(&scene.tool(&joints), joints, settings.cycle_s),
            scene,
            inputs: Signals::default(),
            outputs: Signals::default(),
            variables: BTreeMap::new(),
        };
        // Until fingers hold it, somebody holds the object where it is.
        let open = settings.grasp != Grasp::Held;
        let disturbance = controller.scene.disturbance();
        disturbance.released = open;
        disturbance.jammed = open;
        controller
            .outputs
            .set_word(HAND_OUTPUT, 1, u16::from(!open));
        controller
    }

    /// Data type id of the force sensor in the monitor.
    pub fn sensor_id(&self) -> u16 {
        self.settings.sensor_id
    }

    /// Length of the control cycle, s.
    pub fn cycle_s(&self) -> f64 {
        self.settings.cycle_s
    }

    /// Whether the servo is on.
    pub fn servo_is_on(&self) -> bool {
        self.servo == Servo::On
    }

    /// What it shows of itself.
    pub fn views(&self) -> Views<'_> {
        Views {
            external: self.external.as_ref(),
            motion: &self.motion,
            scene: &self.scene,
        }
    }

    /// Sets outputs; the hand is one of them.
    pub fn set_outputs(&mut self, first: u16, mask: u16, value: u16) {
        let before = self.outputs.is_on(HAND_OUTPUT);
        self.outputs.set_word(first, mask, value);
        let hand = self.outputs.is_on(HAND_OUTPUT);
        if hand != before {
            self.set_grasp(hand);
        }
    }

    /// Closes or opens the fingers; away from the handle they close on nothing.
    pub fn set_grasp(&mut self, closed: bool) {
        self.outputs.set_word(HAND_OUTPUT, 1, u16::from(closed));
        if closed {
            self.settings.grasp = Grasp::Held;
        }
        let held = closed && self.scene.handle_distance_m() < FINGERS_M;
        let disturbance = self.scene.disturbance();
        if held && disturbance.released {
            disturbance.jammed = false;
        }
        disturbance.released = !held;
    }

    /// Takes arm and object from another controller, as they are there at the beginning; its own
    /// state stays.
    pub fn put_back(&mut self, fresh: Self) {
        self.settings.grasp = fresh.settings.grasp;
        self.motion = fresh.motion;
        self.scene = fresh.scene;
        self.measure = fresh.measure;
        self.measure.last_motion_s = self.time_s;
        let hand = fresh.outputs.word(HAND_OUTPUT);
        self.outputs.set_word(HAND_OUTPUT, 1, hand);
    }

    /// One control cycle: program, joints, object.
    pub fn cycle(&mut self) {
        self.cycles += 1;
        self.time_s = self.cycles as f64 * self.settings.cycle_s;
        self.turn_servo();
        self.run_program();
        self.count_silence();
        self.move_joints();
        let (from, to) = (*self.motion.before(), *self.motion.joints());
        self.scene.advance(&from, &to, self.settings.cycle_s);
        let tool = self.scene.tool(&to);
        let force_n = self.scene.true_wrench().force.norm();
        self.measure.cycle(self.time_s, &tool, &to, force_n);
        self.close_fingers_on_motion();
    }

    fn turn_servo(&mut self) {
        if let Servo::TurningOn(left_s) = &mut self.servo {
            *left_s -= self.settings.cycle_s;
            if *left_s <= 0.0 {
                self.servo = Servo::On;
            }
        }
        if self.servo_off_at_rest && self.motion.is_at_rest() {
            self.servo = Servo::Off;
            self.servo_off_at_rest = false;
        }
    }

    fn count_silence(&mut self) {
        let mxtout = self.settings.mxtout;
        let counted = self.external.as_mut().map(|one| one.count_cycle(mxtout));
        if let Some(Err(alarm)) = counted {
            self.raise(alarm);
        }
    }

    fn move_joints(&mut self) {
        match self.next_joints() {
            Ok(Some(next)) => match self.motion.follow(next) {
                Ok(()) => return,
                Err(fault) => {
                    let speed = fault.speed_rad_s.to_degrees();
                    let particulars = format!("J{} at {speed:.0} degrees/s", fault.joint);
                    self.raise(Alarm::new(crate::alarm::JOINT_SPEED).with(&particulars));
                }
            },
            Ok(None) => {}
            Err(alarm) => self.raise(alarm),
        }
        self.motion.coast();
    }

    fn next_joints(&mut self) -> Result<Option<[f64; 6]>, Alarm> {
        let ready = self.servo_is_on() && !self.motion.is_stopping();
        match self.external.as_mut().filter(|_| ready) {
            Some(external) => external.next(self.motion.joints(), &self.scene),
            None => Ok(None),
        }
    }

    fn close_fingers_on_motion(&mut self) {
        let waiting = self.settings.grasp == Grasp::OnMotion && !self.scene.is_held();
        if waiting && self.measure.speed_m_s > GRASPING_SPEED_M_S {
            self.set_grasp(true);
        }
    }
}
