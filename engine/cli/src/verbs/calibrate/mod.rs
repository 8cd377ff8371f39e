//! `pubs-engine calibrate`: from demonstrations to the segments of an object file.

mod check;
mod edit;
pub mod record;
pub mod recordings;
mod summary;

use std::path::PathBuf;

use clap::Args;

use crate::driver::DriverOptions;
use crate::options::{LayerOptions, parse_not_negative, whole};
use crate::{Ended, object};

#[derive(Args)]
#[command(after_help = "\
Examples: pubs-engine calibrate objects/door1.toml
          pubs-engine calibrate objects/door1.toml --resume
          pubs-engine calibrate objects/door1.toml --from recordings/door1-calibration.mcap --dry-run
          pubs-engine calibrate objects/door1.toml --check
Without --from the arm moves: it tares, touches the closed limit, and opens and closes the object in safe and in high-force mode. \
The recording stays; the object file is edited in place, comments and order kept. Exit code 3: a recording has lost data, or with \
--check the model no longer holds.")]
pub struct Arguments {
    /// Object file
    #[arg(value_name = "OBJECT")]
    object: PathBuf,
    /// Fit these recordings, MCAP or CSV, without any robot
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    from: Vec<PathBuf>,
    /// Folder of recordings [default: recordings, beside the object's folder]
    #[arg(long, value_name = "DIR")]
    recordings: Option<PathBuf>,
    /// Demonstrations of each movement action [default: 5, with --check 3]
    #[arg(long, value_name = "N", value_parser = whole::<u32>(1, 100))]
    demonstrations: Option<u32>,
    /// Go on where an interrupted recording ended
    #[arg(long, conflicts_with_all = ["from", "check"])]
    resume: bool,
    /// Compare with the stored model instead of fitting a new one
    #[arg(long)]
    check: bool,
    /// Show the change to the object file without making it
    #[arg(long, conflicts_with = "check")]
    dry_run: bool,
    /// Write the recordings as one CSV file each into this folder and stop there
    #[arg(long, value_name = "DIR", requires = "from", conflicts_with_all = ["check", "dry_run"])]
    export: Option<PathBuf>,
    /// Refuse a resting sensor that is further off than this [default: half of control.force_threshold_n]
    #[arg(long, value_name = "N", value_parser = parse_not_negative)]
    baseline_off_n: Option<f64>,
    /// Refuse a resting sensor whose standard deviation is greater [default: a tenth of control.force_threshold_n]
    #[arg(long, value_name = "N", value_parser = parse_not_negative)]
    baseline_noise_n: Option<f64>,
    #[command(flatten)]
    driver: DriverOptions,
    /// Seed of everything that is drawn
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    layers: LayerOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

impl Arguments {
    fn demonstrations(&self) -> u32 {
        const FOR_A_MODEL: u32 = 5;
        const FOR_A_CHECK: u32 = 3;
        let usual = if self.check { FOR_A_CHECK } else { FOR_A_MODEL };
        self.demonstrations.unwrap_or(usual)
    }
}

pub fn run(arguments: &Arguments) -> Ended {
    let registry = arguments.layers.plugins.registry();
    let overrides = arguments.driver.overrides(&arguments.layers);
    let (loaded, task) = object::without_model(&arguments.object, &overrides, &registry)?;
    let recorded = if arguments.from.is_empty() {
        match record::record(arguments, &loaded, &task, &registry)? {
            record::Recorded::Whole(files) => files,
            record::Recorded::Stopped(code) => return Ok(code),
        }
    } else {
        arguments.from.clone()
    };
    if let Some(folder) = &arguments.export {
        return recordings::export(&recorded, folder, arguments.json);
    }
    let recordings = recordings::checked(arguments, &task, &recorded)?;
    if arguments.check {
        return check::check(arguments, &task, &recordings);
    }
    edit::fit(
        arguments,
        &loaded,
        &task,
        &registry,
        &overrides,
        &recordings,
    )
}
