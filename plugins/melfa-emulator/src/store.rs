//! The controller's programs, and the one open for editing.

use std::collections::BTreeMap;

use crate::alarm::Refusal;
use crate::program::Program;

/// Between the lines of an upload.
const VERTICAL_TAB: char = '\u{b}';

#[derive(Debug, Clone)]
struct Edit {
    name: String,
    text: Vec<String>,
}

/// Programs by name. Case does not matter in names.
#[derive(Debug, Clone, Default)]
pub struct Store {
    programs: BTreeMap<String, Program>,
    edit: Option<Edit>,
}

impl Store {
    /// Puts a program in.
    pub fn insert(&mut self, name: &str, program: Program) {
        self.programs.insert(key(name), program);
    }

    /// The program of this name.
    pub fn get(&self, name: &str) -> Option<&Program> {
        self.programs.get(&key(name))
    }

    /// `NEW`: nothing is open for editing any more.
    pub fn close_edit(&mut self) {
        self.edit = None;
    }

    /// `LOAD=`: opens a program for editing, a new one where there is none.
    pub fn open_edit(&mut self, name: &str) -> Result<(), Refusal> {
        if name.is_empty() {
            return Err(Refusal::BadArgument);
        }
        let text = self.get(name).map(|program| program.lines.clone());
        self.edit = Some(Edit {
            name: name.to_owned(),
            text: text.unwrap_or_default(),
        });
        Ok(())
    }

    /// `ECLR`: empties the open program.
    pub fn clear_edit(&mut self) -> Result<(), Refusal> {
        self.edited()?.text.clear();
        Ok(())
    }

    /// `EMDAT`: adds lines to the open program.
    pub fn add_lines(&mut self, lines: &str) -> Result<(), Refusal> {
        let lines = lines.split([VERTICAL_TAB, '\r', '\n']);
        let lines = lines.filter(|line| !line.trim().is_empty());
        let edit = self.edited()?;
        edit.text.extend(lines.map(str::to_owned));
        Ok(())
    }

    /// `SAVE`: the open program takes its place.
    pub fn save_edit(&mut self) -> Result<(), Refusal> {
        let Edit { name, text } = self.edited()?.clone();
        let program = Program::from_lines(text.iter().map(String::as_str));
        self.insert(&name, program);
        Ok(())
    }

    fn edited(&mut self) -> Result<&mut Edit, Refusal> {
        self.edit.as_mut().ok_or(Refusal::NoEdit)
    }
}

fn key(name: &str) -> String {
    name.trim().to_ascii_uppercase()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn upload_in_parts_replaces_what_was_there() {
        let mut store = Store::default();
        store.insert("PUBS", Program::from_lines(["Hlt"].into_iter()));
        store.open_edit("pubs").unwrap();
        store.clear_edit().unwrap();
        store
            .add_lines("1 Open \"ENET:127.0.0.1\" As #1\u{b}2 Mxt 1,0,10")
            .unwrap();
        store.add_lines("3 Hlt\u{b}4 End\u{b}").unwrap();
        assert_eq!(store.get("PUBS").unwrap().lines, ["Hlt"], "not saved yet");
        store.save_edit().unwrap();
        let lines = &store.get("PUBS").unwrap().lines;
        assert_eq!(lines[1..], ["Mxt 1,0,10", "Hlt", "End"]);
    }

    #[test]
    fn without_an_open_program_there_is_nothing_to_edit() {
        let mut store = Store::default();
        assert_eq!(store.clear_edit(), Err(Refusal::NoEdit));
        assert_eq!(store.add_lines("Hlt"), Err(Refusal::NoEdit));
        store.open_edit("A").unwrap();
        store.close_edit();
        assert_eq!(store.save_edit(), Err(Refusal::NoEdit));
        assert_eq!(store.open_edit(""), Err(Refusal::BadArgument));
    }
}
