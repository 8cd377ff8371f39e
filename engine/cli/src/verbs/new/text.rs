//! The object file of a draft, commented as the shipped ones are.

use pubs_core::object::{Faults, ObjectFile, Overrides, load_text};
use serde_json::Value;

use super::draft::{Draft, Joint};

/// The whole file; `schema_line` tells editors where the JSON Schema lies.
///
/// The controller and the belief are written out with the engine's defaults, since they are what an
/// author turns to first.
///
/// # Errors
/// What is wrong with the draft, as the object file's own checks put it.
pub fn text(draft: &Draft, schema_line: bool) -> Result<String, Faults> {
    let short = tables(draft);
    let file = load_text(draft.name(), short.clone(), &Overrides::none())?.file;
    let line = if schema_line {
        "#:schema ./object.schema.json\n"
    } else {
        ""
    };
    Ok(format!("{line}{short}\n{}", spelled_out(&file)))
}

/// What an author has to say; it loads by itself.
pub fn tables(draft: &Draft) -> String {
    let parts = [head(draft), joint(draft), reward(draft), driver(draft)];
    parts.join("\n")
}

fn head(draft: &Draft) -> String {
    let name = draft.name();
    format!(
        r#"# {name}: what the robot believes of this object, and how it moves it.
#
# `pubs-engine check` shows every fault of this file at its line; `pubs-engine calibrate` records what
# the object feels like and writes it at the end. Keys that are not here have the engine's defaults,
# which `pubs-engine config` prints.

schema = 1                    # version of the file format
name = "{name}"  # policies are named after it: policies/{name}.onnx

# Where the numbers come from: "assumed" until `pubs-engine calibrate` has measured them, and with
# which force sensor. A driver with another sensor is refused from then on.
[source]
kind = "assumed"
"#
    )
}

fn joint(draft: &Draft) -> String {
    let [closed, open] = draft.limits();
    let (opening, up) = (list(draft.opening()), list(draft.up()));
    let head = "\
# The joint. Directions are in the tool's own axes at the moment of the grasp, of any length.
[joint]
";
    let mut text = head.to_owned();
    match draft.joint() {
        Joint::Revolute => {
            text += &format!(
                r#"type = "revolute"             # a hinge; "prismatic": a slide
limits_deg = [{closed:?}, {open:?}]     # closed, open
radius_m = {:?}                # hinge axis to handle, measured at a right angle to the axis
opening_direction = {opening}   # where the handle goes when the object opens
hinge_direction = {}      # from the handle towards the hinge axis, at a right angle to the opening
"#,
                draft.radius_m(),
                list(draft.hinge()),
            );
        }
        Joint::Prismatic => {
            text += &format!(
                r#"type = "prismatic"            # a slide; "revolute": a hinge
limits_m = [{closed:?}, {open:?}]         # closed, open
opening_direction = {opening}   # where the handle goes when the object opens
"#
            );
        }
    }
    text += &format!("up_direction = {up}         # up\n");
    text
}

fn reward(draft: &Draft) -> String {
    let unit = match draft.joint() {
        Joint::Revolute => "deg",
        Joint::Prismatic => "m",
    };
    format!(
        "\
# What training strives for: a stop within this distance of the goal, the nearer the better.
[reward]
goal_tolerance_{unit} = {:?}
",
        draft.tolerance()
    )
}

fn driver(draft: &Draft) -> String {
    let parameters: Vec<String> = draft
        .parameters
        .iter()
        .map(|(key, value)| format!("{key} = {}", written(value)))
        .collect();
    format!(
        "\
# The arm: a driver plugin and its own parameters; `pubs-engine plugins list --schema` describes them.
[driver]
plugin = {}
params = {{ {} }}
",
        written(&Value::from(draft.driver())),
        parameters.join(", ")
    )
}

/// Controller, belief and observation as they are where the file does not say otherwise.
fn spelled_out(file: &ObjectFile) -> String {
    let control = file.control.as_ref().map_or_else(String::new, |control| {
        format!(
            r#"# The controller. `check` works out the force of the worst stop from these and refuses speeds
# that break force_limit_n.
[control]
safe_speed_m_s = {:?}         # of the handle, in safe mode
high_speed_m_s = {:?}         # and in high-force mode
force_threshold_n = {:?}      # safe mode stops above it: more than the object's friction, less than you would mind
force_limit_n = {:?}          # any mode stops above it: less than handle, fingers and arm bear
contact_stiffness_n_per_m = {:?}     # grasp and object at a hard stop

"#,
            control.safe_speed_m_s,
            control.high_speed_m_s,
            control.force_threshold_n,
            control.force_limit_n,
            control.contact_stiffness_n_per_m,
        )
    });
    format!(
        r#"{control}# How far the belief trusts what it feels; `calibrate` proposes other values where these do not fit.
[belief]
tempering = {:?}             # exponent on the likelihood of each counted force reading; 1 takes it at its word
reading_spacing_m = {:?}     # one force reading counts per this much travel or reversal; 0: every update

# What each action feels like at each joint state: the [[observation.segment]] tables that `calibrate`
# writes below.
[observation]
model = "{}"
"#,
        file.belief.tempering, file.belief.reading_spacing_m, file.observation.model,
    )
}

fn list([x, y, z]: [f64; 3]) -> String {
    format!("[{x:?}, {y:?}, {z:?}]")
}

/// A text, number or flag. TOML's basic strings take JSON's escapes.
fn written(value: &Value) -> String {
    value.to_string()
}
