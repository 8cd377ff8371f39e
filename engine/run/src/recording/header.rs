//! A recording's header as named pieces of text: the metadata of an MCAP file, the comment lines
//! of a table.

use pubs_plugin::JointType;
use serde_json::Value;

use super::{FORMAT_VERSION, Header};

/// A piece of the header that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeaderFault {
    /// Which one.
    pub key: &'static str,
    /// Its text; `None` where there is none.
    pub found: Option<String>,
    /// What it should be.
    pub rule: String,
    /// A value that would do.
    pub example: &'static str,
}

impl Header {
    /// The header as pairs of key and text, in the order in which they are written.
    pub fn to_fields(&self) -> [(&'static str, String); 8] {
        [
            ("format", self.format.to_string()),
            ("engine", written(&self.engine)),
            ("object", written(&self.object)),
            ("joint", joint_name(self.joint).to_owned()),
            ("sensor", written(&self.sensor)),
            ("actions", written_list(&self.actions)),
            ("rate_hz", format!("{:?}", self.rate_hz)),
            ("seed", self.seed.to_string()),
        ]
    }

    /// The header from the text that `field` gives for each key.
    ///
    /// # Errors
    /// Every field that is missing or makes no sense, and a format other than [`FORMAT_VERSION`].
    pub fn from_fields<'f>(
        field: impl Fn(&str) -> Option<&'f str>,
    ) -> Result<Self, Vec<HeaderFault>> {
        Self::of_formats(&[FORMAT_VERSION], field)
    }

    /// The same of any of these formats.
    pub(super) fn of_formats<'f>(
        formats: &[u32],
        field: impl Fn(&str) -> Option<&'f str>,
    ) -> Result<Self, Vec<HeaderFault>> {
        let known: Vec<String> = formats.iter().map(u32::to_string).collect();
        let mut fields = Fields {
            field: &field,
            faults: Vec::new(),
        };
        let header = Self {
            format: fields.take(
                "format",
                "1",
                &format!("the version {}", known.join(" or ")),
                |text| text.parse().ok().filter(|format| formats.contains(format)),
            ),
            engine: fields.take("engine", env!("CARGO_PKG_VERSION"), TEXT, read_text),
            object: fields.take("object", "door2", TEXT, read_text),
            joint: fields
                .take(
                    "joint",
                    "revolute",
                    "revolute, prismatic or abstract",
                    |text| {
                        JOINTS
                            .into_iter()
                            .find(|&joint| joint_name(joint) == text)
                            .map(Some)
                    },
                )
                .unwrap_or(JointType::Abstract),
            sensor: fields.take("sensor", "virtual-arm", TEXT, read_text),
            actions: fields.take(
                "actions",
                "stop, safe_open, safe_close, high_open, high_close",
                "the names of the actions, with commas between",
                read_list,
            ),
            rate_hz: fields.take(
                "rate_hz",
                "100.0",
                "a positive number of frames per second",
                |text| {
                    text.parse()
                        .ok()
                        .filter(|&rate_hz: &f64| rate_hz.is_finite() && rate_hz > 0.0)
                },
            ),
            seed: fields.take("seed", "0", "a whole number from 0 on", |text| {
                text.parse().ok()
            }),
        };
        if fields.faults.is_empty() {
            Ok(header)
        } else {
            Err(fields.faults)
        }
    }
}

const TEXT: &str = "a text in one line";

const JOINTS: [JointType; 3] = [
    JointType::Revolute,
    JointType::Prismatic,
    JointType::Abstract,
];

/// The name of a kind of joint, as files spell it.
pub fn joint_name(joint: JointType) -> &'static str {
    match joint {
        JointType::Revolute => "revolute",
        JointType::Prismatic => "prismatic",
        JointType::Abstract => "abstract",
    }
}

/// Reads fields one after the other and keeps what is wrong with them.
struct Fields<'a, F> {
    field: &'a F,
    faults: Vec<HeaderFault>,
}

impl<'f, F: Fn(&str) -> Option<&'f str>> Fields<'_, F> {
    fn take<T: Default>(
        &mut self,
        key: &'static str,
        example: &'static str,
        rule: &str,
        read: impl Fn(&str) -> Option<T>,
    ) -> T {
        let found = (self.field)(key).map(str::trim);
        if let Some(value) = found.and_then(read) {
            return value;
        }
        self.faults.push(HeaderFault {
            key,
            found: found.map(str::to_owned),
            rule: rule.to_owned(),
            example,
        });
        T::default()
    }
}

/// Whether a text can stand by itself in one line, alone or in a list.
fn is_plain(text: &str) -> bool {
    !text.is_empty()
        && text.trim() == text
        && !text.starts_with(['"', '['])
        && !text.contains(|letter: char| letter == ',' || letter.is_control())
}

/// A text as it is where that can be read back, in JSON where not.
fn written(text: &str) -> String {
    if is_plain(text) {
        text.to_owned()
    } else {
        Value::from(text).to_string()
    }
}

fn written_list(texts: &[String]) -> String {
    if texts.is_empty() || !texts.iter().all(|text| is_plain(text)) {
        Value::from(texts).to_string()
    } else {
        texts.join(", ")
    }
}

fn read_text(text: &str) -> Option<String> {
    match text {
        "" => None,
        text if text.starts_with('"') => serde_json::from_str(text).ok(),
        text => Some(text.to_owned()),
    }
}

fn read_list(text: &str) -> Option<Vec<String>> {
    if text.starts_with('[') {
        return serde_json::from_str(text).ok();
    }
    text.split(',').map(|name| read_text(name.trim())).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::collections::BTreeMap;

    use super::*;

    fn header() -> Header {
        Header {
            format: FORMAT_VERSION,
            engine: "0.1.0".to_owned(),
            object: "door2".to_owned(),
            joint: JointType::Revolute,
            sensor: "virtual-arm".to_owned(),
            actions: ["stop", "safe_open"].map(str::to_owned).to_vec(),
            rate_hz: 100.0,
            seed: u64::MAX,
        }
    }

    fn read(fields: &BTreeMap<&str, String>) -> Result<Header, Vec<HeaderFault>> {
        Header::from_fields(|key| fields.get(key).map(String::as_str))
    }

    #[test]
    fn every_header_survives_as_text() {
        let awkward = Header {
            object: "a \"door\",\nin two lines ".to_owned(),
            sensor: String::new(),
            actions: ["[odd]", "x, y"].map(str::to_owned).to_vec(),
            rate_hz: 1.0 / 3.0,
            joint: JointType::Abstract,
            ..header()
        };
        let none = Header {
            actions: Vec::new(),
            joint: JointType::Prismatic,
            ..header()
        };
        for header in [header(), awkward, none] {
            let fields: BTreeMap<_, _> = header.to_fields().into_iter().collect();
            for (key, text) in &fields {
                assert!(
                    !text.contains('\n'),
                    "{key} stands in one line, not {text:?}"
                );
            }
            assert_eq!(read(&fields), Ok(header));
        }
    }

    #[test]
    fn every_fault_is_named_at_once() {
        let mut fields: BTreeMap<_, _> = header().to_fields().into_iter().collect();
        fields.remove("sensor");
        for (key, text) in [
            ("format", "2"),
            ("joint", "hinge"),
            ("rate_hz", "NaN"),
            ("seed", "-1"),
        ] {
            fields.insert(key, text.to_owned());
        }
        let faults = read(&fields).unwrap_err();
        let found: Vec<_> = faults
            .iter()
            .map(|fault| (fault.key, fault.found.as_deref()))
            .collect();
        let expected = [
            ("format", Some("2")),
            ("joint", Some("hinge")),
            ("sensor", None),
            ("rate_hz", Some("NaN")),
            ("seed", Some("-1")),
        ];
        assert_eq!(found, expected);
    }
}
