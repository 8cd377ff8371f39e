//! Memory for one block of samples on its way through a network.

use super::Network;
use crate::kernels::buffer::Buffer;
use crate::kernels::column::BLOCK;
use crate::kernels::matrix::padded;

/// Activations and their gradients, `[sample][width]`.
#[derive(Debug)]
pub(crate) struct Workspace {
    /// Of each hidden layer.
    pub(super) activations: Vec<Buffer>,
    /// Of the output layer.
    pub(super) results: Buffer,
    /// Of the layer that the backward pass has reached, and of the one before it.
    pub(super) gradients: [Buffer; 2],
}

impl Workspace {
    pub(crate) fn new(network: &Network) -> Self {
        let block = |width: usize| Buffer::zeros(BLOCK * width);
        let widest = network
            .hidden
            .iter()
            .map(|layer| layer.columns)
            .max()
            .unwrap_or(0);
        Self {
            activations: network
                .hidden
                .iter()
                .map(|layer| block(layer.columns))
                .collect(),
            results: block(padded(network.outputs())),
            gradients: [block(widest), block(widest)],
        }
    }
}
