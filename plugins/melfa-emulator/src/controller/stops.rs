//! What brings everything to a stop: alarms, the emergency stop, the mode switch, the servo.

use super::{Controller, REMEMBERED_ALARMS, Servo};
use crate::alarm::{self, Alarm, Severity};
use crate::options::Mode;

impl Controller {
    /// Raises an alarm: the program stops and the arm slows down to rest as [`crate::motion`] says;
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
            self.raise(Alarm::new(alarm::EMERGENCY_STOP));
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
