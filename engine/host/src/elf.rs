//! Looks at a library file before the system's loader does.
//!
//! `dlopen` maps a file without asking whether all of it is there: a truncated library ends the
//! process with SIGBUS. So class, machine and the extent of every part are checked here first.

use std::path::Path;

/// e_type of a shared object.
const SHARED_OBJECT: u64 = 3;
/// p_type of a segment that is mapped.
const LOADED: u64 = 1;

/// Checks that `file` is a whole ELF shared object of the machine of this program.
pub(crate) fn check(file: &[u8]) -> Result<(), String> {
    let header = Header::read(file)?;
    match std::env::current_exe()
        .ok()
        .and_then(|path| beginning(&path))
    {
        Some(own) => header.check_machine(&Header::read(&own)?)?,
        None => header.check_class(size_of::<usize>())?,
    }
    header.check_extents(file)
}

fn beginning(path: &Path) -> Option<Vec<u8>> {
    use std::io::Read;
    let mut bytes = vec![0; 64];
    std::fs::File::open(path)
        .ok()?
        .read_exact(&mut bytes)
        .ok()?;
    Some(bytes)
}

/// The part of an ELF header that is the same for 32 and 64 bits, and where the rest is.
struct Header {
    wide: bool,
    little_endian: bool,
    kind: u64,
    machine: u64,
}

impl Header {
    fn read(file: &[u8]) -> Result<Self, String> {
        if !file.starts_with(b"\x7fELF") {
            let shown = String::from_utf8_lossy(&file[..file.len().min(16)])
                .escape_debug()
                .to_string();
            let found = if file.is_empty() {
                "it is empty".to_owned()
            } else {
                format!("it begins with \"{shown}\"")
            };
            return Err(format!(
                "it is not a shared library: an ELF file begins with \"\\u{{7f}}ELF\", {found}"
            ));
        }
        let (Some(class), Some(order)) = (file.get(4), file.get(5)) else {
            return Err(cut("the ELF header", 64, file.len()));
        };
        let mut header = Self {
            wide: *class == 2,
            little_endian: *order == 1,
            kind: 0,
            machine: 0,
        };
        header.kind = header
            .number(file, 16, 2)
            .ok_or_else(|| cut("the ELF header", 64, file.len()))?;
        header.machine = header
            .number(file, 18, 2)
            .ok_or_else(|| cut("the ELF header", 64, file.len()))?;
        Ok(header)
    }

    /// An unsigned number of `width` bytes at `offset`.
    fn number(&self, file: &[u8], offset: u64, width: usize) -> Option<u64> {
        let start = usize::try_from(offset).ok()?;
        let bytes = file.get(start..start.checked_add(width)?)?;
        let shift = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
        Some(if self.little_endian {
            bytes.iter().rev().fold(0, shift)
        } else {
            bytes.iter().fold(0, shift)
        })
    }

    fn describe(&self) -> String {
        let bits = if self.wide { 64 } else { 32 };
        let order = if self.little_endian { "little" } else { "big" };
        let machine = match self.machine {
            3 => "x86".to_owned(),
            40 => "ARM".to_owned(),
            62 => "x86-64".to_owned(),
            183 => "AArch64".to_owned(),
            243 => "RISC-V".to_owned(),
            other => format!("machine number {other}"),
        };
        format!("{bits}-bit {order}-endian {machine}")
    }

    fn check_machine(&self, own: &Self) -> Result<(), String> {
        if (self.wide, self.little_endian, self.machine)
            == (own.wide, own.little_endian, own.machine)
        {
            return Ok(());
        }
        let (theirs, ours) = (self.describe(), own.describe());
        Err(format!(
            "it is built for another machine: engine {ours}, plugin {theirs}; rebuild it on this kind of machine"
        ))
    }

    fn check_class(&self, word_bytes: usize) -> Result<(), String> {
        if self.wide == (word_bytes == 8) {
            return Ok(());
        }
        Err(format!(
            "it is built for another machine: engine {}-bit, plugin {}",
            8 * word_bytes,
            self.describe()
        ))
    }

    /// Every mapped segment and the section table must lie inside the file.
    fn check_extents(&self, file: &[u8]) -> Result<(), String> {
        if self.kind != SHARED_OBJECT {
            return Err(
                "it is an ELF file, but not a shared library; link it with -shared".to_owned(),
            );
        }
        let header_bytes = if self.wide { 64 } else { 52 };
        if file.len() < header_bytes {
            return Err(cut("the ELF header", header_bytes as u64, file.len()));
        }
        let header = if self.wide { WIDE } else { NARROW };
        let at = |offset, width| self.number(file, offset, width).unwrap_or(0);
        let (word, segments) = (header.word, at(header.program_offset, header.word));
        let (entry, count) = (at(header.program_entry, 2), at(header.program_entry + 2, 2));
        self.within(
            file,
            "the program header table",
            segments,
            entry.saturating_mul(count),
        )?;
        for index in 0..count {
            let segment = segments + index * entry;
            if at(segment, 4) != LOADED {
                continue;
            }
            let (offset, size) = (
                at(segment + header.segment_offset, word),
                at(segment + header.segment_size, word),
            );
            self.within(file, &format!("segment {index}"), offset, size)?;
        }
        let sections = at(header.section_offset, word);
        let (entry, count) = (at(header.section_entry, 2), at(header.section_entry + 2, 2));
        self.within(
            file,
            "the section header table",
            sections,
            entry.saturating_mul(count),
        )
    }

    fn within(&self, file: &[u8], part: &str, offset: u64, size: u64) -> Result<(), String> {
        let end = offset.saturating_add(size);
        if end <= file.len() as u64 {
            Ok(())
        } else {
            Err(cut(part, end, file.len()))
        }
    }
}

fn cut(part: &str, needed: u64, found: usize) -> String {
    format!(
        "it is truncated: {part} ends at byte {needed}, the file has {found} bytes; copy or build it again"
    )
}

/// Byte offsets in the file header and in a program header.
struct Offsets {
    word: usize,
    program_offset: u64,
    section_offset: u64,
    program_entry: u64,
    section_entry: u64,
    segment_offset: u64,
    segment_size: u64,
}

const WIDE: Offsets = Offsets {
    word: 8,
    program_offset: 32,
    section_offset: 40,
    program_entry: 54,
    section_entry: 58,
    segment_offset: 8,
    segment_size: 32,
};

const NARROW: Offsets = Offsets {
    word: 4,
    program_offset: 28,
    section_offset: 32,
    program_entry: 42,
    section_entry: 46,
    segment_offset: 4,
    segment_size: 16,
};

#[cfg(test)]
mod tests {
    use super::*;

    /// A 64-bit little-endian shared object of the given machine: one segment of 200 bytes at 0.
    fn tiny(machine: u16) -> Vec<u8> {
        let mut file = vec![0; 200];
        file[..6].copy_from_slice(b"\x7fELF\x02\x01");
        file[16] = 3;
        file[18..20].copy_from_slice(&machine.to_le_bytes());
        file[32] = 64; // program headers
        file[54] = 56;
        file[56] = 1;
        file[64] = 1; // a mapped segment ...
        file[64 + 32] = 200; // ... of this size
        file
    }

    #[test]
    fn a_whole_file_passes_and_every_cut_is_seen() {
        let file = tiny(62);
        let header = Header::read(&file).map_err(|text| panic!("{text}"));
        assert_eq!(
            header.and_then(|header: Header| header.check_extents(&file)),
            Ok::<(), ()>(()).map_err(|()| String::new())
        );
        for length in 0..file.len() {
            let result = Header::read(&file[..length])
                .and_then(|header| header.check_extents(&file[..length]));
            assert!(result.is_err(), "a cut at {length} bytes went unseen");
        }
    }

    #[test]
    fn another_machine_is_named() {
        let (own, other) = (Header::read(&tiny(62)), Header::read(&tiny(183)));
        let text = other.and_then(|other| other.check_machine(&own?));
        let text = text.expect_err("AArch64 is not x86-64");
        assert!(
            text.contains("x86-64") && text.contains("AArch64"),
            "{text}"
        );
    }

    #[test]
    fn numbers_follow_the_byte_order() {
        let header = |little_endian| Header {
            wide: true,
            little_endian,
            kind: 0,
            machine: 0,
        };
        assert_eq!(header(true).number(&[1, 2], 0, 2), Some(0x0201));
        assert_eq!(header(false).number(&[1, 2], 0, 2), Some(0x0102));
        assert_eq!(header(true).number(&[1, 2], 1, 2), None);
        assert_eq!(header(true).number(&[1, 2], u64::MAX, 2), None);
    }
}
