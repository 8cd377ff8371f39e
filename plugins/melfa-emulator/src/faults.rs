//! Faults on demand: what can be asked over the control socket and in a scenario.

use nalgebra::Vector3;
use serde::Deserialize;

use crate::alarm::{self, Alarm};
use crate::controller::Controller;
use crate::link::{Delay, Drop, LinkFaults, Short, Timed};
use crate::options::Mode;

/// Which UDP service.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Service {
    /// External control.
    #[default]
    Mxt,
    /// The real-time monitor.
    Monitor,
    /// Both.
    Both,
}

impl Service {
    /// Indices of [`Faults::links`].
    pub fn indices(self) -> &'static [usize] {
        match self {
            Self::Mxt => &[0],
            Self::Monitor => &[1],
            Self::Both => &[0, 1],
        }
    }
}

/// Which way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// From the client.
    ToController,
    /// To the client.
    ToClient,
    /// Both.
    #[default]
    Both,
}

impl Direction {
    /// Indices of a service's pair of links.
    pub fn indices(self) -> &'static [usize] {
        match self {
            Self::ToController => &[0],
            Self::ToClient => &[1],
            Self::Both => &[0, 1],
        }
    }
}

/// How R3 behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum R3State {
    /// Connections are closed; new ones are taken.
    Close,
    /// Connections are closed, new ones refused.
    Refuse,
    /// New ones are taken again.
    Accept,
}

/// A fault, or its end. See the README for what each does.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
#[allow(missing_docs)]
pub enum Fault {
    Clear,
    Drop {
        probability: f64,
        #[serde(default = "one")]
        burst: u32,
        #[serde(default)]
        service: Service,
        #[serde(default)]
        direction: Direction,
        seconds: Option<f64>,
    },
    Delay {
        ms: f64,
        #[serde(default)]
        jitter_ms: f64,
        #[serde(default)]
        service: Service,
        #[serde(default)]
        direction: Direction,
        seconds: Option<f64>,
    },
    Duplicate {
        probability: f64,
        #[serde(default)]
        service: Service,
        #[serde(default)]
        direction: Direction,
        seconds: Option<f64>,
    },
    Reorder {
        probability: f64,
        #[serde(default)]
        service: Service,
        #[serde(default)]
        direction: Direction,
        seconds: Option<f64>,
    },
    Short {
        probability: f64,
        #[serde(default = "hundred")]
        bytes: usize,
        #[serde(default)]
        service: Service,
        #[serde(default)]
        direction: Direction,
        seconds: Option<f64>,
    },
    Silent {
        #[serde(default)]
        service: Service,
        seconds: Option<f64>,
    },
    Stranger {
        #[serde(default = "one")]
        count: u32,
        #[serde(default)]
        service: Service,
    },
    Alarm {
        number: u32,
        text: Option<String>,
    },
    EmergencyStop {
        #[serde(default = "yes")]
        pressed: bool,
    },
    ContactStop,
    Mode {
        mode: Mode,
    },
    R3 {
        state: R3State,
    },
    Saturate {
        limit_n: Option<f64>,
    },
    BiasStep {
        force_n: [f64; 3],
    },
    BiasRate {
        force_n_per_s: [f64; 3],
    },
    Slip,
    Grasp,
    Jam {
        #[serde(default = "yes")]
        jammed: bool,
        seconds: Option<f64>,
    },
    Pull {
        force_n: f64,
        seconds: f64,
    },
}

fn one() -> u32 {
    1
}

fn hundred() -> usize {
    100
}

fn yes() -> bool {
    true
}

/// The faults there are.
#[derive(Debug, Clone)]
pub struct Faults {
    /// Service, then direction: to the controller, to the client.
    pub links: [[LinkFaults; 2]; 2],
    /// Packets still to be sent from a stranger's address, of each service.
    pub strangers: [u32; 2],
    /// Connections older than this many closings are closed.
    pub r3_closings: u64,
    /// No new ones are taken.
    pub r3_refused: bool,
    jammed_until_s: f64,
    pulled_until_s: f64,
    /// When the newest fault began, s.
    pub newest_s: Option<f64>,
}

impl Default for Faults {
    fn default() -> Self {
        Self {
            links: [[LinkFaults::default(); 2]; 2],
            strangers: [0; 2],
            r3_closings: 0,
            r3_refused: false,
            jammed_until_s: f64::INFINITY,
            pulled_until_s: f64::INFINITY,
            newest_s: None,
        }
    }
}

impl Faults {
    /// Makes a fault happen.
    pub fn apply(&mut self, fault: &Fault, controller: &mut Controller) {
        let now_s = controller.time_s;
        self.newest_s = Some(now_s);
        if self.apply_to_links(fault, now_s) {
            return;
        }
        match fault {
            Fault::Clear => {
                self.clear(controller);
                self.newest_s = None;
            }
            Fault::Stranger { count, service } => {
                for index in service.indices() {
                    self.strangers[*index] += count;
                }
            }
            Fault::Alarm { number, text } => {
                let mut alarm = Alarm::new(*number);
                alarm.text = text.clone().unwrap_or(alarm.text);
                controller.raise(alarm);
            }
            Fault::EmergencyStop { pressed } => controller.press_emergency_stop(*pressed),
            Fault::ContactStop => controller.raise(Alarm::new(alarm::CONTACT)),
            Fault::Mode { mode } => controller.switch_mode(*mode),
            Fault::R3 { state } => {
                self.r3_closings += u64::from(*state != R3State::Accept);
                self.r3_refused = *state == R3State::Refuse;
            }
            Fault::Saturate { limit_n } => {
                let limit_n = limit_n.unwrap_or(f64::INFINITY);
                controller.scene.sensor_fault.saturation_n = limit_n.abs();
            }
            Fault::BiasStep { force_n } => {
                controller.scene.sensor_fault.step_n += Vector3::from(*force_n);
            }
            Fault::BiasRate { force_n_per_s } => {
                controller.scene.sensor_fault.rate_n_per_s = Vector3::from(*force_n_per_s);
            }
            Fault::Slip => controller.set_grasp(false),
            Fault::Grasp => controller.set_grasp(true),
            Fault::Jam { jammed, seconds } => {
                controller.scene.disturbance().jammed = *jammed;
                self.jammed_until_s = end(now_s, *seconds);
            }
            Fault::Pull { force_n, seconds } => {
                controller.scene.disturbance().push_n = *force_n;
                self.pulled_until_s = now_s + seconds;
            }
            // Done above.
            _ => {}
        }
    }

    /// Whether it was one of the links'.
    fn apply_to_links(&mut self, fault: &Fault, now_s: f64) -> bool {
        match *fault {
            Fault::Drop {
                probability,
                burst,
                service,
                direction,
                seconds,
            } => {
                let drop = timed(Drop { probability, burst }, now_s, seconds);
                self.set(service, direction, |link| link.drop = drop);
            }
            Fault::Delay {
                ms,
                jitter_ms,
                service,
                direction,
                seconds,
            } => {
                let delay = Delay {
                    least_s: ms / 1000.0,
                    most_s: (ms + jitter_ms) / 1000.0,
                };
                let delay = timed(delay, now_s, seconds);
                self.set(service, direction, |link| link.delay = delay);
            }
            Fault::Duplicate {
                probability,
                service,
                direction,
                seconds,
            } => {
                let duplicate = timed(probability, now_s, seconds);
                self.set(service, direction, |link| link.duplicate = duplicate);
            }
            Fault::Reorder {
                probability,
                service,
                direction,
                seconds,
            } => {
                let reorder = timed(probability, now_s, seconds);
                self.set(service, direction, |link| link.reorder = reorder);
            }
            Fault::Short {
                probability,
                bytes,
                service,
                direction,
                seconds,
            } => {
                let short = timed(Short { probability, bytes }, now_s, seconds);
                self.set(service, direction, |link| link.short = short);
            }
            Fault::Silent { service, seconds } => {
                let silent = timed((), now_s, seconds);
                self.set(service, Direction::ToClient, |link| link.silent = silent);
            }
            _ => return false,
        }
        true
    }

    fn set(&mut self, service: Service, direction: Direction, change: impl Fn(&mut LinkFaults)) {
        for service in service.indices() {
            for direction in direction.indices() {
                change(&mut self.links[*service][*direction]);
            }
        }
    }

    /// Ends what ends by itself.
    pub fn expire(&mut self, controller: &mut Controller) {
        let now_s = controller.time_s;
        if now_s >= self.jammed_until_s {
            controller.scene.disturbance().jammed = false;
            self.jammed_until_s = f64::INFINITY;
        }
        if now_s >= self.pulled_until_s {
            controller.scene.disturbance().push_n = 0.0;
            self.pulled_until_s = f64::INFINITY;
        }
    }

    /// Ends all faults of links, R3, sensor and object. An alarm, the emergency stop, the mode and
    /// a lost grasp stay.
    fn clear(&mut self, controller: &mut Controller) {
        *self = Self {
            r3_closings: self.r3_closings,
            ..Self::default()
        };
        controller.scene.sensor_fault = Default::default();
        let held = controller.scene.is_held();
        let disturbance = controller.scene.disturbance();
        disturbance.push_n = 0.0;
        disturbance.jammed &= !held;
    }
}

fn end(now_s: f64, seconds: Option<f64>) -> f64 {
    seconds.map_or(f64::INFINITY, |seconds| now_s + seconds)
}

fn timed<T>(fault: T, now_s: f64, seconds: Option<f64>) -> Option<Timed<T>> {
    Some(Timed {
        fault,
        until_s: end(now_s, seconds),
    })
}
