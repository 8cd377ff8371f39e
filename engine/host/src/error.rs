//! What can go wrong with a plugin, in words for the user.

use std::path::PathBuf;

use crate::{Failure, LibraryFault, Origin, ParameterFault, PluginKind};

/// A plugin that cannot be used, or a call of it that failed.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// A file is no plugin of this engine.
    #[error("plugin library {} is refused: {fault}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// What differs.
        fault: LibraryFault,
    },
    /// One name, two plugins.
    #[error(
        "two plugins named `{name}`: {first} and {second}; remove one of them, or take its directory off the search path"
    )]
    Duplicate {
        /// The name.
        name: String,
        /// Where one is from.
        first: Origin,
        /// Where the other is from.
        second: Origin,
    },
    /// No plugin of that name.
    #[error("{}", unknown_text(.name, *.wanted, .known, .nearest.as_deref(), .notes))]
    Unknown {
        /// The name asked for.
        name: String,
        /// What it was wanted as.
        wanted: PluginKind,
        /// Names of the plugins of that kind.
        known: Vec<String>,
        /// The known name most like it, if any is.
        nearest: Option<String>,
        /// The directories searched, with what could not be read or loaded there.
        notes: Vec<String>,
    },
    /// A plugin of that name, but of the other kind.
    #[error("plugin `{name}` ({origin}) is {found}, not {wanted}")]
    WrongKind {
        /// The name.
        name: String,
        /// Where it is from.
        origin: Origin,
        /// What it is.
        found: PluginKind,
        /// What it should be.
        wanted: PluginKind,
    },
    /// The object's parameters do not fit the plugin's schema.
    #[error("plugin `{plugin}` does not take these parameters:{}", faults_text(.faults))]
    Parameters {
        /// The plugin.
        plugin: String,
        /// All that is wrong.
        faults: Vec<ParameterFault>,
    },
    /// The setup cannot be written as JSON.
    #[error("plugin `{plugin}`: its setup cannot be written as JSON: {message}")]
    Setup {
        /// The plugin.
        plugin: String,
        /// Why.
        message: String,
    },
    /// A function of the plugin failed, or gave what it must not give.
    #[error("plugin `{plugin}`, function `{function}`{}: {failure}", context_text(.context))]
    Call {
        /// The plugin.
        plugin: String,
        /// The function.
        function: &'static str,
        /// What it was asked for, such as ``300 states of action 2 (`safe_close`)``; may be empty.
        context: String,
        /// What came of it.
        failure: Failure,
    },
}

fn unknown_text(
    name: &str,
    wanted: PluginKind,
    known: &[String],
    nearest: Option<&str>,
    notes: &[String],
) -> String {
    let mut text = format!("no plugin `{name}` is known as {wanted}");
    if let Some(nearest) = nearest {
        text += &format!("; did you mean `{nearest}`?");
    }
    text += &match known {
        [] => "\n  none is known".to_owned(),
        _ => format!("\n  known: {}", known.join(", ")),
    };
    for note in notes {
        text += &format!("\n  {note}");
    }
    text + "\n  give its directory with --plugin-dir DIR or PUBS_PLUGIN_PATH"
}

fn faults_text(faults: &[ParameterFault]) -> String {
    faults.iter().map(|fault| format!("\n  {fault}")).collect()
}

fn context_text(context: &str) -> String {
    if context.is_empty() {
        String::new()
    } else {
        format!(", {context}")
    }
}
