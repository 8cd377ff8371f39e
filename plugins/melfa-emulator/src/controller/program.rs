//! Running the program: statement by statement, until one takes time.

use pubs_melfa_protocol::r3;

use super::{Controller, Servo};
use crate::alarm::{self, Alarm};
use crate::external::External;
use crate::filter::LowPass;
use crate::program::{Statement, TargetKind};

/// Statements that a cycle has time for.
const STATEMENTS_PER_CYCLE: usize = 16;

impl Controller {
    pub(super) fn run_program(&mut self) {
        for _ in 0..STATEMENTS_PER_CYCLE {
            if !self.task.is_running() || self.external.is_some() {
                return;
            }
            let statement = self.task.statement();
            if !self.execute(statement) {
                return;
            }
        }
    }

    /// Whether the next statement may follow in the same cycle.
    fn execute(&mut self, statement: Statement) -> bool {
        match statement {
            Statement::Open { file, peer } => return self.open(file, peer),
            Statement::Close { file: Some(file) } => {
                self.task.files.remove(&file);
            }
            Statement::Close { file: None } => self.task.files.clear(),
            Statement::Mxt {
                file,
                target,
                filter_ms,
            } => {
                self.begin_external(file, target, filter_ms);
                return false;
            }
            Statement::Servo(true) => {
                self.order_servo_on();
                if self.servo != Servo::On {
                    return false;
                }
            }
            Statement::Servo(false) => {
                // The program goes on, unlike at an order from outside.
                self.motion.stop();
                self.servo = Servo::Off;
            }
            Statement::Override(percent) => self.override_percent = percent.clamp(1, 100),
            Statement::Halt => {
                self.task.advance();
                self.task.interrupt();
                return false;
            }
            Statement::End => {
                self.task.end();
                return false;
            }
            Statement::Other => {}
        }
        self.task.advance();
        true
    }

    fn open(&mut self, file: u8, peer: Option<std::net::IpAddr>) -> bool {
        let Some(peer) = peer else {
            let alarm = Alarm::new(r3::NETWORK_ERROR);
            self.raise(alarm.with("the address of the ENET line cannot be read"));
            return false;
        };
        self.task.files.insert(file, peer);
        self.task.advance();
        true
    }

    /// Waits for an arm that is still slowing down: the session begins where it comes to rest.
    fn begin_external(&mut self, file: u8, target: TargetKind, filter_ms: f64) {
        if !self.motion.is_at_rest() {
            return;
        }
        let Some(peer) = self.task.files.get(&file).copied() else {
            self.raise(Alarm::new(alarm::FILE_NOT_OPEN));
            return;
        };
        let filter = LowPass::new(filter_ms / 1000.0, self.settings.cycle_s);
        let tool = self.scene.tool(self.motion.joints());
        let posture = self.settings.posture;
        self.external = Some(External::new(target, peer, filter, posture, tool));
    }

    /// Command 255: the arm comes to rest, and the program goes on after its `Mxt` line.
    pub(super) fn end_external(&mut self) {
        self.external = None;
        self.motion.stop();
        self.task.advance();
    }
}
