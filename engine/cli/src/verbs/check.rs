//! `pubs-engine check`: every fault of every file at once.

use std::path::PathBuf;

use clap::Args;
use pubs_core::object::{self, Fault, Faults};
use serde::Serialize;

use crate::options::LayerOptions;
use crate::{Ended, exit, show};

#[derive(Args)]
#[command(after_help = "Example: pubs-engine check objects/")]
pub struct Arguments {
    /// Object files, or folders of them
    #[arg(value_name = "PATH", required = true)]
    paths: Vec<PathBuf>,
    #[command(flatten)]
    layers: LayerOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    ok: bool,
    files: usize,
    /// Files without faults that wait for their calibration.
    uncalibrated: Vec<PathBuf>,
    faults: Vec<Fault>,
}

pub fn run(arguments: &Arguments) -> Ended {
    let registry = arguments.layers.plugins.registry();
    let overrides = arguments.layers.overrides();
    let (mut files, mut faults) = (Vec::new(), Vec::new());
    for path in &arguments.paths {
        match object::files(path) {
            Ok(found) => files.extend(found),
            Err(Faults(found)) => faults.extend(found),
        }
    }
    let mut uncalibrated = Vec::new();
    for file in &files {
        let checked = crate::object::check(file, &overrides, &registry);
        if checked.faults.is_empty() && checked.uncalibrated {
            uncalibrated.push(file.clone());
        }
        faults.extend(checked.faults);
    }
    let code = if faults.is_empty() {
        exit::DONE
    } else {
        exit::INVALID
    };
    if arguments.json {
        show::print_json(&Report {
            ok: faults.is_empty(),
            files: files.len(),
            uncalibrated,
            faults,
        })?;
        return Ok(code);
    }
    let count = faults.len();
    if count > 0 {
        show::print(object::render(&Faults(faults), show::color_on_stdout()).trim_end())?;
    }
    let plural = |count: usize| if count == 1 { "" } else { "s" };
    let verdict = if count == 0 {
        "ok".to_owned()
    } else {
        format!("{count} fault{}", plural(count))
    };
    show::print(&format!(
        "{} object file{} checked: {verdict}",
        files.len(),
        plural(files.len())
    ))?;
    for file in uncalibrated {
        show::note(&format!(
            "note: {} is not calibrated yet: pubs-engine calibrate {0}",
            file.display()
        ));
    }
    Ok(code)
}
