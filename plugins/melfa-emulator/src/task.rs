//! The task slot: a program, where it is, and whether it runs.

use std::collections::BTreeMap;
use std::net::IpAddr;

use crate::program::{Program, Statement};

/// Whether it runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Progress {
    /// At its beginning; another program may be selected.
    #[default]
    Ready,
    /// Running.
    Running,
    /// Stopped on the way; a start goes on from there.
    Interrupted,
}

/// Slot 1.
#[derive(Debug, Clone, Default)]
pub struct Task {
    /// Name of the program; empty where none is selected.
    pub name: String,
    /// The program as it was when it was selected.
    program: Program,
    /// Index of the line it is at.
    pub line: usize,
    /// Whether it runs.
    pub progress: Progress,
    /// It begins anew after its end.
    pub repeat: bool,
    /// It will stop at its end.
    pub cycle_stop: bool,
    /// Clients of the files that are open.
    pub files: BTreeMap<u8, IpAddr>,
}

impl Task {
    /// Empty, and repeating as a slot does unless a start says otherwise.
    pub fn new() -> Self {
        Self {
            repeat: true,
            ..Self::default()
        }
    }

    /// Puts a program into the slot, at its beginning.
    pub fn select(&mut self, name: &str, program: Program) {
        *self = Self {
            name: name.to_owned(),
            program,
            repeat: self.repeat,
            ..Self::default()
        };
    }

    /// Back to the beginning.
    pub fn reset(&mut self) {
        self.line = 0;
        self.progress = Progress::Ready;
        self.cycle_stop = false;
        self.files.clear();
    }

    /// Starts or goes on.
    pub fn start(&mut self, repeat: bool) {
        self.repeat = repeat;
        self.cycle_stop = false;
        self.progress = Progress::Running;
    }

    /// Stops where it is.
    pub fn interrupt(&mut self) {
        if self.progress == Progress::Running {
            self.progress = Progress::Interrupted;
        }
    }

    /// Whether it runs.
    pub fn is_running(&self) -> bool {
        self.progress == Progress::Running
    }

    /// What the line it is at does; at and past the end, `End`.
    pub fn statement(&self) -> Statement {
        self.program.statement(self.line).unwrap_or(Statement::End)
    }

    /// Goes to the next line.
    pub fn advance(&mut self) {
        self.line += 1;
    }

    /// Its end: from the beginning again, or stop.
    pub fn end(&mut self) {
        let again = self.repeat && !self.cycle_stop;
        self.reset();
        if again {
            self.progress = Progress::Running;
        }
    }
}
