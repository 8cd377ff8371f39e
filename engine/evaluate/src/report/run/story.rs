//! What happened in a run, as series over time.

use pubs_core::Task;
use pubs_run::recording::{BINS, RunRecording, Tick};

/// A run with a clock that begins at its first tick.
pub(super) struct Story<'a> {
    pub recording: &'a RunRecording,
    pub task: &'a Task,
    start_ns: u64,
    /// How many of the shown units are in one of SI.
    pub factor: f64,
    /// The shown unit.
    pub unit: &'static str,
}

impl<'a> Story<'a> {
    pub fn new(recording: &'a RunRecording, task: &'a Task) -> Self {
        let (unit, factor) = task.joint.kind.shown_unit();
        Self {
            recording,
            task,
            start_ns: recording.ticks.first().map_or(0, |tick| tick.time_ns),
            factor,
            unit,
        }
    }

    pub fn time_s(&self, time_ns: u64) -> f64 {
        (time_ns as f64 - self.start_ns as f64) * 1e-9
    }

    /// Of the last entry of any loop.
    pub fn end_s(&self) -> f64 {
        let ticks = self.recording.ticks.last().map(|tick| tick.time_ns);
        let beliefs = self.recording.beliefs.last().map(|step| step.time_ns);
        let choices = self.recording.choices.last().map(|choice| choice.time_ns);
        let last = [ticks, beliefs, choices].into_iter().flatten().max();
        last.map_or(0.0, |time_ns| self.time_s(time_ns))
    }

    /// Ticks with a reading, with their time.
    pub fn felt(&self) -> impl Iterator<Item = (f64, &'a pubs_run::recording::Frame, [f64; 3])> {
        let ticks: &'a [Tick] = &self.recording.ticks;
        ticks.iter().filter_map(|tick| {
            let (frame, observation) = tick.felt.as_ref()?;
            Some((self.time_s(tick.time_ns), frame, observation.forces_n))
        })
    }

    /// The believed mean, in the shown unit.
    pub fn mean(&self) -> impl Iterator<Item = (f64, Option<f64>)> {
        self.recording.beliefs.iter().map(|step| {
            let mean = step.message.summary.mean * self.factor;
            (
                self.time_s(step.time_ns),
                step.message.valid.then_some(mean),
            )
        })
    }

    /// Entropy, 0 to 1.
    pub fn entropy(&self) -> impl Iterator<Item = (f64, Option<f64>)> {
        self.recording.beliefs.iter().map(|step| {
            let entropy = step.message.summary.entropy;
            (
                self.time_s(step.time_ns),
                step.message.valid.then_some(entropy),
            )
        })
    }

    /// Between these shares of the particles' mass, in the shown unit.
    pub fn between(&self, shares: [f64; 2]) -> impl Iterator<Item = (f64, Option<[f64; 2]>)> {
        let (lower, range) = (self.task.joint.lower, self.task.joint.range());
        let state = move |fraction: f64| (lower + fraction * range) * self.factor;
        self.recording.beliefs.iter().map(move |step| {
            let ends = shares.map(|share| quantile(&step.histogram, share).map(state));
            let [from, to] = ends;
            let ends = from.zip(to).map(|(from, to)| [from, to]);
            (
                self.time_s(step.time_ns),
                ends.filter(|_| step.message.valid),
            )
        })
    }

    /// The true state in the shown unit, where a virtual world tells it.
    pub fn truth(&self) -> Vec<(f64, Option<f64>)> {
        let known = self.felt().map(|(time_s, frame, _)| {
            let truth = frame.truth.map(|truth| truth * self.factor);
            (time_s, truth)
        });
        let known: Vec<_> = known.collect();
        if known.iter().all(|(_, truth)| truth.is_none()) {
            return Vec::new();
        }
        known
    }

    /// From when to when each goal was pursued; it is given by its index.
    pub fn goals(&self) -> Vec<(usize, [f64; 2])> {
        let mut spans: Vec<(usize, [f64; 2])> = Vec::new();
        for choice in &self.recording.choices {
            let time_s = self.time_s(choice.time_ns);
            if let Some((goal, span)) = spans.last_mut() {
                span[1] = time_s;
                if *goal == choice.goal {
                    continue;
                }
            }
            spans.push((choice.goal, [time_s, time_s]));
        }
        if let Some((_, span)) = spans.last_mut() {
            span[1] = self.end_s();
        }
        spans
    }

    /// From when to when each action was in force; it is given by its index.
    pub fn actions(&self) -> Vec<(usize, [f64; 2])> {
        let mut spans: Vec<(usize, [f64; 2])> = Vec::new();
        for (time_s, frame, _) in self.felt() {
            match spans.last_mut() {
                Some((action, span)) if *action == frame.action => span[1] = time_s,
                last => {
                    if let Some((_, span)) = last {
                        span[1] = time_s;
                    }
                    spans.push((frame.action, [time_s, time_s]));
                }
            }
        }
        spans
    }
}

/// Where this share of the mass lies below, as a fraction of the histogram's range; even within a
/// bin. `None` of no mass.
fn quantile(histogram: &[f32; BINS], share: f64) -> Option<f64> {
    let total: f64 = histogram.iter().copied().map(f64::from).sum();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let mut below = 0.0;
    for (bin, mass) in histogram.iter().copied().map(f64::from).enumerate() {
        if mass > 0.0 && below + mass >= share * total {
            let within = (share * total - below) / mass;
            return Some((bin as f64 + within) / BINS as f64);
        }
        below += mass;
    }
    Some(1.0)
}

/// How late each step came, s, after the rules by which a loop keeps its pace: a step that is whole
/// periods late is followed by so many fewer. The recording does not say when steps were due; the
/// most punctual one is taken as on time.
pub(super) fn lateness(times_s: &[f64], rate_hz: f64) -> Vec<(f64, f64)> {
    let period_s = 1.0 / rate_hz;
    let Some(&first_s) = times_s.first() else {
        return Vec::new();
    };
    let mut due = 0.0;
    let mut late = Vec::with_capacity(times_s.len());
    for &time_s in times_s {
        let late_s = time_s - first_s - due * period_s;
        late.push((time_s, late_s));
        due += 1.0 + (late_s * rate_hz).floor().max(0.0);
    }
    let least = late
        .iter()
        .map(|(_, late_s)| *late_s)
        .fold(f64::INFINITY, f64::min);
    for (_, late_s) in &mut late {
        *late_s -= least;
    }
    late
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_lie_evenly_within_a_bin() {
        let mut histogram = [0.0; BINS];
        histogram[10] = 0.25;
        histogram[20] = 0.75;
        let cases = [
            (0.0, 0.2),
            (0.125, 0.21),
            (0.25, 0.22),
            (0.625, 0.41),
            (1.0, 0.42),
        ];
        for (share, expected) in cases {
            let found = quantile(&histogram, share).unwrap_or(f64::NAN);
            assert!(
                (found - expected).abs() < 1e-9,
                "{share}: {found} for {expected}"
            );
        }
        assert_eq!(quantile(&[0.0; BINS], 0.5), None);
        assert_eq!(quantile(&[f32::NAN; BINS], 0.5), None);
    }

    #[test]
    fn lateness_by_hand() {
        // 10 Hz; the second step is 20 ms late, the fourth 130 ms, after which one is left out.
        let times_s = [0.0, 0.12, 0.2, 0.43, 0.5];
        let expected = [0.0, 0.02, 0.0, 0.13, 0.0];
        for (found, expected) in lateness(&times_s, 10.0).iter().zip(expected) {
            assert!(
                (found.1 - expected).abs() < 1e-9,
                "{found:?} for {expected}"
            );
        }
        assert!(lateness(&[], 10.0).is_empty());
    }
}
