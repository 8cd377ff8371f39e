//! R3, the supervision protocol: TCP, ASCII, one request at a time.
//!
//! A request is `robot;slot;COMMAND`, its reply `QoK…`, `Qok…`, `QeR…` or `Qer…`. Lengths are in
//! millimetres and angles in degrees here, unlike in the packets.

mod errors;
mod position;
mod program_state;
mod reply;
mod request;
mod state;

pub use errors::{BUSY, NETWORK_ERROR, OSCILLATING_COMMAND, known_error};
pub use position::{Position, format_joints, format_list, parse_joints, parse_list};
pub use program_state::ProgramState;
pub use reply::{Reply, Status};
pub use request::Request;
pub use state::{RunStatus, State, StopStatus};

/// Longest request that every known controller and client can hold, bytes.
pub const LONGEST_REQUEST: usize = 254;

/// What is wrong with a text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TextError {
    /// Not `robot;slot;COMMAND`.
    #[error("{text:?} is no request: it should read robot;slot;COMMAND")]
    Request {
        /// As received.
        text: String,
    },
    /// Does not begin with one of the four prefixes.
    #[error("{text:?} is no reply: it should begin with QoK, Qok, QeR or Qer")]
    Reply {
        /// As received.
        text: String,
    },
    /// A field is missing or is not what it should be.
    #[error("{text:?} has no {wanted}")]
    Field {
        /// As received.
        text: String,
        /// What was looked for.
        wanted: &'static str,
    },
}

impl TextError {
    fn field(text: &str, wanted: &'static str) -> Self {
        Self::Field {
            text: text.to_owned(),
            wanted,
        }
    }
}
