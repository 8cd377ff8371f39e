//! What is read at a state, and how probable each bin of it is.

use pubs_core::belief::Model;
use pubs_core::{Action, Task};
use pubs_plugin::{Channel, Support, Transitions};
use pubs_solve::Rows;

use super::{Bins, GridError, is_binary};

/// States at which the range of a channel is found.
const PROBED_STATES: usize = 501;
/// Probabilities below this are taken for none.
const LEAST: f64 = 1e-9;

/// Asks the observation model.
pub(super) struct Observer<'a> {
    task: &'a Task,
    model: &'a dyn Model,
    /// Mean and sigma `[channel]` of the latest answer.
    mean: Vec<f32>,
    sigma: Vec<f32>,
}

impl<'a> Observer<'a> {
    pub(super) fn new(task: &'a Task, model: &'a dyn Model) -> Self {
        let channels = model.channels().len();
        Self {
            task,
            model,
            mean: vec![0.0; channels],
            sigma: vec![1.0; channels],
        }
    }

    /// Fills mean and sigma for one transition.
    pub(super) fn ask(&mut self, action: usize, before: f64, after: f64) -> Result<(), GridError> {
        let (before, after) = ([before as f32], [after as f32]);
        let transitions = Transitions {
            action,
            before: &before,
            after: &after,
        };
        let support = self
            .model
            .moments(transitions, &mut self.mean, &mut self.sigma)?;
        match support {
            Support::Given => Ok(()),
            Support::Absent => Err(GridError::NoMoments),
        }
    }

    /// Mean of a channel by its name, from the latest answer.
    pub(super) fn moment(&self, name: &str) -> Option<(f64, f64)> {
        let channels = self.model.channels().iter();
        let index = channels
            .enumerate()
            .find_map(|(index, channel)| (channel.name == name).then_some(index))?;
        Some((f64::from(self.mean[index]), f64::from(self.sigma[index])))
    }

    /// Least and greatest mean, and least sigma, of each channel over all movements and states.
    fn ranges(&mut self) -> Result<Vec<[f64; 3]>, GridError> {
        let joint = &self.task.joint;
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY]; self.mean.len()];
        let movements: Vec<usize> = self.task.movements().map(|(index, _)| index).collect();
        for action in movements {
            for index in 0..PROBED_STATES {
                let state = joint.at_fraction(index as f64 / (PROBED_STATES - 1) as f64);
                let state = if joint.is_integer() {
                    state.round()
                } else {
                    state
                };
                self.ask(action, state, state)?;
                for (range, (mean, sigma)) in
                    ranges.iter_mut().zip(self.mean.iter().zip(&self.sigma))
                {
                    range[0] = range[0].min(f64::from(*mean));
                    range[1] = range[1].max(f64::from(*mean));
                    range[2] = range[2].min(f64::from(*sigma));
                }
            }
        }
        Ok(ranges)
    }

    /// Bins that are no wider than the sharpest sigma of any channel.
    pub(super) fn finest(&mut self) -> Result<usize, GridError> {
        let channels = self.model.channels();
        let ranges = self.ranges()?;
        let counts = channels.iter().zip(ranges);
        let counts = counts
            .filter(|(channel, _)| !is_binary(channel))
            .map(|(_, [from, to, sigma])| ((to - from) / sigma).ceil() as usize + 1);
        Ok(counts.max().unwrap_or(2).max(2))
    }

    /// Probabilities of the observations after `action` led to each of `states`; nothing is read
    /// after a stop.
    pub(super) fn rows(
        &mut self,
        index: usize,
        action: &Action,
        states: &[f64],
        bins: &[Bins],
    ) -> Result<Rows, GridError> {
        if action.is_stop() {
            return Ok(vec![Vec::new(); states.len()]);
        }
        states
            .iter()
            .map(|&state| {
                self.ask(index, state, state)?;
                Ok(self.row(bins))
            })
            .collect()
    }

    /// The channels are independent, eq. (11): products over them, the first varying slowest.
    fn row(&self, bins: &[Bins]) -> Vec<(usize, f64)> {
        let mut row = vec![(0, 1.0)];
        for (index, channel) in self.model.channels().iter().enumerate() {
            let (mean, sigma) = (f64::from(self.mean[index]), f64::from(self.sigma[index]));
            let shares = if is_binary(channel) {
                vec![1.0 - mean, mean]
            } else {
                bins[index].normal(mean, sigma)
            };
            let count = bins[index].count();
            row = row
                .iter()
                .flat_map(|&(place, probability)| {
                    let shares = shares.iter().enumerate();
                    shares.map(move |(bin, share)| (place * count + bin, probability * share))
                })
                .filter(|&(_, probability)| probability > LEAST)
                .collect();
        }
        let sum: f64 = row.iter().map(|(_, probability)| probability).sum();
        row.iter_mut()
            .for_each(|(_, probability)| *probability /= sum);
        row
    }
}

/// Bins of each channel: from its least to its greatest mean; two for one that says 0 or 1.
pub(super) fn channel_bins(
    observer: &mut Observer<'_>,
    channels: &[Channel],
    count: usize,
) -> Result<Vec<Bins>, GridError> {
    let ranges = observer.ranges()?;
    let bins = channels.iter().zip(ranges).map(|(channel, [from, to, _])| {
        if is_binary(channel) {
            Bins::between(0.0, 1.0, 2)
        } else {
            Bins::between(from, to, count)
        }
    });
    Ok(bins.collect())
}
