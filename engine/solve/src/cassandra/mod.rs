//! Cassandra's `.pomdp` format.
//!
//! A preamble in any order (`discount:`, `values:`, `states:`, `actions:`, `observations:`,
//! `start:`), then `T:`, `O:` and `R:` statements in all of their forms. A statement ends where
//! the next begins, not at the end of a line. Later entries take the place of earlier ones.

mod fault;
mod names;
mod parser;
mod preamble;
mod rewards;
mod rows;
mod statements;
mod token;
mod whole;

pub use fault::ParseFault;

use crate::pomdp::Pomdp;
use parser::Parser;

/// Reads a POMDP. Its name is empty: give it one with [`Pomdp::named`].
///
/// # Errors
/// Every fault that can be told apart from the consequences of another one, in the order of the
/// file.
pub fn parse(text: &str) -> Result<Pomdp, Vec<ParseFault>> {
    let mut parser = Parser::new(text);
    parser.read_statements();
    parser.finish()
}
