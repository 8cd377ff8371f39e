//! A results folder, read.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::cell::{Cell, Unit};
use super::heatmap::Heatmap;

/// Folder of the cells within a results folder.
pub const CELLS: &str = "cells";
/// Folder of the heatmaps within a results folder.
pub const HEATMAPS: &str = "heatmaps";
/// Folder of the policies within a results folder.
pub const POLICIES: &str = "policies";

/// The cells and heatmaps of a results folder.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Results {
    cells: BTreeMap<String, Cell>,
    heatmaps: BTreeMap<String, Heatmap>,
    notices: Vec<Notice>,
}

/// A file that was passed over.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// The file.
    pub file: PathBuf,
    /// Why.
    pub reason: String,
}

/// Why a folder cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// The system refused.
    #[error("cannot read the results in {}: {source}", folder.display())]
    Read {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

impl Results {
    /// Reads `cells/*.json` and `heatmaps/*.json`. A folder that is not there has no cells; a file
    /// that is damaged, or is not what its name says, is passed over and named in
    /// [`Results::notices`].
    ///
    /// # Errors
    /// Where a folder is there and cannot be read.
    pub fn read(folder: &Path) -> Result<Self, ResultsError> {
        let mut results = Self::default();
        for (id, file) in files(&folder.join(CELLS))? {
            match parsed(&file).and_then(|cell| checked(cell, &id)) {
                Ok(cell) => _ = results.cells.insert(id, cell),
                Err(reason) => results.notices.push(Notice { file, reason }),
            }
        }
        for (id, file) in files(&folder.join(HEATMAPS))? {
            match parsed::<Heatmap>(&file).and_then(Heatmap::checked) {
                Ok(heatmap) => _ = results.heatmaps.insert(id, heatmap),
                Err(reason) => results.notices.push(Notice { file, reason }),
            }
        }
        Ok(results)
    }

    /// The cell with the unit's id, if it has been run.
    pub fn cell(&self, unit: &Unit) -> Option<&Cell> {
        self.cells.get(&unit.id())
    }

    /// All cells, in order of their ids.
    pub fn cells(&self) -> impl Iterator<Item = (&str, &Cell)> {
        self.cells.iter().map(|(id, cell)| (id.as_str(), cell))
    }

    /// The heatmap with this id: its file name without the extension.
    pub fn heatmap(&self, id: &str) -> Option<&Heatmap> {
        self.heatmaps.get(id)
    }

    /// All heatmaps, in order of their ids.
    pub fn heatmaps(&self) -> impl Iterator<Item = (&str, &Heatmap)> {
        self.heatmaps
            .iter()
            .map(|(id, heatmap)| (id.as_str(), heatmap))
    }

    /// Files that were passed over.
    pub fn notices(&self) -> &[Notice] {
        &self.notices
    }
}

/// JSON files of a folder with their names less the extension, in order; of a folder that is not
/// there none.
fn files(folder: &Path) -> Result<Vec<(String, PathBuf)>, ResultsError> {
    let failed = |source| ResultsError::Read {
        folder: folder.to_owned(),
        source,
    };
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(failed)?,
    };
    let mut files = Vec::new();
    for entry in entries {
        let file = entry.map_err(failed)?.path();
        let json = file.extension().is_some_and(|end| end == "json");
        let id = file.file_stem().and_then(|stem| stem.to_str());
        if let Some(id) = id.filter(|_| json) {
            files.push((id.to_owned(), file.clone()));
        }
    }
    files.sort();
    Ok(files)
}

fn parsed<T: DeserializeOwned>(file: &Path) -> Result<T, String> {
    let text = std::fs::read_to_string(file).map_err(|error| error.to_string())?;
    serde_json::from_str(&text).map_err(|error| error.to_string())
}

fn checked(cell: Cell, id: &str) -> Result<Cell, String> {
    let named = cell.unit.id();
    if named != id {
        return Err(format!("its name says \"{id}\", its contents \"{named}\""));
    }
    if !cell.result.is_of(&cell.unit) {
        return Err("its result is of another kind than its unit".to_owned());
    }
    Ok(cell)
}
