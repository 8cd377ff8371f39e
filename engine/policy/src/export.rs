//! Writes a policy file, and proves that it computes what the trainer computed.

use std::fs::Permissions;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::{Contract, Network, NetworkError, PolicyError, PolicyFile, RunError, Runtime, seal};

/// Largest difference of a logit between the trainer and the file.
pub const TOLERANCE: f32 = 1e-4;

/// What the trainer's own network computed, to hold the file against.
#[derive(Debug, Clone, Copy)]
pub struct Reference<'a> {
    /// `[rows][inputs]` in SI; 1,000 rows or so that were met in training.
    pub inputs: &'a [f32],
    /// `[rows][actions]`.
    pub logits: &'a [f32],
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
    #[error("cannot check {}: {inputs} reference inputs and {logits} logits are not whole rows of both", path.display())]
    Reference {
        /// The file wanted.
        path: PathBuf,
        /// Numbers given.
        inputs: usize,
        /// Numbers given.
        logits: usize,
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
    verify(
        path,
        &PolicyFile::read(temporary.path())?,
        reference,
        runtime,
    )?;
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
    let rows = inputs / network.inputs.len();
    if rows == 0 || rows * network.inputs.len() != inputs || rows * network.actions() != logits {
        return Err(ExportError::Reference {
            path,
            inputs,
            logits,
        });
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
    if contract.format_version != crate::contract::FORMAT_VERSION {
        return Err(format!(
            "has version {}, which this engine does not write",
            contract.format_version
        ));
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

fn verify(
    path: &Path,
    file: &PolicyFile,
    reference: Reference,
    runtime: &Runtime,
) -> Result<(), ExportError> {
    let mut policy = file.open(runtime)?;
    let (features, actions) = (policy.features(), policy.actions());
    let mut logits = Vec::new();
    policy.logits(
        reference.inputs,
        reference.inputs.len() / features,
        &mut logits,
    )?;
    let rows = reference
        .logits
        .chunks_exact(actions)
        .zip(logits.chunks_exact(actions));
    for ((wanted, found), input) in rows.zip(reference.inputs.chunks_exact(features)) {
        if !agree(wanted, found) {
            let difference =
                format!("for input {input:?} the trainer gives {wanted:?}, {runtime} {found:?}");
            return Err(ExportError::Differs {
                path: path.to_owned(),
                difference,
            });
        }
    }
    Ok(())
}

/// Logits this close choose the same action wherever the best leads by more than twice
/// [`TOLERANCE`]. Written so that NaN on either side disagrees.
fn agree(wanted: &[f32], found: &[f32]) -> bool {
    wanted
        .iter()
        .zip(found)
        .all(|(wanted, found)| (wanted - found).abs() <= TOLERANCE)
}

#[cfg(test)]
mod tests {
    use super::agree;

    #[test]
    fn agreement_by_hand() {
        let cases = [
            (&[1.0, 0.0][..], &[1.000_05, 0.0][..], true),
            (&[1.0, 0.0], &[1.000_2, 0.0], false),
            (&[1.0, 0.999_99], &[0.999_96, 1.0], true),
            (&[f32::NAN, 0.0], &[f32::NAN, 0.0], false),
            (&[1.0, 0.0], &[f32::NAN, 0.0], false),
        ];
        for (wanted, found, expected) in cases {
            assert_eq!(agree(wanted, found), expected, "{wanted:?} {found:?}");
        }
    }
}
