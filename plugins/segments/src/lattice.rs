//! The regular nodes at which a model is tabulated, and where a state lies among them.

use pubs_plugin::{ModelSetup, PluginError};

use crate::piecewise::Segment;

/// Nodes over the range that every table has at least.
const MIN_NODES: f64 = 2_000.0;
/// Nodes over the range up to which knots that lie close together refine a table.
const MAX_REFINED_NODES: f64 = 20_000.0;
/// Nodes over the range that no table exceeds.
const MAX_NODES: f64 = 2_000_000.0;
/// Grid spacings that differ by less, relatively, count as the prepared one.
const SPACING_TOLERANCE: f64 = 1e-5;

/// Node k lies at `lower + k · spacing / refinement`, for k = 0 ..= `last`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lattice {
    lower: f64,
    nodes_per_state: f64,
    spacing: f64,
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
    /// Node below the first hypothesis inside; the next one has its node `refinement` higher.
    pub(crate) node: usize,
    /// Where all of them lie between their node and the next, in [0, 1).
    pub(crate) fraction: f32,
}

impl Lattice {
    /// Chooses the nodes for an object.
    ///
    /// # Errors
    /// Where the range or the spacing is not positive, or the spacing is too fine to tabulate.
    pub(crate) fn new(setup: &ModelSetup, segments: &[Segment]) -> Result<Self, PluginError> {
        let (lower, spacing) = (setup.joint.lower, setup.belief.spacing);
        let range = setup.joint.upper - lower;
        let particles_apart = range / spacing;
        if !(range > 0.0 && range.is_finite() && spacing > 0.0 && particles_apart <= MAX_NODES) {
            return Err(PluginError::new(format!(
                "belief: a range of {range} with particles {spacing} apart; both must be positive and the range at most \
                 {MAX_NODES} particles wide; correct the joint's limits or take fewer particles"
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
        Ok(Self {
            lower,
            nodes_per_state,
            spacing,
            refinement: refinement as usize,
            last: last as usize,
        })
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

    /// Cuts `count` hypotheses at the particles' spacing, the first at state `first`.
    #[inline(always)]
    pub(crate) fn span(&self, first: f32, count: usize) -> Span {
        let step = self.refinement as i64;
        let reach = (count as i64 + 1) * step;
        let place = (f64::from(first) - self.lower) * self.nodes_per_state;
        // Farther away nothing changes, and the arithmetic below cannot overflow.
        let place = place
            .max(-(reach as f64))
            .min((self.last + self.refinement) as f64);
        let start = place.floor();
        let fraction = (place - start) as f32;
        let start = start as i64;
        let left = (-start.div_euclid(step)).clamp(0, count as i64);
        let node = start + left * step;
        let inside = ((self.last as i64 - node).div_euclid(step) + 1).clamp(0, count as i64 - left);
        Span {
            left: left as usize,
            inside: inside as usize,
            node: node as usize,
            fraction,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes at 10, 10.5, … 14; particles 1 apart.
    const LATTICE: Lattice = Lattice {
        lower: 10.0,
        nodes_per_state: 2.0,
        spacing: 1.0,
        refinement: 2,
        last: 8,
    };

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
            assert_eq!(LATTICE.locate(state), (node, fraction), "state {state}");
        }
    }

    #[test]
    fn a_span_is_cut_at_both_ends() {
        // first, count -> left, inside, node, fraction
        let cases = [
            (10.0, 5, 0, 5, 0, 0.0),
            (10.25, 5, 0, 4, 0, 0.5),
            (10.75, 5, 0, 4, 1, 0.5),
            (8.75, 8, 2, 4, 1, 0.5),
            (9.0, 3, 1, 2, 0, 0.0),
            (14.0, 3, 0, 1, 8, 0.0),
            (13.75, 1, 0, 1, 7, 0.5),
        ];
        for (first, count, left, inside, node, fraction) in cases {
            assert_eq!(
                LATTICE.span(first, count),
                Span {
                    left,
                    inside,
                    node,
                    fraction
                },
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
            let span = LATTICE.span(first, 4);
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
            assert_eq!(LATTICE.has_spacing(spacing), same, "{spacing}");
        }
    }
}
