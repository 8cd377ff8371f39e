//! Point-based backups of both bounds at a sampled belief.

use super::Sarsop;
use super::lower::{Alpha, backed_up};

/// A bound that moves by less than this share of its size has not moved.
const NOISE: f64 = 1e-10;

impl Sarsop<'_> {
    /// Backs both bounds up at a node.
    pub(super) fn back_up(&mut self, node: usize) {
        self.back_up_upper(node);
        self.back_up_lower(node);
        let node = &mut self.tree.nodes[node];
        let before = node.predicted_from.replace(node.lower);
        self.predictor
            .learn(node.features, before, node.lower, node.features.0);
    }

    /// The action with the greatest upper bound; bounds that may hold too much are brought up to
    /// date until the greatest is.
    pub(super) fn refresh_greatest_upper(&mut self, node: usize) -> usize {
        let mut fresh = usize::MAX;
        loop {
            let branches = &self.tree.nodes[node].branches;
            let mut greatest = 0;
            for (action, branch) in branches.iter().enumerate() {
                if branch.upper > branches[greatest].upper {
                    greatest = action;
                }
            }
            if greatest == fresh {
                return greatest;
            }
            self.tree.expand(node, greatest, &self.lower, &self.upper);
            self.tree.refresh_upper(node, greatest, &self.upper);
            fresh = greatest;
        }
    }

    fn back_up_upper(&mut self, index: usize) {
        let action = self.refresh_greatest_upper(index);
        let node = &mut self.tree.nodes[index];
        let value = node.branches[action].upper;
        if value < node.upper - NOISE * (1.0 + value.abs()) {
            node.upper = value;
            self.upper.lower(index, &node.belief, value);
        }
    }

    fn back_up_lower(&mut self, index: usize) {
        self.tree.refresh_node(index, &self.lower);
        let action = self.refresh_greatest_lower(index);
        let node = &self.tree.nodes[index];
        let branch = &node.branches[action];
        if branch.lower <= node.lower + NOISE * (1.0 + node.lower.abs()) {
            return;
        }
        let Some(outcomes) = &branch.outcomes else {
            return;
        };
        // What cannot be observed at this belief may be followed by any vector.
        let mut follow: Vec<&Alpha> = vec![&node.alpha; self.tree.pomdp.observations().len()];
        for child in &outcomes.children {
            follow[child.observation] = &child.alpha;
        }
        let values = backed_up(self.tree.pomdp, action, &follow);
        let follow: Vec<u32> = follow.iter().map(|alpha| alpha.id).collect();
        self.lower.insert(action, values, &follow);
        self.tree.refresh_node(index, &self.lower);
    }

    /// The action with the greatest lower bound, of those that may be optimal.
    fn refresh_greatest_lower(&mut self, node: usize) -> usize {
        let mut greatest = (f64::MIN, 0);
        for action in 0..self.tree.pomdp.actions().len() {
            if self.tree.nodes[node].branches[action].upper < self.tree.nodes[node].lower {
                continue;
            }
            self.tree.expand(node, action, &self.lower, &self.upper);
            self.tree.refresh_lower(node, action, &self.lower);
            let lower = self.tree.nodes[node].branches[action].lower;
            if lower > greatest.0 {
                greatest = (lower, action);
            }
        }
        greatest.1
    }
}
