//! Making instances of an observation model.

use std::sync::Arc;

use pubs_plugin::ModelSetup;
use pubs_plugin::table::ObservationModelTable;

use crate::call::{Failure, demand};
use crate::channels::ask;
use crate::plugin::{Functions, Plugin};
use crate::registry::wrong_kind;
use crate::{HostError, ModelInstance, ParameterFault, PluginKind, sweep};

/// An observation-model plugin, ready to make instances.
#[derive(Debug, Clone)]
pub struct ModelPlugin {
    pub(crate) plugin: Arc<Plugin>,
    pub(crate) table: &'static ObservationModelTable,
}

impl ModelPlugin {
    /// The plugin as an observation model.
    ///
    /// # Errors
    /// Where it is a driver.
    pub fn new(plugin: Arc<Plugin>) -> Result<Self, HostError> {
        match plugin.functions() {
            Functions::ObservationModel(table) => Ok(Self { plugin, table }),
            Functions::Driver(_) => Err(wrong_kind(&plugin, PluginKind::ObservationModel)),
        }
    }

    /// Name, version, origin, schema.
    pub fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    /// All that is wrong with an `[observation]` table; pointers are from that table.
    pub fn check_parameters(&self, observation: &serde_json::Value) -> Vec<ParameterFault> {
        self.plugin.schema().check_observation(observation)
    }

    /// Makes the model of one object and sweeps it once over actions and states, so that a model
    /// that gives NaN is refused before anything moves.
    ///
    /// # Errors
    /// Where the parameters do not fit the schema, the plugin refuses, or its answers break the
    /// contract.
    pub fn create(&self, setup: &ModelSetup) -> Result<ModelInstance, HostError> {
        let mut instance = self.create_unswept(setup)?;
        instance.gaussian = sweep::sweep(&instance, setup)?;
        Ok(instance)
    }

    /// As [`create`](Self::create) before the sweep: for the conformance kit, which reports.
    pub(crate) fn create_unswept(&self, setup: &ModelSetup) -> Result<ModelInstance, HostError> {
        let faults = self.check_parameters(&setup.observation);
        if !faults.is_empty() {
            return Err(HostError::Parameters {
                plugin: self.plugin.name().to_owned(),
                faults,
            });
        }
        let json = serde_json::to_vec(setup).map_err(|error| HostError::Setup {
            plugin: self.plugin.name().to_owned(),
            message: error.to_string(),
        })?;
        let create = self
            .table
            .create
            .ok_or_else(|| self.failed("create", Failure::Absent))?;
        let mut handle = std::ptr::null_mut();
        // SAFETY: `create` of a checked table; the arguments are as the header says.
        demand(|error, capacity| unsafe {
            create(json.as_ptr(), json.len(), &mut handle, error, capacity)
        })
        .map_err(|failure| self.failed("create", failure))?;
        let mut instance = ModelInstance {
            plugin: Arc::clone(&self.plugin),
            table: self.table,
            handle,
            channels: Vec::new(),
            actions: setup
                .actions
                .iter()
                .map(|action| action.name.clone())
                .collect(),
            gaussian: true,
        };
        instance.channels =
            ask(self.table, handle).map_err(|failure| self.failed("channels", failure))?;
        Ok(instance)
    }

    fn failed(&self, function: &'static str, failure: Failure) -> HostError {
        HostError::Call {
            plugin: self.plugin.name().to_owned(),
            function,
            context: String::new(),
            failure,
        }
    }
}
