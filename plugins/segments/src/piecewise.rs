//! The definition of eq. (11)'s mean and sigma over the joint state, in f64.

/// Values at strictly increasing positions, linear between them, constant beyond the ends.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    /// Positions (rad, m or plain); one value at least.
    position: Vec<f64>,
    value: Vec<f64>,
}

impl Curve {
    /// The same value everywhere.
    pub(crate) fn constant(value: f64) -> Self {
        Self {
            position: vec![0.0],
            value: vec![value],
        }
    }

    /// `position` and `value` of one length, not empty, positions strictly increasing.
    pub(crate) fn new(position: Vec<f64>, value: Vec<f64>) -> Self {
        debug_assert!(position.len() == value.len() && !position.is_empty());
        Self { position, value }
    }

    fn at(&self, state: f64) -> f64 {
        let right = self.position.partition_point(|&p| p <= state);
        if right == 0 {
            return self.value[0];
        }
        if right == self.position.len() {
            return self.value[right - 1];
        }
        let (p0, p1) = (self.position[right - 1], self.position[right]);
        let (v0, v1) = (self.value[right - 1], self.value[right]);
        v0 + (state - p0) / (p1 - p0) * (v1 - v0)
    }
}

/// One calibration segment, in SI.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    /// Its place in the object file's list, from 0.
    pub(crate) index: usize,
    /// Index of the action.
    pub(crate) action: usize,
    /// Index of the channel.
    pub(crate) channel: usize,
    /// Where it starts.
    pub(crate) from: f64,
    /// Where it ends.
    pub(crate) to: f64,
    /// Mean force, N; for m_p the probability of 1.
    pub(crate) mean: Curve,
    /// Sigma of the force, N; 1 for m_p, where nobody reads it.
    pub(crate) sigma: Curve,
}

impl Segment {
    /// Distance between the two knots (start, positions, end) that lie nearest to each other,
    /// leaving out those closer than `negligible`.
    pub(crate) fn smallest_knot_distance(&self, negligible: f64) -> f64 {
        let longest = if self.mean.position.len() > 1 {
            &self.mean
        } else {
            &self.sigma
        };
        let inner = if longest.position.len() > 1 {
            longest.position.as_slice()
        } else {
            &[]
        };
        let ends = [
            inner.first().copied().unwrap_or(self.to) - self.from,
            self.to - inner.last().copied().unwrap_or(self.from),
        ];
        let between = inner.windows(2).map(|pair| pair[1] - pair[0]);
        between
            .chain(ends)
            .filter(|&distance| distance > negligible)
            .fold(f64::INFINITY, f64::min)
    }
}

/// The segments of one action and channel from the closed to the open limit.
#[derive(Debug)]
pub(crate) struct Piecewise<'a>(Vec<&'a Segment>);

impl<'a> Piecewise<'a> {
    /// Takes the segments of this action and channel; they tile the range.
    pub(crate) fn new(segments: &'a [Segment], action: usize, channel: usize) -> Self {
        let mut own: Vec<_> = segments
            .iter()
            .filter(|s| s.action == action && s.channel == channel)
            .collect();
        own.sort_by(|a, b| a.from.total_cmp(&b.from));
        Self(own)
    }

    /// Mean and sigma at a state; a boundary belongs to the segment that starts there.
    pub(crate) fn at(&self, state: f64) -> (f64, f64) {
        let after = self.0.partition_point(|segment| segment.from <= state);
        let segment = self.0[after.saturating_sub(1)];
        (segment.mean.at(state), segment.sigma.at(state))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_linear_between_and_constant_beyond() {
        let curve = Curve::new(vec![1.0, 2.0, 4.0], vec![10.0, 20.0, 0.0]);
        let cases = [
            (0.0, 10.0),
            (1.0, 10.0),
            (1.5, 15.0),
            (2.0, 20.0),
            (3.0, 10.0),
            (4.0, 0.0),
            (9.0, 0.0),
        ];
        for (state, expected) in cases {
            assert_eq!(curve.at(state), expected, "at {state}");
        }
        assert_eq!(Curve::constant(3.0).at(-7.0), 3.0);
    }

    #[test]
    fn the_nearest_knots_count_the_ends_and_pass_over_repeats() {
        let segment = |position: Vec<f64>| Segment {
            index: 0,
            action: 0,
            channel: 0,
            from: 0.0,
            to: 10.0,
            mean: Curve::new(position.clone(), vec![0.0; position.len()]),
            sigma: Curve::constant(1.0),
        };
        for (position, expected) in [
            (vec![0.0, 4.0, 7.0], 3.0),
            (vec![0.5, 4.0, 7.0], 0.5),
            (vec![0.0, 9.0, 10.0], 1.0),
            (vec![3.0], 10.0),
        ] {
            assert_eq!(
                segment(position.clone()).smallest_knot_distance(1e-9),
                expected,
                "{position:?}"
            );
        }
    }
}
