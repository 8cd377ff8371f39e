//! Writes a policy file, and proves that it computes what the trainer computed.

use std::fs::Permissions;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

mod verify;

pub use verify::TOLERANCE;

use crate::{Contract, Network, NetworkError, PolicyError, PolicyFile, RunError, Runtime, seal};

/// What the trainer's own network computed, to hold the file against.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    /// `[rows][inputs]` in SI; 1,000 rows or so that were met in training.
    pub inputs: &'a [f32],
    /// `[rows][actions]`.
    pub logits: &'a [f32],
    /// So many rows, one after the other, are the steps of one episode, which begins with a state
    /// of zeros and hands it on. 1 for a perceptron; at least 2 for a recurrent network, whose
    /// state is held against that of [`Network::forward_with_state`] after each step.
    pub steps: usize,
}

/// What to do where a file of that name exists and differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Leave it and fail.
    Keep,
    /// Put the new one in its place.
    Replace,
}

/// A policy that was not written. Nothing is left behind.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The network does not make sense.
    #[error("cannot write {}: {fault}", path.display())]
    Network {
        /// The file wanted.
        path: PathBuf,
        /// What is wrong.
        fault: NetworkError,
    },
    /// The contract does not make sense, or is not the network's.
    #[error("cannot write {}: its contract {fault}", path.display())]
    Contract {
        /// The file wanted.
        path: PathBuf,
        /// What is wrong.
        fault: String,
    },
    /// The reference has no rows, or half ones.
    #[error("cannot check {}: {inputs} reference inputs and {logits} logits are not whole rows of both, {steps} to an episode", path.display())]
    Reference {
        /// The file wanted.
        path: PathBuf,
        /// Numbers given.
        inputs: usize,
        /// Numbers given.
        logits: usize,
        /// Rows per episode given.
        steps: usize,
    },
    /// An episode of one step says nothing of the state's weights.
    #[error("cannot check {}: a recurrent policy needs reference episodes of two steps or more", path.display())]
    ReferenceSteps {
        /// The file wanted.
        path: PathBuf,
    },
    /// A different file is there.
    #[error("{} exists and differs; remove it or write elsewhere", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The disk says no.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file wanted.
        path: PathBuf,
        /// The system's account.
        source: std::io::Error,
    },
    /// The file does not load.
    #[error("the file just written does not load: {0}")]
    Load(#[from] PolicyError),
    /// The file does not run.
    #[error("the file just written does not run: {0}")]
    Run(#[from] RunError),
    /// The file computes something else.
    #[error("{} does not compute what was trained: {difference}", path.display())]
    Differs {
        /// The file wanted.
        path: PathBuf,
        /// The input and both sides' logits.
        difference: String,
    },
}

/// Writes the policy to `path` and gives it back as read from there.
///
/// The bytes go to a temporary file first and through the runtime; only a file that computes the
/// reference's logits within [`TOLERANCE`], and so chooses the same actions, takes the name. A
/// file that is there already with the same bytes is left as it is.
///
/// # Errors
/// Where the file exists and differs (with [`Existing::Keep`]), cannot be written, or computes
/// something else.
pub fn write(
    path: &Path,
    network: &Network,
    contract: &Contract,
    reference: Reference<'_>,
    runtime: &Runtime,
    existing: Existing,
) -> Result<PolicyFile, ExportError> {
    check(path, network, contract, reference)?;
    let bytes = seal::encode(network, contract).map_err(|fault| ExportError::Contract {
        path: path.to_owned(),
        fault,
    })?;
    if existing == Existing::Keep && differs(path, &bytes)? {
        return Err(ExportError::Exists {
            path: path.to_owned(),
        });
    }
    let temporary = write_beside(path, &bytes).map_err(|source| io(path, source))?;
    let policy = PolicyFile::read(temporary.path())?.open(runtime)?;
    if let Some(difference) = verify::verify(policy, network, reference)? {
        return Err(ExportError::Differs {
            path: path.to_owned(),
            difference: format!("{difference} in {runtime}"),
        });
    }
    place(temporary, path, &bytes, existing)?;
    Ok(PolicyFile::read(path)?)
}

fn io(path: &Path, source: std::io::Error) -> ExportError {
    ExportError::Io {
        path: path.to_owned(),
        source,
    }
}

fn check(
    path: &Path,
    network: &Network,
    contract: &Contract,
    reference: Reference,
) -> Result<(), ExportError> {
    let path = path.to_owned();
    if let Err(fault) = network.check() {
        return Err(ExportError::Network { path, fault });
    }
    if let Err(fault) = contract.check().and_then(|()| fits(network, contract)) {
        return Err(ExportError::Contract { path, fault });
    }
    let (inputs, logits) = (reference.inputs.len(), reference.logits.len());
    let (rows, steps) = (inputs / network.inputs.len(), reference.steps);
    let whole = rows * network.inputs.len() == inputs && rows * network.actions() == logits;
    if rows == 0 || !whole || steps == 0 || !rows.is_multiple_of(steps) {
        return Err(ExportError::Reference {
            path,
            inputs,
            logits,
            steps,
        });
    }
    if network.state_width() > 0 && steps < 2 {
        return Err(ExportError::ReferenceSteps { path });
    }
    Ok(())
}

fn fits(network: &Network, contract: &Contract) -> Result<(), String> {
    if contract.inputs != network.inputs {
        return Err("names other inputs than the network has".into());
    }
    let (named, outputs) = (contract.actions.len(), network.actions());
    if named != outputs {
        return Err(format!(
            "names {named} actions, the network has {outputs} outputs"
        ));
    }
    if contract.state != network.state() {
        return Err("says another state than the network has".into());
    }
    Ok(())
}

/// Whether something else than `bytes` stands under this name.
fn differs(path: &Path, bytes: &[u8]) -> Result<bool, ExportError> {
    match std::fs::read(path) {
        Ok(found) => Ok(found != bytes),
        Err(fault) if fault.kind() == std::io::ErrorKind::NotFound => Ok(false),
        Err(fault) => Err(io(path, fault)),
    }
}

/// In the same directory, so that renaming it is one step.
fn write_beside(path: &Path, bytes: &[u8]) -> std::io::Result<NamedTempFile> {
    let parent = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".policy-").suffix(".partial");
    if let Some(permissions) = shared_permissions() {
        builder.permissions(permissions);
    }
    let mut file = builder.tempfile_in(parent)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    Ok(file)
}

/// A temporary file is its owner's alone, a policy is not: as the umask has it.
#[cfg(unix)]
fn shared_permissions() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt as _;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn shared_permissions() -> Option<Permissions> {
    None
}

fn place(
    temporary: NamedTempFile,
    path: &Path,
    bytes: &[u8],
    existing: Existing,
) -> Result<(), ExportError> {
    if existing == Existing::Replace {
        return temporary
            .persist(path)
            .map(drop)
            .map_err(|fault| io(path, fault.error));
    }
    match temporary.persist_noclobber(path) {
        Ok(_) => Ok(()),
        // Someone else was quicker, or the very same file was there from the start.
        Err(_) if path.exists() && !differs(path, bytes)? => Ok(()),
        Err(_) if path.exists() => Err(ExportError::Exists {
            path: path.to_owned(),
        }),
        Err(fault) => Err(io(path, fault.error)),
    }
}
