//! The regular nodes at which a model is tabulated, and where a state lies among them.

use std::ops::RangeInclusive;

use pubs_plugin::{ModelSetup, PluginError};

use crate::piecewise::Segment;

/// Nodes over the range that every table has at least.
const MIN_NODES: f64 = 2_000.0;
/// Nodes over the range up to which knots that lie close together refine a table.
const MAX_REFINED_NODES: f64 = 20_000.0;
/// Distances of particles that the range may hold; beyond, a table would be pointless or huge.
const PARTICLES_APART: RangeInclusive<f64> = 0.5..=2_000_000.0;
/// Grid spacings that differ by less, relatively, count as the prepared one.
const SPACING_TOLERANCE: f64 = 1e-5;

/// Node k lies at `lower + k · spacing / refinement`, for k = 0 ..= `last`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lattice {
    pub(crate) lower: f64,
    pub(crate) nodes_per_state: f64,
    particles_per_state: f64,
    spacing: f64,
    /// The last node is node `last_entry · refinement + last_phase`.
    last_entry: i64,
    last_phase: i64,
    /// Node distances from one particle to the next, m.
    pub(crate) refinement: usize,
    /// Index of the last node; it lies at the upper limit or less than one node beyond it.
    pub(crate) last: usize,
}

/// Hypotheses at one spacing, cut where they leave the table: `left` of them lie below it, then
/// `inside` within it, the rest above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) left: usize,
    pub(crate) inside: usize,
    /// The first hypothesis inside lies above node `entry · refinement + phase`, the next above
    /// `(entry + 1) · refinement + phase`.
    pub(crate) entry: usize,
    /// Below `refinement`, the same for all hypotheses.
    pub(crate) phase: usize,
    /// How far each lies on the way from its node to the next, in [0, 1).
    pub(crate) fraction: f32,
}

impl Lattice {
    /// Chooses the nodes for an object.
    ///
    /// # Errors
    /// Where the range or the spacing is not positive, or they do not go together.
    pub(crate) fn new(setup: &ModelSetup, segments: &[Segment]) -> Result<Self, PluginError> {
        let (lower, spacing) = (setup.joint.lower, setup.belief.spacing);
        let range = setup.joint.upper - lower;
        let particles_apart = range / spacing;
        let possible =
            range > 0.0 && range.is_finite() && PARTICLES_APART.contains(&particles_apart);
        if !possible {
            return Err(PluginError::new(format!(
                "belief: a range of {range} with particles {spacing} apart; the range must be positive and {} to {} \
                 times as wide as the distance of particles; correct the joint's limits or the number of particles",
                PARTICLES_APART.start(),
                PARTICLES_APART.end()
            )));
        }
        let knots = segments
            .iter()
            .map(|s| s.smallest_knot_distance(1e-9 * range))
            .fold(range, f64::min);
        let least = (MIN_NODES / particles_apart).ceil().max(1.0);
        let wanted = (2.0 * spacing / knots).floor() + 1.0;
        let affordable = (MAX_REFINED_NODES / particles_apart).floor();
        let refinement = least.max(wanted.min(affordable));
        let nodes_per_state = refinement / spacing;
        // Rounding must not add a node beyond a limit that is a whole number of nodes away.
        let last = (range * nodes_per_state - 1e-6).ceil();
        Ok(Self::with(
            lower,
            spacing,
            refinement as usize,
            last as usize,
        ))
    }

    fn with(lower: f64, spacing: f64, refinement: usize, last: usize) -> Self {
        Self {
            lower,
            nodes_per_state: refinement as f64 / spacing,
            particles_per_state: spacing.recip(),
            spacing,
            last_entry: (last / refinement) as i64,
            last_phase: (last % refinement) as i64,
            refinement,
            last,
        }
    }

    /// State of a node (rad, m or plain).
    pub(crate) fn state(&self, node: usize) -> f64 {
        self.lower + node as f64 / self.nodes_per_state
    }

    /// Whether a grid has the particles' spacing; over its whole length it then strays by no more
    /// than 1e-5 of that length.
    pub(crate) fn has_spacing(&self, spacing: f32) -> bool {
        (f64::from(spacing) - self.spacing).abs() <= SPACING_TOLERANCE * self.spacing
    }

    /// The node below a state and the fraction of the way to the next, at the table's end for
    /// states beyond it; in f64, for an f32 index would lose the fraction. NaN gives node 0.
    #[inline(always)]
    pub(crate) fn locate(&self, state: f32) -> (u32, f32) {
        let place = (f64::from(state) - self.lower) * self.nodes_per_state;
        let place = place.max(0.0).min(self.last as f64);
        let node = place as i32;
        (node as u32, (place - f64::from(node)) as f32)
    }

    /// Cuts `count` hypotheses at the particles' spacing, the first at state `first`. In f64 and
    /// without an integer division: this is a good part of a grid's time.
    #[inline(always)]
    pub(crate) fn span(&self, first: f32, count: usize) -> Span {
        let place = (f64::from(first) - self.lower) * self.particles_per_state;
        // Farther away nothing changes, and the arithmetic below cannot overflow.
        let place = place.max(-(count as f64) - 1.0).min(self.last as f64 + 1.0);
        let entry = floor(place);
        let node = (place - entry as f64) * self.refinement as f64;
        let phase = (node as i64).min(self.refinement as i64 - 1);
        let fraction = (node - phase as f64) as f32;
        let left = (-entry).clamp(0, count as i64);
        let entry = entry + left;
        let last_entry = self.last_entry - i64::from(phase > self.last_phase);
        let inside = (last_entry - entry + 1).clamp(0, count as i64 - left);
        Span {
            left: left as usize,
            inside: inside as usize,
            entry: entry as usize,
            phase: phase as usize,
            fraction,
        }
    }
}

/// Largest whole number not above a value of moderate size; the library's is a call on processors
/// of the first x86-64 generation.
#[inline(always)]
fn floor(value: f64) -> i64 {
    let whole = value as i64;
    whole - i64::from(whole as f64 > value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes at 10, 10.5, … 14; particles 1 apart.
    fn lattice() -> Lattice {
        Lattice::with(10.0, 1.0, 2, 8)
    }

    #[test]
    fn a_state_has_a_node_and_a_fraction() {
        let cases = [
            (10.0, 0, 0.0),
            (10.25, 0, 0.5),
            (13.875, 7, 0.75),
            (14.0, 8, 0.0),
            (9.0, 0, 0.0),
            (99.0, 8, 0.0),
            (f32::INFINITY, 8, 0.0),
        ];
        for (state, node, fraction) in cases {
            assert_eq!(lattice().locate(state), (node, fraction), "state {state}");
        }
    }

    #[test]
    fn a_span_is_cut_at_both_ends() {
        // first, count -> left, inside, entry, phase, fraction
        let cases = [
            (10.0, 5, 0, 5, 0, 0, 0.0),
            (10.25, 5, 0, 5, 0, 0, 0.5),
            (10.75, 5, 0, 4, 0, 1, 0.5),
            (8.75, 8, 2, 4, 0, 1, 0.5),
            (9.0, 3, 1, 2, 0, 0, 0.0),
            (14.0, 3, 0, 1, 4, 0, 0.0),
            (13.75, 1, 0, 1, 3, 1, 0.5),
        ];
        for (first, count, left, inside, entry, phase, fraction) in cases {
            let expected = Span {
                left,
                inside,
                entry,
                phase,
                fraction,
            };
            assert_eq!(
                lattice().span(first, count),
                expected,
                "first {first}, count {count}"
            );
        }
    }

    #[test]
    fn hypotheses_all_outside_touch_no_node() {
        for (first, left) in [
            (-1e30, 4),
            (2.0, 4),
            (14.5, 0),
            (1e30, 0),
            (f32::INFINITY, 0),
            (f32::NEG_INFINITY, 4),
        ] {
            let span = lattice().span(first, 4);
            assert_eq!((span.left, span.inside), (left, 0), "first {first}");
        }
    }

    #[test]
    fn only_the_prepared_spacing_is_a_grid() {
        for (spacing, same) in [
            (1.0, true),
            (1.000005, true),
            (0.999, false),
            (1.001, false),
            (f32::NAN, false),
        ] {
            assert_eq!(lattice().has_spacing(spacing), same, "{spacing}");
        }
    }
}
