//! Matrices of which few entries are not zero, row by row.

/// A matrix in compressed rows.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SparseRows {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl SparseRows {
    /// Takes each row as (column, value) in ascending order of columns.
    pub fn new(rows: &[Vec<(usize, f64)>]) -> Self {
        let entries = rows.iter().map(Vec::len).sum();
        let mut matrix = Self {
            starts: Vec::with_capacity(rows.len() + 1),
            columns: Vec::with_capacity(entries),
            values: Vec::with_capacity(entries),
        };
        matrix.starts.push(0);
        for row in rows {
            for &(column, value) in row {
                matrix.columns.push(column as u32);
                matrix.values.push(value);
            }
            matrix.starts.push(matrix.columns.len());
        }
        matrix
    }

    /// Columns and values of a row.
    #[inline]
    pub fn row(&self, row: usize) -> (&[u32], &[f64]) {
        let range = self.starts[row]..self.starts[row + 1];
        (&self.columns[range.clone()], &self.values[range])
    }

    /// The entries of a row.
    #[inline]
    pub fn entries(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let (columns, values) = self.row(row);
        columns
            .iter()
            .zip(values)
            .map(|(&column, &value)| (column as usize, value))
    }

    /// The inner product of a row with a dense vector.
    #[inline]
    pub fn dot(&self, row: usize, vector: &[f64]) -> f64 {
        self.entries(row)
            .map(|(column, value)| value * vector[column])
            .sum()
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }
}
