//! A regular grid of cells over the range of a joint.

/// Cells of equal width from `lower` to `upper`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    lower: f64,
    width: f64,
    cells: usize,
}

impl Grid {
    /// At least one cell; `lower < upper`.
    pub fn new(lower: f64, upper: f64, cells: usize) -> Self {
        let cells = cells.max(1);
        Self {
            lower,
            width: (upper - lower) / cells as f64,
            cells,
        }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells
    }

    /// The cell of a state; states beyond an end belong to the cell there.
    pub fn cell(&self, state: f64) -> usize {
        let index = ((state - self.lower) / self.width).floor();
        (index.max(0.0) as usize).min(self.cells - 1)
    }

    /// Middle of a cell.
    pub fn centre(&self, cell: usize) -> f64 {
        self.lower + (cell as f64 + 0.5) * self.width
    }

    /// Where a cell begins; `edge(len())` is the upper end.
    pub fn edge(&self, cell: usize) -> f64 {
        self.lower + cell as f64 * self.width
    }
}

/// Fills what is `None` by linear interpolation between its neighbours, beyond the ends by the
/// nearest; all zero where there is nothing at all.
pub fn filled(values: &[Option<f64>]) -> Vec<f64> {
    let known: Vec<(usize, f64)> = values
        .iter()
        .enumerate()
        .filter_map(|(index, value)| Some((index, (*value)?)))
        .collect();
    (0..values.len())
        .map(|index| {
            let after = known.partition_point(|&(at, _)| at < index);
            match (
                after.checked_sub(1).map(|before| known[before]),
                known.get(after),
            ) {
                (_, Some(&(at, value))) if at == index => value,
                (Some((from, left)), Some(&(to, right))) => {
                    let part = (index - from) as f64 / (to - from) as f64;
                    left + part * (right - left)
                }
                (Some((_, value)), None) | (None, Some(&(_, value))) => value,
                (None, None) => 0.0,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_find_their_cells() {
        let grid = Grid::new(-1.0, 1.0, 4);
        let cases = [
            (-5.0, 0),
            (-1.0, 0),
            (-0.51, 0),
            (-0.5, 1),
            (0.99, 3),
            (1.0, 3),
            (7.0, 3),
        ];
        for (state, cell) in cases {
            assert_eq!(grid.cell(state), cell, "state {state}");
        }
        assert_eq!((grid.centre(0), grid.edge(4)), (-0.75, 1.0));
    }

    #[test]
    fn gaps_are_bridged_and_ends_held() {
        let cases: [(&[Option<f64>], &[f64]); 3] = [
            (
                &[None, Some(1.0), None, None, Some(4.0), None],
                &[1.0, 1.0, 2.0, 3.0, 4.0, 4.0],
            ),
            (&[None, None], &[0.0, 0.0]),
            (&[Some(2.0)], &[2.0]),
        ];
        for (values, expected) in cases {
            assert_eq!(filled(values), expected, "{values:?}");
        }
    }
}
