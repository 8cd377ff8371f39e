//! Observation model: piecewise Gaussian over calibration segments, eq. (11).
