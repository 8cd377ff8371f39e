//! JSON Schemas of the messages that runs alone have.

use serde_json::{Value, json};

use super::topic::{Topic, integer, number, object, text, time};

/// Properties of the message on that topic; `None` for those that every recording has.
pub(super) fn fields(topic: Topic) -> Option<Value> {
    Some(match topic {
        Topic::Controller => json!({
            "timestamp": time(),
            "tick": integer("number of the controller's tick, from 1"),
            "order_time": time(),
            "stopping": boolean("whether the arm was to come to rest whatever was ordered"),
            "reading": boolean("whether there was a reading; it stands on /pose, /wrench and /observation just before, and on /action just after"),
        }),
        Topic::Belief => json!({
            "timestamp": time(),
            "step": integer("number of the filter's step, from 1"),
            "tick": integer("the controller's tick whose sample it took in; 0: none yet"),
            "valid": boolean("whether there was a sample to follow"),
            "mean": number("mean of the belief, rad (hinge) or m (slide)"),
            "entropy": number("entropy of the belief over ln N: 1 knows nothing"),
            "allowed": list(text("an action that the shield allows")),
            "readings": list(number("the newest reading of each channel that counted, in the model's order")),
            "displacement": number("of the joint since the grasp, rad or m, in the sample that was taken in"),
            "speed_m_s": number("commanded speed in that sample, positive towards open"),
            "recoveries": integer("how often the belief was started afresh so far"),
            "error": maybe("string", "why the filter could not go on"),
            "histogram": object("mass of the particles in even bins", json!({
                "lower": number("where the first bin begins"),
                "upper": number("where the last bin ends"),
                "mass": list(number("mass in each bin; it adds up to 1")),
            })),
        }),
        Topic::Policy => json!({
            "timestamp": time(),
            "step": integer("number of the policy's step, from 1"),
            "belief": integer("the filter's step whose belief it took in; 0: none yet"),
            "truth": maybe("number", "the true joint state, which judges violations alone"),
            "goal": integer("which goal of the run, from 0"),
            "action": text("the action chosen, or still in force"),
            "verdict": { "enum": ["going", "done", "violation"], "description": "what it asked for" },
            "error": maybe("string", "why the policy could not go on"),
        }),
        Topic::Limits => json!({
            "timestamp": time(),
            "unit": text("of everything here: rad (hinge) or m (slide)"),
            "lower": number("closed"),
            "upper": number("open"),
            "goals": list(object("a goal, in turn", json!({
                "state": number("the goal itself"),
                "from": number("where its region begins"),
                "to": number("where its region ends"),
            }))),
        }),
        Topic::Dropped => json!({
            "timestamp": time(),
            "entries": integer("entries lost so far because the disk was too slow"),
        }),
        _ => return None,
    })
}

fn boolean(description: &str) -> Value {
    json!({ "type": "boolean", "description": description })
}

fn list(item: Value) -> Value {
    json!({ "type": "array", "items": item })
}

fn maybe(kind: &str, description: &str) -> Value {
    json!({ "type": [kind, "null"], "description": description })
}
