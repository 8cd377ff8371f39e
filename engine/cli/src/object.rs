//! An object file made ready: checked, compiled, its observation model created.

use std::path::Path;
use std::sync::Arc;

use pubs_core::Task;
use pubs_core::belief::Model;
use pubs_core::object::{self, Fault, Faults, LoadedObject, Overrides, key_of_pointer};
use pubs_core::seed::stream;
use pubs_core::task::compile;
use pubs_host::{HostError, ModelInstance, ParameterFault, Registry};

use crate::built_in;
use crate::failure::Failure;
use crate::show;

/// The observation model that `calibrate` writes segments for.
const SEGMENTS: &str = "segments";

/// Everything that a verb needs of an object.
pub struct Ready {
    /// The file, compiled.
    pub task: Arc<Task>,
    /// Its observation model.
    pub model: Arc<dyn Model>,
    /// Name and version of the model's plugin.
    pub model_plugin: String,
    /// The file.
    pub loaded: LoadedObject,
}

/// Loads an object file and creates its model; with a `belief_frequency`, that many filter updates
/// per policy step instead of the file's.
///
/// # Errors
/// Every fault of the file, a plugin that does not fit, or a frequency that does not.
pub fn ready(
    path: &Path,
    overrides: &Overrides,
    belief_frequency: Option<u32>,
    registry: &Registry,
    seed: u64,
) -> Result<Ready, Failure> {
    let loaded = object::load(path, overrides)?;
    for set in overrides.typed() {
        show::detail(|| format!("overridden: {set}"));
    }
    let task = compile(&loaded.file).map_err(|error| Failure::fault(&error))?;
    let faults = parameter_faults(&loaded, &task, registry);
    if !faults.is_empty() {
        return Err(Failure::Faults(Faults(faults)));
    }
    without_driver(loaded, belief_frequency, registry, seed)
}

/// The same of a file that has been read, or was never one, whose driver will not be opened.
///
/// # Errors
/// As [`ready`], but for faults of the driver.
pub fn without_driver(
    loaded: LoadedObject,
    belief_frequency: Option<u32>,
    registry: &Registry,
    seed: u64,
) -> Result<Ready, Failure> {
    let task = compile(&loaded.file).map_err(|error| Failure::fault(&error))?;
    let mut faults = model_faults(&loaded, &task, registry);
    if faults.is_empty() && is_uncalibrated(&loaded) {
        faults.push(uncalibrated_fault(&loaded));
    }
    if !faults.is_empty() {
        return Err(Failure::Faults(Faults(faults)));
    }
    let task = match belief_frequency {
        None => task,
        Some(times) => task
            .with_belief_frequency(times)
            .map_err(|error| Failure::invalid(error.to_string()))?,
    };
    let plugin = registry.observation_model(&task.observation.model)?;
    let model = match plugin.create(&task.model_setup(stream(seed, "model"))) {
        Ok(model) => model,
        Err(error) => return Err(refusal(&loaded, error)),
    };
    if let Some(fault) = moments_fault(&loaded, &task, &model) {
        return Err(Failure::Faults(Faults(vec![fault])));
    }
    let model_plugin = format!("{} {}", model.plugin().name(), model.plugin().version());
    show::detail(|| {
        let origin = model.plugin().origin();
        format!(
            "object: {}\nobservation model: {model_plugin}, {origin}",
            loaded.path().display()
        )
    });
    Ok(Ready {
        task: Arc::new(task),
        model: Arc::new(model),
        model_plugin,
        loaded,
    })
}

/// An object file whose observation model does not matter yet, as before a calibration.
///
/// # Errors
/// Every fault of the file but those of its observation model.
pub fn without_model(
    path: &Path,
    overrides: &Overrides,
    registry: &Registry,
) -> Result<(LoadedObject, Arc<Task>), Failure> {
    without_model_of(object::load(path, overrides)?, registry)
}

/// The same of a file that has been read.
///
/// # Errors
/// As [`without_model`].
pub fn without_model_of(
    loaded: LoadedObject,
    registry: &Registry,
) -> Result<(LoadedObject, Arc<Task>), Failure> {
    let task = compile(&loaded.file).map_err(|error| Failure::fault(&error))?;
    let faults = driver_faults(&loaded, &task, registry);
    if !faults.is_empty() {
        return Err(Failure::Faults(Faults(faults)));
    }
    Ok((loaded, Arc::new(task)))
}

/// What a check of one file has found.
pub struct Checked {
    /// Everything that can be checked without moving anything.
    pub faults: Vec<Fault>,
    /// Whether the file waits for its calibration, which is no fault.
    pub uncalibrated: bool,
}

/// Checks one file.
pub fn check(path: &Path, overrides: &Overrides, registry: &Registry) -> Checked {
    let loaded = object::load(path, overrides);
    Checked {
        uncalibrated: loaded.as_ref().is_ok_and(is_uncalibrated),
        faults: faults_of(loaded, registry),
    }
}

/// The same of a text that is not in its file yet.
pub fn faults_of_text(
    file: &Path,
    text: &str,
    overrides: &Overrides,
    registry: &Registry,
) -> Vec<Fault> {
    let file = file.display().to_string();
    faults_of(
        object::load_text(&file, text.to_owned(), overrides),
        registry,
    )
}

fn faults_of(loaded: Result<LoadedObject, Faults>, registry: &Registry) -> Vec<Fault> {
    let loaded = match loaded {
        Ok(loaded) => loaded,
        Err(Faults(faults)) => return faults,
    };
    let task = match compile(&loaded.file) {
        Ok(task) => task,
        Err(error) => return vec![loaded.fault("schema", error.to_string(), "report this")],
    };
    let faults = parameter_faults(&loaded, &task, registry);
    if !faults.is_empty() || is_uncalibrated(&loaded) {
        return faults;
    }
    let created = registry
        .observation_model(&task.observation.model)
        .and_then(|plugin| plugin.create(&task.model_setup(0)));
    match created {
        Ok(model) => moments_fault(&loaded, &task, &model).into_iter().collect(),
        Err(error) => {
            let faults = segment_faults(&loaded, &error);
            if faults.is_empty() {
                vec![model_fault(&loaded, &error)]
            } else {
                faults
            }
        }
    }
}

/// Whether an arm's object has yet to be calibrated: `calibrate` writes segments for the built-in
/// model, and there are none.
fn is_uncalibrated(loaded: &LoadedObject) -> bool {
    let observation = &loaded.file.observation;
    loaded.file.control.is_some() && observation.model == SEGMENTS && observation.segment.is_none()
}

fn uncalibrated_fault(loaded: &LoadedObject) -> Fault {
    loaded.fault(
        "observation",
        "the object is not calibrated: it has no [[observation.segment]] tables",
        format!(
            "`pubs-engine calibrate {}` records demonstrations and writes them",
            loaded.path().display()
        ),
    )
}

/// What plugins say of the tables that are theirs.
fn parameter_faults(loaded: &LoadedObject, task: &Task, registry: &Registry) -> Vec<Fault> {
    let mut faults = model_faults(loaded, task, registry);
    faults.extend(driver_faults(loaded, task, registry));
    faults
}

fn model_faults(loaded: &LoadedObject, task: &Task, registry: &Registry) -> Vec<Fault> {
    let mut faults = Vec::new();
    match registry.observation_model(&task.observation.model) {
        Ok(plugin) => {
            let mut table = task.observation.table.clone();
            if is_uncalibrated(loaded) {
                // The rest of the table is checked as if the segments were there.
                table["segment"] = serde_json::json!([]);
            }
            let found = plugin.check_parameters(&table);
            faults.extend(at_their_lines(
                loaded,
                "observation",
                &task.observation.model,
                found,
            ));
        }
        Err(error) => faults.push(loaded.fault(
            "observation.model",
            error.to_string(),
            cure(&error, &task.observation.model),
        )),
    }
    faults
}

fn driver_faults(loaded: &LoadedObject, task: &Task, registry: &Registry) -> Vec<Fault> {
    let mut faults = Vec::new();
    if let Some(driver) = &task.driver {
        match registry.driver(&driver.plugin) {
            Ok(plugin) => {
                let found = plugin.check_parameters(&driver.table);
                faults.extend(at_their_lines(loaded, "driver", &driver.plugin, found));
            }
            Err(error) => {
                let cure = cure(&error, &driver.plugin);
                faults.push(loaded.fault("driver.plugin", error.to_string(), cure));
            }
        }
    }
    faults
}

/// What to do about a plugin that is not found, or found twice.
fn cure(error: &HostError, plugin: &str) -> String {
    if matches!(error, HostError::Duplicate { .. }) {
        "`pubs-engine plugins list` shows where each is from".to_owned()
    } else if built_in::LOADED.contains(&plugin) {
        format!(
            "`{plugin}` comes with the engine as a library to be loaded: `{}` puts it beside the program",
            built_in::BUILD_COMMAND
        )
    } else {
        "name a plugin that `pubs-engine plugins list` shows".to_owned()
    }
}

fn at_their_lines(
    loaded: &LoadedObject,
    table: &str,
    plugin: &str,
    found: Vec<ParameterFault>,
) -> Vec<Fault> {
    let help = format!(
        "the plugin `{plugin}` says what its parameters are: `pubs-engine plugins list --schema`"
    );
    let fault = |fault: ParameterFault| {
        loaded.fault(
            &key_of_pointer(table, &fault.pointer),
            fault.message,
            help.clone(),
        )
    };
    found.into_iter().map(fault).collect()
}

/// A model that could not be created: the object file's doing where segments are named, else the
/// plugin's.
fn refusal(loaded: &LoadedObject, error: HostError) -> Failure {
    let faults = segment_faults(loaded, &error);
    if faults.is_empty() {
        error.into()
    } else {
        Failure::Faults(Faults(faults))
    }
}

/// What a model says of segments, a line each: of a single one, `segment[17] …`, at the segment's
/// own line; of all of them, `segments: …`, or of those of one channel, `(safe_open, f_d): …`, at
/// their table.
fn segment_faults(loaded: &LoadedObject, error: &HostError) -> Vec<Fault> {
    let HostError::Call {
        failure: pubs_host::Failure::Error(text),
        ..
    } = error
    else {
        return Vec::new();
    };
    let faults = text.lines().filter_map(|line| {
        let of_all = ["segments: ", "segment: ", "("];
        if of_all.iter().any(|start| line.starts_with(start)) {
            return Some(loaded.fault(
                "observation",
                line,
                "mend the segments; `pubs-engine plugins list --schema` describes them",
            ));
        }
        let said = &line[line.find("segment[")?..];
        let index: usize = said["segment[".len()..].split(']').next()?.parse().ok()?;
        let key = format!("observation.segment.{index}");
        Some(loaded.fault(
            &key,
            said,
            "mend this segment; `pubs-engine plugins list --schema` describes segments",
        ))
    });
    faults.collect()
}

/// A bias can only be estimated from what a model expects to be read.
fn moments_fault(loaded: &LoadedObject, task: &Task, model: &ModelInstance) -> Option<Fault> {
    let refused = task.belief.force_bias.is_some() && !model.is_gaussian();
    refused.then(|| {
        loaded.fault(
            "belief.filter",
            format!(
                "the filter \"rao_blackwell\" asks for expected forces and their spread, and the observation model `{}` gives likelihoods only",
                task.observation.model
            ),
            "write filter = \"sis\", or use a model that provides moments",
        )
    })
}

fn model_fault(loaded: &LoadedObject, error: &HostError) -> Fault {
    loaded.fault(
        "observation",
        error.to_string(),
        "mend the [observation] table, or the plugin it names",
    )
}
