//! Dropping what optimal play from the initial belief cannot need.

use super::{ROOT, Sarsop};

/// When to look again.
#[derive(Default)]
pub(super) struct Pruning {
    vectors_kept: usize,
    pairs_kept: usize,
}

/// Prune where a set has grown by this factor since it was last pruned.
const GROWTH: f64 = 1.25;
const SLACK: usize = 20;

impl Sarsop<'_> {
    /// Prunes the vectors and the pairs where they have grown enough to be worth the look.
    pub(super) fn prune(&mut self) {
        let grown = |now: usize, kept: usize| now > (kept as f64 * GROWTH) as usize + SLACK;
        let vectors = grown(self.lower.live().len(), self.pruning.vectors_kept);
        let pairs = grown(self.upper.pairs(), self.pruning.pairs_kept);
        if !vectors && !pairs {
            return;
        }
        let reached = self.reached();
        if vectors {
            self.prune_vectors(&reached);
            self.pruning.vectors_kept = self.lower.live().len();
        }
        if pairs {
            self.upper.prune(&reached, &mut self.tree.probe);
            self.pruning.pairs_kept = self.upper.pairs();
        }
    }

    /// Marks the nodes that play can reach without an action known to be worse than another.
    fn reached(&self) -> Vec<bool> {
        let mut reached = vec![false; self.tree.nodes.len()];
        let mut open = vec![ROOT];
        reached[ROOT] = true;
        while let Some(index) = open.pop() {
            let node = &self.tree.nodes[index];
            let branches = node.branches.iter();
            let possible = branches.filter(|branch| branch.upper >= node.lower);
            for outcomes in possible.filter_map(|branch| branch.outcomes.as_ref()) {
                for child in outcomes.children.iter().filter_map(|child| child.node) {
                    if !std::mem::replace(&mut reached[child], true) {
                        open.push(child);
                    }
                }
            }
        }
        reached
    }

    /// Keeps the vectors that are best at a reached node. What their plans go on with may be pruned:
    /// the policy takes its whole plan from all that were made.
    fn prune_vectors(&mut self, reached: &[bool]) {
        let mut keep = Vec::new();
        for (index, _) in reached.iter().enumerate().filter(|entry| *entry.1) {
            self.tree.refresh_node(index, &self.lower);
            let node = &self.tree.nodes[index];
            keep.push(node.alpha.id);
        }
        keep.sort_unstable();
        keep.dedup();
        self.lower.retain(&keep);
    }
}
