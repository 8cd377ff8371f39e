//! The paper's evaluation, §IV: what its parts are, and the report on them.
//!
//! A reproduction is made of [`cell::Cell`]s, each stored as one file of a results folder.
//! [`Results`] reads the folder; [`tables`], [`violations`], [`frequency`] and [`transfer`] make
//! the paper's tables of it, as numbers, beside those of [`paper`]; [`report`] writes them down
//! and draws its figures.

pub mod brief;
pub mod cell;
pub mod choices;
mod document;
mod figures;
pub mod frequency;
pub mod heatmap;
mod html;
mod markdown;
pub mod matrix;
mod numbers;
pub mod paper;
pub mod report;
mod results;
mod sections;
pub mod seeds;
pub mod tables;
pub mod transfer;
mod unit;
pub mod violations;

pub use heatmap::Heatmap;
pub use results::{CELLS, HEATMAPS, Notice, POLICIES, Results, ResultsError};
