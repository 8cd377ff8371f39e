//! What runs the policies: tract, which is in the program, or a real ONNX Runtime.

use std::error::Error as _;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use ort::environment::Environment;
use ort::session::Session;
use ort::session::builder::GraphOptimizationLevel;

/// The choice is the process's: `ort` keeps one table of functions and one environment.
static CHOSEN: Mutex<Option<Runtime>> = Mutex::new(None);

/// The runtime of this process. Choose it once; clones are cheap.
#[derive(Clone)]
pub struct Runtime {
    environment: Environment,
    kind: Kind,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Kind {
    Tract,
    OnnxRuntime { library: PathBuf },
}

/// A runtime that cannot be had.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RuntimeError {
    /// No such library.
    #[error("{}: no ONNX Runtime library here; version 1.{} or newer is wanted", path.display(), ort::MINOR_VERSION)]
    Missing {
        /// The path tried.
        path: PathBuf,
    },
    /// The system's loader refuses it.
    #[error("{}: cannot be loaded as ONNX Runtime 1.{} or newer: {reason}", path.display(), ort::MINOR_VERSION)]
    Load {
        /// The path tried.
        path: PathBuf,
        /// The loader's account.
        reason: String,
    },
    /// Some other library.
    #[error("{}: is not ONNX Runtime (it lacks OrtGetApiBase); version 1.{} or newer is wanted", path.display(), ort::MINOR_VERSION)]
    Foreign {
        /// The path tried.
        path: PathBuf,
    },
    /// Too old.
    #[error("{}: is ONNX Runtime {found}; version 1.{} or newer is wanted", path.display(), ort::MINOR_VERSION)]
    TooOld {
        /// The path tried.
        path: PathBuf,
        /// What the library says of itself.
        found: String,
    },
    /// One process, one runtime.
    #[error("this process already runs policies with {chosen}; it cannot take {wanted} as well")]
    AlreadyChosen {
        /// The first choice.
        chosen: String,
        /// The second one.
        wanted: String,
    },
    /// The library is there but does not start.
    #[error("{runtime} does not start: {reason}")]
    Start {
        /// Which one.
        runtime: String,
        /// Its own account.
        reason: String,
    },
}

impl Runtime {
    /// tract, the default: compiled in, nothing to install.
    ///
    /// # Errors
    /// Where the process has chosen another one before.
    pub fn tract() -> Result<Self, RuntimeError> {
        Self::choose(Kind::Tract, || {
            ort::set_api(ort_tract::api());
            Ok(ort::init())
        })
    }

    /// The ONNX Runtime in a shared library.
    ///
    /// A bare file name is looked for by the system's loader, anything else as a path from here.
    ///
    /// # Errors
    /// Where the library is missing, foreign or older than the `ort` in use needs, or the process
    /// has chosen another runtime before.
    pub fn onnx_runtime(library: &Path) -> Result<Self, RuntimeError> {
        let library = resolve(library)?;
        Self::choose(
            Kind::OnnxRuntime {
                library: library.clone(),
            },
            || ort::init_from(&library).map_err(|fault| load_error(&library, &fault)),
        )
    }

    /// ONNX Runtime where a library is named, else tract.
    ///
    /// # Errors
    /// As those two.
    pub fn from_library(library: Option<&Path>) -> Result<Self, RuntimeError> {
        library.map_or_else(Self::tract, Self::onnx_runtime)
    }

    /// What the runtime says of itself.
    #[must_use]
    pub fn version(&self) -> &'static str {
        ort::info()
    }

    fn choose(
        kind: Kind,
        prepare: impl FnOnce() -> Result<ort::environment::EnvironmentBuilder, RuntimeError>,
    ) -> Result<Self, RuntimeError> {
        let mut chosen = CHOSEN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(runtime) = &*chosen {
            if runtime.kind == kind {
                return Ok(runtime.clone());
            }
            return Err(RuntimeError::AlreadyChosen {
                chosen: runtime.kind.to_string(),
                wanted: kind.to_string(),
            });
        }
        let environment = prepare()?
            .with_name("pubs")
            .with_telemetry(false)
            .build()
            .map_err(|fault| RuntimeError::Start {
                runtime: kind.to_string(),
                reason: fault.to_string(),
            })?;
        let runtime = Self { environment, kind };
        *chosen = Some(runtime.clone());
        Ok(runtime)
    }

    /// A session of one thread.
    pub(crate) fn session(&self, model: &[u8]) -> Result<Session, String> {
        let builder = Session::builder(&self.environment).map_err(|fault| fault.to_string())?;
        // ort-tract leaves a graph as it is, 30 times slower, unless it is told to optimise.
        let mut builder = builder
            .with_optimization_level(GraphOptimizationLevel::Level3)
            .map_err(|fault| fault.to_string())?;
        if matches!(self.kind, Kind::OnnxRuntime { .. }) {
            // A pool of spinning threads per session would starve the control loops.
            builder = builder
                .with_intra_threads(1)
                .map_err(|fault| fault.to_string())?;
        }
        builder
            .commit_from_memory(model)
            .map_err(|fault| fault.to_string())
    }
}

impl fmt::Display for Runtime {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(formatter)
    }
}

impl fmt::Debug for Runtime {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.kind.fmt(formatter)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tract => formatter.write_str("tract"),
            Self::OnnxRuntime { library } => {
                write!(formatter, "ONNX Runtime ({})", library.display())
            }
        }
    }
}

/// `ort` would look beside the executable for a relative path; users mean the directory they are in.
fn resolve(library: &Path) -> Result<PathBuf, RuntimeError> {
    if library.is_file() {
        return library.canonicalize().map_err(|_| RuntimeError::Missing {
            path: library.to_owned(),
        });
    }
    let bare = library.components().count() == 1 && !library.is_dir();
    if bare {
        Ok(library.to_owned())
    } else {
        Err(RuntimeError::Missing {
            path: library.to_owned(),
        })
    }
}

fn load_error(library: &Path, fault: &ort::LoadDynamicError) -> RuntimeError {
    let path = library.to_owned();
    match fault {
        ort::LoadDynamicError::Dlopen { error, .. } => {
            let reason = error
                .source()
                .map_or_else(|| error.to_string(), ToString::to_string);
            RuntimeError::Load { path, reason }
        }
        ort::LoadDynamicError::MissingApi { .. } => RuntimeError::Foreign { path },
        ort::LoadDynamicError::BadVersion { version_str, .. } => RuntimeError::TooOld {
            path,
            found: version_str.clone(),
        },
        fault @ ort::LoadDynamicError::InvalidVersionString => RuntimeError::Load {
            path,
            reason: fault.to_string(),
        },
    }
}
