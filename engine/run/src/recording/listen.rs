//! Following a recording while it is made.

use super::topic::Topic;
use crate::report::RunReport;

/// A message, as it is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Message<'a> {
    /// Name of its topic, such as `/belief`.
    pub topic: &'static str,
    /// Its time, as in the recording.
    pub time_ns: u64,
    /// The very bytes that are recorded.
    pub json: &'a [u8],
}

/// Hears what is recorded, on the recorder's thread (in lockstep: within the loops). It must not
/// wait for anything: what it cannot take at once it has to drop.
pub trait Listener: Send {
    /// A message.
    fn hear(&mut self, message: &Message<'_>);

    /// The run is over, and this is what became of it; nothing follows.
    fn end(&mut self, report: &RunReport);
}

/// A topic of a run and what its messages look like.
#[derive(Debug, Clone, PartialEq)]
pub struct TopicNote {
    /// Its name, such as `/belief`.
    pub name: &'static str,
    /// Name of the schema.
    pub schema_name: &'static str,
    /// JSON Schema of the messages.
    pub schema: serde_json::Value,
}

/// The topics of a run.
pub fn run_topics() -> Vec<TopicNote> {
    let note = |topic: Topic| TopicNote {
        name: topic.name(),
        schema_name: topic.schema_name(),
        schema: topic.schema(),
    };
    Topic::OF_RUN.into_iter().map(note).collect()
}
