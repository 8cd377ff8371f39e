//! The paper's evaluation, §IV: what its parts are, and the report on them.
//!
//! [`plan`](mod@plan) lists the units of work, [`runner`] does them with what a
//! [`workshop::Workshop`] has and stores each as a [`cell::Cell`], one file of a results folder.
//! [`Results`] reads the folder, and [`kept`] has its cells in one file beside a report; [`tables`], [`violations`], [`frequency`] and [`transfer`] make
//! the paper's tables of it, as numbers, beside those of [`paper`]; [`report`] writes them down
//! and draws its figures.

pub mod brief;
pub mod cell;
pub mod choices;
pub(crate) mod figures;
pub mod frequency;
pub mod heatmap;
pub mod kept;
mod markdown;
pub mod matrix;
pub(crate) mod numbers;
pub mod paper;
pub mod plan;
pub mod report;
mod results;
mod run_arm;
mod run_heatmap;
mod run_solver;
mod run_training;
pub mod runner;
mod sections;
pub mod seeds;
pub mod tables;
pub mod transfer;
mod unit;
pub mod violations;
pub mod workshop;

pub use heatmap::Heatmap;
pub use results::{CELLS, HEATMAPS, Notice, POLICIES, Results, ResultsError};
