//! Options that several verbs share.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use pubs_core::object::Overrides;
use pubs_host::Registry;
use pubs_policy::Runtime;

use crate::failure::{Failure, chain};
use crate::{built_in, show};

/// Where an object comes from.
#[derive(Args)]
pub struct ObjectOptions {
    /// Object file
    #[arg(value_name = "OBJECT")]
    pub object: PathBuf,
    #[command(flatten)]
    pub layers: LayerOptions,
}

/// What stands above an object file.
#[derive(Args)]
pub struct LayerOptions {
    /// Override a key of the object file, such as belief.particles=500 [also PUBS_SET__BELIEF__PARTICLES]
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub plugins: PluginOptions,
}

/// Where plugins are.
#[derive(Args)]
pub struct PluginOptions {
    /// Look for plugins here first [also PUBS_PLUGIN_PATH]
    #[arg(long = "plugin-dir", value_name = "DIR")]
    plugin_dirs: Vec<PathBuf>,
}

impl PluginOptions {
    /// The built-in plugins, and those that are found.
    pub fn registry(&self) -> Registry {
        built_in::registry(&self.plugin_dirs)
    }
}

impl LayerOptions {
    /// The overrides, from environment and command line.
    pub fn overrides(&self) -> Overrides {
        Overrides::from_process(self.set.iter().cloned())
    }
}

/// How often the belief is updated.
#[derive(Args)]
pub struct FrequencyOptions {
    /// Update the belief so many times per policy step; on abstract objects during large moves
    /// [default: as the object file says]
    #[arg(long, value_name = "TIMES", value_parser = whole::<u32>(1, 1_000))]
    pub belief_frequency: Option<u32>,
}

/// What runs policies.
#[derive(Args)]
pub struct RuntimeOptions {
    /// Run policies with this ONNX Runtime library instead of the built-in one
    #[arg(long, value_name = "PATH", env = "ORT_DYLIB_PATH")]
    pub onnxruntime: Option<PathBuf>,
}

impl RuntimeOptions {
    /// The runtime, chosen once per process.
    ///
    /// # Errors
    /// Where the library cannot be used.
    pub fn runtime(&self) -> Result<Runtime, Failure> {
        let runtime = Runtime::from_library(self.onnxruntime.as_deref()).map_err(|error| {
            Failure::incompatible(format!(
                "{}\n  (without --onnxruntime and ORT_DYLIB_PATH the built-in runtime serves)",
                chain(&error)
            ))
        })?;
        show::detail(|| format!("policy runtime: {runtime}"));
        Ok(runtime)
    }
}

/// Reads a whole number within bounds, as a value parser.
pub fn whole<N: TryFrom<u64>>(
    least: u64,
    most: u64,
) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync + 'static {
    move |text| {
        let number: Option<u64> = text.parse().ok();
        let fits = number.filter(|number| (least..=most).contains(number));
        fits.and_then(|number| N::try_from(number).ok())
            .ok_or_else(|| match most {
                u64::MAX => format!("give a whole number, {least} or more"),
                most => format!("give a whole number from {least} to {most}"),
            })
    }
}

/// Reads a finite number that is not negative, as a value parser.
///
/// # Errors
/// What to give instead.
pub fn parse_not_negative(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok();
    number
        .filter(|number| *number >= 0.0 && number.is_finite())
        .ok_or_else(|| "give a finite number, 0 or more".to_owned())
}

/// Refuses a file to be written whose folder is not there: long work must not end at it.
///
/// # Errors
/// Where there is no such folder; `option` names another place.
pub fn check_folder(file: &Path, option: &str) -> Result<(), Failure> {
    let folder = file.parent().unwrap_or(Path::new(""));
    if folder.as_os_str().is_empty() || folder.is_dir() {
        return Ok(());
    }
    Err(Failure::invalid(format!(
        "there is no folder {} for {}: make it, or name another place with {option}",
        folder.display(),
        file.file_name().unwrap_or_default().display()
    )))
}

/// Makes a folder for what is to be written, before any long work.
///
/// # Errors
/// Where it cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| {
        Failure::invalid(format!(
            "cannot make the folder {}: {error}",
            folder.display()
        ))
    })
}

/// Reads seconds above 0, as a value parser.
///
/// # Errors
/// What to give instead.
pub fn parse_timeout(text: &str) -> Result<Duration, String> {
    let help = "give seconds above 0, such as 10 or 0.5";
    let seconds: f64 = text.parse().map_err(|_| help.to_owned())?;
    if seconds <= 0.0 {
        return Err(help.to_owned());
    }
    Duration::try_from_secs_f64(seconds).map_err(|_| help.to_owned())
}
