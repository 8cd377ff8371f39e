//! The faults there are, and how one comes and goes.

use nalgebra::Vector3;

use crate::alarm::{self, Alarm};
use crate::controller::Controller;
use crate::fault::{Cuts, Direction, Fault, Losses, R3State, Service};
use crate::link::{Delay, Drop, LinkFaults, Short, Timed};

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
            Fault::Drop(losses) => {
                let Losses {
                    probability, burst, ..
                } = losses;
                let drop = timed(Drop { probability, burst }, now_s, losses.seconds);
                self.set(losses.service, losses.direction, |link| link.drop = drop);
            }
            Fault::Delay(delays) => {
                let delay = Delay {
                    least_s: delays.ms / 1000.0,
                    most_s: (delays.ms + delays.jitter_ms) / 1000.0,
                };
                let delay = timed(delay, now_s, delays.seconds);
                self.set(delays.service, delays.direction, |link| link.delay = delay);
            }
            Fault::Duplicate(disorder) => {
                let duplicate = timed(disorder.probability, now_s, disorder.seconds);
                self.set(disorder.service, disorder.direction, |link| {
                    link.duplicate = duplicate;
                });
            }
            Fault::Reorder(disorder) => {
                let reorder = timed(disorder.probability, now_s, disorder.seconds);
                self.set(disorder.service, disorder.direction, |link| {
                    link.reorder = reorder;
                });
            }
            Fault::Short(cuts) => {
                let Cuts {
                    probability, bytes, ..
                } = cuts;
                let short = timed(Short { probability, bytes }, now_s, cuts.seconds);
                self.set(cuts.service, cuts.direction, |link| link.short = short);
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
