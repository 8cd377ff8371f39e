//! Discrete POMDPs: files in Cassandra's format, QMDP and SARSOP (§IV-C).
//!
//! [`parse`] reads a `.pomdp` file, or [`Pomdp::new`] takes one from its numbers; [`solve()`] gives
//! an [`AlphaPolicy`] with bounds on the value of the initial belief; [`simulate()`] tries the
//! policy out. Nothing here knows of robots.

pub mod belief;
mod blind;
pub mod cassandra;
mod informed;
mod policy;
mod pomdp;
mod qmdp;
mod sarsop;
pub mod simulate;
mod solve;
mod sparse;

pub use blind::blind_values;
pub use cassandra::{ParseFault, parse};
pub use informed::fast_informed_bound;
pub use policy::{AlphaPolicy, AlphaVector, PolicyError};
pub use pomdp::{Pomdp, PomdpError, PomdpParts, Rows, SUM_TOLERANCE};
pub use qmdp::q_values;
pub use simulate::{Mean, Trial, TrialOptions, TrialSummary, simulate};
pub use solve::{Method, Progress, Solution, SolveOptions, Stopped, solve};
