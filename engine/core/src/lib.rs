//! The model behind pubs-engine: what an object is and what the method does with it.
//!
//! An object file ([`object`]) compiles to one immutable [`Task`]: joint, actions, reward and the
//! settings of filter, controller and policy. Everything downstream, the trainer's simulator and
//! the robot alike, takes a `&Task` and runs the same code:
//! [`joint`] maps poses to joint displacements and gives the frame of the motion (§III-A.1, §III-C.2),
//! [`action`] and [`observation`] are A and O of the POMDP (§III-A.2, §III-A.3),
//! [`reward`] is eq. (1), [`belief`] the particle filter of eq. (6)–(10),
//! [`shield`] masks high-force actions near limits and [`repetition`] those that changed nothing,
//! [`controller`] is eq. (12) and (13).
//! Nothing here starts a thread, opens a socket or writes a file.

pub mod action;
pub mod belief;
pub mod controller;
pub mod goal;
pub mod input;
pub mod joint;
pub mod object;
pub mod observation;
pub mod repetition;
pub mod reward;
pub mod seed;
pub mod shield;
pub mod task;
pub mod vector;

pub use action::{Action, Mode, Motion};
pub use goal::Goal;
pub use input::Input;
pub use joint::{Joint, JointKind};
pub use task::Task;
