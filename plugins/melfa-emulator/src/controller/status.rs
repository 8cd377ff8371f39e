//! The state in the bits and fields of R3.

use pubs_melfa_protocol::r3::{Position, ProgramState, RunStatus, State, StopStatus};

use super::Controller;
use crate::options::Mode;
use crate::task::Progress;

impl Controller {
    /// The answer to `DSTATE`.
    pub fn state(&self) -> State {
        let running = self.task.is_running();
        State {
            run: RunStatus {
                repeat: self.task.repeat,
                cycle_stop_off: running && !self.task.cycle_stop,
                machine_lock: false,
                teach: self.mode == Mode::Manual,
                teach_running: false,
                servo_on: self.servo_is_on(),
                running,
                operation_enabled: self.mode == Mode::Auto && !self.emergency_stop,
            },
            stop: StopStatus {
                emergency_stop: self.emergency_stop,
                stop: !running,
                wait: self.task.progress == Progress::Interrupted,
                stop_signal_off: false,
                program_select_enabled: self.task.progress == Progress::Ready,
                pseudo_input: false,
            },
            error: self.alarm.as_ref().map_or(0, |alarm| alarm.number),
            step: self.task.line as u32 + 1,
            mechanism: 0,
        }
    }

    /// The answer to `STATE`.
    pub fn program_state(&self) -> ProgramState {
        ProgramState {
            program: self.task.name.clone(),
            line: self.task.line as u32 + 1,
            override_percent: self.override_percent,
            edit_status: "00".to_owned(),
            state: State {
                mechanism: 1,
                ..self.state()
            },
            slot_program: self.task.name.clone(),
            repeat: self.task.repeat,
            start_condition: "START".to_owned(),
            priority: 1,
            mechanism_number: 1,
        }
    }

    /// The answer to `PPOSF`.
    pub fn position(&self) -> Position {
        let pose = self.views().feedback_pose();
        Position {
            position_mm: pose.position_mm.map(f64::from),
            angles_deg: pose.angles_rad.map(|value| f64::from(value).to_degrees()),
            posture: pose.posture,
            turns: pose.turns,
            override_percent: self.override_percent,
            speed: self.measure.speed_m_s * 1000.0,
        }
    }
}
