//! `pubs-engine man`: the manual, from the same words as `--help`.

use std::path::{Path, PathBuf};

use clap::{Args, Command, CommandFactory};
use clap_mangen::Man;

use crate::failure::Failure;
use crate::{Ended, Program, exit, show};

#[derive(Args)]
#[command(after_help = "\
Examples: pubs-engine man | man -l -
          pubs-engine man --out ~/.local/share/man/man1")]
pub struct Arguments {
    /// Write a page for the program and one for each verb into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Ended {
    // Names of verbs become those of their pages: `pubs-engine-run`.
    let mut program = Program::command();
    program.build();
    match &arguments.out {
        None => show::print(page(&program)?.trim_end())?,
        Some(folder) => {
            std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
            write(folder, &program)?;
        }
    }
    Ok(exit::DONE)
}

fn page(command: &Command) -> Result<String, Failure> {
    let mut text = Vec::new();
    Man::new(command.clone())
        .render(&mut text)
        .map_err(|error| Failure::fault(&error))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// Pages of a command and of all below it.
fn write(folder: &Path, command: &Command) -> Result<(), Failure> {
    let name = command.get_display_name().unwrap_or(command.get_name());
    let file = folder.join(format!("{name}.1"));
    std::fs::write(&file, page(command)?).map_err(|error| unwritable(&file, &error))?;
    show::print(&file.display().to_string())?;
    let below = command
        .get_subcommands()
        .filter(|verb| verb.get_name() != "help");
    below.into_iter().try_for_each(|verb| write(folder, verb))
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::invalid(format!(
        "cannot write {}: {error}\n  (--out DIR writes elsewhere)",
        path.display()
    ))
}
