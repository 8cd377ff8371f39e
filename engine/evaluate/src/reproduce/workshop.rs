//! Where cells are made: objects, plugins, the runtime, and the folder of results.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pubs_core::Task;
use pubs_core::belief::Model;
use pubs_core::object::{self, Overrides};
use pubs_core::seed::stream;
use pubs_core::task::compile;
use pubs_host::Registry;
use pubs_policy::Runtime;
use serde_json::{Map, Value};

use super::results::POLICIES;

/// What the cells are made with.
pub struct Workshop<'a> {
    /// Folder of the object files.
    pub objects: PathBuf,
    /// Folder of results.
    pub results: PathBuf,
    /// Plugins.
    pub registry: &'a Registry,
    /// What runs policies.
    pub runtime: &'a Runtime,
    /// Trials of each evaluation.
    pub trials: u64,
    /// Cap on policy steps.
    pub max_steps: u32,
    /// Steps of each training, in place of the recipe's.
    pub steps: Option<usize>,
}

/// Why an object cannot be had, in words for the user.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct WorkshopError(pub String);

impl WorkshopError {
    /// Takes over what another error says.
    pub fn of(error: impl std::fmt::Display) -> Self {
        Self(error.to_string())
    }
}

/// An object that is ready for training and trials.
#[derive(Clone)]
pub struct Prepared {
    /// The file, compiled.
    pub task: Arc<Task>,
    /// Its observation model.
    pub model: Arc<dyn Model>,
}

impl Workshop<'_> {
    /// Compiles an object by name.
    ///
    /// # Errors
    /// Where its file has faults, or a plugin is missing.
    pub fn object(
        &self,
        name: &str,
        belief_frequency: Option<u32>,
    ) -> Result<Prepared, WorkshopError> {
        let path = self.objects.join(format!("{name}.toml"));
        let loaded = object::load(&path, &Overrides::none())
            .map_err(|faults| WorkshopError::of(object::render(&faults, false)))?;
        let mut task = compile(&loaded.file).map_err(WorkshopError::of)?;
        if let Some(times) = belief_frequency {
            task = task
                .with_belief_frequency(times)
                .map_err(WorkshopError::of)?;
        }
        let plugin = self
            .registry
            .observation_model(&task.observation.model)
            .map_err(WorkshopError::of)?;
        let model = plugin
            .create(&task.model_setup(stream(0, "model")))
            .map_err(WorkshopError::of)?;
        Ok(Prepared {
            task: Arc::new(task),
            model: Arc::new(model),
        })
    }

    /// Opens the object's driver with some of its parameters changed.
    ///
    /// # Errors
    /// Where the object has no driver, or it refuses.
    pub fn arm(
        &self,
        task: &Task,
        params: &Map<String, Value>,
        seed: u64,
    ) -> Result<pubs_host::DriverInstance, WorkshopError> {
        let mut setup = task
            .driver_setup(stream(seed, "driver"))
            .ok_or_else(|| WorkshopError(format!("object `{}` has no [driver]", task.name)))?;
        if let Some(own) = setup
            .driver
            .get_mut("params")
            .and_then(Value::as_object_mut)
        {
            own.extend(params.clone());
        }
        let name = task
            .driver
            .as_ref()
            .map_or("", |driver| driver.plugin.as_str());
        let plugin = self.registry.driver(name).map_err(WorkshopError::of)?;
        plugin.open(&setup).map_err(WorkshopError::of)
    }

    /// Where a policy of the results lies.
    pub fn policy(&self, name: &str) -> PathBuf {
        self.results.join(POLICIES).join(name)
    }
}

/// Writes a file in one step, so that none is ever found half written.
///
/// # Errors
/// Where the disk refuses.
pub fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    std::fs::write(&partial, bytes)?;
    std::fs::rename(&partial, path)
}
