//! Trials of a policy and the figures that judge it.
