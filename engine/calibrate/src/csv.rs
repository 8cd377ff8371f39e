//! Recordings as tables: for people who look at one, and for arms that other programs drive.
//!
//! The first lines say what was recorded, then follow the names of the columns and a row for each
//! frame:
//!
//! ```text
//! # format = 1
//! # engine = 0.1.0
//! # object = door2
//! # joint = revolute
//! # sensor = virtual-arm
//! # actions = stop, safe_open, safe_close, high_open, high_close
//! # rate_hz = 100.0
//! # seed = 7
//! # done = safe_open 1, safe_open 2
//! time_s,action,demonstration,x_m,y_m,z_m,qx,qy,qz,qw,force_x_n,…,status,true_state
//! 1.010000000,safe_open,1,0.5,0.0,0.3,0.0,0.0,0.0,1.0,0.25,…,ready,
//! ```
//!
//! `time_s` has nanoseconds for its last digit and every other number as many digits as it needs,
//! so that what is written is read back to the last bit. `true_state` is empty, or is left out,
//! where nobody knows it; `# done` and `# loss` are left out where there is nothing to tell.
//! Columns may stand in any order, and unknown ones are passed over.

mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::read;
pub use write::write;
