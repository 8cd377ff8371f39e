//! Driver: Mitsubishi MELFA arms (an RV-5AS-D on a CR800) through their three services.
//!
//! MXT over UDP moves the arm and tells its pose, the real-time monitor over UDP tells force, R3
//! over TCP supervises. `GUIDE.md` beside this crate is for whoever has such an arm.
//!
//! [`driver`] is what the engine sees. Opening goes through [`prepare`], which checks everything
//! and starts the program, then [`session`] starts three threads that share a [`board`]:
//!
//! - [`motion`]: one absolute target per control cycle, in step with the controller's replies. The
//!   engine's velocity goes through [`shaper`] (acceleration and jerk), [`joint_guard`] (joint
//!   speeds, ranges, singular postures) and [`target`] (integration, quanta, posture).
//! - [`monitor`]: force, through [`wrench`] to the tool.
//! - [`supervision`]: the controller's state over [`r3`].
//!
//! ```toml
//! [driver]
//! plugin = "melfa"
//! params = { host = "192.168.0.20" }
//! ```

pub mod address;
pub mod baseline;
pub mod board;
pub mod driver;
pub mod fault;
pub mod frames;
pub mod freshness;
pub mod joint_guard;
pub mod log;
pub mod monitor;
pub mod motion;
pub mod mxt;
pub mod params;
pub mod prepare;
pub mod r3;
pub mod report;
pub mod session;
pub mod shaper;
pub mod stats;
pub mod supervision;
pub mod system;
pub mod target;
pub mod twist;
pub mod wrench;

pub use driver::Melfa;

pubs_plugin::export_driver!(Melfa);
