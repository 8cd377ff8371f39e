//! Fitting recordings and editing the object file.

use pubs_calibrate::calibration::{Calibration, calibrate};
use pubs_calibrate::object_text;
use pubs_core::Task;
use pubs_core::object::{Faults, LoadedObject, Overrides, render};
use pubs_host::Registry;

use super::recordings::Checked;
use super::{Arguments, summary};
use crate::failure::Failure;
use crate::{Ended, exit, object, show};

/// Fits, shows what was found, and writes the segments unless that is not wanted.
///
/// # Errors
/// Where the recordings do not give a model, or the file cannot be written; it is then as before.
pub fn fit(
    arguments: &Arguments,
    loaded: &LoadedObject,
    task: &Task,
    registry: &Registry,
    overrides: &Overrides,
    checked: &Checked,
) -> Ended {
    let began = std::time::Instant::now();
    let calibration = calibrate(task, &checked.recordings)
        .map_err(|error| Failure::invalid(error.to_string()))?;
    let time_s = began.elapsed().as_secs_f64();
    let text = edited(loaded, task, checked, &calibration)?;
    let faults = object::faults_of_text(loaded.path(), &text, overrides, registry);
    if !faults.is_empty() {
        show::say(render(&Faults(faults), show::color_on_stderr()).trim_end());
        return Err(Failure::Other {
            code: exit::FAULT,
            message: "the fitted segments do not make a model; the object file is as before"
                .to_owned(),
        });
    }
    if !arguments.dry_run {
        object_text::write_atomically(loaded.path(), &text)
            .map_err(|error| Failure::fault(&error))?;
    }
    for warning in &calibration.warnings {
        show::say(&format!("warning: {warning}"));
    }
    let report = summary::report(arguments, task, checked, &calibration, time_s);
    if arguments.json {
        show::print_json(&report)?;
    } else if arguments.dry_run {
        show::print(&object_text::difference(loaded.text(), &text))?;
        show::note(&summary::text(task, &report));
    } else {
        show::print(&summary::text(task, &report))?;
    }
    Ok(if checked.lost {
        exit::MISSED
    } else {
        exit::DONE
    })
}

/// The text of the object file with the new segments, and where they come from.
fn edited(
    loaded: &LoadedObject,
    task: &Task,
    checked: &Checked,
    calibration: &Calibration,
) -> Result<String, Failure> {
    let broken = |error: object_text::EditError| Failure::invalid(error.to_string());
    let unit = object_text::StateUnit::of(&task.joint);
    let text = object_text::with_segments(
        loaded.text(),
        unit,
        &calibration.segments,
        &summary::heading(task, checked, calibration),
    )
    .map_err(broken)?;
    object_text::with_source(&text, checked.source_kind(), &checked.sensor).map_err(broken)
}
