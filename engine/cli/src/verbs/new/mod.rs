//! `pubs-engine new`: a commented object file from flags or a few questions.

mod dialogue;
mod draft;
mod measure;
mod question;
mod text;
mod write;

use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

use clap::Args;
use pubs_core::object::Faults;
use pubs_host::Registry;
use serde::Serialize;

use self::draft::Draft;
use self::question::Question;
use crate::failure::Failure;
use crate::options::PluginOptions;
use crate::{Ended, exit, show};

#[derive(Args)]
#[command(after_help = "\
Examples: pubs-engine new objects/cupboard.toml
          pubs-engine new objects/fridge.toml --joint revolute --limits 0deg,100deg --radius 50cm --opening -z --up +y --hinge -x --world fridge
          pubs-engine new objects/tray.toml --joint prismatic --limits 0cm,40cm --opening -z --up +x --driver melfa --param host=192.168.0.20
On a terminal, what no flag says is asked for. Lengths and angles come with their units, directions are axes of the tool at the \
moment of the grasp (-z) or three numbers (0.1,0,-1). No file is ever overwritten.")]
pub struct Arguments {
    /// Object file to write (.toml), or - for stdout
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Name of the object [default: that of the file]
    #[arg(long)]
    name: Option<String>,
    /// revolute (a hinge) or prismatic (a slide)
    #[arg(long)]
    joint: Option<String>,
    /// Closed and open limit, such as 0deg,110deg or 0cm,40cm
    #[arg(long, value_name = "CLOSED,OPEN", allow_hyphen_values = true)]
    limits: Option<String>,
    /// Hinge axis to handle, such as 40cm
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    radius: Option<String>,
    /// Where the handle goes when the object opens, in the tool's axes
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true)]
    opening: Option<String>,
    /// Up, in the tool's axes
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true)]
    up: Option<String>,
    /// From the handle towards the hinge axis, in the tool's axes
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true)]
    hinge: Option<String>,
    /// How near the goal is near enough, such as 8deg or 2cm [default: about a twelfth of the range]
    #[arg(long, value_name = "ANGLE|LENGTH", allow_hyphen_values = true)]
    tolerance: Option<String>,
    /// Driver plugin that moves the arm [default with --world: virtual-arm]
    #[arg(long, value_name = "PLUGIN")]
    driver: Option<String>,
    /// World of the virtual arm: what is true of the object, a built-in one or a .toml file
    #[arg(long, value_name = "WORLD")]
    world: Option<String>,
    /// Parameter of the driver, such as host=192.168.0.20
    #[arg(long = "param", value_name = "NAME=VALUE")]
    parameters: Vec<String>,
    #[command(flatten)]
    plugins: PluginOptions,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report<'a> {
    object: &'a Path,
    name: &'a str,
    /// The JSON Schema beside it, where it was not there before.
    schema_written: bool,
    next: [String; 3],
}

pub fn run(arguments: &Arguments) -> Ended {
    let to_stdout = arguments.file.as_os_str() == "-";
    if to_stdout && arguments.json {
        return Err(Failure::invalid(
            "`-` prints the object file itself; leave out --json, or name a file",
        ));
    }
    if !to_stdout {
        write::check_free(&arguments.file)?;
    }
    let registry = arguments.plugins.registry();
    let draft = complete(arguments, told(arguments, &registry)?, &registry)?;
    let faults = question::faults(&draft, &registry);
    if !faults.is_empty() {
        return Err(Failure::Faults(Faults(faults)));
    }
    let text = text::text(&draft, !to_stdout)?;
    if to_stdout {
        show::print(text.trim_end())?;
        return Ok(exit::DONE);
    }
    let schema_written = write::write(&arguments.file, &text)?;
    let report = Report {
        object: &arguments.file,
        name: draft.name(),
        schema_written,
        next: next(&arguments.file),
    };
    if arguments.json {
        show::print_json(&report)?;
    } else {
        show::print(&format!(
            "{}: written; next:\n  {}",
            arguments.file.display(),
            report.next.join("\n  ")
        ))?;
    }
    Ok(exit::DONE)
}

/// The draft as the flags say it, or all that is wrong with them.
fn told(arguments: &Arguments, registry: &Registry) -> Result<Draft, Failure> {
    let mut draft = Draft::default();
    let mut wrong = Vec::new();
    match name(arguments) {
        Ok(name) => draft.name = Some(name),
        Err(reason) => wrong.push(reason),
    }
    for (question, answer) in flags(arguments, &mut wrong) {
        match question.answer(&draft, &answer, registry) {
            Ok(with_it) => draft = with_it,
            Err(reason) => wrong.push(format!("{}: {reason}", question.flag())),
        }
    }
    let hinge_flags = [
        ("--radius", &arguments.radius),
        ("--hinge", &arguments.hinge),
    ];
    for (flag, given) in hinge_flags {
        if given.is_some() && draft.joint == Some(draft::Joint::Prismatic) {
            wrong.push(format!("{flag}: a slide has no hinge; leave it out"));
        }
    }
    if wrong.is_empty() {
        return Ok(draft);
    }
    Err(Failure::each(wrong.join("\n")))
}

/// `--name`, or the file's.
fn name(arguments: &Arguments) -> Result<String, String> {
    let of_file = arguments.file.file_stem().and_then(|stem| stem.to_str());
    let name = arguments.name.as_deref().or(of_file).unwrap_or_default();
    let fits = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
    if !name.is_empty() && name != "-" && name.chars().all(fits) {
        return Ok(name.to_owned());
    }
    Err(format!(
        "--name: `{name}` is not a name for an object: give one of letters, digits, `_` and `-`"
    ))
}

/// What the flags answer, in the order of the questions.
fn flags(arguments: &Arguments, wrong: &mut Vec<String>) -> Vec<(Question, String)> {
    let driver = arguments
        .driver
        .clone()
        .or_else(|| arguments.world.is_some().then(|| "virtual-arm".to_owned()));
    let given = [
        (Question::Joint, arguments.joint.clone()),
        (Question::Limits, arguments.limits.clone()),
        (Question::Radius, arguments.radius.clone()),
        (Question::Opening, arguments.opening.clone()),
        (Question::Up, arguments.up.clone()),
        (Question::Hinge, arguments.hinge.clone()),
        (Question::Tolerance, arguments.tolerance.clone()),
        (Question::Driver, driver),
        (
            Question::Parameter("world".to_owned()),
            arguments.world.clone(),
        ),
    ];
    let mut flags: Vec<(Question, String)> = given
        .into_iter()
        .filter_map(|(question, answer)| Some((question, answer?)))
        .collect();
    for parameter in &arguments.parameters {
        match parameter.split_once('=') {
            Some((name, value)) => {
                flags.push((Question::Parameter(name.to_owned()), value.to_owned()));
            }
            None => wrong.push(format!(
                "--param: `{parameter}` sets nothing; write NAME=VALUE"
            )),
        }
    }
    flags
}

/// Asks for the rest where somebody is there to answer.
fn complete(arguments: &Arguments, draft: Draft, registry: &Registry) -> Result<Draft, Failure> {
    let missing: Vec<String> = Question::of(&draft, registry)
        .into_iter()
        .filter(|question| !question.is_answered(&draft) && !question.is_optional())
        .map(|question| missing_flag(&question, &draft))
        .collect();
    if missing.is_empty() {
        return Ok(draft);
    }
    if !io::stdin().is_terminal() || !io::stderr().is_terminal() {
        return Err(Failure::invalid(format!(
            "nobody can be asked here (no terminal), and these are missing: {}\n  (`pubs-engine new --help` has examples)",
            missing.join(", ")
        )));
    }
    show::note(&format!(
        "A few questions about {}; Enter takes what stands in brackets.",
        arguments.file.display()
    ));
    let answered = dialogue::ask(
        draft,
        registry,
        &mut io::stdin().lock(),
        &mut io::stderr().lock(),
    );
    answered.map_err(|error| Failure::invalid(error.to_string()))
}

fn missing_flag(question: &Question, draft: &Draft) -> String {
    match question {
        Question::Radius | Question::Hinge if draft.joint.is_none() => {
            format!("{} (of a hinge)", question.flag())
        }
        Question::Driver => "--world (of the virtual arm) or --driver".to_owned(),
        _ => question.flag(),
    }
}

/// What follows, to be copied into a shell.
fn next(file: &Path) -> [String; 3] {
    let file = quoted(&file.display().to_string());
    [
        format!("pubs-engine calibrate {file}"),
        format!("pubs-engine train {file}"),
        format!("pubs-engine run {file} --goal 0.5"),
    ]
}

/// In quotes where a shell would take it apart.
fn quoted(text: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || "/._-".contains(letter);
    if text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}
