//! The macros that make a `cdylib` a plugin.

/// Exports the plugin's one symbol for an [`ObservationModel`](crate::ObservationModel). Once per
/// library, in a crate with `crate-type = ["cdylib"]`; a built-in plugin returns
/// [`observation_model_table`](crate::observation_model_table) instead.
#[macro_export]
macro_rules! export_observation_model {
    ($model:ty) => {
        /// What the engine looks up after loading this library.
        #[unsafe(no_mangle)]
        pub extern "C" fn pubs_plugin_v1() -> *const $crate::table::PluginTable {
            $crate::observation_model_table::<$model>()
        }
    };
}

/// Exports the plugin's one symbol for a [`Driver`](crate::Driver). Once per library, in a crate
/// with `crate-type = ["cdylib"]`; a built-in plugin returns [`driver_table`](crate::driver_table)
/// instead.
#[macro_export]
macro_rules! export_driver {
    ($driver:ty) => {
        /// What the engine looks up after loading this library.
        #[unsafe(no_mangle)]
        pub extern "C" fn pubs_plugin_v1() -> *const $crate::table::PluginTable {
            $crate::driver_table::<$driver>()
        }
    };
}
