//! SARSOP (Kurniawati, Hsu & Lee, RSS 2008): point-based value iteration at beliefs near those
//! that optimal play reaches.
//!
//! [`lower`] and [`upper`] are the two bounds, [`tree`] the sampled beliefs between them. A trial
//! ([`sample`]) walks down the tree where the bounds are furthest apart, then backs both up along
//! the path ([`backup`]). [`prune`] drops what optimal play cannot reach. What is cached in the
//! tree carries a stamp of the vectors and pairs that it has seen, so that a look costs only what
//! is new.

mod backup;
mod lower;
mod predict;
mod prune;
mod sample;
mod sparse_belief;
mod tree;
mod upper;

use std::ops::ControlFlow;
use std::time::Instant;

use self::lower::LowerBound;
use self::predict::Predictor;
use self::prune::Pruning;
use self::sparse_belief::SparseBelief;
use self::tree::Tree;
use self::upper::UpperBound;
use crate::blind::blind_values;
use crate::informed::fast_informed_bound;
use crate::policy::{AlphaPolicy, AlphaVector};
use crate::pomdp::Pomdp;
use crate::qmdp::{ceiling, q_values};
use crate::solve::{Method, Progress, Solution, SolveOptions, Stopped};

const ROOT: usize = 0;

/// A trial ends where the gap is this share of the gap at the root (discounted).
const TRIAL_SHARE: f64 = 0.5;

/// The first bounds may take this share of the time.
const BOUNDS_SHARE: u32 = 5;

struct Sarsop<'a> {
    tree: Tree<'a>,
    lower: LowerBound,
    upper: UpperBound,
    predictor: Predictor,
    pruning: Pruning,
    begun: Instant,
    deadline: Option<Instant>,
    trials: usize,
}

/// Solves a POMDP to the options' precision, or as far as the time goes.
pub(crate) fn solve(
    pomdp: &Pomdp,
    options: &SolveOptions,
    mut report: impl FnMut(&Progress) -> ControlFlow<()>,
) -> Solution {
    let mut solver = Sarsop::new(pomdp, options);
    let mut reported = Instant::now();
    let mut asked = report(&solver.progress()).is_break();
    let stopped = loop {
        if asked {
            break Stopped::Asked;
        }
        if solver.gap() <= options.precision {
            break Stopped::Precision;
        }
        if solver.is_late() {
            break Stopped::Timeout;
        }
        let path = solver.sample(options.precision, |progress| {
            if reported.elapsed() >= options.report_interval {
                reported = Instant::now();
                asked = report(&progress()).is_break();
            }
            asked
        });
        for &node in path.iter().rev() {
            solver.back_up(node);
        }
        solver.prune();
    };
    let progress = solver.progress();
    let _ = report(&progress);
    solver.into_solution(&progress, stopped)
}

impl<'a> Sarsop<'a> {
    fn new(pomdp: &'a Pomdp, options: &SolveOptions) -> Self {
        let begun = Instant::now();
        let deadline = options.timeout.map(|timeout| begun + timeout);
        let early = options
            .timeout
            .map(|timeout| begun + timeout / BOUNDS_SHARE);
        let residual = (options.precision * 1e-2).max(1e-9);
        let blind = blind_values(pomdp, residual, early);
        let q = q_values(pomdp, residual, early);
        let informed = fast_informed_bound(pomdp, q, residual, early);
        let values = informed.iter().flatten().copied();
        let lowest = values.fold(f64::MAX, f64::min);
        let lower = LowerBound::new(blind);
        let upper = UpperBound::new(informed);
        let mut tree = Tree::new(pomdp);
        let start = pomdp.start().iter().enumerate();
        let start = start.filter(|entry| *entry.1 > 0.0);
        let start = start.map(|(state, weight)| (state as u32, *weight));
        let root = SparseBelief::scaled(start, 1.0);
        tree.node_of(root, &lower, &upper);
        Self {
            tree,
            lower,
            upper,
            predictor: Predictor::new(lowest, ceiling(pomdp)),
            pruning: Pruning::default(),
            begun,
            deadline,
            trials: 0,
        }
    }

    fn gap(&self) -> f64 {
        let root = &self.tree.nodes[ROOT];
        root.upper - root.lower
    }

    fn is_late(&self) -> bool {
        self.deadline
            .is_some_and(|deadline| Instant::now() >= deadline)
    }

    fn progress(&self) -> Progress {
        let root = &self.tree.nodes[ROOT];
        Progress {
            time_s: self.begun.elapsed().as_secs_f64(),
            lower: root.lower,
            upper: root.upper,
            gap: root.upper - root.lower,
            alpha_vectors: self.lower.live().len(),
            beliefs: self.tree.nodes.len(),
            trials: self.trials,
        }
    }

    fn into_solution(self, progress: &Progress, stopped: Stopped) -> Solution {
        let plan = self.lower.whole_plan(&self.tree.nodes[ROOT].alpha);
        let vectors = plan.iter().map(|alpha| AlphaVector {
            action: alpha.action,
            values: alpha.values.to_vec(),
        });
        let pomdp = self.tree.pomdp;
        let (lower, upper) = (progress.lower, progress.upper);
        Solution {
            policy: AlphaPolicy::new(pomdp, Method::Sarsop, lower, upper, vectors.collect()),
            lower,
            upper,
            alpha_vectors: plan.len(),
            time_s: progress.time_s,
            beliefs: progress.beliefs,
            trials: progress.trials,
            stopped,
        }
    }
}
