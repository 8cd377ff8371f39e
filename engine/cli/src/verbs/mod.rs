//! One file per verb.

pub mod calibrate;
pub mod check;
pub mod completions;
pub mod config;
pub mod doctor;
pub mod evaluate;
pub mod man;
pub mod new;
pub mod plot;
pub mod plugin_check;
pub mod plugins;
pub mod replay;
pub mod report;
pub mod reproduce;
pub mod run;
pub mod solve;
pub mod survey;
pub mod train;
