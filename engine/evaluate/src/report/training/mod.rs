//! The page of a training, from the policy file and the learning curves beside it.

mod curves;
mod maps;
mod tables;

use pubs_draw::DrawError;
use pubs_draw::document::{Block, Figure};
use pubs_policy::{Contract, Goal, PolicyFile, RunError, Runtime};

use crate::learning::LearningCurves;
use crate::reproduce::numbers::percent;

/// What a page is made of.
pub struct TrainingInput<'a> {
    /// The policy.
    pub file: &'a PolicyFile,
    /// What it promises.
    pub contract: &'a Contract,
    /// What runs it.
    pub runtime: &'a Runtime,
    /// How it was trained; `None` where that was not kept.
    pub curves: Option<&'a LearningCurves>,
}

/// Why there is no page.
#[derive(Debug, thiserror::Error)]
pub enum TrainingPageError {
    /// A picture cannot be drawn.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// The policy cannot be asked.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The policy cannot be opened.
    #[error(transparent)]
    Policy(#[from] pubs_policy::PolicyError),
}

/// The page: learning curves, what the policy does, numbers, provenance.
///
/// # Errors
/// [`TrainingPageError`].
pub fn page(input: &TrainingInput<'_>) -> Result<Vec<Block>, TrainingPageError> {
    let contract = input.contract;
    let mut page = vec![
        Block::Title(format!("Training for {}", contract.object)),
        Block::Paragraph(headline(input)),
        Block::Heading("Figures".to_owned()),
    ];
    match input.curves {
        Some(curves) => page.extend(curves::figures(curves)?.into_iter().map(Block::Figure)),
        None => page.push(Block::Notice(
            "No learning curve was kept beside this policy: it was trained by an older version, or \
             its NAME.training.json was left behind."
                .to_owned(),
        )),
    }
    let maps = maps::figures(input)?;
    if maps.is_empty() {
        page.push(Block::Paragraph(
            "This policy does not choose by mean and entropy alone, so its choices cannot be drawn \
             over them."
                .to_owned(),
        ));
    }
    page.extend(maps.into_iter().map(Block::Figure));
    page.push(Block::Heading("Numbers".to_owned()));
    page.extend(tables::numbers(input));
    page.push(Block::Heading("Provenance".to_owned()));
    page.extend(tables::provenance(input));
    Ok(page)
}

fn headline(input: &TrainingInput<'_>) -> String {
    let contract = input.contract;
    let goal = match contract.goal {
        Goal::Every => "every goal".to_owned(),
        Goal::Fixed { fraction, .. } => format!("the goal {fraction}"),
    };
    let trained = format!(
        "One policy for {goal}, trained by {} with the recipe {} for {} steps",
        contract.method, contract.recipe, contract.steps
    );
    match input.curves {
        None => format!("{trained}."),
        Some(curves) => format!(
            "{trained}; the best of {} seeds, it reached the goal in {} of {} fresh trials.",
            curves.seeds.len(),
            percent(curves.evaluation.success_rate),
            curves.evaluation.trials,
        ),
    }
}

fn figure(svg: String, caption: impl Into<String>) -> Figure {
    Figure {
        file: String::new(),
        svg,
        caption: caption.into(),
    }
}
