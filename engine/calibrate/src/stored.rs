//! The model of one action and channel, as its segments hold it.

use crate::{Channel, Segment, Values};

/// Segments of one action and channel, in increasing order.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored<'a>(Vec<&'a Segment>);

impl<'a> Stored<'a> {
    /// Those of `segments` that belong to this action and channel; None where there is none.
    pub fn of(segments: &'a [Segment], action: &str, channel: Channel) -> Option<Self> {
        let belongs = |segment: &&Segment| segment.action == action && segment.channel == channel;
        let mut own: Vec<_> = segments.iter().filter(belongs).collect();
        own.sort_by(|a, b| a.from.total_cmp(&b.from));
        (!own.is_empty()).then_some(Self(own))
    }

    /// Its segments.
    pub fn segments(&self) -> &[&'a Segment] {
        &self.0
    }

    /// The first start and the last end (rad or m).
    pub fn ends(&self) -> (f64, f64) {
        let (first, last) = (self.0.first(), self.0.last());
        first
            .zip(last)
            .map_or((0.0, 0.0), |(first, last)| (first.from, last.to))
    }

    /// Distance from the first start to the last end (rad or m).
    pub fn range(&self) -> f64 {
        let (first, last) = self.ends();
        last - first
    }

    /// Mean and sigma, N, at a state (rad or m), eq. (11): linear between positions, constant
    /// beyond the first and last of a segment; a boundary belongs to the segment that starts
    /// there. For m_p the probability and its standard deviation √(p (1 − p)).
    pub fn moments(&self, state: f64) -> (f64, f64) {
        let after = self.0.partition_point(|segment| segment.from <= state);
        match &self.0[after.saturating_sub(1)].values {
            Values::Moves { probability } => {
                (*probability, (probability * (1.0 - probability)).sqrt())
            }
            Values::Force {
                position,
                mean_n,
                sigma_n,
            } => (at(position, mean_n, state), at(position, sigma_n, state)),
        }
    }
}

/// A curve at a state; one value holds everywhere.
pub(crate) fn at(position: &[f64], value: &[f64], state: f64) -> f64 {
    let right = position.partition_point(|&p| p <= state).min(value.len());
    if right == 0 || right == value.len() {
        return value[right.saturating_sub(1)];
    }
    let part = (state - position[right - 1]) / (position[right] - position[right - 1]);
    value[right - 1] + part * (value[right] - value[right - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(from: f64, to: f64, channel: Channel, values: Values) -> Segment {
        Segment {
            action: "a".to_owned(),
            channel,
            from,
            to,
            values,
            note: None,
        }
    }

    #[test]
    fn moments_are_linear_within_a_segment_and_jump_between_two() {
        let curve = Values::Force {
            position: vec![0.0, 1.0],
            mean_n: vec![10.0, 20.0],
            sigma_n: vec![1.0, 3.0],
        };
        let constant = Values::Force {
            position: vec![3.0, 4.0],
            mean_n: vec![-1.0, -2.0],
            sigma_n: vec![0.5],
        };
        let segments = [
            segment(2.0, 4.0, Channel::Up, constant),
            segment(0.0, 2.0, Channel::Up, curve),
            segment(0.0, 4.0, Channel::Moves, Values::Moves { probability: 0.2 }),
        ];
        let stored = Stored::of(&segments, "a", Channel::Up).expect("two segments");
        assert_eq!(stored.range(), 4.0);
        let cases = [
            (-1.0, (10.0, 1.0)),
            (0.0, (10.0, 1.0)),
            (0.5, (15.0, 2.0)),
            (1.5, (20.0, 3.0)),
            (2.0, (-1.0, 0.5)),
            (3.5, (-1.5, 0.5)),
            (9.0, (-2.0, 0.5)),
        ];
        for (state, expected) in cases {
            assert_eq!(stored.moments(state), expected, "at {state}");
        }
        let moves = Stored::of(&segments, "a", Channel::Moves).expect("one segment");
        assert_eq!(moves.moments(1.0), (0.2, 0.4));
        assert_eq!(Stored::of(&segments, "b", Channel::Up), None);
    }
}
