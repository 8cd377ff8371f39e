//! Options that several verbs share.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use pubs_core::object::Overrides;
use pubs_policy::Runtime;

use crate::failure::{Failure, chain};
use crate::show;

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
    /// Look for plugins here first [also PUBS_PLUGIN_PATH]
    #[arg(long = "plugin-dir", value_name = "DIR")]
    pub plugin_dirs: Vec<PathBuf>,
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
    #[arg(long, value_name = "TIMES", value_parser = clap::value_parser!(u32).range(1..=1000))]
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
        let runtime = Runtime::from_library(self.onnxruntime.as_deref())
            .map_err(|error| Failure::incompatible(chain(&error)))?;
        show::detail(|| format!("policy runtime: {runtime}"));
        Ok(runtime)
    }
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
