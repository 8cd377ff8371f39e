//! Limits, start, goal and goal tolerance of the joint.

use super::Rules;

/// The keys of limits and tolerance for each unit.
const UNITS: [(&str, &str); 3] = [
    ("joint.limits_deg", "reward.goal_tolerance_deg"),
    ("joint.limits_m", "reward.goal_tolerance_m"),
    ("joint.limits", "reward.goal_tolerance"),
];

pub(super) fn check(rules: &mut Rules<'_>) {
    for (limits_key, tolerance_key) in UNITS {
        let Some([lower, upper]) = rules.numbers::<2>(limits_key) else {
            continue;
        };
        if lower >= upper {
            rules.fault(
                limits_key,
                format!("`{limits_key}` goes from {lower} to {upper}; the second must be larger"),
                format!("the closed limit comes first: [{upper}, {lower}]; a door that opens the other way has another opening_direction"),
            );
            continue;
        }
        tolerance(rules, tolerance_key, lower, upper);
        inside(rules, lower, upper);
    }
    whole(rules);
}

/// With a goal region as wide as the range, every stop would be a good one.
fn tolerance(rules: &mut Rules<'_>, key: &str, lower: f64, upper: f64) {
    let half_range = (upper - lower) / 2.0;
    if let Some(tolerance) = rules.number(key)
        && tolerance >= half_range
    {
        rules.fault(
            key,
            format!("`{key}` is {tolerance}; half the range is {half_range}, and stopping anywhere near the middle would do"),
            format!("write a tolerance below {half_range}"),
        );
    }
}

fn inside(rules: &mut Rules<'_>, lower: f64, upper: f64) {
    if let Some([first, last]) = rules.numbers::<2>("joint.start")
        && !(lower <= first && first <= last && last <= upper)
    {
        rules.fault(
            "joint.start",
            format!("`joint.start` goes from {first} to {last}; it must be ordered and inside the limits [{lower}, {upper}]"),
            "write the smallest and the largest state at the start, or leave the key out for the whole range",
        );
    }
    if let Some(goal) = rules.number("joint.goal")
        && !(lower <= goal && goal <= upper)
    {
        rules.fault(
            "joint.goal",
            format!("`joint.goal` is {goal}, outside the limits [{lower}, {upper}]"),
            "write a goal inside the limits",
        );
    }
}

/// States that are whole numbers start and end on whole numbers.
fn whole(rules: &mut Rules<'_>) {
    if rules.flag("joint.integer") != Some(true) {
        return;
    }
    let pairs = ["joint.limits", "joint.start"].map(|key| (key, rules.numbers::<2>(key)));
    for (key, pair) in pairs {
        if let Some([first, last]) = pair
            && (first.fract() != 0.0 || last.fract() != 0.0)
        {
            rules.fault(
                key,
                format!(
                    "`{key}` is [{first}, {last}], but states are whole numbers (integer = true)"
                ),
                format!("write [{}, {}]", first.round(), last.round()),
            );
        }
    }
}
