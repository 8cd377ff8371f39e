//! What a policy does over mean and entropy, Fig. 5, as numbers.

use serde::{Deserialize, Serialize};

use super::unit::GoalName;

/// The policies of Fig. 5: task, goal, and what stands above the picture.
pub const PICTURES: [(&str, GoalName, &str); 3] = [
    ("door2", GoalName::Middle, "Door 2, middle"),
    ("drawer2", GoalName::Closed, "Drawer 2, close"),
    ("light_dark", GoalName::Own, "Light-Dark"),
];

/// Name of a heatmap's file, less its extension.
pub fn heatmap_id(task: &str, goal: GoalName) -> String {
    format!("{task}-{}", goal.name())
}

/// The chosen actions on a grid: one file, `heatmaps/<id>.json` of a results folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Heatmap {
    /// Name of the object.
    pub task: String,
    /// What stands above it: object and goal.
    pub title: String,
    /// Unit of `mean` and `goal`: "deg", "cm", or "" for plain numbers.
    pub unit: String,
    /// Mean joint states, rising.
    pub mean: Vec<f64>,
    /// Entropies in [0, 1], rising.
    pub entropy: Vec<f64>,
    /// Index into `actions` of the chosen one: a row per entropy, a column per mean.
    pub action: Vec<Vec<usize>>,
    /// Names of the actions, in order.
    pub actions: Vec<String>,
    /// The goal, in the unit of `mean`.
    pub goal: f64,
}

impl Heatmap {
    /// The heatmap, if it can be drawn; otherwise why not.
    pub(super) fn checked(self) -> Result<Self, String> {
        let [columns, rows] = [self.mean.len(), self.entropy.len()];
        if columns < 2 || rows < 2 {
            return Err(format!("a grid of {columns} by {rows} cannot be drawn"));
        }
        let rising = |axis: &[f64]| axis.windows(2).all(|pair| pair[0] < pair[1]);
        if !rising(&self.mean) || !rising(&self.entropy) {
            return Err("mean and entropy must rise".to_owned());
        }
        if self.action.len() != rows || self.action.iter().any(|row| row.len() != columns) {
            return Err(format!("\"action\" must have {rows} rows of {columns}"));
        }
        let known = |&index: &usize| index < self.actions.len();
        if !self.action.iter().flatten().all(known) {
            return Err("\"action\" names an action that is not in \"actions\"".to_owned());
        }
        Ok(self)
    }
}
