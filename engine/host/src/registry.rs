//! The plugins that this program knows, by name.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use pubs_plugin::table::PluginTable;

use crate::nearest::nearest;
use crate::search_path::{beside_the_executable, libraries};
use crate::{
    DriverPlugin, HostError, LibraryFault, ModelPlugin, Origin, Plugin, PluginKind, library,
};

/// One entry of [`Registry::list`].
#[derive(Debug, Clone)]
pub enum Listed {
    /// A plugin that can be used.
    Plugin(Arc<Plugin>),
    /// A library on the search path that is no plugin at all.
    NotAPlugin(PathBuf),
    /// A library or a directory that cannot be used.
    Refused {
        /// Where it is.
        place: String,
        /// Why it cannot be used.
        reason: String,
    },
}

/// Built-in plugins and those of the search path, which is searched at the first question. A
/// broken library there is no error for those who do not ask for it.
#[derive(Debug)]
pub struct Registry {
    built_ins: Vec<&'static PluginTable>,
    search_path: Vec<PathBuf>,
    found: OnceLock<Vec<Listed>>,
}

impl Registry {
    /// A registry of the built-in tables and the directories to search, in order
    /// ([`search_path`](crate::search_path)). Reads nothing yet.
    pub fn new(built_ins: &[&'static PluginTable], search_path: Vec<PathBuf>) -> Self {
        Self {
            built_ins: built_ins.to_vec(),
            search_path,
            found: OnceLock::new(),
        }
    }

    /// The observation model of that name.
    ///
    /// # Errors
    /// Where there is none, there are two, or it is a driver.
    pub fn observation_model(&self, name: &str) -> Result<ModelPlugin, HostError> {
        ModelPlugin::new(self.plugin(name, PluginKind::ObservationModel)?)
    }

    /// The driver of that name.
    ///
    /// # Errors
    /// Where there is none, there are two, or it is an observation model.
    pub fn driver(&self, name: &str) -> Result<DriverPlugin, HostError> {
        DriverPlugin::new(self.plugin(name, PluginKind::Driver)?)
    }

    /// Everything found: the built-in plugins, then the search path in order.
    pub fn list(&self) -> &[Listed] {
        self.found.get_or_init(|| self.scan())
    }

    fn scan(&self) -> Vec<Listed> {
        let mut found: Vec<Listed> = self.built_ins.iter().map(|table| built_in(table)).collect();
        let own_directory = beside_the_executable();
        let mut seen = HashSet::new();
        for directory in &self.search_path {
            let files = match libraries(directory) {
                Ok(files) => files,
                Err(error) => {
                    found.push(refused(
                        directory,
                        format!("this directory cannot be searched: {error}"),
                    ));
                    continue;
                }
            };
            let canonical = directory.canonicalize().ok();
            let is_own = canonical.is_some() && canonical == own_directory;
            let new = files
                .into_iter()
                .filter(|file| seen.insert(file.canonicalize().unwrap_or(file.clone())));
            let listed = new.map(|file| loaded(&file));
            // Beside the executable lie libraries of all kinds; those are nobody's fault.
            found
                .extend(listed.filter(|entry| !(is_own && matches!(entry, Listed::NotAPlugin(_)))));
        }
        found
    }

    fn plugins(&self) -> impl Iterator<Item = &Arc<Plugin>> {
        self.list().iter().filter_map(|listed| match listed {
            Listed::Plugin(plugin) => Some(plugin),
            _ => None,
        })
    }

    fn plugin(&self, name: &str, wanted: PluginKind) -> Result<Arc<Plugin>, HostError> {
        let mut named = self.plugins().filter(|plugin| plugin.name() == name);
        match (named.next(), named.next()) {
            (None, _) => Err(self.unknown(name, wanted)),
            (Some(first), Some(second)) => Err(HostError::Duplicate {
                name: name.to_owned(),
                first: first.origin().clone(),
                second: second.origin().clone(),
            }),
            (Some(plugin), None) if plugin.kind() != wanted => Err(wrong_kind(plugin, wanted)),
            (Some(plugin), None) => Ok(Arc::clone(plugin)),
        }
    }

    fn unknown(&self, name: &str, wanted: PluginKind) -> HostError {
        let of_kind = self.plugins().filter(|plugin| plugin.kind() == wanted);
        let known: Vec<String> = of_kind.map(|plugin| plugin.name().to_owned()).collect();
        let searched = self
            .search_path
            .iter()
            .map(|directory| format!("searched: {}", directory.display()));
        let refused = self.list().iter().filter_map(|listed| match listed {
            Listed::Refused { place, reason } => Some(format!("refused: {place}: {reason}")),
            _ => None,
        });
        HostError::Unknown {
            name: name.to_owned(),
            wanted,
            nearest: nearest(name, known.iter().map(String::as_str)).map(str::to_owned),
            known,
            notes: searched.chain(refused).collect(),
        }
    }
}

fn refused(place: &Path, reason: String) -> Listed {
    Listed::Refused {
        place: place.display().to_string(),
        reason,
    }
}

fn built_in(table: &'static PluginTable) -> Listed {
    // SAFETY: a table of this very program, static and of its own type.
    match unsafe { Plugin::from_table(table, Origin::BuiltIn) } {
        Ok(plugin) => Listed::Plugin(Arc::new(plugin)),
        Err(fault) => Listed::Refused {
            place: Origin::BuiltIn.to_string(),
            reason: fault.to_string(),
        },
    }
}

fn loaded(file: &Path) -> Listed {
    match library::load(file) {
        Ok(plugin) => Listed::Plugin(Arc::new(plugin)),
        Err(HostError::Refused {
            fault: LibraryFault::NotAPlugin,
            path,
        }) => Listed::NotAPlugin(path),
        Err(HostError::Refused { fault, path }) => refused(&path, fault.to_string()),
        Err(other) => refused(file, other.to_string()),
    }
}

pub(crate) fn wrong_kind(plugin: &Plugin, wanted: PluginKind) -> HostError {
    HostError::WrongKind {
        name: plugin.name().to_owned(),
        origin: plugin.origin().clone(),
        found: plugin.kind(),
        wanted,
    }
}
