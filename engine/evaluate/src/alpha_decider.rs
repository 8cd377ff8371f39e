//! A policy of alpha vectors in trials of the object that it was solved for.

use pubs_core::Task;
use pubs_core::belief::Model;
use pubs_core::shield::Shield;
use pubs_solve::{AlphaPolicy, belief};
use pubs_train::surrogate::{Episode, Senses};

use crate::decider::Decider;
use crate::evaluation::{Contestant, EvaluateError};
use crate::grid::Grid;
use crate::trial::TrialError;

/// A policy of alpha vectors with the grid of its object.
#[derive(Debug, Clone, Copy)]
pub struct AlphaContestant<'a> {
    /// The vectors.
    pub policy: &'a AlphaPolicy,
    /// The object as the policy knows it.
    pub grid: &'a Grid,
}

impl Contestant for AlphaContestant<'_> {
    fn open(&self, _: &Task, _: &dyn Model) -> Result<Box<dyn Decider + '_>, EvaluateError> {
        Ok(Box::new(AlphaDecider {
            policy: self.policy,
            grid: self.grid,
            tracked: Vec::new(),
        }))
    }
}

/// Follows each trial with an exact belief over the grid's states.
struct AlphaDecider<'a> {
    policy: &'a AlphaPolicy,
    grid: &'a Grid,
    tracked: Vec<Tracked>,
}

/// One trial's belief, and the action that it has not heard the outcome of.
#[derive(Clone)]
struct Tracked {
    belief: Vec<f64>,
    action: Option<usize>,
}

impl Decider for AlphaDecider<'_> {
    fn senses(&self, _: Option<&Shield>) -> Senses {
        Senses::new([], false)
    }

    fn begin(&mut self, count: usize) {
        let fresh = Tracked {
            belief: self.grid.pomdp.start().to_vec(),
            action: None,
        };
        self.tracked = vec![fresh; count];
    }

    fn decide(
        &mut self,
        running: &[(usize, &Episode)],
        _: Option<&Shield>,
        actions: &mut Vec<usize>,
    ) -> Result<(), TrialError> {
        actions.clear();
        for &(trial, episode) in running {
            let tracked = &mut self.tracked[trial];
            if let Some(action) = tracked.action {
                tracked.belief = followed(self.grid, &tracked.belief, action, episode);
            }
            let action = self.policy.choose(&tracked.belief);
            tracked.action = Some(action);
            actions.push(action);
        }
        Ok(())
    }
}

/// The exact update, eq. (5). Where the grid holds the readings for impossible, or there were none,
/// the belief only moves: bins are coarser than the truth.
fn followed(grid: &Grid, before: &[f64], action: usize, episode: &Episode) -> Vec<f64> {
    let observation = episode.has_read().then(|| grid.observe(episode.readings()));
    let updated = observation
        .and_then(|observation| belief::update(&grid.pomdp, before, action, observation));
    match updated {
        Some((belief, _)) => belief,
        None => moved(grid, before, action),
    }
}

/// The trial goes on, so it is not in the terminal state.
fn moved(grid: &Grid, before: &[f64], action: usize) -> Vec<f64> {
    let mut after = belief::predict(&grid.pomdp, before, action);
    if let Some(ended) = after.last_mut() {
        *ended = 0.0;
    }
    let sum: f64 = after.iter().sum();
    if sum <= 0.0 {
        return grid.pomdp.start().to_vec();
    }
    after.iter_mut().for_each(|weight| *weight /= sum);
    after
}
