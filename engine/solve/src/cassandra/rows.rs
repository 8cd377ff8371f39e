//! Tables of probabilities as they are written down, entry by entry.

/// One row: its entries that are not zero in ascending order, and which token wrote it last.
#[derive(Clone, Default)]
pub(super) struct Row {
    pub entries: Vec<(u32, f64)>,
    pub written_by: Option<usize>,
}

impl Row {
    /// Sets one entry; a later entry takes the place of an earlier one.
    pub fn set(&mut self, column: usize, value: f64, token: usize) {
        self.written_by = Some(token);
        let column = column as u32;
        match self.entries.binary_search_by_key(&column, |entry| entry.0) {
            Ok(place) if value == 0.0 => {
                self.entries.remove(place);
            }
            Ok(place) => self.entries[place].1 = value,
            Err(_) if value == 0.0 => {}
            Err(place) => self.entries.insert(place, (column, value)),
        }
    }

    /// Replaces the row.
    pub fn replace(&mut self, values: impl Iterator<Item = f64>, token: usize) {
        self.written_by = Some(token);
        self.entries.clear();
        let entries = values.enumerate().filter(|entry| entry.1 != 0.0);
        self.entries
            .extend(entries.map(|(column, value)| (column as u32, value)));
    }

    pub fn sum(&self) -> f64 {
        // An empty sum is -0, which reads badly.
        self.entries.iter().map(|entry| entry.1).sum::<f64>() + 0.0
    }
}

/// A row for each action and state.
#[derive(Default)]
pub(super) struct Table {
    rows: Vec<Row>,
    states: usize,
}

impl Table {
    pub fn new(actions: usize, states: usize) -> Self {
        Self {
            rows: vec![Row::default(); actions * states],
            states,
        }
    }

    pub fn row(&self, action: usize, state: usize) -> &Row {
        &self.rows[action * self.states + state]
    }

    pub fn row_mut(&mut self, action: usize, state: usize) -> &mut Row {
        &mut self.rows[action * self.states + state]
    }

    /// The rows with their action and state.
    pub fn rows(&self) -> impl Iterator<Item = (usize, usize, &Row)> {
        let states = self.states;
        let rows = self.rows.iter().enumerate();
        rows.map(move |(place, row)| (place / states, place % states, row))
    }
}
