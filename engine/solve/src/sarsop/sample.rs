//! A trial: a walk down the tree where it is worth while (SARSOP, algorithm 3).

use super::{ROOT, Sarsop, TRIAL_SHARE};
use crate::solve::Progress;

/// A path is never longer than this.
const MAX_DEPTH: usize = 10_000;

impl Sarsop<'_> {
    /// The nodes of a new path, the root first. `interrupt` is asked at each.
    pub(super) fn sample(
        &mut self,
        precision: f64,
        mut interrupt: impl FnMut(&dyn Fn() -> Progress) -> bool,
    ) -> Vec<usize> {
        self.trials += 1;
        let discount = self.tree.pomdp.discount();
        let root = &self.tree.nodes[ROOT];
        let mut allowed = (self.gap() * TRIAL_SHARE).max(precision * 0.9);
        let (mut wanted_lower, mut wanted_upper) = (root.lower, root.lower + allowed);
        let (mut node, mut path) = (ROOT, Vec::new());
        while path.len() < MAX_DEPTH {
            path.push(node);
            if self.is_late() || interrupt(&|| self.progress()) {
                break;
            }
            self.tree.refresh_node(node, &self.lower);
            let here = &self.tree.nodes[node];
            let predicted = self.predictor.predict(here.features, here.upper);
            let close = here.upper <= wanted_upper.max(here.lower + allowed);
            let closed = here.upper - here.lower <= allowed * 0.02;
            if closed || close && predicted <= wanted_lower {
                break;
            }
            let action = self.refresh_greatest_upper(node);
            self.tree.refresh_lower(node, action, &self.lower);
            allowed /= discount;
            let here = &self.tree.nodes[node];
            let best = here.branches.iter().map(|branch| branch.lower);
            let best = best.fold(f64::MIN, f64::max);
            wanted_lower = wanted_lower.max(best);
            wanted_upper = wanted_upper.max(best + allowed * discount);
            let Some(outcomes) = &here.branches[action].outcomes else {
                break;
            };
            let mut widest = (f64::MIN, 0);
            let (mut lower_sum, mut upper_sum) = (0.0, 0.0);
            for (slot, child) in outcomes.children.iter().enumerate() {
                lower_sum += child.lower;
                upper_sum += child.upper;
                let excess = child.upper - child.lower - child.probability * allowed;
                if excess > widest.0 {
                    widest = (excess, slot);
                }
            }
            let child = &outcomes.children[widest.1];
            let needed = |wanted: f64, others: f64| {
                ((wanted - outcomes.reward) / discount - others) / child.probability
            };
            wanted_lower = needed(wanted_lower, lower_sum - child.lower);
            wanted_upper = needed(wanted_upper, upper_sum - child.upper);
            let next = self
                .tree
                .child_node(node, action, widest.1, &self.lower, &self.upper);
            let Some(next) = next else { break };
            node = next;
        }
        path
    }
}
