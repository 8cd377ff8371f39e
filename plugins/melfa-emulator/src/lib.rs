//! A MELFA controller on loopback, with a simulated arm and object behind it.
//!
//! Three services, as a CR800 has them: R3 over TCP ([`r3_service`], [`framing`], [`command`]),
//! MXT over UDP ([`external`]) and the real-time monitor over UDP ([`monitor`]). The
//! [`controller`] keeps the state and runs the program; [`motion`] moves the joints of an
//! RV-5AS-D within their limits; [`scene`] has the virtual arm's object, grasp and force sensor
//! on its flange. One thread ([`pace`]) runs all of it in control cycles; [`measure`] sees how
//! the arm truly moves. [`fault`]s come on demand, through a control socket or a [`scenario`].
//!
//! The README beside this crate says which behaviour is confirmed and which is invented.

pub mod alarm;
pub mod axes;
mod build;
pub mod command;
mod control_service;
pub mod controller;
mod emulator;
pub mod external;
pub mod fault;
pub mod faults;
pub mod filter;
pub mod framing;
pub mod link;
pub mod machine;
pub mod measure;
pub mod monitor;
pub mod motion;
pub mod mount;
pub mod options;
pub mod pace;
pub mod program;
pub mod pulses;
pub mod r3_service;
pub mod scenario;
pub mod scene;
pub mod shared;
pub mod signals;
pub mod store;
pub mod task;
pub mod views;

pub use build::build;
pub use emulator::{Emulator, Ports, StartError};
pub use options::Options;
