//! The trained policy, ready to be asked.

use crate::kernels::column::{BLOCK, to_rows};
use crate::loss::Distribution;
use crate::network::{DenseLayer, Network, Workspace};
use crate::scaling::InputScaling;

/// A policy network with its input scaling and the memory it works in.
#[derive(Debug)]
pub struct Policy {
    network: Network,
    scaling: InputScaling,
    workspace: Workspace,
    scaled: Vec<f32>,
    distribution: Distribution,
}

impl Policy {
    pub(crate) fn new(network: Network, scaling: InputScaling) -> Self {
        Self {
            workspace: Workspace::new(&network),
            scaled: vec![0.0; BLOCK * network.inputs()],
            distribution: Distribution::new(network.outputs()),
            network,
            scaling,
        }
    }

    /// The layers, first to last; they expect scaled inputs.
    #[must_use]
    pub fn layers(&self) -> Vec<DenseLayer> {
        self.network.export()
    }

    /// How inputs are scaled before the first layer.
    #[must_use]
    pub fn scaling(&self) -> &InputScaling {
        &self.scaling
    }

    /// Numbers in one observation.
    #[must_use]
    pub fn features(&self) -> usize {
        self.network.inputs()
    }

    /// Number of actions.
    #[must_use]
    pub fn actions(&self) -> usize {
        self.network.outputs()
    }

    /// Logits `[n][actions]` of unscaled observations `[n][features]`.
    pub fn logits(&mut self, features: &[f32], logits: &mut [f32]) {
        let (inputs, actions) = (self.features(), self.actions());
        let blocks = features
            .chunks(BLOCK * inputs)
            .zip(logits.chunks_mut(BLOCK * actions));
        for (features, logits) in blocks {
            self.forward(features);
            to_rows(&self.distribution.logits, logits);
        }
    }

    /// The most probable allowed action for each observation: features `[n][features]`, unscaled,
    /// allowed `[n][actions]`, at least one each, chosen `[n]`.
    pub fn choose(&mut self, features: &[f32], allowed: &[bool], chosen: &mut [usize]) {
        let (inputs, actions) = (self.features(), self.actions());
        let blocks = features
            .chunks(BLOCK * inputs)
            .zip(allowed.chunks(BLOCK * actions));
        for ((features, allowed), chosen) in blocks.zip(chosen.chunks_mut(BLOCK)) {
            self.forward(features);
            let rows = allowed.chunks_exact(actions).enumerate();
            for ((sample, allowed), chosen) in rows.zip(chosen) {
                let logit = |action: &usize| self.distribution.logits[*action][sample];
                let candidates = (0..actions).filter(|action| allowed[*action]);
                let best = candidates.max_by(|a, b| logit(a).total_cmp(&logit(b)));
                *chosen = best.unwrap_or(0);
            }
        }
    }

    /// One block of at most [`BLOCK`] observations.
    fn forward(&mut self, features: &[f32]) {
        self.scaling.apply(features, &mut self.scaled);
        let samples = features.len() / self.features();
        let logits = &mut self.distribution.logits;
        self.network
            .forward(samples, &self.scaled, &mut self.workspace, logits);
    }
}
