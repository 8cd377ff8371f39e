//! The closed loop of Fig. 2: controller, filter and policy at their own rates.
//!
//! The *controller* loop (`control_loop`, 100 Hz) reads the driver through the [`guard`] and
//! commands a twist, while [`grip`] watches the handle in the fingers; the *filter* loop
//! (`filter_loop`, 30 Hz) follows with the belief; the *policy* loop (`policy_loop`, 10 Hz) chooses
//! an action and judges goals. Each is a plain value with one `step`, and they exchange the latest
//! value of a few small messages (`messages`); [`recording`] keeps what each saw, and [`replay`]
//! shows it to them again. The two slower loops are interchangeable ([`Follower`], [`Chooser`]): calibration
//! has its own. `live` runs them as three threads on absolute deadlines, exchanging through
//! triple buffers, so that none can block the fast loop; `lockstep` runs the same steps on a
//! virtual clock, repeatably. Every way out ends in a ramped stop, and nothing resumes after one.

mod actor;
pub mod arm;
pub mod clock;
mod control_loop;
mod filter_loop;
pub mod grip;
pub mod guard;
pub mod inputs;
mod lateness;
mod live;
mod lockstep;
mod loops;
mod messages;
mod motion;
mod policy_loop;
pub mod recording;
pub mod replay;
mod report;
mod run;
pub mod utc;

pub use actor::{Actor, ActorError};
pub use arm::{Arm, ArmError};
pub use guard::{Guard, Trip};
pub use lateness::{Lateness, LatenessSummary};
pub use loops::{Chooser, Drive, Driven, Felt, Follower, Period, Rates, Tap, Verdict};
pub use messages::{BeliefMessage, Order, Sample, Signals, Status};
pub use report::{BeliefReport, GoalReport, JudgedBy, LatenessReport, Outcome, RunReport};
pub use run::{GoalPlan, RunError, RunOptions, run, run_recorded};
