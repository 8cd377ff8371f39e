//! Trials of a policy and the figures that judge it, §IV.
//!
//! [`evaluate`] runs randomised trials of a policy file on the surrogate of an object, on all
//! cores, and sums them up as an [`Evaluation`]; the number of threads never changes a figure.
//! [`train_best`] trains a policy with several seeds and keeps the one that does best on common
//! trials, and [`expected_of`] says what an object asks of a policy. [`trial`] is one trial, [`statistics`] its sums.
//! [`reproduce`] is the paper's evaluation as a whole. [`report`] makes pages on runs,
//! trainings and evaluations.

mod alpha_decider;
mod asked;
mod candidates;
pub mod decider;
mod evaluation;
mod goal_errors;
pub mod grid;
mod learning;
mod network;
mod policy_file;
mod reads;
pub mod report;
pub mod reproduce;
pub mod statistics;
mod training;
pub mod trial;

pub use alpha_decider::AlphaContestant;
pub use candidates::{Candidate, TrainBestError, TrainingPlan, train_best};
pub use evaluation::{
    Contestant, EvaluateError, Evaluation, EvaluationOptions, Figures, GoalChoice,
    NetworkContestant, evaluate,
};
pub use goal_errors::GoalErrors;
pub use learning::{LearningCurves, LearningFileError, SeedCurve};
pub use policy_file::expected_of;
pub use pubs_policy::Method;
pub use reads::{EntropyInput, UnknownEntropy};
