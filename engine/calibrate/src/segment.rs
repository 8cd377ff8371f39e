//! Calibration segments, as an object file holds them.

use serde::Serialize;

/// A component of the observation of an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// f_d, along the motion.
    #[serde(rename = "f_d")]
    Along,
    /// f_z, up.
    #[serde(rename = "f_z")]
    Up,
    /// f_n, normal to both.
    #[serde(rename = "f_n")]
    Normal,
    /// m_p, whether the handle moves.
    #[serde(rename = "m_p")]
    Moves,
}

impl Channel {
    /// The three forces, in the order in which they are told apart.
    pub const FORCES: [Self; 3] = [Self::Along, Self::Up, Self::Normal];

    /// All of them, forces first.
    pub const ALL: [Self; 4] = [Self::Along, Self::Up, Self::Normal, Self::Moves];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Along => "f_d",
            Self::Up => "f_z",
            Self::Normal => "f_n",
            Self::Moves => "m_p",
        }
    }
}

/// One `[[observation.segment]]`. States in SI (rad or m).
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Name of the action.
    pub action: String,
    /// Which component.
    pub channel: Channel,
    /// Where it starts.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// What the model says there.
    pub values: Values,
    /// A remark for the reader of the file, written as a comment above the segment.
    pub note: Option<String>,
}

/// What a segment says.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Mean and sigma of a force at `position`, linear between, N.
    Force {
        /// Strictly increasing, within the segment.
        position: Vec<f64>,
        /// One for each position.
        mean_n: Vec<f64>,
        /// One for each position, or one for all.
        sigma_n: Vec<f64>,
    },
    /// Probability that the handle moves.
    Moves {
        /// From 0 to 1.
        probability: f64,
    },
}

impl Values {
    /// Mean forces, N, or the probability.
    pub fn means(&self) -> &[f64] {
        match self {
            Self::Force { mean_n, .. } => mean_n,
            Self::Moves { probability } => std::slice::from_ref(probability),
        }
    }

    /// Sigmas, N; m_p has none.
    pub fn sigmas(&self) -> &[f64] {
        match self {
            Self::Force { sigma_n, .. } => sigma_n,
            Self::Moves { .. } => &[],
        }
    }
}

/// Least and greatest; `None` of nothing.
pub fn extent(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values.into_iter().fold(None, |extent, value| {
        let [low, high] = extent.unwrap_or([value; 2]);
        Some([low.min(value), high.max(value)])
    })
}
