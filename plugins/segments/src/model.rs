//! The plugin: segments in, moments out.

use pubs_plugin::{
    Channel, ChannelKind, GridTransitions, ModelSetup, ObservationModel, PluginError, Support,
    Transitions,
};

use crate::channel;
use crate::kernel::{Grid, Kernel, Output, States, VectorUnit};
use crate::lattice::Lattice;
use crate::nodes::Nodes;
use crate::read;

/// Piecewise Gaussian over calibration segments, eq. (11).
///
/// Channels are f_d, f_z, f_n (N, at the state after the move) and m_p (its probability, at the
/// state before it, within [0.001, 0.999]). Sigma of m_p is 1 and means nothing. States beyond
/// the limits get the nearest limit's values. An action that stops needs no segments: it answers
/// mean 0 N, sigma 100 N, and m_p at its lowest probability.
#[derive(Debug)]
pub struct Segments {
    channels: Vec<Channel>,
    lattice: Lattice,
    /// By index of the action.
    actions: Vec<Nodes>,
    kernel: Kernel,
}

impl Segments {
    /// The same model with the loops for `unit`, or the portable ones where the processor lacks
    /// it. [`create`](ObservationModel::create) takes the best; all give the same bits.
    #[must_use]
    pub fn with_vector_unit(self, unit: VectorUnit) -> Self {
        Self {
            kernel: Kernel::new(unit),
            ..self
        }
    }

    fn nodes(&self, action: usize) -> Result<&Nodes, PluginError> {
        self.actions
            .get(action)
            .ok_or_else(|| no_such_action(action, self.actions.len()))
    }
}

impl ObservationModel for Segments {
    const NAME: &'static str = "segments";
    const VERSION: &'static str = env!("CARGO_PKG_VERSION");
    const PARAMS_SCHEMA: &'static str = include_str!("params.schema.json");

    fn create(setup: &ModelSetup) -> Result<Self, PluginError> {
        let segments = read::segments(setup)?;
        let lattice = Lattice::new(setup, &segments)?;
        let tabulate = |(index, action): (usize, &pubs_plugin::ActionSetup)| match action.stop {
            true => Nodes::of_stop(&lattice),
            false => Nodes::of_movement(&lattice, &segments, index),
        };
        Ok(Self {
            channels: channels(),
            actions: setup.actions.iter().enumerate().map(tabulate).collect(),
            lattice,
            kernel: Kernel::new(VectorUnit::best()),
        })
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn moments(
        &self,
        transitions: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, PluginError> {
        let Transitions {
            action,
            before,
            after,
        } = transitions;
        let nodes = self.nodes(action)?;
        let count = after.len();
        check_lengths(count, before.len(), mean, sigma)?;
        let states = States { before, after };
        if self
            .kernel
            .scattered(&self.lattice, nodes, states, Output { mean, sigma })
        {
            Ok(Support::Given)
        } else {
            Err(not_a_number())
        }
    }

    fn moments_grid(
        &self,
        grid: GridTransitions,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, PluginError> {
        let GridTransitions {
            action,
            before,
            after,
            spacing,
            count,
        } = grid;
        let nodes = self.nodes(action)?;
        check_lengths(count, count, mean, sigma)?;
        if before.is_nan() || after.is_nan() {
            return Err(not_a_number());
        }
        if !self.lattice.has_spacing(spacing) {
            return Ok(Support::Absent);
        }
        if count > 0 {
            self.kernel.gridded(
                &self.lattice,
                nodes,
                Grid {
                    before,
                    after,
                    count,
                },
                Output { mean, sigma },
            );
        }
        Ok(Support::Given)
    }
}

fn channels() -> Vec<Channel> {
    let kind = |c| {
        if c == channel::MOTION {
            ChannelKind::Bernoulli
        } else {
            ChannelKind::Gaussian
        }
    };
    channel::NAMES
        .iter()
        .enumerate()
        .map(|(c, &name)| Channel {
            name: name.to_owned(),
            kind: kind(c),
        })
        .collect()
}

fn check_lengths(
    after: usize,
    before: usize,
    mean: &[f32],
    sigma: &[f32],
) -> Result<(), PluginError> {
    let outputs = after * channel::COUNT;
    if before == after && mean.len() == outputs && sigma.len() == outputs {
        return Ok(());
    }
    Err(wrong_lengths(after, before, mean.len(), sigma.len()))
}

#[cold]
fn wrong_lengths(after: usize, before: usize, mean: usize, sigma: usize) -> PluginError {
    PluginError::new(format!(
        "{before} states before and {after} after the move, room for {mean} means and {sigma} sigmas; there must be as \
         many states before as after and {} values for each",
        channel::COUNT
    ))
}

#[cold]
fn no_such_action(action: usize, count: usize) -> PluginError {
    PluginError::new(format!("action {action} of an object with {count} actions"))
}

#[cold]
fn not_a_number() -> PluginError {
    PluginError::new("a joint state is not a number (NaN); states must be rad, m or plain numbers")
}
