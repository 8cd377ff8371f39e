//! The trained recurrent policy, ready to be asked.

use super::export::LstmLayer;
use super::network::{RecurrentNetwork, StepMemory};
use crate::kernels::column::{BLOCK, Column, to_rows};
use crate::network::DenseLayer;
use crate::scaling::InputScaling;

/// A recurrent policy with its input scaling and the memory it works in.
#[derive(Debug)]
pub struct RecurrentPolicy {
    network: RecurrentNetwork,
    scaling: InputScaling,
    memory: StepMemory,
    scaled: Vec<f32>,
    columns: Vec<Column>,
}

impl RecurrentPolicy {
    pub(crate) fn new(network: RecurrentNetwork, scaling: InputScaling) -> Self {
        Self {
            memory: network.step_memory(),
            scaled: vec![0.0; BLOCK * network.stack.inputs()],
            columns: vec![[0.0; BLOCK]; network.head.outputs()],
            network,
            scaling,
        }
    }

    /// The recurrent layers, first to last; they expect scaled inputs.
    #[must_use]
    pub fn lstm_layers(&self) -> Vec<LstmLayer> {
        self.network.stack.export()
    }

    /// The layers above them, first to last.
    #[must_use]
    pub fn dense_layers(&self) -> Vec<DenseLayer> {
        self.network.head.export()
    }

    /// How inputs are scaled before the first layer.
    #[must_use]
    pub fn scaling(&self) -> &InputScaling {
        &self.scaling
    }

    /// Numbers in one observation.
    #[must_use]
    pub fn features(&self) -> usize {
        self.network.stack.inputs()
    }

    /// Number of actions.
    #[must_use]
    pub fn actions(&self) -> usize {
        self.network.head.outputs()
    }

    /// Numbers in the state of one episode.
    #[must_use]
    pub fn state_size(&self) -> usize {
        self.network.stack.state_size()
    }

    /// One step of n episodes: logits `[n][actions]` of unscaled observations `[n][features]`. The
    /// states `[n][layer][2][width]`, h and then c of each layer, move on; an episode starts with
    /// zeros.
    pub fn logits(&mut self, features: &[f32], states: &mut [f32], logits: &mut [f32]) {
        let (inputs, actions, size) = (self.features(), self.actions(), self.state_size());
        let rows = features
            .chunks(BLOCK * inputs)
            .zip(states.chunks_mut(BLOCK * size));
        for ((features, states), logits) in rows.zip(logits.chunks_mut(BLOCK * actions)) {
            self.scaling.apply(features, &mut self.scaled);
            let (memory, columns) = (&mut self.memory, &mut self.columns);
            self.network.step(&self.scaled, states, memory, columns);
            to_rows(columns, logits);
        }
    }
}
