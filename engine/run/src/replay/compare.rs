//! What was recorded beside what is so today.

use serde_json::{Value, json};

use super::report::{Compared, Difference, ReplayReport};
use crate::messages::{BeliefMessage, Sample};
use crate::recording::{BeliefStep, Choice, ChoiceVerdict, RunRecording, Tick};

/// How far apart two values may be and still count as the same; 0: not a bit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tolerances {
    /// Of displacement and mean, rad or m.
    pub state: f64,
    /// Of forces, N.
    pub force_n: f64,
    /// Of the entropy, of 1.
    pub entropy: f64,
}

/// The comparison so far.
pub(super) struct Comparison<'a> {
    recording: &'a RunRecording,
    tolerances: Tolerances,
    start_ns: u64,
    first: [Option<Difference>; 3],
    counts: [Compared; 3],
    missing: Vec<String>,
}

const OBSERVATION: usize = 0;
const BELIEF: usize = 1;
const POLICY: usize = 2;
const TOPICS: [&str; 3] = ["/observation", "/belief", "/policy"];

/// Name, value in the run and today, whether they count as the same.
type Field = (&'static str, Value, Value, bool);

impl<'a> Comparison<'a> {
    pub fn new(recording: &'a RunRecording, tolerances: Tolerances, start_ns: u64) -> Self {
        let mut missing: Vec<String> = recording.loss.iter().cloned().collect();
        if recording.dropped > 0 {
            missing.push(format!(
                "the disk was too slow for {} entries of the recording",
                recording.dropped
            ));
        }
        Self {
            recording,
            tolerances,
            start_ns,
            first: [None, None, None],
            counts: [Compared::default(); 3],
            missing,
        }
    }

    fn time_s(&self, time_ns: u64) -> f64 {
        (time_ns as f64 - self.start_ns as f64) * 1e-9
    }

    /// Number `number` on that topic is not there, and what comes after it cannot be replayed.
    pub fn gap(&mut self, time_ns: u64, topic: &str, number: u64) {
        self.missing.push(format!(
            "number {number} on {topic} is missing, and what needs it is not replayed from {:.2} s on",
            self.time_s(time_ns)
        ));
    }

    /// A loop was given number `number` of that topic, and today there is none. Why is told already
    /// where an earlier loop ended at a gap or came to something else; else it is a gap.
    pub fn lacks(&mut self, time_ns: u64, topic: &str, number: u64) {
        let is_told = !self.missing.is_empty() || self.first.iter().any(Option::is_some);
        if !is_told {
            self.gap(time_ns, topic, number);
        }
    }

    /// A tick's sample.
    pub fn sample(&mut self, tick: &Tick, today: &Sample) {
        let Some((frame, observation)) = &tick.felt else {
            return;
        };
        let Tolerances { state, force_n, .. } = self.tolerances;
        let [f_d, f_z, f_n] = observation.forces_n;
        let [d, z, n] = today.forces_n;
        let fields = [
            number(
                "displacement",
                observation.displacement,
                today.displacement,
                state,
            ),
            number("f_d", f_d, d, force_n),
            number("f_z", f_z, z, force_n),
            number("f_n", f_n, n, force_n),
            number("speed_m_s", frame.speed_m_s, today.speed_m_s, 0.0),
            exact("settled", json!(frame.settled), json!(today.settled)),
        ];
        self.take(OBSERVATION, tick.time_ns, tick.tick, fields);
    }

    /// A step of the filter.
    pub fn belief(&mut self, step: &BeliefStep, today: &Result<BeliefMessage, String>) {
        let recorded = &step.message;
        let fields = match today {
            Ok(today) => vec![
                exact("error", json!(step.error), Value::Null),
                number(
                    "mean",
                    recorded.summary.mean,
                    today.summary.mean,
                    self.tolerances.state,
                ),
                number(
                    "entropy",
                    recorded.summary.entropy,
                    today.summary.entropy,
                    self.tolerances.entropy,
                ),
                exact(
                    "allowed",
                    self.names(recorded.allowed),
                    self.names(today.allowed),
                ),
            ],
            Err(error) => vec![exact("error", json!(step.error), json!(error))],
        };
        self.take(BELIEF, step.time_ns, recorded.step, fields);
    }

    /// A step of the policy.
    pub fn choice(&mut self, choice: &Choice, today: &Result<(usize, ChoiceVerdict), String>) {
        let fields = match today {
            Ok((action, verdict)) => vec![
                exact("error", json!(choice.error), Value::Null),
                exact("action", self.name(choice.action), self.name(*action)),
                exact("verdict", json!(choice.verdict), json!(verdict)),
            ],
            Err(error) => vec![exact("error", json!(choice.error), json!(error))],
        };
        self.take(POLICY, choice.time_ns, choice.step, fields);
    }

    fn name(&self, action: usize) -> Value {
        json!(self.recording.header.actions.get(action))
    }

    fn names(&self, allowed: u64) -> Value {
        let actions = self.recording.header.actions.iter().enumerate();
        let allowed = actions.filter(|(index, _)| allowed >> index & 1 == 1);
        allowed.map(|(_, name)| name.as_str()).collect()
    }

    fn take(
        &mut self,
        what: usize,
        time_ns: u64,
        step: u64,
        fields: impl IntoIterator<Item = Field>,
    ) {
        self.counts[what].compared += 1;
        let differing = fields.into_iter().find(|(.., same)| !same);
        let Some((field, recorded, replayed, _)) = differing else {
            return;
        };
        self.counts[what].differ += 1;
        let time_s = self.time_s(time_ns);
        self.first[what].get_or_insert(Difference {
            time_s,
            topic: TOPICS[what],
            step,
            field,
            recorded,
            replayed,
        });
    }

    /// All of it; `unit` is the vector unit of the replay.
    pub fn report(self, unit: String) -> ReplayReport {
        let last_ns = self.recording.ticks.last().map_or(0, |tick| tick.time_ns);
        let time_s = self.time_s(last_ns).max(0.0);
        let mut differences: Vec<Difference> = self.first.into_iter().flatten().collect();
        // Stable: what feeds the others comes first where times are the same.
        differences.sort_by(|one, other| one.time_s.total_cmp(&other.time_s));
        let [observations, beliefs, actions] = self.counts;
        ReplayReport {
            same: differences.is_empty() && self.missing.is_empty(),
            first: differences.first().cloned(),
            differences,
            observations,
            beliefs,
            actions,
            time_s,
            missing: self.missing,
            recorded_on: self.recording.run.vector_unit.clone(),
            replayed_on: unit,
        }
    }
}

fn number(field: &'static str, recorded: f64, today: f64, tolerance: f64) -> Field {
    let same = recorded.to_bits() == today.to_bits() || (recorded - today).abs() <= tolerance;
    (field, json!(recorded), json!(today), same)
}

fn exact(field: &'static str, recorded: Value, today: Value) -> Field {
    let same = recorded == today;
    (field, recorded, today, same)
}
