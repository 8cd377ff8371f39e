//! The protobuf wire format: numbered fields, each a varint, four or eight bytes, or a run of bytes.

const VARINT: u64 = 0;
const FIXED64: u64 = 1;
const BYTES: u64 = 2;
const FIXED32: u64 = 5;

/// Builds one message.
#[derive(Default)]
pub struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// A message whose fields `fill` writes.
    pub fn message(fill: impl FnOnce(&mut Self)) -> Vec<u8> {
        let mut writer = Self::default();
        fill(&mut writer);
        writer.bytes
    }

    /// A number.
    pub fn number(&mut self, field: u32, value: u64) {
        self.varint(u64::from(field) << 3 | VARINT);
        self.varint(value);
    }

    /// Bytes, a text, or a message already built.
    pub fn bytes(&mut self, field: u32, value: impl AsRef<[u8]>) {
        let value = value.as_ref();
        self.varint(u64::from(field) << 3 | BYTES);
        self.varint(value.len() as u64);
        self.bytes.extend_from_slice(value);
    }

    /// A message within this one.
    pub fn nested(&mut self, field: u32, fill: impl FnOnce(&mut Self)) {
        self.bytes(field, Self::message(fill));
    }

    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.bytes.push(value as u8);
    }
}

/// What a field holds.
#[derive(Debug, Clone, Copy)]
pub enum Value<'a> {
    /// A number.
    Number(u64),
    /// Four or eight bytes, which nothing in a policy uses singly.
    Fixed,
    /// A text, a message, or packed numbers.
    Bytes(&'a [u8]),
}

/// One field of a message.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    /// Its number.
    pub number: u32,
    /// What it holds.
    pub value: Value<'a>,
    /// The field as it stands in the file, with its number.
    pub raw: &'a [u8],
    /// The message it stands in, for messages to the user.
    message: &'static str,
}

impl<'a> Field<'a> {
    /// The bytes of a text or message.
    pub fn bytes(&self) -> Result<&'a [u8], String> {
        match self.value {
            Value::Bytes(bytes) => Ok(bytes),
            _ => Err(self.wrong_kind()),
        }
    }

    /// A text without zero bytes: the runtimes take names as C strings.
    pub fn text(&self) -> Result<&'a str, String> {
        let text = std::str::from_utf8(self.bytes()?)
            .map_err(|_| format!("a text in its {} is not UTF-8", self.message))?;
        if text.contains('\0') {
            return Err(format!(
                "a text in its {} contains a zero byte",
                self.message
            ));
        }
        Ok(text)
    }

    /// A number.
    pub fn number(&self) -> Result<u64, String> {
        match self.value {
            Value::Number(number) => Ok(number),
            _ => Err(self.wrong_kind()),
        }
    }

    /// Adds one number, or the packed numbers of one field, to `numbers`.
    pub fn numbers(&self, numbers: &mut Vec<u64>) -> Result<(), String> {
        let Value::Bytes(bytes) = self.value else {
            numbers.push(self.number()?);
            return Ok(());
        };
        let mut rest = Fields::new(bytes, self.message);
        while rest.at < bytes.len() {
            numbers.push(rest.varint()?);
        }
        Ok(())
    }

    fn wrong_kind(&self) -> String {
        format!(
            "field {} of its {} has the wrong kind",
            self.number, self.message
        )
    }
}

/// Goes through the fields of a message; stops at the first fault.
pub struct Fields<'a> {
    bytes: &'a [u8],
    message: &'static str,
    at: usize,
}

impl<'a> Fields<'a> {
    /// The fields of `bytes`, which is said to be a `message`.
    pub fn new(bytes: &'a [u8], message: &'static str) -> Self {
        Self {
            bytes,
            message,
            at: 0,
        }
    }

    fn field(&mut self) -> Result<Field<'a>, String> {
        let start = self.at;
        let tag = self.varint()?;
        let number = u32::try_from(tag >> 3).unwrap_or(0);
        if number == 0 || number >= 1 << 29 {
            return Err(format!(
                "its {} has a field numbered {}",
                self.message,
                tag >> 3
            ));
        }
        let value = match tag & 7 {
            VARINT => Value::Number(self.varint()?),
            FIXED64 => self.fixed(8)?,
            BYTES => {
                let length = self.varint()?;
                Value::Bytes(self.take(length)?)
            }
            FIXED32 => self.fixed(4)?,
            kind => {
                return Err(format!(
                    "field {number} of its {} is of unknown kind {kind}",
                    self.message
                ));
            }
        };
        Ok(Field {
            number,
            value,
            raw: &self.bytes[start..self.at],
            message: self.message,
        })
    }

    fn fixed(&mut self, length: u64) -> Result<Value<'a>, String> {
        self.take(length).map(|_| Value::Fixed)
    }

    fn take(&mut self, length: u64) -> Result<&'a [u8], String> {
        let left = self.bytes.len() - self.at;
        let length = usize::try_from(length)
            .ok()
            .filter(|length| *length <= left)
            .ok_or_else(|| {
                format!(
                    "its {} ends early: a field of {length} bytes begins where {left} are left",
                    self.message
                )
            })?;
        let taken = &self.bytes[self.at..self.at + length];
        self.at += length;
        Ok(taken)
    }

    fn varint(&mut self) -> Result<u64, String> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = *self
                .bytes
                .get(self.at)
                .ok_or_else(|| format!("its {} ends in the middle of a number", self.message))?;
            self.at += 1;
            if shift == 63 && byte > 1 {
                break;
            }
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(format!(
            "a number in its {} is longer than 64 bits",
            self.message
        ))
    }
}

impl<'a> Iterator for Fields<'a> {
    type Item = Result<Field<'a>, String>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.bytes.len() {
            return None;
        }
        let field = self.field();
        if field.is_err() {
            self.at = self.bytes.len();
        }
        Some(field)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn bytes_are_those_of_the_protobuf_documentation() {
        // "Encoding" in the protobuf guide: field 1 = 150 is 08 96 01, field 2 = "testing".
        let bytes = Writer::message(|m| {
            m.number(1, 150);
            m.bytes(2, "testing");
            m.nested(3, |m| m.number(1, 150));
        });
        let expected = [
            0x08, 0x96, 0x01, 0x12, 0x07, 0x74, 0x65, 0x73, 0x74, 0x69, 0x6e, 0x67, 0x1a, 0x03,
            0x08, 0x96, 0x01,
        ];
        assert_eq!(bytes, expected);

        let fields: Vec<Field> = Fields::new(&bytes, "message").map(Result::unwrap).collect();
        assert_eq!((fields[0].number, fields[0].number().unwrap()), (1, 150));
        assert_eq!(fields[1].text().unwrap(), "testing");
        assert_eq!(fields[2].raw, &expected[12..]);
    }

    #[test]
    fn every_width_of_number_reads_back() {
        for shift in 0..64 {
            for value in [1_u64 << shift, (1 << shift) - 1, u64::MAX >> shift] {
                let bytes = Writer::message(|m| m.number(9, value));
                let field = Fields::new(&bytes, "message").next().unwrap().unwrap();
                assert_eq!(field.number().unwrap(), value);
            }
        }
    }

    #[test]
    fn packed_and_single_numbers_read_alike() {
        // The guide's example: repeated field 6 = [3, 270, 86942].
        let packed = [0x32, 0x06, 0x03, 0x8e, 0x02, 0x9e, 0xa7, 0x05];
        let single = Writer::message(|m| {
            [3, 270, 86942]
                .into_iter()
                .for_each(|value| m.number(6, value))
        });
        for bytes in [&packed[..], &single] {
            let mut numbers = Vec::new();
            Fields::new(bytes, "message")
                .for_each(|field| field.unwrap().numbers(&mut numbers).unwrap());
            assert_eq!(numbers, [3, 270, 86942]);
        }
    }

    #[test]
    fn damage_is_named() {
        let cases: [(&[u8], &str); 7] = [
            (
                &[0x12, 0x07, 0x74],
                "ends early: a field of 7 bytes begins where 1 are left",
            ),
            (&[0x08, 0x96], "ends in the middle of a number"),
            (
                &[
                    0x08, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02,
                ],
                "longer than 64 bits",
            ),
            (&[0x00, 0x01], "a field numbered 0"),
            (&[0x0b], "unknown kind 3"),
            (&[0x09, 1, 2, 3], "ends early"),
            (
                &[
                    0x12, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01,
                ],
                "ends early",
            ),
        ];
        for (bytes, part) in cases {
            let fault = Fields::new(bytes, "graph").find_map(Result::err).unwrap();
            assert!(
                fault.contains(part) && fault.contains("graph"),
                "{bytes:x?}: {fault}"
            );
        }
        let bytes = Writer::message(|m| m.bytes(1, [0xff, 0xfe]));
        assert!(
            Fields::new(&bytes, "graph")
                .next()
                .unwrap()
                .unwrap()
                .text()
                .is_err(),
            "not UTF-8"
        );
    }
}
