//! The upper bound: values at the corners of the belief simplex and at sampled beliefs, joined by
//! the sawtooth interpolation (Hauskrecht 2000).

use super::sparse_belief::SparseBelief;

/// A belief whose value is known not to pass `value`.
struct Pair {
    /// Ascending in the order of making: says which pairs someone has seen.
    id: u32,
    node: usize,
    /// States and weights, the heaviest first: where another belief lacks weight there, the ratio
    /// is small at once.
    entries: Box<[(u32, f64)]>,
    signature: u128,
    value: f64,
    /// The value less what the corners alone promise; negative, or the pair says nothing.
    slack: f64,
}

/// The bound. All of its parts only come down.
pub(super) struct UpperBound {
    corners: Vec<f64>,
    informed: Vec<Vec<f64>>,
    pairs: Vec<Pair>,
    next_id: u32,
}

/// A belief times its probability, ready to be looked up in.
pub(super) struct Probe {
    dense: Vec<f64>,
    states: Vec<u32>,
    signature: u128,
    mass: f64,
}

impl Probe {
    pub fn new(states: usize) -> Self {
        Self {
            dense: vec![0.0; states],
            states: Vec::new(),
            signature: 0,
            mass: 0.0,
        }
    }

    /// Holds these weights in place of the last.
    pub fn load(&mut self, entries: impl Iterator<Item = (u32, f64)>) {
        for state in self.states.drain(..) {
            self.dense[state as usize] = 0.0;
        }
        (self.signature, self.mass) = (0, 0.0);
        for (state, weight) in entries {
            self.dense[state as usize] = weight;
            self.states.push(state);
            self.signature |= bit(state);
            self.mass += weight;
        }
    }

    fn dot(&self, vector: &[f64]) -> f64 {
        let states = self.states.iter().map(|&state| state as usize);
        states.map(|state| self.dense[state] * vector[state]).sum()
    }
}

fn bit(state: u32) -> u128 {
    1 << (state % 128)
}

impl UpperBound {
    /// Begins with the vectors of the fast informed bound.
    pub fn new(informed: Vec<Vec<f64>>) -> Self {
        let states = 0..informed[0].len();
        let corners = states.map(|state| {
            let values = informed.iter().map(|vector| vector[state]);
            values.fold(f64::MIN, f64::max)
        });
        Self {
            corners: corners.collect(),
            informed,
            pairs: Vec::new(),
            next_id: 0,
        }
    }

    /// The bound on doing `action` at a belief, before anything is sampled.
    pub fn informed_action(&self, action: usize, belief: &SparseBelief) -> f64 {
        belief.dot(&self.informed[action])
    }

    /// The bound at the probe, times its mass, before any pair is looked at.
    pub fn informed(&self, probe: &Probe) -> f64 {
        let values = self.informed.iter().map(|vector| probe.dot(vector));
        values.fold(f64::MIN, f64::max)
    }

    /// The bound at the probe, times its mass, from `best` and the pairs made since `seen`.
    pub fn improve(&self, probe: &Probe, seen: u32, best: f64) -> f64 {
        let corner = probe.dot(&self.corners);
        let mut best = best.min(corner);
        let first = self.pairs.partition_point(|pair| pair.id < seen);
        for pair in &self.pairs[first..] {
            // The ratio of weights at which this pair begins to say more than is known.
            let needed = (corner - best) / -pair.slack;
            if probe.mass <= needed || pair.signature & !probe.signature != 0 {
                continue;
            }
            let mut ratio = probe.mass;
            for &(state, weight) in &pair.entries {
                let here = probe.dense[state as usize];
                if here < ratio * weight {
                    ratio = here / weight;
                    if ratio <= needed {
                        break;
                    }
                }
            }
            if ratio > needed {
                best = corner + ratio * pair.slack;
            }
        }
        best
    }

    /// Writes down that the value at a belief, which is node `node`'s, does not pass `value`.
    pub fn lower(&mut self, node: usize, belief: &SparseBelief, value: f64) {
        if let &[state] = belief.states() {
            self.lower_corner(state as usize, value);
            return;
        }
        self.pairs.retain(|pair| pair.node != node);
        let slack = value - belief.dot(&self.corners);
        if slack >= 0.0 {
            return;
        }
        let mut entries: Vec<_> = belief.entries().collect();
        let signature = entries.iter().fold(0, |bits, entry| bits | bit(entry.0));
        entries.sort_by(|one, other| other.1.total_cmp(&one.1));
        self.pairs.push(Pair {
            id: self.next_id,
            node,
            entries: entries.into_boxed_slice(),
            signature,
            value,
            slack,
        });
        self.next_id += 1;
    }

    fn lower_corner(&mut self, state: usize, value: f64) {
        if value >= self.corners[state] {
            return;
        }
        self.corners[state] = value;
        let corners = &self.corners;
        self.pairs.retain_mut(|pair| {
            let promised = pair.entries.iter();
            let promised: f64 = promised
                .map(|&(state, weight)| weight * corners[state as usize])
                .sum();
            pair.slack = pair.value - promised;
            pair.slack < 0.0
        });
    }

    /// The id that the next pair gets.
    pub fn next_id(&self) -> u32 {
        self.next_id
    }

    /// How many pairs there are.
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Drops the pairs of nodes that are no longer reached, and those that the others imply.
    pub fn prune(&mut self, reached: &[bool], probe: &mut Probe) {
        self.pairs.retain(|pair| reached[pair.node]);
        let mut index = 0;
        while index < self.pairs.len() {
            let pair = self.pairs.remove(index);
            probe.load(pair.entries.iter().copied());
            let implied = self.improve(probe, 0, f64::MAX);
            if implied > pair.value {
                self.pairs.insert(index, pair);
                index += 1;
            }
        }
    }
}
