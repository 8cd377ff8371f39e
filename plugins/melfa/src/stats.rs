//! Figures of a session: pacing, packets, steps.

use std::fmt;

/// Lateness is counted in steps of so much, ns.
const STEP_NS: u64 = 10_000;

/// And up to so many of them; later is counted as that.
const STEPS: usize = 2_000;

/// How late cycles were: a histogram, so that it never grows.
#[derive(Debug, Clone)]
pub struct Lateness {
    counts: Vec<u64>,
    greatest_ns: u64,
    total: u64,
}

impl Default for Lateness {
    fn default() -> Self {
        Self {
            counts: vec![0; STEPS],
            greatest_ns: 0,
            total: 0,
        }
    }
}

impl Lateness {
    /// Counts one cycle.
    pub fn record(&mut self, late_ns: u64) {
        let step = ((late_ns / STEP_NS) as usize).min(STEPS - 1);
        self.counts[step] += 1;
        self.greatest_ns = self.greatest_ns.max(late_ns);
        self.total += 1;
    }

    /// The upper edge of the step that holds this share of all cycles, µs.
    pub fn percentile_us(&self, share: f64) -> f64 {
        let wanted = (share * self.total as f64).ceil() as u64;
        let mut seen = 0;
        for (step, count) in self.counts.iter().enumerate() {
            seen += count;
            if seen >= wanted && seen > 0 {
                let edge_ns = (step as u64 + 1) * STEP_NS;
                return edge_ns.min(self.greatest_ns) as f64 * 1e-3;
            }
        }
        0.0
    }

    /// The latest cycle, µs.
    pub fn greatest_us(&self) -> f64 {
        self.greatest_ns as f64 * 1e-3
    }
}

/// What a session came to.
#[derive(Debug, Clone, Default)]
pub struct Stats {
    /// Of the motion thread's cycles.
    pub lateness: Lateness,
    /// Packets sent to MXT.
    pub sent: u64,
    /// New replies.
    pub replies: u64,
    /// Packets that were short, foreign to the protocol, repeated or overtaken.
    pub ignored: u64,
    /// Requests without a reply in time.
    pub misses: u64,
    /// Links made again.
    pub relinks: u64,
    /// Greatest step of the target in one cycle, m.
    pub step_m: f64,
    /// Its limit, m.
    pub step_limit_m: f64,
    /// Greatest share of a joint's speed limit that a step used.
    pub joint_share: f64,
    /// Its limit.
    pub joint_share_limit: f64,
    /// Whether the motion thread got real-time scheduling.
    pub real_time: bool,
}

impl Stats {
    /// Packets sent for each reply that came.
    pub fn sent_per_reply(&self) -> f64 {
        self.sent as f64 / self.replies.max(1) as f64
    }
}

impl fmt::Display for Stats {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "cycle late p50 {:.0} p99 {:.0} max {:.0} µs{}, {} sent, {:.3} per reply, {} missed, {} ignored, \
             {} relinked, greatest step {:.4} of {:.4} mm, joint speed {:.2} of {:.2} of its limit",
            self.lateness.percentile_us(0.5),
            self.lateness.percentile_us(0.99),
            self.lateness.greatest_us(),
            if self.real_time { " (real time)" } else { "" },
            self.sent,
            self.sent_per_reply(),
            self.misses,
            self.ignored,
            self.relinks,
            self.step_m * 1e3,
            self.step_limit_m * 1e3,
            self.joint_share,
            self.joint_share_limit,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_upper_edges() {
        let mut lateness = Lateness::default();
        assert_eq!(lateness.percentile_us(0.5), 0.0);
        for index in 0..100_u64 {
            lateness.record(index * 10_000 + 5_000);
        }
        assert_eq!(lateness.percentile_us(0.5), 500.0);
        assert_eq!(lateness.percentile_us(0.99), 990.0);
        assert_eq!(lateness.greatest_us(), 995.0);
        lateness.record(1_000_000_000_000);
        assert_eq!(lateness.greatest_us(), 1e9);
    }
}
