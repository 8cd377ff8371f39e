//! Live views of a run: what the robot believes, while it moves.
//!
//! Both views hear what the recorder writes, message by message ([`pubs_run::recording::Listener`]),
//! so that what is seen is what is recorded. `feed` passes it on without ever waiting for a
//! viewer; [`dashboard`] serves the page in `page/` to a browser, with a button that stops the arm;
//! [`foxglove`] serves the Foxglove app. [`scene`] is what a viewer needs to know once: the joint,
//! the goals, the calibrated forces. [`access`] says who may look: on this machine everybody,
//! from elsewhere whoever knows the token, which `gate` asks for where a server does not.
//! All of it runs in `background` threads that give way to the loops.

pub mod access;
mod background;
pub mod dashboard;
mod error;
mod feed;
pub mod foxglove;
mod gate;
mod page;
pub mod scene;

pub use access::{Access, Listen, Token};
pub use dashboard::Dashboard;
pub use error::LiveError;
pub use foxglove::Foxglove;
pub use scene::Scene;
