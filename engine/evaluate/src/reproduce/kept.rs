//! Cells and heatmaps of a report, kept as one file beside it.
//!
//! A report that is committed without what it was made of could never be drawn again, and a cell
//! that is missing in it could not be added without making all others anew. So [`write()`] puts
//! every cell and heatmap on one line of JSON each, and [`unpack`] lays them into a folder of
//! results, from which the runner takes them as done. Their policies are not among them, but for
//! those that are kept as files.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::heatmap::Heatmap;
use super::results::{CELLS, HEATMAPS, Results};
use super::workshop::write_whole;

/// Name of the file beside a kept report.
pub const FILE: &str = "cells.jsonl";

/// A line of the file.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[expect(
    clippy::large_enum_variant,
    reason = "one at a time, and nearly all are cells"
)]
enum Line {
    Cell(Cell),
    Heatmap { id: String, heatmap: Heatmap },
}

/// Why kept cells cannot be written or taken.
#[derive(Debug, thiserror::Error)]
pub enum KeptError {
    /// The file cannot be had.
    #[error("cannot read the kept cells in {}: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The disk refused.
    #[error("cannot write {}: {source}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A line is no cell.
    #[error(
        "{}:{line}: not a cell of a reproduction: {reason}; take the file from its version control again, \
         or remove the line to have its cell made anew",
        file.display()
    )]
    Line {
        /// The file.
        file: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
}

/// Writes all cells and heatmaps to `cells.jsonl` in `folder`, in order of their ids.
///
/// # Errors
/// Where the disk refuses.
pub fn write(results: &Results, folder: &Path) -> Result<PathBuf, KeptError> {
    let cells = results.cells().map(|(_, cell)| {
        Line::Cell(Cell {
            without_policy: false,
            ..cell.clone()
        })
    });
    let heatmaps = results.heatmaps().map(|(id, heatmap)| Line::Heatmap {
        id: id.to_owned(),
        heatmap: heatmap.clone(),
    });
    let file = folder.join(FILE);
    lines(cells.chain(heatmaps))
        .and_then(|text| write_whole(&file, text.as_bytes()))
        .map_err(|source| KeptError::Write {
            file: file.clone(),
            source,
        })?;
    Ok(file)
}

fn lines(lines: impl Iterator<Item = Line>) -> std::io::Result<String> {
    let mut text = String::new();
    for line in lines {
        text += &serde_json::to_string(&line)?;
        text.push('\n');
    }
    Ok(text)
}

/// Lays the cells and heatmaps of `file` into the folder `results`, each marked as taken from a
/// kept report; what is stored there already stays. How many were laid.
///
/// # Errors
/// Where the file cannot be read, a line is no cell, or the disk refuses; nothing has been laid
/// then, but for the last case.
pub fn unpack(file: &Path, results: &Path) -> Result<usize, KeptError> {
    let text = std::fs::read_to_string(file).map_err(|source| KeptError::Read {
        file: file.to_owned(),
        source,
    })?;
    let mut stored = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let place = parsed(line).map_err(|reason| KeptError::Line {
            file: file.to_owned(),
            line: index + 1,
            reason,
        })?;
        stored.push(place);
    }
    let mut laid = 0;
    for (place, text) in stored {
        let path = results.join(place);
        if !path.exists() {
            write_whole(&path, text.as_bytes())
                .map_err(|source| KeptError::Write { file: path, source })?;
            laid += 1;
        }
    }
    Ok(laid)
}

/// Where a line belongs within a folder of results, and the file's text.
fn parsed(line: &str) -> Result<(PathBuf, String), String> {
    let (folder, id, text) = match serde_json::from_str(line).map_err(|error| error.to_string())? {
        Line::Cell(cell) => {
            let cell = Cell {
                without_policy: true,
                ..cell
            };
            (CELLS, cell.unit.id(), serde_json::to_string_pretty(&cell))
        }
        Line::Heatmap { id, heatmap } => (HEATMAPS, id, serde_json::to_string_pretty(&heatmap)),
    };
    let is_name = |letter: char| letter.is_ascii_alphanumeric() || "_-".contains(letter);
    if id.is_empty() || !id.chars().all(is_name) {
        return Err(format!("\"{id}\" names no file"));
    }
    let text = text.map_err(|error| error.to_string())?;
    Ok((Path::new(folder).join(format!("{id}.json")), text))
}
