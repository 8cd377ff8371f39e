//! The controller's state as `DSTATE` tells it: two bytes of bits, an error number, a step.

use std::fmt;
use std::str::FromStr;

use super::TextError;

/// First byte: how the robot runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RunStatus {
    /// Bit 0: the program repeats; clear: it runs once.
    pub repeat: bool,
    /// Bit 1: cycle stop is off.
    pub cycle_stop_off: bool,
    /// Bit 2: machine lock.
    pub machine_lock: bool,
    /// Bit 3: teach mode; clear: automatic.
    pub teach: bool,
    /// Bit 4: running in teach mode.
    pub teach_running: bool,
    /// Bit 5: servo on.
    pub servo_on: bool,
    /// Bit 6: the program runs.
    pub running: bool,
    /// Bit 7: operation is enabled.
    pub operation_enabled: bool,
}

impl RunStatus {
    /// From the byte.
    pub fn from_bits(bits: u8) -> Self {
        let [
            repeat,
            cycle_stop_off,
            machine_lock,
            teach,
            teach_running,
            servo_on,
            running,
            operation_enabled,
        ] = set_bits(bits);
        Self {
            repeat,
            cycle_stop_off,
            machine_lock,
            teach,
            teach_running,
            servo_on,
            running,
            operation_enabled,
        }
    }

    /// To the byte.
    pub fn bits(&self) -> u8 {
        byte_of([
            self.repeat,
            self.cycle_stop_off,
            self.machine_lock,
            self.teach,
            self.teach_running,
            self.servo_on,
            self.running,
            self.operation_enabled,
        ])
    }
}

/// Second byte: why it does not. Bits 5 and 7 are not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StopStatus {
    /// Bit 0: emergency stop.
    pub emergency_stop: bool,
    /// Bit 1: stopped.
    pub stop: bool,
    /// Bit 2: waiting.
    pub wait: bool,
    /// Bit 3: the stop signal is off.
    pub stop_signal_off: bool,
    /// Bit 4: a program may be selected.
    pub program_select_enabled: bool,
    /// Bit 6: pseudo input.
    pub pseudo_input: bool,
}

impl StopStatus {
    /// From the byte.
    pub fn from_bits(bits: u8) -> Self {
        let [
            emergency_stop,
            stop,
            wait,
            stop_signal_off,
            program_select_enabled,
            _,
            pseudo_input,
            _,
        ] = set_bits(bits);
        Self {
            emergency_stop,
            stop,
            wait,
            stop_signal_off,
            program_select_enabled,
            pseudo_input,
        }
    }

    /// To the byte.
    pub fn bits(&self) -> u8 {
        byte_of([
            self.emergency_stop,
            self.stop,
            self.wait,
            self.stop_signal_off,
            self.program_select_enabled,
            false,
            self.pseudo_input,
            false,
        ])
    }
}

fn set_bits(bits: u8) -> [bool; 8] {
    std::array::from_fn(|index| bits & (1 << index) != 0)
}

fn byte_of(set: [bool; 8]) -> u8 {
    let bits = set.iter().enumerate();
    bits.fold(0, |byte, (index, set)| byte | u8::from(*set) << index)
}

/// The answer to `DSTATE`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct State {
    /// How it runs.
    pub run: RunStatus,
    /// Why it does not.
    pub stop: StopStatus,
    /// Number of the present error; 0: none.
    pub error: u32,
    /// Step of the program.
    pub step: u32,
    /// Number of the mechanism.
    pub mechanism: u32,
}

impl State {
    /// The two bytes and the error number, as `DSTATE` and field 4 of `STATE` have them.
    pub(super) fn parse_status(text: &str) -> Option<Self> {
        let byte = |range| u8::from_str_radix(text.get(range)?, 16).ok();
        // Letters of severity: H high, L low, C caution.
        let rest = text.get(4..)?;
        let number = rest.strip_prefix(['H', 'L', 'C']).unwrap_or(rest);
        Some(Self {
            run: RunStatus::from_bits(byte(0..2)?),
            stop: StopStatus::from_bits(byte(2..4)?),
            error: match number.trim() {
                "" => 0,
                digits => digits.parse().ok()?,
            },
            step: 0,
            mechanism: 0,
        })
    }

    pub(super) fn status_text(&self) -> String {
        let (run, stop) = (self.run.bits(), self.stop.bits());
        format!("{run:02X}{stop:02X}{}", self.error)
    }
}

impl fmt::Display for State {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let status = self.status_text();
        write!(formatter, "{status};{};{}", self.step, self.mechanism)
    }
}

impl FromStr for State {
    type Err = TextError;

    /// Reads what follows `QoK` in an answer to `DSTATE`.
    fn from_str(text: &str) -> Result<Self, TextError> {
        let mut fields = text.split(';');
        let status = fields.next().and_then(Self::parse_status);
        let status = status.ok_or_else(|| TextError::field(text, "two status bytes in hex"))?;
        let mut number = || fields.next().and_then(|field| field.trim().parse().ok());
        Ok(Self {
            step: number().unwrap_or(0),
            mechanism: number().unwrap_or(0),
            ..status
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A reply that was captured from a controller: servo on, idle, no error.
    #[test]
    fn captured_reply_is_read_and_written() {
        let state: State = "A1060;1;0".parse().unwrap();
        let run = RunStatus {
            repeat: true,
            servo_on: true,
            operation_enabled: true,
            ..RunStatus::default()
        };
        let stop = StopStatus {
            stop: true,
            wait: true,
            ..StopStatus::default()
        };
        assert_eq!((state.run, state.stop), (run, stop));
        assert_eq!((state.error, state.step, state.mechanism), (0, 1, 0));
        assert_eq!(state.to_string(), "A1060;1;0");
    }

    #[test]
    fn every_bit_has_its_place() {
        let places = |bits: u8| {
            let run = RunStatus::from_bits(bits);
            [
                run.repeat,
                run.cycle_stop_off,
                run.machine_lock,
                run.teach,
                run.teach_running,
                run.servo_on,
                run.running,
                run.operation_enabled,
            ]
        };
        for index in 0..8 {
            let mut wanted = [false; 8];
            wanted[index] = true;
            assert_eq!(places(1 << index), wanted, "bit {index} of the run status");
        }
        for bits in 0..=255u8 {
            assert_eq!(RunStatus::from_bits(bits).bits(), bits);
            let known = bits & 0b0101_1111;
            assert_eq!(StopStatus::from_bits(bits).bits(), known, "{bits:08b}");
        }
        assert!(StopStatus::from_bits(0x01).emergency_stop);
        assert!(StopStatus::from_bits(0x10).program_select_enabled);
        assert!(StopStatus::from_bits(0x40).pseudo_input);
    }

    #[test]
    fn error_numbers_are_read_with_and_without_their_letter() {
        for (text, error) in [("80116130;3;0", 6130), ("8001H0117;1;0", 117), ("8001", 0)] {
            let state: State = text.parse().unwrap();
            assert_eq!(state.error, error, "{text}");
        }
        for text in ["", "A1", "G1060;1;0", "A106x;1;0"] {
            assert!(text.parse::<State>().is_err(), "{text:?} was taken");
        }
    }
}
