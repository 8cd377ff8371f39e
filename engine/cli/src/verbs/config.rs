//! `pubs-engine config`: the defaults, commented, or the schema for editors.

use clap::Args;
use pubs_core::object::{DEFAULTS, json_schema_text};

use crate::{Ended, exit, show};

#[derive(Args)]
#[command(after_help = "Example: pubs-engine config")]
pub struct Arguments {
    /// Print the JSON Schema of object files instead, for editors
    #[arg(long)]
    schema: bool,
}

pub fn run(arguments: &Arguments) -> Ended {
    let text = if arguments.schema {
        json_schema_text()
    } else {
        DEFAULTS.to_owned()
    };
    show::print(text.trim_end())?;
    Ok(exit::DONE)
}
