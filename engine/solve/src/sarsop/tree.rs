//! The sampled beliefs: a tree, but for beliefs met twice, which are one node.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

use super::lower::{Alpha, LowerBound, add_observations};
use super::sparse_belief::SparseBelief;
use super::upper::{Probe, UpperBound};
use crate::pomdp::Pomdp;

/// A sampled belief and what is known of its value.
pub(super) struct Node {
    pub belief: SparseBelief,
    pub lower: f64,
    pub upper: f64,
    /// The vector that gives the lower bound.
    pub alpha: Rc<Alpha>,
    alpha_seen: u32,
    /// One for each action.
    pub branches: Vec<Branch>,
    /// The bin of [`super::predict`] that the belief is in.
    pub features: (f64, f64),
    /// The lower bound that the bins last heard of.
    pub predicted_from: Option<f64>,
}

/// An action at a belief.
pub(super) struct Branch {
    pub upper: f64,
    pub lower: f64,
    pub outcomes: Option<Box<Outcomes>>,
}

/// What an action at a belief leads to.
pub(super) struct Outcomes {
    pub reward: f64,
    /// Next states and their probabilities, before the observation.
    next: Box<[(u32, f64)]>,
    alpha_seen: u32,
    pair_seen: u32,
    pub children: Vec<Child>,
}

/// An observation after an action. Its values are times its probability.
pub(super) struct Child {
    pub observation: usize,
    pub probability: f64,
    pub lower: f64,
    pub upper: f64,
    pub alpha: Rc<Alpha>,
    pub node: Option<usize>,
}

/// All sampled beliefs.
pub(super) struct Tree<'a> {
    pub pomdp: &'a Pomdp,
    pub nodes: Vec<Node>,
    by_hash: HashMap<u64, Vec<usize>>,
    dense: Vec<f64>,
    by_observation: Vec<f64>,
    slots: Vec<u32>,
    pub probe: Probe,
}

impl<'a> Tree<'a> {
    pub fn new(pomdp: &'a Pomdp) -> Self {
        Self {
            pomdp,
            nodes: Vec::new(),
            by_hash: HashMap::new(),
            dense: vec![0.0; pomdp.states().len()],
            by_observation: vec![0.0; pomdp.observations().len()],
            slots: vec![u32::MAX; pomdp.observations().len()],
            probe: Probe::new(pomdp.states().len()),
        }
    }

    /// The node of a belief, a new one where it was never sampled.
    pub fn node_of(
        &mut self,
        belief: SparseBelief,
        lower: &LowerBound,
        upper: &UpperBound,
    ) -> usize {
        let hash = hash(&belief);
        let found = self.by_hash.get(&hash).and_then(|nodes| {
            let mut nodes = nodes.iter().copied();
            nodes.find(|&node| self.nodes[node].belief.is_close_to(&belief))
        });
        if let Some(node) = found {
            return node;
        }
        let node = self.nodes.len();
        self.by_hash.entry(hash).or_default().push(node);
        self.probe.load(belief.entries());
        let informed = upper.informed(&self.probe);
        let branches = (0..self.pomdp.actions().len()).map(|action| Branch {
            upper: upper.informed_action(action, &belief),
            lower: f64::MIN,
            outcomes: None,
        });
        self.nodes.push(Node {
            features: (informed, belief.entropy(self.pomdp.states().len())),
            lower: f64::MIN,
            upper: upper.improve(&self.probe, 0, informed),
            alpha: Rc::clone(&lower.live()[0]),
            alpha_seen: 0,
            branches: branches.collect(),
            belief,
            predicted_from: None,
        });
        self.refresh_node(node, lower);
        node
    }

    /// Looks the vectors made since the last look up for the node's lower bound.
    pub fn refresh_node(&mut self, node: usize, lower: &LowerBound) {
        let node = &mut self.nodes[node];
        for alpha in lower.since(node.alpha_seen) {
            let value = node.belief.dot(&alpha.values);
            if value > node.lower {
                node.lower = value;
                node.alpha = Rc::clone(alpha);
            }
        }
        node.alpha_seen = lower.next_id();
    }

    /// Works out what an action leads to, where that was not done yet.
    pub fn expand(&mut self, node: usize, action: usize, lower: &LowerBound, upper: &UpperBound) {
        if self.nodes[node].branches[action].outcomes.is_some() {
            return;
        }
        let belief = &self.nodes[node].belief;
        let next = self.predicted(belief.clone(), action);
        for &(state, weight) in &next {
            add_observations(
                self.pomdp,
                action,
                state as usize,
                weight,
                &mut self.by_observation,
            );
        }
        let fallback = &lower.live()[0];
        let mut children = Vec::new();
        for (observation, probability) in self.by_observation.iter_mut().enumerate() {
            if *probability > 0.0 {
                children.push(Child {
                    observation,
                    probability: *probability,
                    lower: f64::MIN,
                    upper: f64::MAX,
                    alpha: Rc::clone(fallback),
                    node: None,
                });
                *probability = 0.0;
            }
        }
        let mut outcomes = Box::new(Outcomes {
            reward: self.nodes[node].belief.dot(&self.pomdp.rewards[action]),
            next: next.into_boxed_slice(),
            alpha_seen: 0,
            pair_seen: 0,
            children,
        });
        self.visit_children(action, &mut outcomes, |child, probe| {
            child.upper = upper.improve(probe, 0, upper.informed(probe));
        });
        outcomes.pair_seen = upper.next_id();
        self.nodes[node].branches[action].outcomes = Some(outcomes);
    }

    fn predicted(&mut self, belief: SparseBelief, action: usize) -> Vec<(u32, f64)> {
        let mut states = Vec::new();
        for (state, weight) in belief.entries() {
            for (next, probability) in self.pomdp.transitions[action].entries(state as usize) {
                if self.dense[next] == 0.0 {
                    states.push(next as u32);
                }
                self.dense[next] += weight * probability;
            }
        }
        states.sort_unstable();
        let take = |state: u32| (state, std::mem::take(&mut self.dense[state as usize]));
        states.into_iter().map(take).collect()
    }

    /// Calls `visit` with each child and its belief times its probability.
    fn visit_children(
        &mut self,
        action: usize,
        outcomes: &mut Outcomes,
        mut visit: impl FnMut(&mut Child, &Probe),
    ) {
        let count = outcomes.children.len();
        let mut weights: Vec<Vec<(u32, f64)>> = vec![Vec::new(); count];
        for (slot, child) in outcomes.children.iter().enumerate() {
            self.slots[child.observation] = slot as u32;
        }
        for &(state, weight) in &outcomes.next {
            let row = self.pomdp.observation_rows[action].entries(state as usize);
            for (observation, likelihood) in row {
                weights[self.slots[observation] as usize].push((state, weight * likelihood));
            }
        }
        for (child, weights) in outcomes.children.iter_mut().zip(weights) {
            self.probe.load(weights.into_iter());
            visit(child, &self.probe);
        }
    }

    /// Brings an action's upper bound up to date with the pairs made since the last look.
    pub fn refresh_upper(&mut self, node: usize, action: usize, upper: &UpperBound) {
        let Some(mut outcomes) = self.nodes[node].branches[action].outcomes.take() else {
            return;
        };
        let seen = outcomes.pair_seen;
        if seen < upper.next_id() {
            self.visit_children(action, &mut outcomes, |child, probe| {
                child.upper = upper.improve(probe, seen, child.upper);
            });
            outcomes.pair_seen = upper.next_id();
        }
        let mut sum = 0.0;
        for child in &mut outcomes.children {
            if let Some(node) = child.node {
                child.upper = child.upper.min(child.probability * self.nodes[node].upper);
            }
            sum += child.upper;
        }
        let branch = &mut self.nodes[node].branches[action];
        branch.upper = branch
            .upper
            .min(outcomes.reward + self.pomdp.discount() * sum);
        branch.outcomes = Some(outcomes);
    }

    /// Brings an action's lower bound up to date with the vectors made since the last look.
    pub fn refresh_lower(&mut self, node: usize, action: usize, lower: &LowerBound) {
        let branch = &mut self.nodes[node].branches[action];
        let Some(outcomes) = &mut branch.outcomes else {
            return;
        };
        for alpha in lower.since(outcomes.alpha_seen) {
            for &(state, weight) in &outcomes.next {
                let state = state as usize;
                add_observations(
                    self.pomdp,
                    action,
                    state,
                    weight * alpha.values[state],
                    &mut self.by_observation,
                );
            }
            for child in &mut outcomes.children {
                let value = std::mem::take(&mut self.by_observation[child.observation]);
                if value > child.lower {
                    child.lower = value;
                    child.alpha = Rc::clone(alpha);
                }
            }
        }
        outcomes.alpha_seen = lower.next_id();
        let sum: f64 = outcomes.children.iter().map(|child| child.lower).sum();
        branch.lower = outcomes.reward + self.pomdp.discount() * sum;
    }

    /// The node of the belief after an action and its child at `slot`.
    pub fn child_node(
        &mut self,
        node: usize,
        action: usize,
        slot: usize,
        lower: &LowerBound,
        upper: &UpperBound,
    ) -> Option<usize> {
        let outcomes = self.nodes[node].branches[action].outcomes.as_ref()?;
        let child = &outcomes.children[slot];
        if child.node.is_some() {
            return child.node;
        }
        let observation = child.observation;
        let entries = outcomes.next.iter().filter_map(|&(state, weight)| {
            let (columns, values) = self.pomdp.observation_rows[action].row(state as usize);
            let place = columns.binary_search(&(observation as u32)).ok()?;
            Some((state, weight * values[place]))
        });
        let belief = SparseBelief::scaled(entries, child.probability);
        let found = self.node_of(belief, lower, upper);
        let outcomes = self.nodes[node].branches[action].outcomes.as_mut()?;
        outcomes.children[slot].node = Some(found);
        Some(found)
    }
}

fn hash(belief: &SparseBelief) -> u64 {
    let mut hasher = DefaultHasher::new();
    for (state, weight) in belief.entries() {
        state.hash(&mut hasher);
        ((weight * 1e9).round() as u64).hash(&mut hasher);
    }
    hasher.finish()
}
