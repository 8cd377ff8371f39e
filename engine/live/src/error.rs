//! Why a live view cannot be served.

use std::net::SocketAddr;

/// Each names the address and the cure.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// Nobody can listen there.
    #[error(
        "cannot serve {what} at {address}: {source}\n  (give another address, such as {option} 127.0.0.1:0 for any free port)"
    )]
    Address {
        /// `the dashboard`, `the Foxglove app`.
        what: &'static str,
        /// The option that says where.
        option: &'static str,
        /// Where.
        address: SocketAddr,
        /// What the system said.
        source: std::io::Error,
    },
    /// No thread or socket is to be had.
    #[error("cannot serve {what}: {reason}")]
    System {
        /// `the dashboard`, `the Foxglove app`.
        what: &'static str,
        /// What the system said.
        reason: String,
    },
    /// The observation model does not answer.
    #[error("the observation model gives no forces to draw: {0}")]
    Model(#[from] pubs_core::belief::ModelError),
}
