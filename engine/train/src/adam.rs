//! The optimiser: Adam (Kingma and Ba, 2015), as PyTorch defines it.

use pubs_core::vector::{Arithmetic, VectorUnit, dispatched};

use crate::kernels::buffer::Buffer;

const MOMENTUM_DECAY: f32 = 0.9;
const VARIANCE_DECAY: f32 = 0.999;

/// Running moments of the gradients of one set of parameters.
#[derive(Debug)]
pub(crate) struct Adam {
    mean: Buffer,
    square: Buffer,
    steps: i32,
    epsilon: f32,
}

/// The numbers of one step.
#[derive(Clone, Copy)]
pub(crate) struct Step {
    /// Factor of the gradients, from clipping their norm.
    gradient_scale: f32,
    /// Learning rate with the correction of the mean's bias.
    rate: f32,
    /// Correction of the square's bias, for its root.
    root_correction: f32,
    epsilon: f32,
}

impl Adam {
    pub(crate) fn new(parameters: usize, epsilon: f32) -> Self {
        Self {
            mean: Buffer::zeros(parameters),
            square: Buffer::zeros(parameters),
            steps: 0,
            epsilon,
        }
    }

    /// Moves `parameters` against `gradient_scale` · `gradients`.
    pub(crate) fn step(
        &mut self,
        unit: VectorUnit,
        learning_rate: f32,
        gradient_scale: f32,
        gradients: &[f32],
        parameters: &mut [f32],
    ) {
        self.steps += 1;
        let mean_correction = 1.0 - f64::from(MOMENTUM_DECAY).powi(self.steps);
        let square_correction = 1.0 - f64::from(VARIANCE_DECAY).powi(self.steps);
        let step = Step {
            gradient_scale,
            rate: (f64::from(learning_rate) / mean_correction) as f32,
            root_correction: (1.0 / square_correction.sqrt()) as f32,
            epsilon: self.epsilon,
        };
        move_parameters(
            unit,
            step,
            gradients,
            &mut self.mean,
            &mut self.square,
            parameters,
        );
    }
}

dispatched! {
    fn move_parameters(step: Step, gradients: &[f32], mean: &mut [f32], square: &mut [f32], parameters: &mut [f32]) = move_parameters_body
}

#[inline(always)]
fn move_parameters_body<A: Arithmetic>(
    step: Step,
    gradients: &[f32],
    mean: &mut [f32],
    square: &mut [f32],
    parameters: &mut [f32],
) {
    let moments = mean.iter_mut().zip(square);
    for ((parameter, gradient), (mean, square)) in parameters.iter_mut().zip(gradients).zip(moments)
    {
        let gradient = gradient * step.gradient_scale;
        *mean = A::multiply_add(MOMENTUM_DECAY, *mean, (1.0 - MOMENTUM_DECAY) * gradient);
        *square = A::multiply_add(
            VARIANCE_DECAY,
            *square,
            (1.0 - VARIANCE_DECAY) * gradient * gradient,
        );
        let root = A::multiply_add(square.sqrt(), step.root_correction, step.epsilon);
        *parameter -= step.rate * *mean / root;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gradients 1 and then −2, both halved from 2 and −4 by the scale; learning rate 0.1.
    ///
    /// Step 1: m = 0.1, v = 0.001; corrected 1 and 1, so the parameter moves by −0.1.
    /// Step 2: m = 0.9 · 0.1 + 0.1 · (−2) = −0.11, v = 0.999 · 0.001 + 0.001 · 4 = 0.004999;
    /// corrected −0.11 / 0.19 = −0.578947 and 0.004999 / 0.001999 = 2.500750, root 1.581376;
    /// the parameter moves by +0.1 · 0.578947 / 1.581376 = 0.0366103.
    #[test]
    fn two_steps_by_hand() {
        for unit in VectorUnit::available() {
            let mut adam = Adam::new(1, 1e-8);
            let mut parameters = [3.0];
            adam.step(unit, 0.1, 0.5, &[2.0], &mut parameters);
            assert!((parameters[0] - 2.9).abs() < 1e-6, "{unit}: {parameters:?}");
            adam.step(unit, 0.1, 0.5, &[-4.0], &mut parameters);
            assert!(
                (parameters[0] - 2.936_610_3).abs() < 1e-6,
                "{unit}: {parameters:?}"
            );
        }
    }

    /// With a gradient as small as ε the move is half the learning rate.
    #[test]
    fn epsilon_is_added_to_the_corrected_root() {
        for unit in VectorUnit::available() {
            let mut adam = Adam::new(1, 1e-5);
            let mut parameters = [0.0];
            adam.step(unit, 0.1, 1.0, &[1e-5], &mut parameters);
            assert!(
                (parameters[0] + 0.05).abs() < 1e-6,
                "{unit}: {parameters:?}"
            );
        }
    }
}
