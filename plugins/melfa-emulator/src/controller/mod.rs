//! The controller: its state, and what a control cycle does.

mod program;
mod status;

use std::collections::{BTreeMap, VecDeque};
use std::net::SocketAddr;

use pubs_melfa_protocol::mxt::{Io, Reply, Request};

use crate::alarm::{Alarm, Severity};
use crate::external::{External, Heard};
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

/// A packet that gets a reply at the end of the cycle.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Who asked.
    pub by: SocketAddr,
    request: Request,
    count: u32,
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

    /// Takes a packet of MXT. `None`: it gets no reply. What has not 196 bytes, is none of the
    /// protocol's, comes from elsewhere or while no program is at an `Mxt` line, is passed over.
    pub fn hear(&mut self, bytes: &[u8], from: SocketAddr) -> Option<Asked> {
        let servo_on = self.servo_is_on();
        let external = self.external.as_mut()?;
        if external.peer != from.ip() {
            return None;
        }
        let request = Request::decode(bytes).ok()?;
        match external.hear(&request, servo_on, self.motion.joints()) {
            Heard::Reply => {
                let count = external.count;
                self.write_outputs(&request.io);
                Some(Asked {
                    by: from,
                    request,
                    count,
                })
            }
            Heard::End => {
                self.end_external();
                None
            }
            Heard::Alarm(alarm) => {
                self.raise(alarm);
                None
            }
        }
    }

    fn write_outputs(&mut self, io: &Io) {
        if io.send == 1 {
            self.set_outputs(io.first_bit, io.mask, io.data);
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

    /// Closes or opens the fingers.
    pub fn set_grasp(&mut self, held: bool) {
        self.outputs.set_word(HAND_OUTPUT, 1, u16::from(held));
        let disturbance = self.scene.disturbance();
        if held && disturbance.released {
            disturbance.jammed = false;
        }
        disturbance.released = !held;
    }

    /// What a packet asked for, as it is after the cycle; `None` where external control has ended.
    pub fn reply(&self, asked: &Asked) -> Option<Reply> {
        let external = self.external.as_ref()?;
        let views = self.views();
        let io = &asked.request.io;
        Some(Reply {
            command: asked.request.command as u16,
            data: asked
                .request
                .receive
                .map(|data_type| (data_type, views.data(data_type))),
            io: Io {
                send: io.receive,
                first_bit: io.first_bit,
                data: match io.receive {
                    1 => self.outputs.word(io.first_bit),
                    2 => self.inputs.word(io.first_bit),
                    _ => 0,
                },
                ..Io::default()
            },
            timeout_count: external.timeout_count,
            count: asked.count,
        })
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
            self.settings.grasp = Grasp::Held;
            self.set_grasp(true);
        }
    }

    /// Raises an alarm: the program stops, the arm slows down to rest by [`Motion::stop`], and
    /// after a grave one the servo goes off then. The first alarm stays until it is reset.
    pub fn raise(&mut self, alarm: Alarm) {
        self.stop_program();
        if alarm.severity == Severity::High {
            self.order_servo_off();
        }
        self.past_alarms.push_back(alarm.clone());
        if self.past_alarms.len() > REMEMBERED_ALARMS {
            self.past_alarms.pop_front();
        }
        self.alarm.get_or_insert(alarm);
    }

    /// Presses or releases the emergency stop.
    pub fn press_emergency_stop(&mut self, pressed: bool) {
        let newly = pressed && !self.emergency_stop;
        self.emergency_stop = pressed;
        if newly {
            self.raise(Alarm::new(crate::alarm::EMERGENCY_STOP));
        }
    }

    /// Turns the mode switch; it stops everything.
    pub fn switch_mode(&mut self, mode: Mode) {
        if mode == self.mode {
            return;
        }
        self.mode = mode;
        self.operation_right = None;
        self.stop_program();
        self.order_servo_off();
    }

    /// Begins to turn the servo on.
    pub fn order_servo_on(&mut self) {
        self.servo_off_at_rest = false;
        if self.servo == Servo::Off {
            self.servo = Servo::TurningOn(self.settings.servo_delay_s);
        }
    }

    /// Brings the arm to rest and turns the servo off then.
    pub fn order_servo_off(&mut self) {
        self.stop_program();
        self.servo_off_at_rest = self.servo == Servo::On;
        if !self.servo_off_at_rest {
            self.servo = Servo::Off;
        }
    }

    /// Stops the program where it is, and the arm.
    pub fn stop_program(&mut self) {
        self.task.interrupt();
        self.external = None;
        self.motion.stop();
    }
}
