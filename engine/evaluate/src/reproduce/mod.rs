//! The paper's evaluation, §IV: what its parts are, and the report on them.
//!
//! A reproduction is made of [`cell::Cell`]s, each stored as one file of a results folder.

pub mod cell;
