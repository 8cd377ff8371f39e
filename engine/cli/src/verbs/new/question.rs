//! What has to be known of a new object: the flag that says it, the question that asks for it, and
//! the rules an answer must keep, which are those of the object file.

use std::path::Path;

use pubs_core::object::{Fault, Overrides, load_text};
use pubs_core::task::compile;
use pubs_host::Registry;
use serde_json::Value;

use super::draft::{Draft, Joint};
use super::measure::{Measure, read_direction, written_direction};
use super::text;
use crate::object;

/// One thing to be known, in the order in which it is asked for: an answer is judged by those
/// before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Question {
    /// Kind of joint.
    Joint,
    /// Closed and open limit.
    Limits,
    /// Hinge axis to handle.
    Radius,
    /// Where the handle goes.
    Opening,
    /// Up.
    Up,
    /// Where the hinge lies.
    Hinge,
    /// Half the width of the goal region.
    Tolerance,
    /// The driver plugin.
    Driver,
    /// A parameter that the driver requires.
    Parameter(String),
}

impl Question {
    /// Everything that an object like the draft needs to have said.
    pub fn of(draft: &Draft, registry: &Registry) -> Vec<Self> {
        let hinge = draft.joint() == Joint::Revolute;
        let mut questions = vec![Self::Joint, Self::Limits];
        questions.extend(hinge.then_some(Self::Radius));
        questions.extend([Self::Opening, Self::Up]);
        questions.extend(hinge.then_some(Self::Hinge));
        questions.extend([Self::Tolerance, Self::Driver]);
        if draft.driver.is_some() {
            let names = required_parameters(draft.driver(), registry);
            questions.extend(names.into_iter().map(Self::Parameter));
        }
        questions
    }

    /// Whether the draft has the answer.
    pub fn is_answered(&self, draft: &Draft) -> bool {
        match self {
            Self::Joint => draft.joint.is_some(),
            Self::Limits => draft.limits.is_some(),
            Self::Radius => draft.radius_m.is_some(),
            Self::Opening => draft.opening.is_some(),
            Self::Up => draft.up.is_some(),
            Self::Hinge => draft.hinge.is_some(),
            Self::Tolerance => draft.tolerance.is_some(),
            Self::Driver => draft.driver.is_some(),
            Self::Parameter(name) => draft.parameters.contains_key(name),
        }
    }

    /// Whether it may stay open where nobody can be asked.
    pub fn is_optional(&self) -> bool {
        *self == Self::Tolerance
    }

    /// The flag that answers it.
    pub fn flag(&self) -> String {
        match self {
            Self::Joint => "--joint".to_owned(),
            Self::Limits => "--limits".to_owned(),
            Self::Radius => "--radius".to_owned(),
            Self::Opening => "--opening".to_owned(),
            Self::Up => "--up".to_owned(),
            Self::Hinge => "--hinge".to_owned(),
            Self::Tolerance => "--tolerance".to_owned(),
            Self::Driver => "--driver".to_owned(),
            Self::Parameter(name) if name == "world" => "--world".to_owned(),
            Self::Parameter(name) => format!("--param {name}="),
        }
    }

    /// What is asked, in a line.
    pub fn explanation(&self, draft: &Draft, registry: &Registry) -> String {
        let hinge = draft.joint() == Joint::Revolute;
        let text = match self {
            Self::Joint => {
                "Is it a hinge (revolute: a door, a lid) or a slide (prismatic: a drawer)?"
            }
            Self::Limits if hinge => {
                "How far does it turn? The closed and the open limit, degrees."
            }
            Self::Limits => "How far does it slide? The closed and the open limit.",
            Self::Radius => "How far is the handle from the hinge axis, at a right angle to it?",
            Self::Opening => {
                "Hold the tool as it will grasp. Along which of its own axes does the handle move as the object opens?"
            }
            Self::Up => {
                "Which axis of the tool points up? (Or across the motion, where that is up or down.)"
            }
            Self::Hinge => {
                "Which axis of the tool points from the handle to the hinge? At a right angle to the opening."
            }
            Self::Tolerance => "How near the goal is near enough?",
            Self::Driver => {
                "Which driver plugin moves the arm? virtual-arm simulates arm and object; `pubs-engine plugins list` has the others."
            }
            Self::Parameter(name) => return described(draft.driver(), name, registry),
        };
        text.to_owned()
    }

    /// What is taken where the answer is empty; nothing to be guessed of a driver's parameter.
    pub fn usual(&self, draft: &Draft) -> Option<String> {
        let measure = draft.joint().measure();
        Some(match self {
            Self::Joint => "revolute".to_owned(),
            Self::Limits => draft.limits().map(|limit| measure.written(limit)).join(","),
            Self::Radius => Measure::Length.written(draft.radius_m()),
            Self::Opening => written_direction(draft.opening()),
            Self::Up => written_direction(draft.up()),
            Self::Hinge => written_direction(draft.hinge()),
            Self::Tolerance => measure.written(draft.tolerance()),
            Self::Driver => draft.driver().to_owned(),
            Self::Parameter(_) => return None,
        })
    }

    /// The draft with this answer in it.
    ///
    /// # Errors
    /// Why the answer cannot be taken, and what to write instead.
    pub fn answer(
        &self,
        draft: &Draft,
        answer: &str,
        registry: &Registry,
    ) -> Result<Draft, String> {
        let mut draft = draft.clone();
        let measure = draft.joint().measure();
        match self {
            Self::Joint => draft.joint = Some(read_joint(answer)?),
            Self::Limits => draft.limits = Some(measure.read_limits(answer)?),
            Self::Radius => draft.radius_m = Some(Measure::Length.read(answer)?),
            Self::Opening => draft.opening = Some(read_direction(answer)?),
            Self::Up => draft.up = Some(read_direction(answer)?),
            Self::Hinge => draft.hinge = Some(read_direction(answer)?),
            Self::Tolerance => draft.tolerance = Some(measure.read(answer)?),
            Self::Driver => draft.driver = Some(answer.trim().to_owned()),
            Self::Parameter(name) => {
                let value = read_parameter(draft.driver(), name, answer, registry)?;
                draft.parameters.insert(name.clone(), value);
            }
        }
        match faults(&draft, registry)
            .iter()
            .find(|fault| self.owns(fault))
        {
            None => Ok(draft),
            Some(fault) => Err(self.said(fault)),
        }
    }

    /// The key of the object file that holds the answer, without its unit.
    fn key(&self) -> String {
        let key = match self {
            Self::Joint => "joint.type",
            Self::Limits => "joint.limits",
            Self::Radius => "joint.radius",
            Self::Opening => "joint.opening_direction",
            Self::Up => "joint.up_direction",
            Self::Hinge => "joint.hinge_direction",
            Self::Tolerance => "reward.goal_tolerance",
            Self::Driver => "driver.plugin",
            Self::Parameter(name) => return format!("driver.params.{name}"),
        };
        key.to_owned()
    }

    fn owns(&self, fault: &Fault) -> bool {
        let unit = fault.key.strip_prefix(&self.key());
        unit.is_some_and(|unit| ["", "_deg", "_m"].contains(&unit))
    }

    /// A fault in the words of the flag.
    fn said(&self, fault: &Fault) -> String {
        let message = fault.message.replace(
            &format!("`{}`", fault.key),
            &format!("`{}`", self.flag().trim_end_matches('=')),
        );
        format!("{message} ({})", fault.help)
    }
}

/// Everything that is wrong with a draft, as `check` finds it.
pub fn faults(draft: &Draft, registry: &Registry) -> Vec<Fault> {
    let text = text::tables(draft);
    let file = Path::new(draft.name());
    let faults = object::faults_of_text(file, &text, &Overrides::none(), registry);
    if faults.is_empty() {
        return world_fault(draft, text, registry).into_iter().collect();
    }
    faults
}

/// What the virtual arm says of its world. Opening it moves nothing; another arm is left alone.
fn world_fault(draft: &Draft, text: String, registry: &Registry) -> Option<Fault> {
    if draft.driver() != "virtual-arm" {
        return None;
    }
    let loaded = load_text(draft.name(), text, &Overrides::none()).ok()?;
    let setup = compile(&loaded.file).ok()?.driver_setup(0)?;
    let error = registry.driver(draft.driver()).ok()?.open(&setup).err()?;
    let help = "the world says what is true of the object";
    Some(loaded.fault("driver.params.world", error.to_string(), help))
}

fn read_joint(text: &str) -> Result<Joint, String> {
    match text.trim() {
        "revolute" | "hinge" => Ok(Joint::Revolute),
        "prismatic" | "slide" => Ok(Joint::Prismatic),
        other => Err(format!(
            "`{other}` is not a joint: write revolute (a hinge) or prismatic (a slide)"
        )),
    }
}

/// A parameter as its schema wants it: a text, or else a number or a flag.
fn read_parameter(
    driver: &str,
    name: &str,
    text: &str,
    registry: &Registry,
) -> Result<Value, String> {
    let text = text.trim();
    let is_text = parameter(driver, name, registry).is_some_and(|it| it["type"] == "string");
    let value = match serde_json::from_str(text) {
        Ok(value) if !is_text => value,
        _ => Value::from(text),
    };
    if value.is_object() || value.is_array() {
        return Err(format!(
            "`{name}` is neither a text nor a number nor a flag; write it into the file afterwards"
        ));
    }
    Ok(value)
}

fn described(driver: &str, name: &str, registry: &Registry) -> String {
    let schema = parameter(driver, name, registry);
    let words = schema
        .as_ref()
        .and_then(|schema| schema["description"].as_str());
    match words {
        Some(words) => format!("The driver `{driver}` needs `{name}`: {words}."),
        None => format!("The driver `{driver}` needs `{name}`."),
    }
}

fn parameter(driver: &str, name: &str, registry: &Registry) -> Option<Value> {
    let plugin = registry.driver(driver).ok()?;
    let properties = plugin.plugin().params_schema().get("properties")?;
    properties.get(name).cloned()
}

fn required_parameters(driver: &str, registry: &Registry) -> Vec<String> {
    let Ok(plugin) = registry.driver(driver) else {
        return Vec::new(); // said where the driver is named
    };
    let required = plugin.plugin().params_schema().get("required");
    let names = required.and_then(Value::as_array).into_iter().flatten();
    names
        .filter_map(|name| name.as_str().map(str::to_owned))
        .collect()
}
