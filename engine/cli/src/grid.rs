//! An object file put on a grid, for the solvers.

use std::path::Path;

use clap::Args;
use pubs_evaluate::grid::{Grid, GridError, GridOptions, GridOrigin};

use crate::failure::Failure;
use crate::object;
use crate::options::{FrequencyOptions, LayerOptions};
use crate::verbs::evaluate::parse_goal;

/// How an object is put on a grid.
#[derive(Args)]
pub struct GridArguments {
    /// Goal of an object [default: of an abstract object, its file's]
    #[arg(long, value_name = "GOAL", allow_hyphen_values = true)]
    goal: Option<String>,
    /// States along an object's joint, both limits among them [default: 101, or its whole states]
    #[arg(long, value_name = "NUMBER")]
    bins: Option<usize>,
    /// Bins of each force channel of an object, which multiply [default: 5 on an arm, else as fine as the readings]
    #[arg(long, value_name = "NUMBER")]
    observation_bins: Option<usize>,
    #[command(flatten)]
    frequency: FrequencyOptions,
    #[command(flatten)]
    layers: LayerOptions,
}

impl GridArguments {
    /// The object in a file, on a grid, with all that is needed to make it again.
    ///
    /// # Errors
    /// Where the file has faults, or the object does not go on such a grid.
    pub fn grid(&self, file: &Path) -> Result<(Grid, GridOrigin), Failure> {
        let registry = self.layers.plugins.registry();
        let frequency = self.frequency.belief_frequency;
        let overrides = self.layers.overrides();
        let ready = object::ready(file, &overrides, frequency, &registry, 0)?;
        let (task, model) = (&ready.task, ready.model.as_ref());
        let goal = match &self.goal {
            Some(text) => parse_goal(text, &task.joint)?,
            None => task.default_goal.ok_or_else(|| {
                Failure::invalid(
                    "the object file states no goal (joint.goal): add --goal, such as --goal 0.5",
                )
            })?,
        };
        let failed = |error: GridError| Failure::invalid(error.to_string());
        let options =
            GridOptions::of(task, model, self.bins, self.observation_bins).map_err(failed)?;
        let grid = Grid::new(task, model, goal, options).map_err(failed)?;
        let origin = GridOrigin {
            object: task.name.clone(),
            goal,
            grid: options,
            belief_frequency: frequency,
        };
        Ok((grid, origin))
    }

    /// An option that only objects have, where one was given.
    pub fn named(&self) -> Option<&'static str> {
        let given = [
            (self.goal.is_some(), "--goal"),
            (self.bins.is_some(), "--bins"),
            (self.observation_bins.is_some(), "--observation-bins"),
            (
                self.frequency.belief_frequency.is_some(),
                "--belief-frequency",
            ),
            (!self.layers.set.is_empty(), "--set"),
        ];
        given
            .into_iter()
            .find_map(|(given, name)| given.then_some(name))
    }
}
