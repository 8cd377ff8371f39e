//! Everything that the services share: controller, listeners, faults.

use std::net::SocketAddr;

use serde::Deserialize;
use serde_json::{Value, json};

use crate::build::build;
use crate::controller::{Asked, Controller, Servo};
use crate::fault::Fault;
use crate::faults::Faults;
use crate::monitor::Monitor;
use crate::options::Options;
use crate::scenario::Scenario;

/// How far the cycle is behind the clock.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pacing {
    /// Worst since the last reset, s.
    pub worst_s: f64,
    /// Times at which cycles were left out because it was too far behind.
    pub slips: u64,
}

/// The machine.
#[derive(Debug, Clone)]
pub struct Machine {
    /// Controller, arm and object.
    pub controller: Controller,
    /// Who listens to the monitor.
    pub monitor: Monitor,
    /// Faults.
    pub faults: Faults,
    /// Faults to come.
    pub scenario: Scenario,
    /// Who asked last over MXT.
    pub client: Option<SocketAddr>,
    /// How well it keeps its cycle.
    pub pacing: Pacing,
    options: Options,
    first_motion_s: Option<f64>,
}

/// Another start.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Place {
    #[serde(rename = "do")]
    _what: String,
    /// As a fraction of the range; drawn from the seed where left out.
    start: Option<f64>,
    /// Of the start and the sensor's noise; the option's where left out.
    seed: Option<u64>,
}

/// Packets by the address they go to.
pub type Packets = Vec<(SocketAddr, Vec<u8>)>;

impl Machine {
    /// Nobody listens, nothing is wrong.
    pub fn new(controller: Controller, scenario: Scenario, options: Options) -> Self {
        Self {
            controller,
            monitor: Monitor::default(),
            faults: Faults::default(),
            scenario,
            client: None,
            pacing: Pacing::default(),
            options,
            first_motion_s: None,
        }
    }

    /// One control cycle with the packets that came for MXT; gives the replies.
    pub fn cycle(&mut self, packets: &[(SocketAddr, Vec<u8>)]) -> Packets {
        let now_s = self.controller.time_s;
        for fault in self.scenario.due(now_s, self.first_motion_s) {
            self.faults.apply(&fault, &mut self.controller);
        }
        self.faults.expire(&mut self.controller);
        let mut asked: Vec<Asked> = vec![];
        for (from, bytes) in packets {
            asked.extend(self.controller.hear(bytes, *from));
        }
        self.controller.cycle();
        if self.first_motion_s.is_none() && !self.controller.measure.at_rest {
            self.first_motion_s = Some(self.controller.time_s);
        }
        let mut replies = vec![];
        for asked in &asked {
            self.client = Some(asked.by);
            let reply = self.controller.reply(asked);
            replies.extend(reply.map(|reply| (asked.by, reply.encode().to_vec())));
        }
        replies
    }

    /// The monitor's packets of this cycle.
    pub fn monitor_packets(&mut self) -> Packets {
        self.monitor.packets(&self.controller)
    }

    /// Carries out a line of the control socket and answers.
    pub fn command(&mut self, line: &str) -> Value {
        let parsed: Result<Value, _> = serde_json::from_str(line);
        let value = match parsed {
            Ok(value) => value,
            Err(error) => return refused(&format!("not JSON: {error}")),
        };
        match value.get("do").and_then(Value::as_str) {
            Some("state") => self.report(),
            Some("reset_peaks") => {
                self.controller.measure.peaks = Default::default();
                self.pacing.worst_s = 0.0;
                json!({ "ok": true })
            }
            Some("place") => match self.place(value) {
                Ok(()) => json!({ "ok": true }),
                Err(error) => refused(&error),
            },
            _ => match serde_json::from_value::<Fault>(value) {
                Ok(fault) => {
                    self.faults.apply(&fault, &mut self.controller);
                    json!({ "ok": true, "time_s": self.controller.time_s })
                }
                Err(error) => refused(&error.to_string()),
            },
        }
    }

    /// Puts arm and object to another start, as at the beginning. Not while a program runs.
    fn place(&mut self, value: Value) -> Result<(), String> {
        let Place { start, seed, .. } =
            serde_json::from_value(value).map_err(|error| error.to_string())?;
        if !start.is_none_or(|start| (0.0..=1.0).contains(&start)) {
            return Err("start should be from 0 to 1".to_owned());
        }
        if self.controller.task.is_running() || self.controller.motion.is_stopping() {
            return Err("stop the program first".to_owned());
        }
        let options = Options {
            start,
            seed: seed.unwrap_or(self.options.seed),
            program: None,
            run: false,
            scenario: None,
            ..self.options.clone()
        };
        let (fresh, _) = build(&options).map_err(|error| error.to_string())?;
        self.controller.put_back(fresh.controller);
        Ok(())
    }

    /// The true state.
    fn report(&self) -> Value {
        let controller = &self.controller;
        let measure = &controller.measure;
        let joints = controller.motion.joints();
        let tool = controller.scene.tool(joints);
        let quaternion = tool.rotation.coords;
        let wrench = controller.scene.true_wrench();
        let shown = controller.scene.shown();
        json!({
            "ok": true,
            "time_s": controller.time_s,
            "cycles": controller.cycles,
            "cycle_s": controller.cycle_s(),
            "lateness": { "worst_s": self.pacing.worst_s, "slips": self.pacing.slips },
            "mode": controller.mode,
            "servo": match controller.servo {
                Servo::Off => "off",
                Servo::TurningOn(_) => "turning_on",
                Servo::On => "on",
            },
            "emergency_stop": controller.emergency_stop,
            "alarm": controller.alarm.as_ref().map(|alarm| json!({
                "number": alarm.number,
                "text": alarm.text,
            })),
            "program": {
                "name": controller.task.name,
                "line": controller.task.line + 1,
                "running": controller.task.is_running(),
            },
            "mxt": controller.external.as_ref().map(|external| json!({
                "peer": external.peer.to_string(),
                "handshaken": external.handshaken,
                "has_target": external.target.is_some(),
                "count": external.count,
                "timeout_count": external.timeout_count,
            })),
            "client": self.client.map(|client| client.to_string()),
            "monitor_listeners": self.monitor.listeners(),
            "joints_rad": joints,
            "joint_speed_rad_s": measure.rates(),
            "tool_m": tool.translation.vector.as_slice(),
            "tool_xyzw": quaternion.as_slice(),
            "tool_speed_m_s": measure.speed_m_s,
            "tool_acceleration_m_s2": measure.acceleration_m_s2,
            "at_rest": measure.at_rest,
            "last_motion_s": measure.last_motion_s,
            "fault_s": self.faults.newest_s,
            "rest_after_fault_s": self.rest_after_fault_s(),
            "peaks": measure.peaks,
            "object": {
                "joint_state": controller.scene.joint_state(),
                "handle_speed_m_s": controller.scene.handle_speed_m_s(),
                "held": controller.scene.is_held(),
            },
            "force_n": wrench.force.as_slice(),
            "torque_nm": wrench.torque.as_slice(),
            "shown_force_n": shown.force.as_slice(),
        })
    }

    /// From the newest fault to the last motion since; nothing while it moves.
    fn rest_after_fault_s(&self) -> Option<f64> {
        let measure = &self.controller.measure;
        let fault_s = self.faults.newest_s.filter(|_| measure.at_rest)?;
        Some((measure.last_motion_s - fault_s).max(0.0))
    }
}

fn refused(error: &str) -> Value {
    json!({ "ok": false, "error": error })
}
