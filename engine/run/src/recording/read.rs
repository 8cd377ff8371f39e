//! Reading a recording back, whole or what is left of it.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use mcap::MAGIC;

use super::join::{Joined, join};
use super::records::{Contents, End, contents};
use super::topic::Topic;
use super::write::OBJECT_ATTACHMENT;
use super::{FORMAT_VERSION, Header, METADATA, RUN_FORMAT_VERSION, Recording, RecordingError};

/// Reads a recording. Of a file that is cut off or damaged everything readable is returned, and
/// [`Recording::loss`] says what is missing.
///
/// # Errors
/// Where the file is no recording, or is one of another version of the format; the first message
/// with a value that is missing or not finite, or with an action that the header does not name.
pub fn read(file: &Path) -> Result<Recording, RecordingError> {
    let bytes = bytes_of(file)?;
    let contents = contents(&bytes);
    let header = header_of(file, &contents, &[FORMAT_VERSION, RUN_FORMAT_VERSION])?;
    let joined = frames(file, &header, &contents)?;
    Ok(Recording {
        header,
        loss: loss(&contents, &joined),
        frames: joined.frames,
        done: joined.done,
    })
}

/// The object file as it was when the recording was made; `None` where it is damaged or cut off.
///
/// # Errors
/// Where the file cannot be read, or is no MCAP file.
pub fn object_toml(file: &Path) -> Result<Option<String>, RecordingError> {
    let bytes = bytes_of(file)?;
    let text = contents(&bytes)
        .attachments
        .get(OBJECT_ATTACHMENT)
        .map(|bytes| bytes.to_vec());
    Ok(text.and_then(|text| String::from_utf8(text).ok()))
}

/// The bytes of an MCAP file.
pub(super) fn bytes_of(file: &Path) -> Result<Vec<u8>, RecordingError> {
    let bytes = fs::read(file).map_err(|error| RecordingError::Read {
        file: file.to_owned(),
        reason: error.to_string(),
    })?;
    let file = file.to_owned();
    if bytes.starts_with(MAGIC) {
        Ok(bytes)
    } else if MAGIC.starts_with(&bytes) {
        Err(RecordingError::Headless { file })
    } else {
        Err(RecordingError::NotMcap { file })
    }
}

/// The header, of one of these formats.
pub(super) fn header_of(
    file: &Path,
    contents: &Contents<'_>,
    formats: &[u32],
) -> Result<Header, RecordingError> {
    let file = file.to_owned();
    match &contents.metadata {
        Some(metadata) => header(&file, metadata, formats),
        None if contents.end == End::Complete => Err(RecordingError::Foreign { file }),
        None => Err(RecordingError::Headless { file }),
    }
}

/// The frames of a file.
pub(super) fn frames(
    file: &Path,
    header: &Header,
    contents: &Contents<'_>,
) -> Result<Joined, RecordingError> {
    let file = file.to_owned();
    if let Some(compression) = contents.compression.clone() {
        return Err(RecordingError::Compressed { file, compression });
    }
    let joined = join(&file, &header.actions, contents)?;
    if let Some(topic) = silent_topic(contents) {
        return Err(RecordingError::NoMessages { file, topic });
    }
    Ok(joined)
}

fn header(
    file: &Path,
    metadata: &BTreeMap<String, String>,
    formats: &[u32],
) -> Result<Header, RecordingError> {
    let field = |key: &str| metadata.get(key).map(String::as_str);
    Header::of_formats(formats, field).map_err(|faults| {
        let fault = faults.into_iter().next();
        RecordingError::Header {
            file: file.to_owned(),
            key: fault.as_ref().map_or(METADATA, |fault| fault.key),
            found: fault
                .as_ref()
                .and_then(|fault| fault.found.as_ref())
                .map_or("missing".to_owned(), |found| format!("{found:?}")),
            rule: fault.map_or(String::new(), |fault| fault.rule),
        }
    })
}

/// A topic that every frame needs and that a file which lost nothing does not have, though it has
/// the others.
fn silent_topic(contents: &Contents<'_>) -> Option<&'static str> {
    if contents.end != End::Complete || !contents.damaged.is_empty() {
        return None;
    }
    let needed = [Topic::Pose, Topic::Wrench, Topic::Action].map(Topic::name);
    let speaks = needed.map(|topic| {
        contents.messages.iter().any(|message| {
            let name = contents.topics.get(&message.channel);
            name.is_some_and(|name| name == topic)
        })
    });
    let silent = speaks.iter().position(|&speaks| !speaks)?;
    speaks.contains(&true).then_some(needed[silent])
}

/// What is missing, in words.
pub(super) fn loss(contents: &Contents<'_>, joined: &Joined) -> Option<String> {
    let extent = extent(joined);
    let mut losses = Vec::new();
    match contents.end {
        End::Complete => {}
        End::Unfinished => losses.push(format!(
            "the recording was never finished, as when the program is killed: it ends {extent}; up to a second after that is lost"
        )),
        End::InRecord | End::InChunk => {
            let within = if contents.end == End::InChunk { "chunk" } else { "record" };
            losses.push(format!(
                "the file ends in the middle of a {within} {extent}; what came after is lost"
            ));
        }
        End::Unreadable(bytes) => losses.push(format!(
            "the file cannot be read {extent}; the {} bytes that follow are lost",
            grouped(bytes)
        )),
    }
    losses.extend(damaged(contents, joined));
    // At a cut, the last frame is cut as well.
    let at_the_cut = usize::from(contents.end != End::Complete);
    let incomplete = joined.incomplete.saturating_sub(at_the_cut);
    if incomplete > 0 {
        losses.push(format!(
            "{} frames are left out because one of /pose, /wrench and /action is missing at their time",
            grouped(incomplete)
        ));
    }
    (!losses.is_empty()).then(|| losses.join("; "))
}

/// "after 12.3 s (1,230 frames)".
fn extent(joined: &Joined) -> String {
    let (Some(start_ns), Some(last)) = (joined.start_ns, joined.frames.last()) else {
        return "before the first frame".to_owned();
    };
    format!(
        "after {:.1} s ({} frames)",
        seconds(start_ns, last.reading.time_ns),
        grouped(joined.frames.len())
    )
}

/// Which chunks are left out.
fn damaged(contents: &Contents<'_>, joined: &Joined) -> Option<String> {
    /// So many are named.
    const NAMED: usize = 3;
    let count = contents.damaged.len();
    if count == 0 {
        return None;
    }
    let start_ns = joined.start_ns.unwrap_or(0);
    let mut spans: Vec<String> = contents
        .damaged
        .iter()
        .flatten()
        .take(NAMED)
        .map(|&(from_ns, to_ns)| {
            let [from_s, to_s] = [from_ns, to_ns].map(|time_ns| seconds(start_ns, time_ns));
            format!("from {from_s:.2} s to {to_s:.2} s")
        })
        .collect();
    if count > spans.len() {
        spans.push(format!("{} more", count - spans.len()));
    }
    let chunks = if count == 1 { "chunk is" } else { "chunks are" };
    Some(format!(
        "{count} {chunks} damaged and left out ({})",
        spans.join(", ")
    ))
}

fn seconds(start_ns: u64, time_ns: u64) -> f64 {
    (time_ns as f64 - start_ns as f64) * 1e-9
}

/// A number with commas between its thousands.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn thousands_are_set_apart() {
        for (number, text) in [
            (0, "0"),
            (999, "999"),
            (1230, "1,230"),
            (1_000_000, "1,000,000"),
        ] {
            assert_eq!(grouped(number), text);
        }
    }
}
