//! Observation model `segments`: eq. (11) over calibration segments, §III-C.1.
//!
//! For each movement action and each of the channels f_d, f_z, f_n and m_p, an object file lists
//! calibration segments (`[[observation.segment]]`) that tile the range of the joint. Inside a
//! segment the mean and sigma of a force are interpolated linearly; at a boundary they may jump.
//! m_p is Bernoulli, its probability kept within [0.001, 0.999]: a named deviation from (11),
//! so that one reading never rules a state out.
//! `create` checks the segments and samples them into one regular table per action; the
//! model *is* the linear interpolation in that table. `moments` looks states up one by one,
//! `moments_grid` serves evenly spaced states by contiguous loads alone.
//!
//! | module | what it holds |
//! |---|---|
//! | `model` | [`Segments`], the observation model |
//! | `read`, `fields`, `cover` | the object file's segments, each fault named |
//! | `piecewise` | the definition in f64 |
//! | `lattice`, `nodes` | the regular tables |
//! | `kernel` | the loops, for each vector unit |

mod channel;
mod cover;
mod faults;
mod fields;
mod kernel;
mod lattice;
mod model;
mod nodes;
mod piecewise;
mod read;
mod unit;

pub use kernel::VectorUnit;
pub use model::Segments;

use pubs_plugin::table::PluginTable;

/// The table of this built-in plugin, the same that a loaded library would export.
pub fn table() -> &'static PluginTable {
    pubs_plugin::observation_model_table::<Segments>()
}
