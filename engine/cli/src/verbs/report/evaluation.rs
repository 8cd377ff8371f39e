//! The page of an evaluation.

use pubs_evaluate::report::evaluation::{Judged, page as page_of};

use super::{Arguments, Page};
use crate::failure::Failure;

/// # Errors
/// Where a picture cannot be drawn.
pub fn page(arguments: &Arguments, text: &str, judged: &[Judged]) -> Result<Page, Failure> {
    let blocks = page_of(&arguments.input, text, judged).map_err(|error| Failure::fault(&error))?;
    Ok(Page {
        blocks,
        missing: Vec::new(),
    })
}
