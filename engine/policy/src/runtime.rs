//! What runs the policies: tract, which is in the program, or a real ONNX Runtime.

use std::error::Error as _;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use ort::environment::{Environment, EnvironmentBuilder};
use ort::session::Session;
use ort::session::builder::GraphOptimizationLevel;

/// The choice is the process's: `ort` keeps one table of functions and one environment.
static CHOSEN: Mutex<Choice> = Mutex::new(Choice::Open);

enum Choice {
    Open,
    /// `ort` 2.0.0-rc.14 keeps an uninitialised library after a failed load and would use it at
    /// the next one, so there is no next one. tract needs no library and stays free.
    LibraryFailed(RuntimeError),
    Made(Runtime),
}

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
    /// One process, one attempt at a library.
    #[error("{}: not tried, since another library failed in this process before: {first}", path.display())]
    FailedBefore {
        /// The path wanted.
        path: PathBuf,
        /// The first failure.
        first: Box<RuntimeError>,
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
        let mut choice = CHOSEN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(made) = choice.made(&Kind::Tract) {
            return made;
        }
        ort::set_api(ort_tract::api());
        choice.make(ort::init(), Kind::Tract)
    }

    /// The ONNX Runtime in a shared library.
    ///
    /// A bare file name is looked for by the system's loader, anything else as a path from here.
    ///
    /// # Errors
    /// Where the library is missing, foreign or older than the `ort` in use needs, or the process
    /// has chosen another runtime, or failed to load one, before.
    pub fn onnx_runtime(library: &Path) -> Result<Self, RuntimeError> {
        let library = resolve(library)?;
        let kind = Kind::OnnxRuntime {
            library: library.clone(),
        };
        let mut choice = CHOSEN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(made) = choice.made(&kind) {
            return made;
        }
        if let Choice::LibraryFailed(first) = &*choice {
            return Err(RuntimeError::FailedBefore {
                path: library,
                first: Box::new(first.clone()),
            });
        }
        match ort::init_from(&library) {
            Ok(environment) => choice.make(environment, kind),
            Err(fault) => {
                let fault = load_error(&library, &fault);
                *choice = Choice::LibraryFailed(fault.clone());
                Err(fault)
            }
        }
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

impl Choice {
    fn made(&self, wanted: &Kind) -> Option<Result<Runtime, RuntimeError>> {
        let Self::Made(runtime) = self else {
            return None;
        };
        if runtime.kind == *wanted {
            return Some(Ok(runtime.clone()));
        }
        let (chosen, wanted) = (runtime.kind.to_string(), wanted.to_string());
        Some(Err(RuntimeError::AlreadyChosen { chosen, wanted }))
    }

    fn make(
        &mut self,
        environment: EnvironmentBuilder,
        kind: Kind,
    ) -> Result<Runtime, RuntimeError> {
        let environment = environment
            .with_name("pubs")
            .with_telemetry(false)
            .build()
            .map_err(|fault| RuntimeError::Start {
                runtime: kind.to_string(),
                reason: fault.to_string(),
            })?;
        let runtime = Runtime { environment, kind };
        *self = Self::Made(runtime.clone());
        Ok(runtime)
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
