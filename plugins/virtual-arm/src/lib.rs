//! Driver: an arm and a real object, simulated.
//!
//! A *world* ([`world`]) says what is true of an object and of the fingers on its handle. The
//! plant integrates it: an arm that follows velocities ([`arm`]), a joint with its resistance
//! ([`resistance`]), springs between the two ([`plant`]), all in the frames of [`geometry`].
//! A wrist sensor with noise, bias and drift ([`sensor`]) reports the force that the tool exerts
//! on the object; [`trouble`] is what may go wrong with object and grasp. [`simulation`] runs them
//! in ticks of one millisecond, and [`driver`] puts that behind the engine's driver interface, in
//! real time or in virtual time, where the same seed and the same calls give the same bytes.
//!
//! ```toml
//! [driver]
//! plugin = "virtual-arm"
//! params = { world = "door2", start = 0.3 }
//! ```

pub mod arm;
mod clock;
pub mod driver;
pub mod geometry;
mod params;
pub mod plant;
pub mod resistance;
pub mod sensor;
pub mod simulation;
pub mod trouble;
pub mod world;

pub use driver::VirtualArm;

/// The table of this plugin, the same that a loaded library would export.
pub fn table() -> &'static pubs_plugin::table::PluginTable {
    pubs_plugin::driver_table::<VirtualArm>()
}
