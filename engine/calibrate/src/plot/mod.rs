//! Pictures of an observation model and of the demonstrations it was made from.
//!
//! One sheet per object, A4 landscape: a row for each channel, a column for each action, all of a
//! row on one scale. [`svg`] draws it, [`png`] renders that very SVG.

mod curve;
mod error;
mod legend;
mod object;
mod panel;
mod scale;
mod sheet;
mod style;
mod thin;

pub use error::PlotError;
pub use object::{Readings, picture, readings, subtitle};
pub use pubs_draw::png;
pub use sheet::svg;

use crate::segment::{Channel, Segment};

/// What a sheet shows. One panel alone fills it.
#[derive(Debug, Clone)]
pub struct Picture<'a> {
    /// First line, the object's name for one.
    pub title: String,
    /// Second line: where the samples come from.
    pub subtitle: String,
    /// How joint states are written.
    pub unit: StateUnit,
    /// Limits of the joint, SI.
    pub limits: [f64; 2],
    /// F_t of (13), drawn along f_d, N.
    pub force_threshold_n: Option<f64>,
    /// In any order; actions get their columns in the order in which they come.
    pub panels: Vec<Panel<'a>>,
}

/// One channel of one action.
#[derive(Debug, Clone)]
pub struct Panel<'a> {
    /// Name of the action.
    pub action: &'a str,
    /// Which component.
    pub channel: Channel,
    /// The model, in order of joint states.
    pub segments: Vec<&'a Segment>,
    /// What was recorded.
    pub samples: &'a [Sample],
    /// Stretches without demonstrations, where the model says "blocked", SI.
    pub left_out: Vec<[f64; 2]>,
}

/// One reading of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Joint state, SI.
    pub state: f64,
    /// N; for m_p 1 where the handle moved and 0 where it did not.
    pub value: f64,
}

/// How joint states are written on the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateUnit {
    /// A hinge.
    Degrees,
    /// A slide.
    Centimetres,
    /// A number without a unit.
    Plain,
}

impl StateUnit {
    fn of_si(self, state: f64) -> f64 {
        match self {
            Self::Degrees => state.to_degrees(),
            Self::Centimetres => state * 100.0,
            Self::Plain => state,
        }
    }

    fn axis_title(self) -> &'static str {
        match self {
            Self::Degrees => "joint state, degrees (closed at the left, open at the right)",
            Self::Centimetres => "joint state, cm (closed at the left, open at the right)",
            Self::Plain => "joint state",
        }
    }
}
