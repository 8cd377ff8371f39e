//! The rates of the three loops, and the order of speeds and forces.

use super::Rules;

pub(super) fn check(rules: &mut Rules<'_>) {
    not_above(
        rules,
        "control.safe_speed_m_s",
        "control.high_speed_m_s",
        "safe mode is the slower one",
    );
    not_above(
        rules,
        "belief.rate_hz",
        "control.rate_hz",
        "the filter reads what the controller measures",
    );
    not_above(
        rules,
        "policy.rate_hz",
        "belief.rate_hz",
        "the policy reads what the filter estimates",
    );
    whole_updates(rules);
    let threshold = rules.number("control.force_threshold_n");
    let limit = rules.number("control.force_limit_n");
    if let (Some(threshold), Some(limit)) = (threshold, limit)
        && threshold >= limit
    {
        rules.fault(
            rules.stated(&["control.force_threshold_n", "control.force_limit_n"]),
            format!("`control.force_threshold_n` is {threshold} N, not below force_limit_n, {limit} N"),
            format!("write a threshold below {limit}: safe mode stops at the threshold, every mode at the limit"),
        );
    }
}

fn not_above(rules: &mut Rules<'_>, small: &str, large: &str, reason: &str) {
    if let (Some(low), Some(high)) = (rules.number(small), rules.number(large))
        && low > high
    {
        rules.fault(
            rules.stated(&[small, large]),
            format!("`{small}` is {low}, above `{large}`, {high}; {reason}"),
            format!("write `{small}` at most {high}, or raise `{large}`"),
        );
    }
}

/// The trainer and the robot run the same number of filter updates in every policy step.
fn whole_updates(rules: &mut Rules<'_>) {
    let (Some(belief), Some(policy)) = (
        rules.number("belief.rate_hz"),
        rules.number("policy.rate_hz"),
    ) else {
        return;
    };
    let updates = belief / policy;
    if updates < 1.0 || (updates - updates.round()).abs() <= 1e-9 * updates {
        return;
    }
    rules.fault(
        rules.stated(&["belief.rate_hz", "policy.rate_hz"]),
        format!("`belief.rate_hz` is {belief} and `policy.rate_hz` {policy}: {updates:.2} filter updates to each policy step, which must be a whole number"),
        format!("write belief.rate_hz = {} or {}", updates.floor() * policy, updates.ceil() * policy),
    );
}
