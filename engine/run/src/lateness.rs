//! How late a loop's ticks were.

use serde::{Deserialize, Serialize};

/// Lateness of every tick so far.
#[derive(Debug, Clone)]
pub struct Lateness {
    period_ns: u64,
    late_us: Vec<u32>,
    missed: u64,
}

/// What the summary of a run shows of one loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LatenessSummary {
    /// Half the ticks were at most this late.
    pub p50_us: u32,
    /// 99 of 100 were.
    pub p99_us: u32,
    /// The latest.
    pub max_us: u32,
    /// Ticks that came more than a period late, and were left out.
    pub missed: u64,
}

impl Lateness {
    /// None yet, with room for `ticks` so that the loop allocates nothing.
    pub fn new(rate_hz: f64, ticks: usize) -> Self {
        Self {
            period_ns: (1e9 / rate_hz) as u64,
            late_us: Vec::with_capacity(ticks),
            missed: 0,
        }
    }

    /// A tick due at `due_ns` came at `came_ns`. How many later ticks are past as well: the loop
    /// skips them instead of hurrying after them.
    pub fn record(&mut self, due_ns: u64, came_ns: u64) -> u64 {
        let late_ns = came_ns.saturating_sub(due_ns);
        if self.late_us.len() < self.late_us.capacity() {
            self.late_us
                .push(u32::try_from(late_ns / 1000).unwrap_or(u32::MAX));
        }
        let skipped = late_ns / self.period_ns;
        self.missed += skipped;
        skipped
    }

    /// The figures.
    pub fn summary(&self) -> LatenessSummary {
        let mut sorted = self.late_us.clone();
        sorted.sort_unstable();
        let quantile = |share: f64| {
            let index = (share * sorted.len() as f64).ceil() as usize;
            sorted.get(index.saturating_sub(1)).copied().unwrap_or(0)
        };
        LatenessSummary {
            p50_us: quantile(0.5),
            p99_us: quantile(0.99),
            max_us: sorted.last().copied().unwrap_or(0),
            missed: self.missed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_and_missed_ticks_by_hand() {
        let mut lateness = Lateness::new(100.0, 200);
        for tick in 1..=100_u64 {
            assert_eq!(lateness.record(1_000_000, 1_000_000 + tick * 1000), 0);
        }
        let expected = LatenessSummary {
            p50_us: 50,
            p99_us: 99,
            max_us: 100,
            missed: 0,
        };
        assert_eq!(lateness.summary(), expected);
        assert_eq!(
            lateness.record(0, 25_000_000),
            2,
            "25 ms late at 10 ms a tick skips two"
        );
        assert_eq!(lateness.summary().missed, 2);
        assert_eq!(lateness.summary().max_us, 25_000);
    }
}
