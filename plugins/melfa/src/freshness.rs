//! Telling new packets from repeated and overtaken ones by their running number.

/// After so many packets in a row with older numbers the count has begun again.
const RESTARTED: u32 = 20;

/// The newest number seen.
#[derive(Debug, Clone, Default)]
pub struct Freshness {
    newest: Option<u32>,
    /// Whether numbers change at all; what the controller counts is not documented.
    counts: bool,
    older: u32,
}

impl Freshness {
    /// Whether a packet with this number is newer than all before.
    pub fn accepts(&mut self, number: u32) -> bool {
        let Some(newest) = self.newest else {
            self.newest = Some(number);
            return true;
        };
        // Numbers wrap round, so "newer" is less than half of them ahead.
        let ahead = number.wrapping_sub(newest) as i32;
        self.counts |= ahead != 0;
        if ahead == 0 && !self.counts {
            return true;
        }
        self.older = if ahead < 0 { self.older + 1 } else { 0 };
        let newer = ahead > 0 || self.older > RESTARTED;
        if newer {
            self.newest = Some(number);
            self.older = 0;
        }
        newer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_and_overtaken_packets_are_old() {
        let cases: [(&str, &[u32], &[bool]); 4] = [
            ("in order", &[1, 2, 3, 7], &[true, true, true, true]),
            ("repeated", &[1, 2, 2, 3], &[true, true, false, true]),
            ("overtaken", &[1, 3, 2, 4], &[true, true, false, true]),
            (
                "wrapping",
                &[u32::MAX, 0, u32::MAX, 1],
                &[true, true, false, true],
            ),
        ];
        for (name, numbers, expected) in cases {
            let mut fresh = Freshness::default();
            let found: Vec<bool> = numbers
                .iter()
                .map(|number| fresh.accepts(*number))
                .collect();
            assert_eq!(found, expected, "{name}: {numbers:?}");
        }
    }

    #[test]
    fn a_controller_that_does_not_count_is_believed() {
        let mut fresh = Freshness::default();
        assert!((0..100).all(|_| fresh.accepts(0)), "all zero");
    }

    #[test]
    fn a_count_that_begins_again_is_taken_up() {
        let mut fresh = Freshness::default();
        assert!((1000..1010).all(|number| fresh.accepts(number)));
        let taken = (0..100).filter(|number| fresh.accepts(*number)).count();
        assert_eq!(taken, 100 - RESTARTED as usize);
    }
}
