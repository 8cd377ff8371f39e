//! Tables of pulls at hinged doors that somebody has measured: force against angle, no more.
//!
//! Two kinds of table are read. One has a row for each angle, with the columns `pull`, `angle_deg`
//! and `tangential_force_n`, and optionally `class`, `mechanism` and `agent`; a door is what one
//! agent pulled at one mechanism. The other is the log of a single pull with the columns
//! `angle_deg_fit` and `f_list_ati_tangential_N`; its door is named after the file.
//!
//! The samples of a pull stay in the order of the file, whatever stands between them: at rest an
//! angle goes to and fro.

use std::path::Path;

use crate::fault::Refused;
use crate::table::{Row, Table, of_file};

/// A door and the pulls at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Door {
    /// Mechanism and agent, or what there is of them, or the file's name.
    pub name: String,
    /// What kind of door, where the table says.
    pub class: Option<String>,
    /// In the order of the file.
    pub pulls: Vec<Pull>,
}

/// One pull.
#[derive(Debug, Clone, PartialEq)]
pub struct Pull {
    /// Its name in the table.
    pub label: String,
    /// Angle from closed, degrees, in the order of the file.
    pub angle_deg: Vec<f64>,
    /// Force along the motion, one for each angle, N.
    pub force_n: Vec<f64>,
}

/// Angle and force of the table of many doors, and of the log of one pull.
const DOORS: [&str; 2] = ["angle_deg", "tangential_force_n"];
const LOG: [&str; 2] = ["angle_deg_fit", "f_list_ati_tangential_N"];
const PULL: &str = "pull";

/// Reads the doors of a table, in the order of the file.
///
/// # Errors
/// Where the columns are not those of a table of pulls, there are no rows, or cells hold no finite
/// numbers: all of them, up to twenty.
pub fn read(file: &Path) -> Result<Vec<Door>, Refused> {
    let table = Table::read(file)?;
    let columns = Columns::of(&table)?;
    if table.rows.is_empty() {
        let found = "the table has no rows".to_owned();
        return Err(of_file(file, found, "at least one pull", "give a table with rows").into());
    }
    let mut refused = Refused::none();
    let mut doors = Vec::new();
    for row in &table.rows {
        let numbers = [columns.angle, columns.force].map(|position| {
            let number = row.number(position);
            if number.is_none() {
                let cure = "mend the cell, or take the row out";
                refused.push(table.cell_fault(row, position, "a finite number", cure));
            }
            number
        });
        if columns
            .pull
            .is_some_and(|position| row.cell(position).is_empty())
        {
            let cure = "give each row the number of its pull";
            let position = columns.pull.unwrap_or_default();
            refused.push(table.cell_fault(row, position, "the name of a pull", cure));
        }
        if let [Some(angle_deg), Some(force_n)] = numbers {
            let pull = columns.pull_of(row, &mut doors, file);
            pull.angle_deg.push(angle_deg);
            pull.force_n.push(force_n);
        }
    }
    refused.unless_at_fault(doors)
}

/// Where the columns of a table of pulls stand.
struct Columns {
    angle: usize,
    force: usize,
    /// `None` in a log, which is one pull.
    pull: Option<usize>,
    mechanism: Option<usize>,
    agent: Option<usize>,
    class: Option<usize>,
}

impl Columns {
    fn of(table: &Table) -> Result<Self, Refused> {
        let at = |name: &str| table.position(name);
        if let ([Some(angle), Some(force)], Some(pull)) = (DOORS.map(at), at(PULL)) {
            return Ok(Self {
                angle,
                force,
                pull: Some(pull),
                mechanism: at("mechanism"),
                agent: at("agent"),
                class: at("class"),
            });
        }
        if let [Some(angle), Some(force)] = LOG.map(at) {
            return Ok(Self {
                angle,
                force,
                pull: None,
                mechanism: None,
                agent: None,
                class: None,
            });
        }
        let found = format!("the columns are {}", table.columns.join(", "));
        let rule = format!(
            "{PULL}, {} (and class, mechanism, agent where there are any), or {} in the log of one pull",
            DOORS.join(", "),
            LOG.join(", ")
        );
        Err(of_file(
            &table.file,
            found,
            rule,
            "rename the columns; angles are degrees, forces newtons",
        )
        .into())
    }

    /// The pull that a row belongs to, which is added where it is new.
    fn pull_of<'d>(&self, row: &Row, doors: &'d mut Vec<Door>, file: &Path) -> &'d mut Pull {
        let text = |position: Option<usize>| {
            let cell = position.map(|position| row.cell(position));
            cell.filter(|cell| !cell.is_empty())
        };
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        let name = match (text(self.mechanism), text(self.agent)) {
            (Some(mechanism), Some(agent)) => format!("{mechanism} ({agent})"),
            (Some(mechanism), None) => mechanism.to_owned(),
            (None, Some(agent)) => format!("{stem} ({agent})"),
            (None, None) => stem.into_owned(),
        };
        let door = find_or_add(
            doors,
            |door| door.name == name,
            || Door {
                name: name.clone(),
                class: text(self.class).map(str::to_owned),
                pulls: Vec::new(),
            },
        );
        let label = text(self.pull).unwrap_or("0");
        find_or_add(
            &mut door.pulls,
            |pull| pull.label == label,
            || Pull {
                label: label.to_owned(),
                angle_deg: Vec::new(),
                force_n: Vec::new(),
            },
        )
    }
}

fn find_or_add<T>(list: &mut Vec<T>, is_it: impl Fn(&T) -> bool, new: impl Fn() -> T) -> &mut T {
    let position = list.iter().position(is_it).unwrap_or_else(|| {
        list.push(new());
        list.len() - 1
    });
    &mut list[position]
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::fs;
    use std::path::PathBuf;

    use super::*;

    fn read_text(text: &str) -> Result<Vec<Door>, Refused> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("kitchen.csv");
        fs::write(&file, text).unwrap();
        read(&file)
    }

    fn pull(label: &str, angle_deg: &[f64], force_n: &[f64]) -> Pull {
        Pull {
            label: label.to_owned(),
            angle_deg: angle_deg.to_vec(),
            force_n: force_n.to_vec(),
        }
    }

    #[test]
    fn a_door_is_a_mechanism_and_an_agent_and_samples_keep_their_order() {
        let doors = read_text(
            "agent,mechanism,class,pull,angle_deg,tangential_force_n\n\
             hook,m1,Fridge,0,0,25.5\nhook,m1,Fridge,1,0,24\npr2,m1,Fridge,0,2,9\n\
             hook,m1,Fridge,0,-1,14\nhook,m1,Fridge,0,0.5,6\n",
        )
        .unwrap();
        let class = Some("Fridge".to_owned());
        let expected = [
            Door {
                name: "m1 (hook)".to_owned(),
                class: class.clone(),
                pulls: vec![
                    pull("0", &[0.0, -1.0, 0.5], &[25.5, 14.0, 6.0]),
                    pull("1", &[0.0], &[24.0]),
                ],
            },
            Door {
                name: "m1 (pr2)".to_owned(),
                class,
                pulls: vec![pull("0", &[2.0], &[9.0])],
            },
        ];
        assert_eq!(doors, expected);
    }

    #[test]
    fn names_that_are_missing_are_made_of_what_there_is() {
        for (columns, cells, name, class) in [
            ("", "", "kitchen", None),
            ("mechanism,", "m1,", "m1", None),
            ("agent,", "hook,", "kitchen (hook)", None),
            ("class,mechanism,", "Freezer,m2,", "m2", Some("Freezer")),
            ("class,mechanism,", ",,", "kitchen", None),
        ] {
            let text = format!("{columns}pull,angle_deg,tangential_force_n\n{cells}7,1,2\n");
            let doors = read_text(&text).unwrap();
            assert_eq!(doors[0].name, name, "{columns}");
            assert_eq!(doors[0].class.as_deref(), class, "{columns}");
            assert_eq!(doors[0].pulls, [pull("7", &[1.0], &[2.0])], "{columns}");
        }
    }

    #[test]
    fn a_log_is_one_pull() {
        let text =
            "sample,f_list_ati_tangential_N,angle_deg_fit\n0,0.5,0\n1,0.25,0.02\n2,0.75,0.01\n";
        let doors = read_text(text).unwrap();
        let expected = Door {
            name: "kitchen".to_owned(),
            class: None,
            pulls: vec![pull("0", &[0.0, 0.02, 0.01], &[0.5, 0.25, 0.75])],
        };
        assert_eq!(doors, [expected]);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let accepted = "expected pull, angle_deg, tangential_force_n (and class, mechanism, agent where there are any), or angle_deg_fit, f_list_ati_tangential_N in the log of one pull";
        let cases: [(&str, &[&str]); 5] = [
            (
                "pull,angle,force_n\n0,1,2\n",
                &["the columns are pull, angle, force_n; ", accepted],
            ),
            ("angle_deg,tangential_force_n\n1,2\n", &[accepted]),
            (
                "pull,angle_deg,tangential_force_n\n",
                &["the table has no rows"],
            ),
            (
                "pull,angle_deg,tangential_force_n\n0,1,2\n0,x,nan\n",
                &[
                    "kitchen.csv: line 3, column angle_deg: found `x`; expected a finite number",
                    "kitchen.csv: line 3, column tangential_force_n: found `nan`",
                ],
            ),
            (
                "# remark\npull,angle_deg,tangential_force_n\n,1,2\n",
                &["line 3, column pull: the cell is empty; expected the name of a pull"],
            ),
        ];
        for (text, expected) in cases {
            let said = read_text(text).unwrap_err().to_string();
            for expected in expected {
                assert!(said.contains(expected), "`{said}` should say `{expected}`");
            }
        }
    }

    #[test]
    fn the_measured_doors_are_read() {
        let data = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
        let table = data.join("door_forces.csv");
        if !table.exists() {
            println!("skipped: no data");
            return;
        }
        let doors = read(&table).unwrap();
        let pulls: usize = doors.iter().map(|door| door.pulls.len()).sum();
        assert_eq!(pulls, 105);
        let first = &doors[0];
        assert_eq!(first.name, "fridge_01 (human_hook)");
        assert_eq!(first.class.as_deref(), Some("Fridge"));
        assert_eq!(first.pulls[0].force_n[..3], [25.3261, 14.2112, 6.1303]);
        for name in ["pr2_ikea_cabinet_log", "pr2_lab_cabinet_log"] {
            let doors = read(&data.join(format!("{name}.csv"))).unwrap();
            assert_eq!(doors.len(), 1, "{name}");
            assert_eq!(doors[0].name, name);
            let pull = &doors[0].pulls[0];
            assert!(
                pull.angle_deg.len() > 500,
                "{name}: {}",
                pull.angle_deg.len()
            );
            assert_eq!(pull.angle_deg.len(), pull.force_n.len(), "{name}");
        }
    }
}
