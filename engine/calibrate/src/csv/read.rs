//! Reading a recording from a table.

use std::path::Path;

use pubs_plugin::Reading;
use pubs_run::clock::SECOND_NS;
use pubs_run::recording::{Done, Frame, Header, Recording, status_named};

use crate::column::Column;
use crate::fault::{Fault, Place, Refused, nearest};
use crate::source::Source;
use crate::table::{Row, Table, of_file};

/// Reads a recording from a table, with the line of each frame.
///
/// # Errors
/// Every line and column that is missing and every cell that cannot be used, up to twenty.
pub fn read(file: &Path) -> Result<(Recording, Source), Refused> {
    let table = Table::read(file)?;
    let header = header(&table)?;
    let columns = columns(&table)?;
    let mut refused = Refused::none();
    let done = done(&table, &header.actions, &mut refused);
    let mut frames = Vec::with_capacity(table.rows.len());
    for row in &table.rows {
        frames.push(frame(&table, row, &columns, &header.actions, &mut refused));
    }
    let recording = Recording {
        loss: loss(&table),
        header,
        frames,
        done,
    };
    let lines = table.rows.iter().map(|row| row.line).collect();
    refused.unless_at_fault((recording, Source::csv(file, lines)))
}

fn header(table: &Table) -> Result<Header, Refused> {
    let text = |key: &str| table.comment(key).map(|comment| comment.value.as_str());
    Header::from_fields(text).map_err(|faults| {
        let mut refused = Refused::none();
        for fault in faults {
            let line = format!("# {} = {}", fault.key, fault.example);
            refused.push(Fault {
                file: table.file.clone(),
                place: Place::Comment {
                    key: fault.key.to_owned(),
                    line: table.comment(fault.key).map(|comment| comment.line),
                },
                cure: match fault.found {
                    None => format!("add a line such as `{line}` at the top"),
                    Some(_) => format!("write a line such as `{line}`"),
                },
                found: match fault.found {
                    None => "this line is missing".to_owned(),
                    Some(found) => format!("found `{found}`"),
                },
                rule: fault.rule,
            });
        }
        refused
    })
}

/// Each known column with its position in the table.
fn columns(table: &Table) -> Result<Vec<(Column, usize)>, Refused> {
    let known = Column::ALL.map(Column::name);
    let strangers = || {
        let names = table.columns.iter().map(String::as_str);
        names.filter(|name| !known.contains(name))
    };
    let mut refused = Refused::none();
    let mut found = Vec::new();
    for column in Column::ALL {
        let name = column.name();
        match table.position(name) {
            Some(position) => found.push((column, position)),
            None if column == Column::Truth => {}
            None => refused.push(of_file(
                &table.file,
                format!("the column `{name}` is missing"),
                format!("the columns {}", known.join(", ")),
                match nearest(name, strangers()) {
                    Some(alike) => format!("is `{alike}` meant? Rename it to `{name}`"),
                    None => format!("add a column `{name}`"),
                },
            )),
        }
    }
    refused.unless_at_fault(found)
}

/// The frame of a row; where a cell cannot be used, `refused` says so and the frame is void.
fn frame(
    table: &Table,
    row: &Row,
    columns: &[(Column, usize)],
    actions: &[String],
    refused: &mut Refused,
) -> Frame {
    let mut frame = Frame {
        reading: Reading::default(),
        action: 0,
        demonstration: 0,
        speed_m_s: 0.0,
        settled: false,
        truth: None,
    };
    for &(column, position) in columns {
        if set(&mut frame, column, row, position, actions).is_none() {
            let (rule, cure) = rule(column, actions);
            refused.push(table.cell_fault(row, position, &rule, cure));
        }
    }
    frame
}

fn set(
    frame: &mut Frame,
    column: Column,
    row: &Row,
    position: usize,
    actions: &[String],
) -> Option<()> {
    let cell = row.cell(position);
    match column {
        Column::Time => frame.reading.time_ns = time_ns(cell)?,
        Column::Action => frame.action = actions.iter().position(|action| action == cell)?,
        Column::Demonstration => frame.demonstration = cell.parse().ok()?,
        Column::Settled => frame.settled = flag(cell)?,
        Column::Status => frame.reading.status = status_named(cell)?,
        Column::Truth if cell.is_empty() => frame.truth = None,
        Column::Truth => frame.truth = Some(row.number(position)?),
        _ => *column.number_mut(frame)? = row.number(position)?,
    }
    Some(())
}

fn rule(column: Column, actions: &[String]) -> (String, &'static str) {
    let mend = "mend the cell, or take the row out";
    match column {
        Column::Time => ("seconds from 0 on, such as 12.340000000".to_owned(), mend),
        Column::Action => (
            format!("one of `# actions`: {}", actions.join(", ")),
            "mend the cell, or add the action to `# actions`",
        ),
        Column::Demonstration => ("a whole number; 0 where there is none".to_owned(), mend),
        Column::Settled => ("true or false".to_owned(), mend),
        Column::Status => ("ready, stopped or fault".to_owned(), mend),
        Column::Truth => (
            "a finite number, or nothing".to_owned(),
            "empty the cell where nobody knows the true state",
        ),
        _ => ("a finite number".to_owned(), mend),
    }
}

fn flag(cell: &str) -> Option<bool> {
    match cell.to_ascii_lowercase().as_str() {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}

/// Nanoseconds of a time in seconds: exactly where it has at most nine decimals, as
/// [`write`](super::write) gives it, else to the nearest.
pub(super) fn time_ns(cell: &str) -> Option<u64> {
    const DECIMALS: usize = 9;
    let (whole, decimals) = cell.split_once('.').unwrap_or((cell, ""));
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    if !whole.is_empty() && digits(whole) && digits(decimals) && decimals.len() <= DECIMALS {
        let part: u64 = format!("{decimals:0<DECIMALS$}").parse().ok()?;
        let whole: u64 = whole.parse().ok()?;
        return whole.checked_mul(SECOND_NS)?.checked_add(part);
    }
    let time_ns = (cell.parse::<f64>().ok()? * SECOND_NS as f64).round();
    (0.0..u64::MAX as f64)
        .contains(&time_ns)
        .then_some(time_ns as u64)
}

fn done(table: &Table, actions: &[String], refused: &mut Refused) -> Vec<Done> {
    let Some(comment) = table.comment("done") else {
        return Vec::new();
    };
    let known = |done: &Done| actions.contains(&done.action);
    let done = done_list(&comment.value).filter(|done| done.iter().all(known));
    done.unwrap_or_else(|| {
        refused.push(Fault {
            file: table.file.clone(),
            place: Place::Comment {
                key: comment.key.clone(),
                line: Some(comment.line),
            },
            found: format!("found `{}`", comment.value),
            rule: format!(
                "an action of `# actions` ({}) and a number for each demonstration that was carried out to its end",
                actions.join(", ")
            ),
            cure: "write a line such as `# done = safe_open 1, safe_open 2`".to_owned(),
        });
        Vec::new()
    })
}

fn done_list(text: &str) -> Option<Vec<Done>> {
    if text.starts_with('[') {
        return serde_json::from_str(text).ok();
    }
    let one = |entry: &str| {
        let (action, number) = entry.trim().rsplit_once(' ')?;
        Some(Done {
            action: action.trim().to_owned(),
            demonstration: number.parse().ok()?,
        })
    };
    text.split(',').map(one).collect()
}

fn loss(table: &Table) -> Option<String> {
    let text = &table.comment("loss")?.value;
    Some(serde_json::from_str(text).unwrap_or_else(|_| text.clone()))
}
