//! The records of an MCAP file, as far as they go.
//!
//! Readers of whole files give up where a file is cut off or a chunk is damaged. Every record says
//! how long it is, so what is whole before the cut, within the last chunk too, and what follows a
//! damaged chunk can still be had.

use std::collections::BTreeMap;

use mcap::MAGIC;
use mcap::records::{Record, op};

use super::METADATA;
use super::run_header::RUN_METADATA;

/// Opcode and length before each record.
const PREFIX: usize = 1 + 8;

/// What an MCAP file holds.
#[derive(Debug, Default)]
pub(super) struct Contents<'a> {
    /// The metadata of that name.
    pub metadata: Option<BTreeMap<String, String>>,
    /// The metadata that runs have beside it.
    pub run_metadata: Option<BTreeMap<String, String>>,
    /// Attachments by name, those alone whose checksum is right.
    pub attachments: BTreeMap<String, &'a [u8]>,
    /// Names of topics.
    pub topics: BTreeMap<u16, String>,
    /// In the order of the file.
    pub messages: Vec<RawMessage<'a>>,
    /// Time spans (from, to; ns) of chunks that are damaged and left out, where they can be told.
    pub damaged: Vec<Option<(u64, u64)>>,
    /// How the file ends.
    pub end: End,
    /// The compression of a chunk, where there is any.
    pub compression: Option<String>,
}

/// A message before anybody has looked into it.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawMessage<'a> {
    pub channel: u16,
    pub time_ns: u64,
    pub data: &'a [u8],
    /// Whether a chunk that is cut off holds it, so that no checksum vouches for it.
    pub doubtful: bool,
}

/// How a file ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum End {
    /// With the mark that all is there.
    Complete,
    /// After a whole record, without that mark.
    #[default]
    Unfinished,
    /// Within a record.
    InRecord,
    /// Within a chunk.
    InChunk,
    /// With so many bytes that are no records.
    Unreadable(usize),
}

/// One record after the other; what is left over at the end stays in `rest`.
struct Records<'a> {
    rest: &'a [u8],
}

impl<'a> Iterator for Records<'a> {
    type Item = (u8, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let (prefix, body) = self.rest.split_first_chunk::<PREFIX>()?;
        let (&opcode, length) = prefix.split_first()?;
        let length = usize::try_from(u64::from_le_bytes(length.try_into().ok()?)).ok()?;
        // No record has the opcode 0: it is what a file system leaves of data it never wrote.
        if opcode == 0 || length > body.len() {
            return None;
        }
        let (body, rest) = body.split_at(length);
        self.rest = rest;
        Some((opcode, body))
    }
}

/// Everything that can be read of a file that begins with the magic bytes.
pub(super) fn contents(bytes: &[u8]) -> Contents<'_> {
    let mut contents = Contents::default();
    let mut records = Records {
        rest: bytes.strip_prefix(MAGIC).unwrap_or_default(),
    };
    let mut complete = false;
    for (opcode, body) in records.by_ref() {
        match opcode {
            op::CHUNK => contents.chunk(body),
            op::DATA_END => complete = true,
            _ => contents.record(opcode, body, false),
        }
    }
    contents.end = if complete {
        End::Complete
    } else {
        contents.tail(records.rest)
    };
    contents
}

impl<'a> Contents<'a> {
    fn record(&mut self, opcode: u8, body: &'a [u8], doubtful: bool) {
        if opcode == op::ATTACHMENT {
            self.attachments.extend(attachment(body));
            return;
        }
        if !matches!(opcode, op::CHANNEL | op::MESSAGE | op::METADATA) {
            return;
        }
        match mcap::parse_record(opcode, body) {
            Ok(Record::Channel(channel)) => {
                self.topics.insert(channel.id, channel.topic);
            }
            Ok(Record::Metadata(metadata)) if metadata.name == METADATA => {
                self.metadata = Some(metadata.metadata);
            }
            Ok(Record::Metadata(metadata)) if metadata.name == RUN_METADATA => {
                self.run_metadata = Some(metadata.metadata);
            }
            Ok(Record::Message { header, .. }) => self.messages.push(RawMessage {
                channel: header.channel_id,
                time_ns: header.log_time,
                data: &body[body.len().min(MESSAGE_HEADER)..],
                doubtful,
            }),
            _ => {}
        }
    }

    /// A chunk that is there from end to end.
    fn chunk(&mut self, body: &'a [u8]) {
        let Some(chunk) = Chunk::new(body) else {
            self.damaged.push(None);
            return;
        };
        if !chunk.compression.is_empty() {
            self.compression = Some(String::from_utf8_lossy(chunk.compression).into_owned());
            return;
        }
        let Some(records) = chunk.sound_records() else {
            self.damaged.push(Some((chunk.from_ns, chunk.to_ns)));
            return;
        };
        for (opcode, body) in (Records { rest: records }) {
            self.record(opcode, body, false);
        }
    }

    /// What the file ends with where its end mark is missing.
    fn tail(&mut self, tail: &'a [u8]) -> End {
        match tail.first() {
            None => End::Unfinished,
            Some(&op::CHUNK) => {
                let chunk = tail.get(PREFIX..).and_then(Chunk::new);
                if let Some(chunk) = chunk.filter(|chunk| chunk.compression.is_empty()) {
                    for (opcode, body) in (Records {
                        rest: chunk.records,
                    }) {
                        self.record(opcode, body, true);
                    }
                }
                End::InChunk
            }
            Some(op::HEADER..=op::DATA_END) => End::InRecord,
            Some(_) => End::Unreadable(tail.len()),
        }
    }
}

/// Bytes of a message before its data: channel, sequence, two times.
const MESSAGE_HEADER: usize = 2 + 4 + 8 + 8;

/// Name and content of an attachment; `None` where its lengths or its checksum are wrong.
fn attachment(body: &[u8]) -> Option<(String, &[u8])> {
    let (sound, checksum) = body.split_last_chunk()?;
    let checksum = u32::from_le_bytes(*checksum);
    if checksum != 0 && crc32fast::hash(sound) != checksum {
        return None;
    }
    let rest = sound.get(ATTACHMENT_TIMES..)?;
    let (name, rest) = text(rest)?;
    let (_media_type, rest) = text(rest)?;
    let (length, data) = rest.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let name = String::from_utf8_lossy(name).into_owned();
    (length == data.len()).then_some((name, data))
}

/// Bytes of an attachment before its name.
const ATTACHMENT_TIMES: usize = 8 + 8;

/// A text with its length before it, and what follows.
fn text(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}

/// A chunk, or the beginning of one.
struct Chunk<'a> {
    from_ns: u64,
    to_ns: u64,
    checksum: u32,
    compression: &'a [u8],
    length: u64,
    records: &'a [u8],
}

impl<'a> Chunk<'a> {
    fn new(body: &'a [u8]) -> Option<Self> {
        let (from, rest) = body.split_first_chunk()?;
        let (to, rest) = rest.split_first_chunk()?;
        let (_uncompressed_length, rest) = rest.split_first_chunk::<8>()?;
        let (checksum, rest) = rest.split_first_chunk()?;
        let (compression, rest) = text(rest)?;
        let (length, records) = rest.split_first_chunk()?;
        Some(Self {
            from_ns: u64::from_le_bytes(*from),
            to_ns: u64::from_le_bytes(*to),
            checksum: u32::from_le_bytes(*checksum),
            compression,
            length: u64::from_le_bytes(*length),
            records,
        })
    }

    /// The records, where all are there and their checksum, if there is one, is right.
    fn sound_records(&self) -> Option<&'a [u8]> {
        let records = self.records.get(..usize::try_from(self.length).ok()?)?;
        (self.checksum == 0 || crc32fast::hash(records) == self.checksum).then_some(records)
    }
}
