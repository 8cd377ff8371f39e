//! The four layers of an object's values, each over the one before: the engine's defaults, the
//! object file, the environment, `--set`.

use std::collections::BTreeMap;

use figment::value::{Dict, Map, Value};
use figment::{Figment, Metadata, Profile, Provider};
use pubs_plugin::JointType;

use super::document::{self, join};
use super::keys;
use super::schema::{JOINTS, Need, joint_name};

/// The engine's defaults: a commented TOML text.
pub const DEFAULTS: &str = include_str!("default.toml");

/// Start of the names of environment variables that set a key, `PUBS_SET__BELIEF__PARTICLES`.
pub const ENVIRONMENT_PREFIX: &str = "PUBS_SET__";

/// Where a value came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// The engine's defaults.
    Default,
    /// The object file.
    File,
    /// An environment variable; the text is `NAME=VALUE`.
    Environment(String),
    /// The command line; the text is what stood after `--set`.
    Set(String),
}

impl Origin {
    /// What the user typed, where it did not come from a file.
    pub fn typed(&self) -> Option<String> {
        match self {
            Self::Default | Self::File => None,
            Self::Environment(text) => Some(text.clone()),
            Self::Set(text) => Some(format!("--set {text}")),
        }
    }

    /// Name of the layer in figment.
    fn layer(&self) -> String {
        match self {
            Self::Default => "engine default".to_owned(),
            Self::File => "object file".to_owned(),
            Self::Environment(text) => format!("environment {text}"),
            Self::Set(text) => format!("--set {text}"),
        }
    }
}

/// Values that go over the object file's, as the user typed them.
#[derive(Debug, Clone, Default)]
pub struct Overrides(Vec<Origin>);

impl Overrides {
    /// No overrides: the file and the defaults alone.
    pub fn none() -> Self {
        Self::default()
    }

    /// Takes `PUBS_SET__…` variables out of `environment`, and the texts after `--set`.
    pub fn new(
        environment: impl IntoIterator<Item = (String, String)>,
        set: impl IntoIterator<Item = String>,
    ) -> Self {
        let mut variables: Vec<String> = environment
            .into_iter()
            .filter(|(name, _)| name.starts_with(ENVIRONMENT_PREFIX))
            .map(|(name, value)| format!("{name}={value}"))
            .collect();
        variables.sort();
        let variables = variables.into_iter().map(Origin::Environment);
        Self(variables.chain(set.into_iter().map(Origin::Set)).collect())
    }

    /// The same with the environment of this process.
    pub fn from_process(set: impl IntoIterator<Item = String>) -> Self {
        let text = |text: std::ffi::OsString| text.to_string_lossy().into_owned();
        let variables = std::env::vars_os().map(|(name, value)| (text(name), text(value)));
        Self::new(variables, set)
    }
}

impl Overrides {
    /// Each as the user typed it, lowest layer first.
    pub fn typed(&self) -> Vec<String> {
        self.0.iter().filter_map(Origin::typed).collect()
    }
}

/// One override, taken apart.
struct Override {
    origin: Origin,
    path: Vec<String>,
    value: Value,
}

/// An override that cannot be taken apart or applied.
pub(super) struct OverrideError {
    pub origin: Origin,
    pub message: String,
    pub help: String,
}

/// One layer, as figment takes it.
struct Layer {
    name: String,
    values: Dict,
}

impl Provider for Layer {
    fn metadata(&self) -> Metadata {
        Metadata::named(self.name.clone())
    }

    fn data(&self) -> Result<Map<Profile, Dict>, figment::Error> {
        Ok(Profile::Default.collect(self.values.clone()))
    }
}

/// The layers merged.
pub(super) struct Merged {
    /// Reads into structs.
    pub figment: Figment,
    /// The values.
    pub values: Dict,
    /// Key path to the layer that gave the value.
    pub origins: BTreeMap<String, Origin>,
    /// The joint's type, where it is one.
    pub joint: Option<JointType>,
}

/// Merges the layers.
///
/// # Errors
/// Overrides that cannot be applied; the layers are merged without them.
pub(super) fn merge(file: &Dict, overrides: &Overrides) -> (Merged, Vec<OverrideError>) {
    let mut errors = Vec::new();
    let mut applied = Vec::new();
    for origin in &overrides.0 {
        match take_apart(origin).and_then(|taken| reachable(file, taken)) {
            Ok(taken) => applied.push(taken),
            Err(error) => errors.push(error),
        }
    }
    let file = &without_foreign_parameters(file, &applied);
    let joint = joint_type(&stack(Dict::new(), file, &applied).1);
    let (figment, values) = stack(defaults_for(joint), file, &applied);
    let known: BTreeMap<String, &Origin> = [&Origin::Default, &Origin::File]
        .into_iter()
        .chain(&overrides.0)
        .map(|origin| (origin.layer(), origin))
        .collect();
    let mut origins = BTreeMap::new();
    let mut see = |path: &str, value: &Value| {
        let layer = figment
            .get_metadata(value.tag())
            .map(|metadata| metadata.name.as_ref());
        if let Some(origin) = layer.and_then(|layer| known.get(layer)) {
            origins.insert(path.to_owned(), (*origin).clone());
        }
    };
    for (name, value) in &values {
        visit(name, value, &mut see);
    }
    (
        Merged {
            figment,
            values,
            origins,
            joint,
        },
        errors,
    )
}

/// The file's values without `[driver] params` where an override names another driver: they are
/// those of the file's own.
fn without_foreign_parameters(file: &Dict, overrides: &[Override]) -> Dict {
    let mut file = file.clone();
    let named = overrides
        .iter()
        .rev()
        .find(|taken| taken.path == ["driver", "plugin"])
        .and_then(|taken| taken.value.as_str());
    if let (Some(named), Some(Value::Dict(_, driver))) = (named, file.get_mut("driver"))
        && driver.get("plugin").and_then(Value::as_str) != Some(named)
    {
        driver.remove("params");
    }
    file
}

fn stack(defaults: Dict, file: &Dict, overrides: &[Override]) -> (Figment, Dict) {
    let layer = |origin: &Origin, values| Layer {
        name: origin.layer(),
        values,
    };
    let mut figment = Figment::new()
        .merge(layer(&Origin::Default, defaults))
        .merge(layer(&Origin::File, file.clone()));
    for taken in overrides {
        figment = figment.merge(layer(&taken.origin, nest(&taken.path, &taken.value)));
    }
    let values = figment
        .find_value("")
        .ok()
        .and_then(Value::into_dict)
        .unwrap_or_default();
    (figment, values)
}

/// The engine's defaults for one joint type.
pub(super) fn defaults_for(joint: Option<JointType>) -> Dict {
    let mut defaults = document::parse(DEFAULTS)
        .map(|document| document.values)
        .unwrap_or_default();
    keep_defaulted("", &mut defaults, joint);
    defaults
}

/// Takes out of the defaults what this joint type states itself or has no use for.
fn keep_defaulted(parent: &str, values: &mut Dict, joint: Option<JointType>) {
    values.retain(|name, value| {
        let path = join(parent, name);
        if let Value::Dict(_, inner) = value {
            keep_defaulted(&path, inner, joint);
            return !inner.is_empty();
        }
        let Some(key) = keys::find(&path) else {
            return false;
        };
        joint.is_none() || key.need(joint) == Need::Defaulted
    });
}

fn joint_type(values: &Dict) -> Option<JointType> {
    let word = values.get("joint")?.as_dict()?.get("type")?.as_str()?;
    JOINTS.into_iter().find(|joint| joint_name(*joint) == word)
}

fn nest(path: &[String], value: &Value) -> Dict {
    let mut path = path.iter().rev();
    let last = path.next().map(|name| (name.clone(), value.clone()));
    path.fold(last.into_iter().collect(), |inner: Dict, name| {
        [(name.clone(), Value::from(inner))].into_iter().collect()
    })
}

fn take_apart(origin: &Origin) -> Result<Override, OverrideError> {
    let fault = |message: &str, help: &str| OverrideError {
        origin: origin.clone(),
        message: message.to_owned(),
        help: help.to_owned(),
    };
    let (path, value): (Vec<String>, &str) = match origin {
        Origin::Environment(text) => {
            let (name, value) = text.split_once('=').unwrap_or((text, ""));
            let name = name.trim_start_matches(ENVIRONMENT_PREFIX).to_lowercase();
            (name.split("__").map(str::to_owned).collect(), value)
        }
        Origin::Default | Origin::File => (Vec::new(), ""),
        Origin::Set(text) => {
            let Some((name, value)) = text.split_once('=') else {
                let message = format!("`--set {text}` sets nothing");
                return Err(fault(
                    &message,
                    "write KEY=VALUE, such as --set belief.particles=500",
                ));
            };
            (
                name.split('.').map(|part| part.trim().to_owned()).collect(),
                value.trim(),
            )
        }
    };
    if path.iter().any(String::is_empty) {
        let message = format!("`{}` names no key", origin.typed().unwrap_or_default());
        return Err(fault(
            &message,
            "write belief.particles after --set, or PUBS_SET__BELIEF__PARTICLES in the environment",
        ));
    }
    let value = document::parse_value(value).unwrap_or_else(|| Value::from(value));
    Ok(Override {
        origin: origin.clone(),
        path,
        value,
    })
}

/// Refuses an override that reaches into a list: it would replace the whole of it.
fn reachable(file: &Dict, taken: Override) -> Result<Override, OverrideError> {
    let mut values = file;
    for (depth, name) in taken.path.iter().enumerate() {
        match values.get(name) {
            Some(Value::Dict(_, inner)) => values = inner,
            Some(Value::Array(..)) if depth + 1 < taken.path.len() => {
                let list = taken.path[..=depth].join(".");
                return Err(OverrideError {
                    message: format!(
                        "`{}` reaches into `{list}`, which is a list",
                        taken.origin.typed().unwrap_or_default()
                    ),
                    help: format!("set the whole of `{list}`, or edit the file"),
                    origin: taken.origin,
                });
            }
            _ => break,
        }
    }
    Ok(taken)
}

/// Calls `see` with the path of `value` and of everything in it.
pub(super) fn visit(path: &str, value: &Value, see: &mut impl FnMut(&str, &Value)) {
    see(path, value);
    match value {
        Value::Dict(_, inner) => {
            for (name, value) in inner {
                visit(&join(path, name), value, see);
            }
        }
        Value::Array(_, list) => {
            for (index, element) in list.iter().enumerate() {
                visit(&join(path, &index.to_string()), element, see);
            }
        }
        _ => {}
    }
}
