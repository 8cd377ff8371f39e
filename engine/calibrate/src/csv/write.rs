//! Writing a recording as a table.

use std::fs::File;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

use pubs_run::clock::SECOND_NS;
use pubs_run::recording::{Done, Frame, Recording, status_name};

use crate::column::Column;
use crate::fault::Refused;
use crate::table::of_file;

/// Writes `recording` to `file`, which must not exist yet.
///
/// # Errors
/// Where the file exists already or cannot be written.
pub fn write(file: &Path, recording: &Recording) -> Result<(), Refused> {
    let written = File::options()
        .write(true)
        .create_new(true)
        .open(file)
        .and_then(|opened| write_to(BufWriter::new(opened), recording));
    written.map_err(|error| {
        if error.kind() == ErrorKind::AlreadyExists {
            let found = "this file exists".to_owned();
            return of_file(
                file,
                found,
                "a new one",
                "choose another name, or remove it first",
            )
            .into();
        }
        let found = format!("cannot be written: {error}");
        of_file(file, found, "a place with room", "choose another place").into()
    })
}

fn write_to(mut out: impl Write, recording: &Recording) -> io::Result<()> {
    let header = &recording.header;
    for (key, value) in header.to_fields() {
        writeln!(out, "# {key} = {value}")?;
    }
    if !recording.done.is_empty() {
        writeln!(out, "# done = {}", done_text(&recording.done)?)?;
    }
    if let Some(loss) = &recording.loss {
        writeln!(out, "# loss = {}", serde_json::to_string(loss)?)?;
    }
    let mut table = ::csv::Writer::from_writer(out);
    table.write_record(Column::ALL.map(Column::name))?;
    for frame in &recording.frames {
        let action = header.actions.get(frame.action).map_or("", String::as_str);
        table.write_record(Column::ALL.map(|column| cell(column, frame, action)))?;
    }
    table.flush()
}

fn cell(column: Column, frame: &Frame, action: &str) -> String {
    match column {
        Column::Time => {
            let time_ns = frame.reading.time_ns;
            format!("{}.{:09}", time_ns / SECOND_NS, time_ns % SECOND_NS)
        }
        Column::Action => action.to_owned(),
        Column::Demonstration => frame.demonstration.to_string(),
        Column::Settled => frame.settled.to_string(),
        Column::Status => status_name(frame.reading.status).to_owned(),
        _ => column
            .number(frame)
            .map_or(String::new(), |number| format!("{number:?}")),
    }
}

/// "safe_open 1, safe_open 2"; JSON where a name has a comma or begins as JSON does.
fn done_text(done: &[Done]) -> io::Result<String> {
    let awkward = |done: &Done| {
        let name = &done.action;
        name.contains(|letter: char| letter == ',' || letter.is_control())
            || name.starts_with('[')
            || name.trim() != name
    };
    if done.iter().any(awkward) {
        return Ok(serde_json::to_string(done)?);
    }
    let one = |done: &Done| format!("{} {}", done.action, done.demonstration);
    Ok(done.iter().map(one).collect::<Vec<_>>().join(", "))
}
