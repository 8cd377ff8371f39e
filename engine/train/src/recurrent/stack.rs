//! Stacked layers of long short-term memory: their parameters and where these lie.
//!
//! Units go in groups of [`LANES`], the matrices in a panel `[row][PANEL]` for each group (see
//! `kernels::gates`). The way back reads the matrices transposed, `[PANEL][row]` for each group,
//! from copies that are renewed after every change. Widths are padded to whole groups; what is
//! padded has weights 0, and so cells and gradients 0.

use std::ops::Range;

use pubs_core::vector::{LANES, VectorUnit};
use rand::{Rng, RngExt};

use super::Lstm;
use crate::kernels::buffer::Buffer;
use crate::kernels::gates::PANEL;
use crate::kernels::matrix::padded;
use crate::kernels::transpose::transpose;
use crate::network::take;

/// Parameters of the layers and their gradients.
#[derive(Debug, Clone)]
pub(crate) struct Stack {
    pub(super) unit: VectorUnit,
    pub(super) layers: Vec<Layer>,
    pub(crate) parameters: Buffer,
    pub(crate) gradients: Buffer,
    /// Transposed weights, layer by layer.
    pub(super) copies: Buffer,
}

/// Where a layer lies in the buffers.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    /// Numbers that come in, and units, without padding.
    pub(super) inputs: usize,
    pub(super) width: usize,
    /// What meets the inputs.
    pub(super) input: Matrix,
    /// What meets the layer's own state; its rows are the width, padded.
    pub(super) hidden: Matrix,
    /// Both of PyTorch's biases in one, `[group][PANEL]`.
    pub(super) bias: Range<usize>,
}

/// Where a matrix lies.
#[derive(Debug, Clone)]
pub(super) struct Matrix {
    pub(super) rows: usize,
    /// In the parameters and the gradients, `[group][row][PANEL]`.
    pub(super) weights: Range<usize>,
    /// In the copies, `[group][PANEL][padded(row)]`; empty where no gradient is passed on.
    pub(super) copy: Range<usize>,
}

impl Layer {
    /// Units with padding: the numbers in a row of states.
    pub(super) fn padded(&self) -> usize {
        self.hidden.rows
    }

    pub(super) fn groups(&self) -> usize {
        self.padded() / LANES
    }

    /// Where the bias, or in a matrix the weight of each row, of gate `gate` (0 to 3) of `unit`
    /// lies among those of its group.
    pub(super) fn place(unit: usize, gate: usize) -> (usize, usize) {
        (unit / LANES, gate * LANES + unit % LANES)
    }
}

impl Stack {
    /// Layers with every parameter uniform within ±1/√width, as PyTorch starts them.
    pub(crate) fn new(
        unit: VectorUnit,
        inputs: usize,
        lstm: Lstm,
        generator: &mut impl Rng,
    ) -> Self {
        let (mut parameters, mut copies) = (0, 0);
        let mut layers = Vec::with_capacity(lstm.layers);
        for l in 0..lstm.layers {
            let rows = padded(lstm.width);
            let size = rows / LANES * PANEL;
            let mut matrix = |rows: usize, copied: bool| Matrix {
                rows,
                weights: take(&mut parameters, rows * size),
                copy: take(&mut copies, if copied { padded(rows) * size } else { 0 }),
            };
            let input = matrix(if l == 0 { inputs } else { rows }, l > 0);
            let hidden = matrix(rows, true);
            layers.push(Layer {
                inputs: if l == 0 { inputs } else { lstm.width },
                width: lstm.width,
                input,
                hidden,
                bias: take(&mut parameters, size),
            });
        }
        let mut stack = Self {
            unit,
            layers,
            parameters: Buffer::zeros(parameters),
            gradients: Buffer::zeros(parameters),
            copies: Buffer::zeros(copies),
        };
        stack.initialise(generator);
        stack.renew_copies();
        stack
    }

    fn initialise(&mut self, generator: &mut impl Rng) {
        for layer in &self.layers {
            let bound = 1.0 / (layer.width as f32).sqrt();
            let mut draw = || generator.random_range(-bound..=bound);
            for u in 0..layer.width {
                for gate in 0..4 {
                    let (group, column) = Layer::place(u, gate);
                    for (matrix, rows) in
                        [(&layer.input, layer.inputs), (&layer.hidden, layer.width)]
                    {
                        let weights = &mut self.parameters[matrix.weights.clone()];
                        let panel = &mut weights[group * matrix.rows * PANEL..];
                        for row in 0..rows {
                            panel[row * PANEL + column] = draw();
                        }
                    }
                    let bias = &mut self.parameters[layer.bias.clone()];
                    bias[group * PANEL + column] = draw() + draw();
                }
            }
        }
    }

    /// To be called after the parameters changed.
    pub(crate) fn renew_copies(&mut self) {
        let matrices = self.layers.iter().flat_map(|l| [&l.input, &l.hidden]);
        for matrix in matrices.filter(|matrix| !matrix.copy.is_empty()) {
            let panels = self.parameters[matrix.weights.clone()].chunks_exact(matrix.rows * PANEL);
            let copies =
                self.copies[matrix.copy.clone()].chunks_exact_mut(padded(matrix.rows) * PANEL);
            for (panel, copy) in panels.zip(copies) {
                transpose(self.unit, matrix.rows, PANEL, panel, copy);
            }
        }
    }

    /// Numbers in one observation.
    pub(crate) fn inputs(&self) -> usize {
        self.layers[0].inputs
    }

    /// Numbers in a row of the last layer's states, with padding.
    pub(crate) fn outputs(&self) -> usize {
        self.layers[self.layers.len() - 1].padded()
    }

    /// Numbers in the state of one copy, `[layer][2][width]`: h, then c.
    pub(crate) fn state_size(&self) -> usize {
        self.layers.iter().map(|layer| 2 * layer.width).sum()
    }
}
