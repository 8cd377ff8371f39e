//! Gradients of the parameters, by the chain rule from the last layer to the first.

use super::{Layer, Network, Workspace};
use crate::kernels::column::{BLOCK, Column};
use crate::kernels::matrix::{Left, Shape, Start, multiply};
use crate::kernels::tanh::backward_tanh;

impl Network {
    /// Adds to the gradients what follows from the gradients `[output]` of the results of the
    /// latest [`forward`](Self::forward), which must have had the same samples and inputs. Gives
    /// back the gradients of the first layer's sums.
    pub(crate) fn backward<'w>(
        &mut self,
        samples: usize,
        inputs: &[f32],
        workspace: &'w mut Workspace,
        result_gradients: &[Column],
    ) -> &'w [f32] {
        let Workspace {
            activations,
            gradients: [current, previous],
            ..
        } = workspace;
        let mut current = &mut current[..];
        let mut previous = &mut previous[..];
        let last = self.hidden.len() - 1;
        self.backward_output(samples, result_gradients, &activations[last], current);
        for l in (0..=last).rev() {
            let layer = self.hidden[l].clone();
            let size = samples * layer.columns;
            let bias_gradients = &mut self.gradients[layer.bias.clone()];
            backward_tanh(
                self.unit,
                &activations[l][..size],
                &mut current[..size],
                bias_gradients,
            );
            let layer_inputs = if l == 0 {
                inputs
            } else {
                &activations[l - 1][..]
            };
            self.weight_gradients(samples, &layer, layer_inputs, current);
            if l > 0 {
                self.input_gradients(samples, &layer, current, previous);
                std::mem::swap(&mut current, &mut previous);
            }
        }
        current
    }

    /// [`backward`](Self::backward), and then the gradients of the inputs `[sample][input]`, of a
    /// network that lies [`above`](Self::above) others.
    pub(crate) fn backward_to_inputs(
        &mut self,
        samples: usize,
        inputs: &[f32],
        workspace: &mut Workspace,
        result_gradients: &[Column],
        input_gradients: &mut [f32],
    ) {
        let gradients = self.backward(samples, inputs, workspace, result_gradients);
        self.input_gradients(samples, &self.hidden[0], gradients, input_gradients);
    }

    /// The output layer's share; writes the gradients of its inputs.
    fn backward_output(
        &mut self,
        samples: usize,
        result_gradients: &[Column],
        inputs: &[f32],
        input_gradients: &mut [f32],
    ) {
        let layer = &self.output;
        let bias = &mut self.gradients[layer.bias.clone()];
        for (sum, gradients) in bias.iter_mut().zip(result_gradients) {
            *sum += gradients[..samples].iter().sum::<f32>();
        }
        let (values, stride) = (result_gradients.as_flattened(), BLOCK);

        let shape = Shape {
            rows: layer.rows,
            depth: samples,
            columns: layer.columns,
        };
        let sums = &mut self.gradients[layer.weights.clone()];
        multiply(
            self.unit,
            shape,
            Left::Rows { values, stride },
            inputs,
            Start::Sum,
            sums,
        );

        let shape = Shape {
            rows: samples,
            depth: layer.rows,
            columns: layer.columns,
        };
        let left = Left::Columns { values, stride };
        let weights = &self.parameters[layer.weights.clone()];
        multiply(
            self.unit,
            shape,
            left,
            weights,
            Start::Zero,
            input_gradients,
        );
    }

    /// Adds inputsᵀ · gradients.
    fn weight_gradients(
        &mut self,
        samples: usize,
        layer: &Layer,
        inputs: &[f32],
        gradients: &[f32],
    ) {
        let shape = Shape {
            rows: layer.rows,
            depth: samples,
            columns: layer.columns,
        };
        let left = Left::Columns {
            values: inputs,
            stride: layer.rows,
        };
        let sums = &mut self.gradients[layer.weights.clone()];
        multiply(self.unit, shape, left, gradients, Start::Sum, sums);
    }

    /// gradients · weightsᵀ.
    fn input_gradients(
        &self,
        samples: usize,
        layer: &Layer,
        gradients: &[f32],
        input_gradients: &mut [f32],
    ) {
        let shape = Shape {
            rows: samples,
            depth: layer.columns,
            columns: layer.rows,
        };
        let left = Left::Rows {
            values: gradients,
            stride: layer.columns,
        };
        let weights = &self.copies[layer.copy.clone()];
        multiply(
            self.unit,
            shape,
            left,
            weights,
            Start::Zero,
            input_gradients,
        );
    }
}
