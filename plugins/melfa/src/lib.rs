//! Driver: Mitsubishi MELFA arms (RV-5AS-D on a CR800) through their three services.
pub mod baseline;
pub mod fault;
pub mod frames;
pub mod freshness;
pub mod joint_guard;
pub mod log;
pub mod params;
pub mod shaper;
pub mod stats;
pub mod system;
pub mod target;
pub mod twist;
pub mod wrench;
