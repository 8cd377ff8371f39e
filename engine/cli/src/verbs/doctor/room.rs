//! Where recordings and live views find room: disk and ports.

use std::net::TcpListener;
use std::path::{Path, PathBuf};

use pubs_plugin::{CheckState, DriverCheck};

use super::check;
use crate::recorded::{self, RECORD_VARIABLE, folder_of};

/// What a run records, measured: 2.2 MB in 14 s of door2 at 100, 30 and 10 Hz.
const BYTES_PER_MINUTE: u64 = 10_000_000;
/// Below this many minutes the disk is a reason to worry.
const FEW_MINUTES: u64 = 60;

/// The disk behind the recordings of an object, and the ports of the live views.
pub fn checks(object: Option<&Path>) -> Vec<DriverCheck> {
    let ports = [
        ("dashboard", pubs_live::dashboard::DEFAULT_PORT),
        ("foxglove", pubs_live::foxglove::DEFAULT_PORT),
    ];
    let mut checks = vec![disk(&folder(object))];
    checks.extend(ports.map(|(view, port)| free(view, port)));
    checks
}

/// Where a run would record.
fn folder(object: Option<&Path>) -> PathBuf {
    match (std::env::var_os(RECORD_VARIABLE), object) {
        (Some(named), _) => folder_of_named(named.into()),
        (None, Some(object)) => folder_of(object),
        (None, None) => folder_of(Path::new("objects/object.toml")),
    }
}

/// A name that ends in `.mcap` is that of the file.
fn folder_of_named(named: PathBuf) -> PathBuf {
    match (recorded::is_file_name(&named), named.parent()) {
        (true, Some(folder)) => folder.to_owned(),
        _ => named,
    }
}

fn disk(folder: &Path) -> DriverCheck {
    let elsewhere =
        "record elsewhere with --record DIR (or PUBS_RECORD), or not at all with --no-record";
    // It is made when it is first needed; until then the disk is that of the folder it will be in.
    let there = folder.ancestors().find(|path| path.exists());
    let there = there.filter(|path| !path.as_os_str().is_empty());
    let there = there.unwrap_or(Path::new("."));
    let fault = |found: String| check("recordings", CheckState::Fault, found, elsewhere);
    if !there.is_dir() {
        return fault(format!(
            "{}: a file is in the place of the folder",
            there.display()
        ));
    }
    // Only a file that was made says that one can be: rights, and a disk that may not be written.
    if let Err(error) = tempfile::tempfile_in(there) {
        return fault(format!(
            "{}: nothing can be written: {error}",
            there.display()
        ));
    }
    let room = match rustix::fs::statvfs(there) {
        Ok(room) => room.f_bavail.saturating_mul(room.f_frsize),
        Err(error) => return fault(format!("{}: {error}", there.display())),
    };
    let minutes = room / BYTES_PER_MINUTE;
    let found = format!(
        "{}: {:.1} GB free, about {:.0} hours of runs",
        folder.display(),
        room as f64 * 1e-9,
        minutes as f64 / 60.0
    );
    match minutes {
        0..FEW_MINUTES => {
            let found = format!(
                "{}: room for about {minutes} minutes of runs",
                folder.display()
            );
            check(
                "recordings",
                CheckState::Warn,
                found,
                &format!("make room, or {elsewhere}"),
            )
        }
        _ => check("recordings", CheckState::Ok, found, ""),
    }
}

fn free(view: &str, port: u16) -> DriverCheck {
    match TcpListener::bind(("127.0.0.1", port)) {
        Ok(_) => check(view, CheckState::Ok, format!("port {port} is free"), ""),
        Err(error) => check(
            view,
            CheckState::Warn,
            format!("port {port} cannot be had: {error}"),
            &format!("give another one, such as run … --{view} 127.0.0.1:0"),
        ),
    }
}
