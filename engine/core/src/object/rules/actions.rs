//! The actions of an abstract joint.

use super::Rules;

/// One action as far as it is right by itself.
struct Entry {
    path: String,
    name: Option<String>,
    stop: bool,
    displacement: Option<f64>,
    observations: f64,
}

pub(super) fn check(rules: &mut Rules<'_>) {
    let count = super::lookup(&rules.merged.values, "action")
        .and_then(|list| list.as_array())
        .map(<[_]>::len);
    let is_list_or_element = |key: &str| match key.strip_prefix("action") {
        Some("") => true,
        Some(rest) => rest[1..].parse::<usize>().is_ok(),
        None => false,
    };
    let refused = rules
        .at_fault
        .iter()
        .any(|fault| is_list_or_element(&fault.key));
    let Some(count) = count.filter(|_| !refused) else {
        return;
    };
    let entries: Vec<Entry> = (0..count).map(|index| entry(rules, index)).collect();
    one_stop(rules, &entries);
    unique_names(rules, &entries);
    let range = rules
        .numbers::<2>("joint.limits")
        .map(|[lower, upper]| upper - lower);
    let integer = rules.flag("joint.integer") == Some(true);
    for entry in &entries {
        if entry.stop {
            stays(rules, entry);
        } else {
            moves(rules, entry, range, integer);
        }
    }
}

fn entry(rules: &Rules<'_>, index: usize) -> Entry {
    let path = format!("action.{index}");
    let at = |name: &str| format!("{path}.{name}");
    Entry {
        name: rules.text(&at("name")).map(str::to_owned),
        stop: rules.flag(&at("stop")) == Some(true),
        displacement: rules.number(&at("move")),
        observations: rules.number(&at("observations")).unwrap_or(1.0),
        path,
    }
}

fn one_stop(rules: &mut Rules<'_>, entries: &[Entry]) {
    let stops: Vec<&Entry> = entries.iter().filter(|entry| entry.stop).collect();
    match stops.as_slice() {
        [_] => {}
        [] => rules.fault(
            "action",
            "no action is the stop action; exactly one must be",
            "add `stop = true` to the [[action]] that ends an episode",
        ),
        [first, others @ ..] => {
            let taken = first.name.as_deref().unwrap_or("another").to_owned();
            for other in others {
                rules.fault(
                    &format!("{}.stop", other.path),
                    format!("a second stop action; `{taken}` is one already"),
                    "leave `stop = true` at one action",
                );
            }
        }
    }
}

fn unique_names(rules: &mut Rules<'_>, entries: &[Entry]) {
    for (index, entry) in entries.iter().enumerate() {
        let Some(name) = &entry.name else { continue };
        if entries[..index]
            .iter()
            .any(|before| before.name.as_ref() == Some(name))
        {
            rules.fault(
                &format!("{}.name", entry.path),
                format!("two actions have the name `{name}`"),
                "write another name: policies and logs tell actions apart by it",
            );
        }
    }
}

fn stays(rules: &mut Rules<'_>, entry: &Entry) {
    for name in ["move", "observations", "high_force"] {
        let key = format!("{}.{name}", entry.path);
        if super::lookup(&rules.merged.values, &key).is_some() {
            rules.fault(
                &key,
                format!("the stop action has `{name}`; it ends the episode where it stands"),
                "remove it",
            );
        }
    }
}

fn moves(rules: &mut Rules<'_>, entry: &Entry, range: Option<f64>, integer: bool) {
    let key = format!("{}.move", entry.path);
    let Some(displacement) = entry.displacement else {
        if super::lookup(&rules.merged.values, &key).is_none() {
            rules.fault(
                &key,
                format!("`{key}` is missing"),
                "add `move = …`, the signed displacement, or `stop = true`",
            );
        }
        return;
    };
    if displacement == 0.0 {
        rules.fault(
            &key,
            format!("`{key}` is 0: the action does nothing"),
            "write a signed displacement, or `stop = true`",
        );
    }
    if let Some(range) = range
        && range > 0.0
        && displacement.abs() > range
    {
        rules.fault(
            &key,
            format!("`{key}` is {displacement}, more than the whole range, {range}"),
            "write a displacement that fits between the limits",
        );
    }
    let sub_move = displacement / entry.observations;
    if integer && sub_move.fract() != 0.0 {
        rules.fault(
            &key,
            format!("`{key}` is {displacement} in {} sub-moves of {sub_move}, but states are whole numbers (integer = true)", entry.observations),
            "write a move that is a whole multiple of `observations`",
        );
    }
}
