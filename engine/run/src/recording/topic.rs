//! The topics of a recording and the schemas of their messages.

use serde_json::{Value, json};

use super::run_schema;

/// What is written under a name of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Topic {
    Pose,
    Wrench,
    Action,
    Observation,
    Truth,
    Demonstration,
    Guard,
    Timing,
    Controller,
    Belief,
    Policy,
    Limits,
    Dropped,
}

impl Topic {
    /// Those of a calibration.
    pub const OF_CALIBRATION: [Self; 8] = [
        Self::Pose,
        Self::Wrench,
        Self::Action,
        Self::Observation,
        Self::Truth,
        Self::Demonstration,
        Self::Guard,
        Self::Timing,
    ];

    /// Those of a run.
    pub const OF_RUN: [Self; 12] = [
        Self::Pose,
        Self::Wrench,
        Self::Action,
        Self::Observation,
        Self::Truth,
        Self::Guard,
        Self::Timing,
        Self::Controller,
        Self::Belief,
        Self::Policy,
        Self::Limits,
        Self::Dropped,
    ];

    /// All of them, in the order of their discriminants.
    pub const ALL: [Self; 13] = [
        Self::Pose,
        Self::Wrench,
        Self::Action,
        Self::Observation,
        Self::Truth,
        Self::Demonstration,
        Self::Guard,
        Self::Timing,
        Self::Controller,
        Self::Belief,
        Self::Policy,
        Self::Limits,
        Self::Dropped,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Pose => "/pose",
            Self::Wrench => "/wrench",
            Self::Action => "/action",
            Self::Observation => "/observation",
            Self::Truth => "/truth",
            Self::Demonstration => "/demonstration",
            Self::Guard => "/guard",
            Self::Timing => "/timing",
            Self::Controller => "/controller",
            Self::Belief => "/belief",
            Self::Policy => "/policy",
            Self::Limits => "/limits",
            Self::Dropped => "/dropped",
        }
    }

    /// Name of the message's schema; `/pose` has a well-known one, that viewers draw.
    pub fn schema_name(self) -> &'static str {
        match self {
            Self::Pose => "foxglove.PoseInFrame",
            Self::Wrench => "pubs.Wrench",
            Self::Action => "pubs.Action",
            Self::Observation => "pubs.Observation",
            Self::Truth => "pubs.Truth",
            Self::Demonstration => "pubs.Demonstration",
            Self::Guard => "pubs.Guard",
            Self::Timing => "pubs.Timing",
            Self::Controller => "pubs.Controller",
            Self::Belief => "pubs.Belief",
            Self::Policy => "pubs.Policy",
            Self::Limits => "pubs.Limits",
            Self::Dropped => "pubs.Dropped",
        }
    }

    /// JSON Schema of the message.
    pub fn schema(self) -> Value {
        let fields = match self {
            Self::Pose => json!({
                "timestamp": time(),
                "frame_id": text("the frame that the pose is given in"),
                "pose": object("tool in base", json!({
                    "position": xyz("tool origin, m"),
                    "orientation": object("rotation from tool axes to base axes", json!({
                        "x": number("x"), "y": number("y"), "z": number("z"), "w": number("w"),
                    })),
                })),
            }),
            Self::Wrench => json!({
                "timestamp": time(),
                "frame_id": text("the frame that the wrench is given in"),
                "force": xyz("by the tool on the object, tool axes, tared, N"),
                "torque": xyz("about the tool origin, tool axes, tared, N m"),
            }),
            Self::Action => json!({
                "timestamp": time(),
                "action": text("the action in force"),
                "demonstration": integer("which demonstration it belongs to, from 1; 0: none"),
                "speed_m_s": number("commanded speed along the path, positive towards open"),
                "settled": { "type": "boolean", "description": "whether the arm moved as the action asks" },
                "status": { "enum": ["ready", "stopped", "fault"], "description": "what the driver says of itself" },
            }),
            Self::Observation => json!({
                "timestamp": time(),
                "displacement": number("of the joint since the grasp, rad (hinge) or m (slide)"),
                "f_d": number("force along the motion, N; resistance is positive"),
                "f_z": number("force up, N"),
                "f_n": number("force normal to both, N"),
            }),
            Self::Truth => json!({
                "timestamp": time(),
                "joint_state": number("the true joint state, rad (hinge) or m (slide)"),
            }),
            Self::Demonstration => json!({
                "timestamp": time(),
                "action": text("the action that was demonstrated"),
                "demonstration": integer("which demonstration was carried out to its end, from 1"),
            }),
            Self::Guard => json!({
                "timestamp": time(),
                "reason": text("why the guard stopped the arm"),
            }),
            Self::Timing => json!({
                "timestamp": time(),
                "controller": lateness(),
                "filter": lateness(),
                "policy": lateness(),
            }),
            Self::Controller | Self::Belief | Self::Policy | Self::Limits | Self::Dropped => {
                run_schema::fields(self).unwrap_or_default()
            }
        };
        let mut schema = object(self.schema_name(), fields);
        schema["title"] = self.schema_name().into();
        schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
        schema
    }
}

pub(super) fn object(description: &str, fields: Value) -> Value {
    let required: Vec<String> = fields
        .as_object()
        .map(|fields| fields.keys().cloned().collect())
        .unwrap_or_default();
    json!({ "type": "object", "description": description, "properties": fields, "required": required })
}

pub(super) fn time() -> Value {
    object(
        "the host's monotonic clock",
        json!({ "sec": integer("seconds"), "nsec": integer("nanoseconds") }),
    )
}

fn xyz(description: &str) -> Value {
    object(
        description,
        json!({ "x": number("x"), "y": number("y"), "z": number("z") }),
    )
}

fn lateness() -> Value {
    object(
        "how late the ticks of this loop were",
        json!({
            "p50_us": integer("half were at most this late"),
            "p99_us": integer("99 of 100 were"),
            "max_us": integer("the latest"),
            "missed": integer("ticks left out"),
        }),
    )
}

pub(super) fn number(description: &str) -> Value {
    json!({ "type": "number", "description": description })
}

pub(super) fn integer(description: &str) -> Value {
    json!({ "type": "integer", "minimum": 0, "description": description })
}

pub(super) fn text(description: &str) -> Value {
    json!({ "type": "string", "description": description })
}
