//! `pubs-engine completions`: what a shell needs to complete verbs and options.

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use crate::{Ended, Program, exit, show};

#[derive(Args)]
#[command(after_help = "\
Examples: pubs-engine completions bash > ~/.local/share/bash-completion/completions/pubs-engine
          pubs-engine completions fish > ~/.config/fish/completions/pubs-engine.fish
For zsh, write it as _pubs-engine into a folder of $fpath.")]
pub struct Arguments {
    /// Which shell
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Ended {
    let mut text = Vec::new();
    let mut command = Program::command();
    clap_complete::generate(arguments.shell, &mut command, "pubs-engine", &mut text);
    show::print(String::from_utf8_lossy(&text).trim_end())?;
    Ok(exit::DONE)
}
