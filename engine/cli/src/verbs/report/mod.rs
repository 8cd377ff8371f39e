//! `pubs-engine report`: one page on a run, a training, an evaluation or a calibration.

mod calibration;
mod evaluation;
mod input;
mod run;
mod training;

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use pubs_draw::document::Block;
use serde::Serialize;

use crate::failure::Failure;
use crate::options::{PluginOptions, RuntimeOptions};
use crate::{Ended, exit, show};
use input::{Input, Kind};

#[derive(Args)]
#[command(after_help = "\
Examples: pubs-engine report recordings/door2-20261124T171750Z.mcap
          pubs-engine report policies/door2.onnx --out door2.html
          pubs-engine evaluate policies/door2.onnx --json | pubs-engine report -
          pubs-engine report recordings/door2-calibration.mcap
The page is one HTML file without scripts that needs nothing beside it. Exits with 3 where the input lacks data; the page says what is missing.")]
pub struct Arguments {
    /// Recording of a run or of a calibration (.mcap), policy (.onnx), what `evaluate --json` has
    /// printed (`-`: from stdin), or a calibrated object file (.toml)
    #[arg(value_name = "INPUT")]
    input: PathBuf,
    /// Write the page here [default: NAME.report.html beside the input]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace a page that is there already
    #[arg(long)]
    overwrite: bool,
    /// Object file of a calibration's recording [default: objects/OBJECT.toml beside its folder; else the
    /// one in the recording]
    #[arg(long, value_name = "FILE")]
    object: Option<PathBuf>,
    #[command(flatten)]
    plugins: PluginOptions,
    #[command(flatten)]
    runtime: RuntimeOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// A page, and what is to be said of it.
struct Page {
    blocks: Vec<Block>,
    /// What the input lacks, in words.
    missing: Vec<String>,
}

#[derive(Serialize)]
struct Report<'a> {
    report: &'a Path,
    kind: Kind,
    missing: &'a [String],
}

pub fn run(arguments: &Arguments) -> Ended {
    let out = out(arguments);
    if out.exists() && !arguments.overwrite {
        return Err(exists(&out));
    }
    let input = input::read(&arguments.input)?;
    let kind = input.kind();
    let page = page(arguments, input)?;
    for missing in &page.missing {
        show::say(&format!(
            "warning: {}: {missing}",
            arguments.input.display()
        ));
    }
    write(arguments, &out, &pubs_draw::html(&page.blocks))?;
    if arguments.json {
        show::print_json(&Report {
            report: &out,
            kind,
            missing: &page.missing,
        })?;
    } else {
        show::print(&out.display().to_string())?;
    }
    Ok(if page.missing.is_empty() {
        exit::DONE
    } else {
        exit::MISSED
    })
}

fn page(arguments: &Arguments, input: Input) -> Result<Page, Failure> {
    let is_recording = matches!(input, Input::CalibrationRecording(_));
    if arguments.object.is_some() && !is_recording {
        return Err(Failure::invalid(
            "--object is for the recording of a calibration; other inputs say themselves what they are about",
        ));
    }
    match input {
        Input::Run(recording) => run::page(arguments, &recording),
        Input::Policy(file) => training::page(arguments, &file),
        Input::Evaluation { text, judged } => evaluation::page(arguments, &text, &judged),
        Input::CalibrationRecording(recording) => calibration::of_recording(arguments, *recording),
        Input::Object(loaded) => calibration::of_object(arguments, *loaded),
    }
}

/// Where the page goes.
fn out(arguments: &Arguments) -> PathBuf {
    let beside = || {
        if input::is_stdin(&arguments.input) {
            return PathBuf::from("evaluation.report.html");
        }
        arguments.input.with_extension("report.html")
    };
    arguments.out.clone().unwrap_or_else(beside)
}

fn exists(out: &Path) -> Failure {
    Failure::invalid(format!(
        "{} exists; --overwrite replaces it, --out FILE writes elsewhere",
        out.display()
    ))
}

fn write(arguments: &Arguments, out: &Path, text: &str) -> Result<(), Failure> {
    let same = |other: &Path| other.canonicalize().ok() == out.canonicalize().ok();
    if out.exists() && same(&arguments.input) {
        return Err(Failure::invalid(format!(
            "{} is the input itself; name another file with --out",
            out.display()
        )));
    }
    let mut options = OpenOptions::new();
    if arguments.overwrite {
        options.create(true).truncate(true);
    } else {
        options.create_new(true);
    }
    let written = options
        .write(true)
        .open(out)
        .and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => exists(out),
        _ => Failure::invalid(format!(
            "cannot write {}: {error} (--out FILE writes elsewhere)",
            out.display()
        )),
    })
}
