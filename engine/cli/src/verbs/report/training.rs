//! The page of a training.

use pubs_evaluate::LearningCurves;
use pubs_evaluate::report::training::{TrainingInput, TrainingPageError, page as page_of};
use pubs_policy::PolicyFile;

use super::{Arguments, Page};
use crate::failure::{Failure, chain};

/// # Errors
/// Where the policy carries no contract, cannot be asked, or its learning curves are not its own.
pub fn page(arguments: &Arguments, file: &PolicyFile) -> Result<Page, Failure> {
    let named = arguments.input.display();
    let contract = file.contract().ok_or_else(|| {
        Failure::incompatible(format!("{named} carries no contract of this program"))
    })?;
    let curves = LearningCurves::read(file.path(), file.sha256());
    let (curves, missing) = match curves {
        Ok(curves) => (curves, Vec::new()),
        Err(error) => (None, vec![error.to_string()]),
    };
    let input = TrainingInput {
        file,
        contract,
        runtime: &arguments.runtime.runtime()?,
        curves: curves.as_ref(),
    };
    let blocks = page_of(&input).map_err(|error| match &error {
        TrainingPageError::Draw(_) => Failure::fault(&error),
        TrainingPageError::Run(_) | TrainingPageError::Policy(_) => {
            Failure::incompatible(chain(&error))
        }
    })?;
    Ok(Page { blocks, missing })
}
