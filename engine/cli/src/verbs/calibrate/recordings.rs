//! Reading recordings, and refusing what cannot be used before anything is changed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use pubs_calibrate::faults::{Expectation, check};
use pubs_calibrate::{Fault, Source, csv};
use pubs_core::Task;
use pubs_run::recording::{self, Recording};

use super::Arguments;
use crate::failure::Failure;
use crate::{Ended, exit, show};

/// So many faults are shown; the rest are counted.
const SHOWN: usize = 20;

/// Recordings that fit the object.
pub struct Checked {
    /// File and content.
    pub recordings: Vec<(String, Recording)>,
    /// The force sensor that all of them were taken with.
    pub sensor: String,
    /// Whether a file is cut off or damaged.
    pub lost: bool,
}

impl Checked {
    /// `[source] kind`: a virtual world tells the true state, a real object does not.
    pub fn source_kind(&self) -> &'static str {
        let virtual_world = self
            .recordings
            .iter()
            .flat_map(|(_, recording)| &recording.frames)
            .any(|frame| frame.truth.is_some());
        if virtual_world { "virtual" } else { "measured" }
    }
}

/// Reads every file.
///
/// # Errors
/// Where one cannot be read.
pub fn read(files: &[PathBuf]) -> Result<Vec<(String, Recording)>, Failure> {
    let named = |file: &PathBuf| Ok((file.display().to_string(), read_one(file)?.0));
    files.iter().map(named).collect()
}

/// MCAP, or a table where the name ends in `.csv`.
fn read_one(file: &Path) -> Result<(Recording, Source), Failure> {
    let is_table = file
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    if is_table {
        return csv::read(file).map_err(|refused| Failure::each(refused.to_string()));
    }
    let recording = recording::read(file).map_err(|error| Failure::invalid(error.to_string()))?;
    Ok((recording, Source::mcap(file)))
}

/// Reads every file and checks it against the object.
///
/// # Errors
/// Everything that is wrong with them.
pub fn checked(arguments: &Arguments, task: &Task, files: &[PathBuf]) -> Result<Checked, Failure> {
    let read = files
        .iter()
        .map(|file| read_one(file))
        .collect::<Result<Vec<_>, Failure>>()?;
    let wanted = if arguments.check {
        0
    } else {
        arguments.demonstrations() as usize
    };
    // What one recording lacks, another may have.
    let alone = read.len() == 1;
    // A new recording is made to take up the driver's sensor; one from elsewhere must be the object's.
    let any_sensor =
        arguments.driver.accept_sensor || (arguments.from.is_empty() && !arguments.check);
    let expectation = Expectation {
        demonstrations: if alone { wanted } else { 0 },
        any_sensor,
    };
    let mut faults = Vec::new();
    for (recording, source) in &read {
        if let Some(loss) = &recording.loss {
            show::say(&format!("warning: {}: {loss}", source.file().display()));
        }
        let findings = check(recording, source, task, expectation);
        for warning in &findings.warnings {
            show::say(&format!("warning: {warning}"));
        }
        faults.extend(findings.faults);
    }
    refuse(&faults)?;
    let recordings: Vec<(String, Recording)> = read
        .into_iter()
        .map(|(recording, source)| (source.file().display().to_string(), recording))
        .collect();
    if !alone {
        enough_in_all(task, &recordings, wanted)?;
    }
    Ok(Checked {
        sensor: one_sensor(&recordings)?,
        lost: recordings
            .iter()
            .any(|(_, recording)| recording.loss.is_some()),
        recordings,
    })
}

fn refuse(faults: &[Fault]) -> Result<(), Failure> {
    if faults.is_empty() {
        return Ok(());
    }
    let mut lines: Vec<String> = faults.iter().take(SHOWN).map(Fault::to_string).collect();
    if faults.len() > SHOWN {
        lines.push(format!("and {} more", faults.len() - SHOWN));
    }
    Err(Failure::each(lines.join("\n")))
}

fn enough_in_all(
    task: &Task,
    recordings: &[(String, Recording)],
    wanted: usize,
) -> Result<(), Failure> {
    for action in task.actions.iter().filter(|action| !action.is_stop()) {
        let done: BTreeSet<(usize, u32)> = recordings
            .iter()
            .enumerate()
            .flat_map(|(file, (_, recording))| {
                let own = recording
                    .done
                    .iter()
                    .filter(|done| done.action == action.name);
                own.map(move |done| (file, done.demonstration))
            })
            .collect();
        if done.len() < wanted {
            return Err(Failure::invalid(format!(
                "the recordings hold {} whole demonstrations of `{}`; expected at least {wanted} (record the others with --resume, or accept fewer with --demonstrations {})",
                done.len(),
                action.name,
                done.len()
            )));
        }
    }
    Ok(())
}

fn one_sensor(recordings: &[(String, Recording)]) -> Result<String, Failure> {
    let sensors: BTreeSet<&str> = recordings
        .iter()
        .map(|(_, recording)| recording.header.sensor.as_str())
        .collect();
    match sensors.iter().collect::<Vec<_>>().as_slice() {
        [sensor] => Ok((**sensor).to_owned()),
        several => Err(Failure::invalid(format!(
            "the recordings were taken with different force sensors ({}); fit those of one sensor",
            several
                .iter()
                .map(|sensor| **sensor)
                .collect::<Vec<_>>()
                .join(", ")
        ))),
    }
}

/// Writes each recording as a table.
///
/// # Errors
/// Where one cannot be read or written.
pub fn export(files: &[PathBuf], folder: &Path, json: bool) -> Ended {
    std::fs::create_dir_all(folder).map_err(|error| {
        Failure::invalid(format!(
            "cannot make the folder {}: {error}",
            folder.display()
        ))
    })?;
    let mut tables = Vec::new();
    let mut code = exit::DONE;
    for file in files {
        let (recording, _) = read_one(file)?;
        if let Some(loss) = &recording.loss {
            show::say(&format!("warning: {}: {loss}", file.display()));
            code = exit::MISSED;
        }
        let name = file.file_stem().unwrap_or(file.as_os_str());
        let table = folder.join(name).with_extension("csv");
        csv::write(&table, &recording).map_err(|refused| Failure::invalid(refused.to_string()))?;
        tables.push(table);
    }
    if json {
        show::print_json(&serde_json::json!({ "tables": tables }))?;
    } else {
        for table in &tables {
            show::print(&table.display().to_string())?;
        }
    }
    Ok(code)
}
