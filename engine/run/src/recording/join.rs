//! Messages of one moment, joined into frames.

use std::collections::HashMap;
use std::path::Path;

use pubs_plugin::{DriverStatus, Reading};
use serde_json::Value;

use super::error::BadMessage;
use super::message::status_named;
use super::records::{Contents, RawMessage};
use super::topic::Topic;
use super::{Done, Frame, RecordingError};

/// What the messages of a file say.
#[derive(Debug, Default)]
pub(super) struct Joined {
    pub frames: Vec<Frame>,
    pub done: Vec<Done>,
    /// Moments at which something is missing that a frame needs.
    pub incomplete: usize,
    /// Time of the first message that belongs to a frame, ns.
    pub start_ns: Option<u64>,
}

/// Joins `/pose`, `/wrench`, `/action` and `/truth` of the same log time; a moment that was
/// recorded twice gives two frames.
///
/// # Errors
/// The first message that cannot be used.
pub(super) fn join(
    file: &Path,
    actions: &[String],
    contents: &Contents<'_>,
) -> Result<Joined, RecordingError> {
    let mut joiner = Joiner {
        file,
        actions,
        counts: [0; Topic::ALL.len()],
        start_ns: None,
        moments: Vec::new(),
        by_time: HashMap::new(),
        done: Vec::new(),
    };
    for message in &contents.messages {
        let name = contents.topics.get(&message.channel).map(String::as_str);
        let topic = Topic::ALL
            .into_iter()
            .find(|topic| Some(topic.name()) == name);
        if let Some(topic) = topic.filter(|&topic| is_read(topic)) {
            joiner.take(topic, message)?;
        }
    }
    Ok(joiner.finish())
}

fn is_read(topic: Topic) -> bool {
    matches!(
        topic,
        Topic::Pose | Topic::Wrench | Topic::Action | Topic::Truth | Topic::Demonstration
    )
}

/// A frame in the making.
#[derive(Debug, Default, Clone, Copy)]
struct Moment {
    time_ns: u64,
    pose: Option<([f64; 3], [f64; 4])>,
    wrench: Option<([f64; 3], [f64; 3])>,
    action: Option<ActionPart>,
    truth: Option<f64>,
}

#[derive(Debug, Clone, Copy)]
struct ActionPart {
    action: usize,
    demonstration: u32,
    speed_m_s: f64,
    settled: bool,
    status: DriverStatus,
}

impl Moment {
    fn has(&self, topic: Topic) -> bool {
        match topic {
            Topic::Pose => self.pose.is_some(),
            Topic::Wrench => self.wrench.is_some(),
            Topic::Action => self.action.is_some(),
            Topic::Truth => self.truth.is_some(),
            _ => false,
        }
    }

    fn frame(&self) -> Option<Frame> {
        let (position_m, orientation_xyzw) = self.pose?;
        let (force_n, torque_nm) = self.wrench?;
        let action = self.action?;
        Some(Frame {
            reading: Reading {
                time_ns: self.time_ns,
                position_m,
                orientation_xyzw,
                force_n,
                torque_nm,
                status: action.status,
            },
            action: action.action,
            demonstration: action.demonstration,
            speed_m_s: action.speed_m_s,
            settled: action.settled,
            truth: self.truth,
        })
    }
}

struct Joiner<'a> {
    file: &'a Path,
    actions: &'a [String],
    /// Messages so far, in the order of [`Topic::ALL`].
    counts: [usize; Topic::ALL.len()],
    start_ns: Option<u64>,
    moments: Vec<Moment>,
    by_time: HashMap<u64, Vec<usize>>,
    done: Vec<Done>,
}

impl Joiner<'_> {
    fn take(&mut self, topic: Topic, message: &RawMessage<'_>) -> Result<(), RecordingError> {
        let time_ns = message.time_ns;
        let start_ns = *self.start_ns.get_or_insert(time_ns);
        self.counts[topic as usize] += 1;
        let at = Place {
            file: self.file,
            topic,
            number: self.counts[topic as usize],
            time_s: (time_ns as f64 - start_ns as f64) * 1e-9,
        };
        let value: Value = match serde_json::from_slice(message.data) {
            Ok(value) => value,
            // The cut may have gone through what looks like a whole message.
            Err(_) if message.doubtful => return Ok(()),
            Err(error) => return Err(at.error("the message", &error.to_string(), "JSON")),
        };
        let fields = Fields { at, value: &value };
        if topic == Topic::Demonstration {
            self.done.push(self.done_of(&fields)?);
            return Ok(());
        }
        let action = match topic {
            Topic::Action => Some(self.action_of(&fields)?),
            _ => None,
        };
        let moment = self.moment(topic, time_ns);
        match topic {
            Topic::Pose => {
                let position = fields.xyz("pose.position")?;
                let [x, y, z] = fields.xyz("pose.orientation")?;
                let w = fields.number("pose.orientation.w")?;
                moment.pose = Some((position, [x, y, z, w]));
            }
            Topic::Wrench => moment.wrench = Some((fields.xyz("force")?, fields.xyz("torque")?)),
            Topic::Truth => moment.truth = Some(fields.number("joint_state")?),
            _ => moment.action = action,
        }
        Ok(())
    }

    /// The first moment of that time which still lacks the topic.
    fn moment(&mut self, topic: Topic, time_ns: u64) -> &mut Moment {
        let same_time = self.by_time.entry(time_ns).or_default();
        let lacking = same_time
            .iter()
            .copied()
            .find(|&index| !self.moments[index].has(topic));
        let index = lacking.unwrap_or_else(|| {
            same_time.push(self.moments.len());
            self.moments.push(Moment {
                time_ns,
                ..Moment::default()
            });
            self.moments.len() - 1
        });
        &mut self.moments[index]
    }

    fn action_of(&self, fields: &Fields<'_>) -> Result<ActionPart, RecordingError> {
        let name = self.known_action(fields)?;
        let statuses = "ready, stopped or fault";
        Ok(ActionPart {
            action: name,
            demonstration: fields.count("demonstration")?,
            speed_m_s: fields.number("speed_m_s")?,
            settled: fields.take("settled", "true or false", Value::as_bool)?,
            status: fields.take("status", statuses, |value| {
                value.as_str().and_then(status_named)
            })?,
        })
    }

    fn done_of(&self, fields: &Fields<'_>) -> Result<Done, RecordingError> {
        Ok(Done {
            action: self.actions[self.known_action(fields)?].clone(),
            demonstration: fields.count("demonstration")?,
        })
    }

    /// Index of the action that a message names.
    fn known_action(&self, fields: &Fields<'_>) -> Result<usize, RecordingError> {
        let rule = format!("an action of the header: {}", self.actions.join(", "));
        fields.take("action", &rule, |value| {
            let name = value.as_str()?;
            self.actions.iter().position(|action| action == name)
        })
    }

    fn finish(self) -> Joined {
        let frames: Vec<Frame> = self.moments.iter().filter_map(Moment::frame).collect();
        Joined {
            incomplete: self.moments.len() - frames.len(),
            frames,
            done: self.done,
            start_ns: self.start_ns,
        }
    }
}

/// A message, as errors name it.
struct Place<'a> {
    file: &'a Path,
    topic: Topic,
    number: usize,
    time_s: f64,
}

impl Place<'_> {
    fn error(&self, field: &str, found: &str, rule: &str) -> RecordingError {
        RecordingError::Message(Box::new(BadMessage {
            file: self.file.to_owned(),
            topic: self.topic.name(),
            number: self.number,
            time_s: self.time_s,
            field: field.to_owned(),
            found: found.to_owned(),
            rule: rule.to_owned(),
        }))
    }
}

/// The values of a message.
struct Fields<'a> {
    at: Place<'a>,
    value: &'a Value,
}

impl Fields<'_> {
    /// The value at `path` (`force.x`), where `read` makes something of it.
    fn take<'v, T>(
        &'v self,
        path: &str,
        rule: &str,
        read: impl Fn(&'v Value) -> Option<T>,
    ) -> Result<T, RecordingError> {
        let mut found = Some(self.value);
        for key in path.split('.') {
            found = found.and_then(|value| value.get(key));
        }
        found.and_then(read).ok_or_else(|| {
            let found = found.map_or("missing".to_owned(), Value::to_string);
            self.at.error(path, &found, rule)
        })
    }

    fn number(&self, path: &str) -> Result<f64, RecordingError> {
        self.take(path, "a finite number", |value| {
            value.as_f64().filter(|number| number.is_finite())
        })
    }

    fn count(&self, path: &str) -> Result<u32, RecordingError> {
        self.take(path, "a whole number from 0 on", |value| {
            value.as_u64()?.try_into().ok()
        })
    }

    fn xyz(&self, path: &str) -> Result<[f64; 3], RecordingError> {
        Ok([
            self.number(&format!("{path}.x"))?,
            self.number(&format!("{path}.y"))?,
            self.number(&format!("{path}.z"))?,
        ])
    }
}
