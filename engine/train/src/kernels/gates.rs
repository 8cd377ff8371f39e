//! The gates of long short-term memory (Hochreiter and Schmidhuber, 1997), as PyTorch has them:
//!
//! i, f, o = σ(sums), g = tanh(sums), c' = f · c + i · g, h' = o · tanh c'.
//!
//! A group of [`LANES`] units keeps its gates side by side: [`PANEL`] numbers per row, first all
//! i, then all f, g and o. So the product that makes the sums has a right operand of its own for
//! each group, dense in memory, and the gates find what they need in one place. Of the other
//! numbers `[row][unit]` the slices begin at the group's first unit, `stride` from row to row.

use pubs_core::vector::{Arithmetic, LANES, dispatched};

use super::tanh::{sigmoid, tanh};

/// Numbers of one row and group: four gates of [`LANES`] units.
pub(crate) const PANEL: usize = 4 * LANES;

const INPUT: usize = 0;
const FORGET: usize = LANES;
const CANDIDATE: usize = 2 * LANES;
const OUTPUT: usize = 3 * LANES;

/// What a step makes of a group.
pub(crate) struct Cells<'a> {
    /// c'.
    pub(crate) cell: &'a mut [f32],
    /// tanh c'.
    pub(crate) cell_tanh: &'a mut [f32],
    /// h'.
    pub(crate) hidden: &'a mut [f32],
}

dispatched! {
    /// Turns the sums `[row][PANEL]` into gates, and the cells c that enter into what they become.
    pub(crate) fn open_gates(stride: usize, gates: &mut [f32], entering: &[f32], cells: Cells<'_>) = open_gates_body
}

#[inline(always)]
fn open_gates_body<A: Arithmetic>(
    stride: usize,
    gates: &mut [f32],
    entering: &[f32],
    cells: Cells<'_>,
) {
    for (row, gates) in gates.as_chunks_mut::<PANEL>().0.iter_mut().enumerate() {
        let at = row * stride;
        let entering = &entering[at..][..LANES];
        let cell = &mut cells.cell[at..][..LANES];
        let cell_tanh = &mut cells.cell_tanh[at..][..LANES];
        let hidden = &mut cells.hidden[at..][..LANES];
        for n in 0..LANES {
            let input = sigmoid::<A>(gates[INPUT + n]);
            let forget = sigmoid::<A>(gates[FORGET + n]);
            let candidate = tanh::<A>(gates[CANDIDATE + n]);
            let output = sigmoid::<A>(gates[OUTPUT + n]);
            gates[INPUT + n] = input;
            gates[FORGET + n] = forget;
            gates[CANDIDATE + n] = candidate;
            gates[OUTPUT + n] = output;
            cell[n] = A::multiply_add(forget, entering[n], input * candidate);
            cell_tanh[n] = tanh::<A>(cell[n]);
            hidden[n] = output * cell_tanh[n];
        }
    }
}

/// What a step leaves for the way back.
#[derive(Clone, Copy)]
pub(crate) struct Kept<'a> {
    /// c.
    pub(crate) entering: &'a [f32],
    /// tanh c'.
    pub(crate) cell_tanh: &'a [f32],
    /// Gradients of h'.
    pub(crate) hidden_gradients: &'a [f32],
}

dispatched! {
    /// Turns gates `[row][PANEL]` into the gradients of their sums, and the gradients of c' into
    /// those of c; adds the sums' gradients over all rows to `bias_gradients` `[PANEL]`.
    pub(crate) fn close_gates(stride: usize, gates: &mut [f32], kept: Kept<'_>, cell_gradients: &mut [f32], bias_gradients: &mut [f32]) = close_gates_body
}

#[inline(always)]
fn close_gates_body<A: Arithmetic>(
    stride: usize,
    gates: &mut [f32],
    kept: Kept<'_>,
    cell_gradients: &mut [f32],
    bias_gradients: &mut [f32],
) {
    let mut sums = [0.0; PANEL];
    for (row, gates) in gates.as_chunks_mut::<PANEL>().0.iter_mut().enumerate() {
        let at = row * stride;
        let entering = &kept.entering[at..][..LANES];
        let cell_tanh = &kept.cell_tanh[at..][..LANES];
        let hidden_gradients = &kept.hidden_gradients[at..][..LANES];
        let cell_gradients = &mut cell_gradients[at..][..LANES];
        for n in 0..LANES {
            let (input, forget) = (gates[INPUT + n], gates[FORGET + n]);
            let (candidate, output) = (gates[CANDIDATE + n], gates[OUTPUT + n]);
            let slope = A::multiply_add(-cell_tanh[n], cell_tanh[n], 1.0);
            let of_hidden = hidden_gradients[n];
            let of_cell = A::multiply_add(of_hidden * output, slope, cell_gradients[n]);
            cell_gradients[n] = of_cell * forget;
            gates[INPUT + n] = of_cell * candidate * input * (1.0 - input);
            gates[FORGET + n] = of_cell * entering[n] * forget * (1.0 - forget);
            gates[CANDIDATE + n] = of_cell * input * A::multiply_add(-candidate, candidate, 1.0);
            gates[OUTPUT + n] = of_hidden * cell_tanh[n] * output * (1.0 - output);
        }
        for n in 0..PANEL {
            sums[n] += gates[n];
        }
    }
    for (gradient, sum) in bias_gradients.iter_mut().zip(sums) {
        *gradient += sum;
    }
}
