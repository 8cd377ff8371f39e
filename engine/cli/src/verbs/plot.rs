//! `pubs-engine plot`: an object's observation model as a picture, with the readings behind it.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use pubs_calibrate::calibration::all_traces;
use pubs_calibrate::object_text::{StateUnit, segments_of};
use pubs_calibrate::plot::{self, picture, readings, subtitle};
use pubs_core::Task;
use pubs_core::object::schema::joint_name;
use pubs_run::recording::Recording;
use serde::Serialize;

use crate::failure::Failure;
use crate::options::ObjectOptions;
use crate::verbs::calibrate::{self, recordings};
use crate::{Ended, exit, object, show};

#[derive(Args)]
#[command(after_help = "\
Examples: pubs-engine plot objects/door2.toml
          pubs-engine plot objects/door2.toml --from recordings/door2-calibration.mcap --out pictures --format svg
Rows are the channels f_d, f_z, f_n and m_p, columns the actions: recorded readings, segments, mean and ±2 sigma over the joint's range.")]
pub struct Arguments {
    #[command(flatten)]
    object: ObjectOptions,
    /// Draw the readings of these recordings [default: those of `calibrate`, where they are found]
    #[arg(long, value_name = "RECORDING", num_args = 1..)]
    from: Vec<PathBuf>,
    /// Folder for the pictures
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// File formats
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Format::Svg, Format::Png])]
    format: Vec<Format>,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Svg,
    Png,
}

#[derive(Serialize)]
struct Report {
    files: Vec<PathBuf>,
    segments: usize,
    readings: usize,
}

/// Pixels of the PNG for each of the sheet's own: 300 dots per inch on A4.
const PNG_SCALE: f32 = 2.0;

pub fn run(arguments: &Arguments) -> Ended {
    let layers = &arguments.object.layers;
    let registry = layers.plugins.registry();
    let path = &arguments.object.object;
    let (_, task) = object::without_model(path, &layers.overrides(), &registry)?;
    let segments = segments_of(&task.observation.table, StateUnit::of(&task.joint))
        .map_err(|error| Failure::invalid(error.to_string()))?;
    if segments.is_empty() {
        return Err(Failure::invalid(format!(
            "{} has no calibration segments to draw; `pubs-engine calibrate` writes them",
            path.display()
        )));
    }
    let files = if arguments.from.is_empty() {
        calibrate::record::found(path, &task.name)
    } else {
        arguments.from.clone()
    };
    let recordings = recordings::read(&files)?;
    for (file, recording) in &recordings {
        of_the_object(&task, file, recording)?;
    }
    let (traces, _) =
        all_traces(&task, &recordings).map_err(|error| Failure::invalid(error.to_string()))?;
    let readings = readings(&task, &traces);
    let subtitle = subtitle(&files, &traces);
    let sheet = plot::svg(&picture(&task, &segments, &readings, subtitle))
        .map_err(|error| Failure::fault(&error))?;
    let report = Report {
        files: written(arguments, &task.name, &sheet)?,
        segments: segments.len(),
        readings: readings.iter().map(|(_, _, samples)| samples.len()).sum(),
    };
    if arguments.json {
        show::print_json(&report)?;
    } else {
        for file in &report.files {
            show::print(&file.display().to_string())?;
        }
    }
    Ok(exit::DONE)
}

/// Readings of a hinge tell nothing of a slide, and those of another door little.
fn of_the_object(task: &Task, file: &str, recording: &Recording) -> Result<(), Failure> {
    let header = &recording.header;
    if header.joint != task.joint.joint_type() {
        return Err(Failure::invalid(format!(
            "{file}: the recording is of a joint that is {}, that of `{}` is {}; give a recording of this object",
            joint_name(header.joint),
            task.name,
            joint_name(task.joint.joint_type())
        )));
    }
    if header.object != task.name {
        show::say(&format!(
            "warning: {file}: the recording is of `{}`, not of `{}`",
            header.object, task.name
        ));
    }
    Ok(())
}

fn written(arguments: &Arguments, name: &str, sheet: &str) -> Result<Vec<PathBuf>, Failure> {
    let cannot = |path: &PathBuf, error: &std::io::Error| {
        Failure::invalid(format!("cannot write {}: {error}", path.display()))
    };
    std::fs::create_dir_all(&arguments.out).map_err(|error| {
        Failure::invalid(format!(
            "cannot make the folder {}: {error}; name another with --out",
            arguments.out.display()
        ))
    })?;
    let mut files = Vec::new();
    for format in &arguments.format {
        let (ending, bytes) = match format {
            Format::Svg => ("svg", sheet.as_bytes().to_vec()),
            Format::Png => {
                let png = plot::png(sheet, PNG_SCALE).map_err(|error| Failure::fault(&error))?;
                ("png", png)
            }
        };
        let path = arguments.out.join(format!("{name}.{ending}"));
        std::fs::write(&path, bytes).map_err(|error| cannot(&path, &error))?;
        files.push(path);
    }
    Ok(files)
}
