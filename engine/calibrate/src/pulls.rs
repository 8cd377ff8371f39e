//! Tables of pulls of a door: force against angle, from other people's measurements.
//!
//! Two kinds of CSV are read, told apart by their columns:
//! many pulls of many doors (`mechanism, agent, pull, angle_deg, tangential_force_n`; `class` where
//! there is one; a door is a mechanism pulled by an agent), and the log of one pull with a wrist
//! sensor (`angle_deg_fit, f_list_ati_tangential_N`; the door is named after the file).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// One pull.
#[derive(Debug, Clone, PartialEq)]
pub struct Pull {
    /// Its name in the table.
    pub label: String,
    /// In the order of the file.
    pub angle_deg: Vec<f64>,
    /// Along the path of the handle, resistance positive, N.
    pub force_n: Vec<f64>,
}

/// A door with its pulls.
#[derive(Debug, Clone, PartialEq)]
pub struct Door {
    /// Mechanism and agent, or the name of the file.
    pub name: String,
    /// Kind of door, where the table says.
    pub class: Option<String>,
    /// In the order of the file.
    pub pulls: Vec<Pull>,
}

/// Why a table cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PullsError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {reason}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the operating system or the parser says.
        reason: String,
    },
    /// It is no table of pulls.
    #[error(
        "{}: its columns are {found}; expected {TABLE} (and class where there is one), or {LOG}",
        file.display()
    )]
    Columns {
        /// The file.
        file: PathBuf,
        /// What the first row says.
        found: String,
    },
    /// A cell is no number.
    #[error("{}: line {line}, column `{column}`: `{found}` is not a finite number; mend or remove that row", file.display())]
    Cell {
        /// The file.
        file: PathBuf,
        /// Line in the file, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// What stands there.
        found: String,
    },
    /// It has no rows.
    #[error("{}: there is no row below the names of the columns", file.display())]
    Empty {
        /// The file.
        file: PathBuf,
    },
}

const TABLE: &str = "mechanism, agent, pull, angle_deg, tangential_force_n";
const LOG: &str = "angle_deg_fit, f_list_ati_tangential_N";

/// Where what stands.
struct Columns {
    names: Vec<String>,
    angle: usize,
    force: usize,
    /// (mechanism, agent, pull); `None` for a log.
    keys: Option<[usize; 3]>,
    class: Option<usize>,
}

impl Columns {
    fn of(names: &csv::StringRecord) -> Option<Self> {
        let find = |name: &str| names.iter().position(|found| found.trim() == name);
        let all = |names: [&str; 2]| Some([find(names[0])?, find(names[1])?]);
        let keys = [find("mechanism"), find("agent"), find("pull")];
        let owned = names.iter().map(|name| name.trim().to_owned()).collect();
        if let ([Some(mechanism), Some(agent), Some(pull)], Some([angle, force])) =
            (keys, all(["angle_deg", "tangential_force_n"]))
        {
            return Some(Self {
                names: owned,
                angle,
                force,
                keys: Some([mechanism, agent, pull]),
                class: find("class"),
            });
        }
        let [angle, force] = all(["angle_deg_fit", "f_list_ati_tangential_N"])?;
        Some(Self {
            names: owned,
            angle,
            force,
            keys: None,
            class: None,
        })
    }
}

/// The doors of a table, in the order of their names.
///
/// # Errors
/// Where it cannot be read or a cell is not a number.
pub fn read(file: &Path) -> Result<Vec<Door>, PullsError> {
    let unreadable = |reason: String| PullsError::Read {
        file: file.to_owned(),
        reason,
    };
    let mut reader = csv::Reader::from_path(file).map_err(|error| unreadable(error.to_string()))?;
    let names = reader
        .headers()
        .map_err(|error| unreadable(error.to_string()))?
        .clone();
    let columns = Columns::of(&names).ok_or_else(|| PullsError::Columns {
        file: file.to_owned(),
        found: names.iter().collect::<Vec<_>>().join(", "),
    })?;
    let stem = file
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned());
    let mut doors: BTreeMap<String, Door> = BTreeMap::new();
    for row in reader.records() {
        let row = row.map_err(|error| unreadable(error.to_string()))?;
        let cell = |index: usize| row.get(index).unwrap_or_default().trim();
        let (name, label) = match columns.keys {
            Some([mechanism, agent, pull]) => (
                format!("{} {}", cell(mechanism), cell(agent)),
                cell(pull).to_owned(),
            ),
            None => (stem.clone().unwrap_or_default(), "0".to_owned()),
        };
        let number = |index: usize| -> Result<f64, PullsError> {
            let found = cell(index);
            let value: Option<f64> = found.parse().ok();
            value
                .filter(|value| value.is_finite())
                .ok_or_else(|| PullsError::Cell {
                    file: file.to_owned(),
                    line: row.position().map_or(0, csv::Position::line),
                    column: columns.names[index].clone(),
                    found: found.to_owned(),
                })
        };
        let (angle, force) = (number(columns.angle)?, number(columns.force)?);
        let door = doors.entry(name.clone()).or_insert_with(|| Door {
            name,
            class: columns.class.map(|index| cell(index).to_owned()),
            pulls: Vec::new(),
        });
        let pull = match door.pulls.iter_mut().find(|pull| pull.label == label) {
            Some(pull) => pull,
            None => {
                door.pulls.push(Pull {
                    label,
                    angle_deg: Vec::new(),
                    force_n: Vec::new(),
                });
                let last = door.pulls.len() - 1;
                &mut door.pulls[last]
            }
        };
        pull.angle_deg.push(angle);
        pull.force_n.push(force);
    }
    if doors.is_empty() {
        return Err(PullsError::Empty {
            file: file.to_owned(),
        });
    }
    Ok(doors.into_values().collect())
}
