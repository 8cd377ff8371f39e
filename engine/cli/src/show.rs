//! Results go to stdout, talk to stderr.

use std::io::{self, IsTerminal, Write};
use std::sync::OnceLock;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;

use crate::failure::Failure;

/// How much the program talks; results and faults are not talk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Talk {
    /// Warnings, and what a user has to know to go on.
    Quiet,
    /// Notes and progress beside.
    Usual,
    /// What was read from where, too.
    Verbose,
}

static TALK: OnceLock<Talk> = OnceLock::new();

/// Chooses how much to talk, once, before anything is said.
pub fn choose(talk: Talk) {
    TALK.get_or_init(|| talk);
}

fn talks(least: Talk) -> bool {
    *TALK.get().unwrap_or(&Talk::Usual) >= least
}

/// Writes a result. A reader that has gone away is no error.
///
/// # Errors
/// Where stdout cannot be written for another reason.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    let result = out
        .write_all(text.as_bytes())
        .and_then(|()| out.write_all(b"\n"))
        .and_then(|()| out.flush());
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::fault(&error)),
        _ => Ok(()),
    }
}

/// Writes one JSON object as the result.
///
/// # Errors
/// As [`print()`].
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    print(&serde_json::to_string(value).map_err(|error| Failure::fault(&error))?)
}

/// Says what has to be heard, `--quiet` or not: faults, warnings, where a live view is. Nobody
/// listening is no error.
pub fn say(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Says what is good to know, unless `--quiet`.
pub fn note(text: &str) {
    if talks(Talk::Usual) {
        say(text);
    }
}

/// Says what is read from where, where `--verbose` asks for it.
pub fn detail(text: impl FnOnce() -> String) {
    if talks(Talk::Verbose) {
        say(&text());
    }
}

/// A bar of progress on a terminal, unless `--quiet`.
pub fn bar(length: u64, template: &str) -> ProgressBar {
    styled(ProgressBar::new(length), template)
}

/// A line of status on a terminal, unless `--quiet`.
pub fn status_line() -> ProgressBar {
    let line = styled(ProgressBar::new_spinner(), "{spinner} {msg}");
    line.enable_steady_tick(Duration::from_millis(200));
    line
}

fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    if !talks(Talk::Usual) {
        return ProgressBar::hidden();
    }
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// Whether stdout is a terminal that wants colours.
pub fn color_on_stdout() -> bool {
    io::stdout().is_terminal() && wants_color()
}

/// Whether stderr is a terminal that wants colours.
pub fn color_on_stderr() -> bool {
    io::stderr().is_terminal() && wants_color()
}

/// As <https://no-color.org> and <https://bixense.com/clicolors> ask for.
fn wants_color() -> bool {
    let is = |name: &str, value: &str| std::env::var_os(name).is_some_and(|own| own == value);
    let no_color = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    !no_color && !is("CLICOLOR", "0") && !is("TERM", "dumb")
}
