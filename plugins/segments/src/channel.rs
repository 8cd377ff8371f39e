//! The observation vector [f_d, f_z, f_n, m_p] of §III-A.3.

/// Names in the order of every `[C]` axis.
pub(crate) const NAMES: [&str; 4] = ["f_d", "f_z", "f_n", "m_p"];

/// Number of channels, C.
pub(crate) const COUNT: usize = NAMES.len();

/// Index of m_p, the only Bernoulli channel.
pub(crate) const MOTION: usize = 3;

/// Lowest and highest probability of m_p: one reading never rules a state out.
pub(crate) const MOTION_PROBABILITY: (f64, f64) = (0.001, 0.999);
