//! The force of the worst stop. A stop begins where a force passes its bound; until the handle
//! is at rest it presses on into the contact.

use super::Rules;
use crate::controller::stop_overshoot_n;

/// What a stop depends on besides the speed.
struct Stop {
    rate_hz: f64,
    deceleration: f64,
    stiffness: f64,
    threshold_n: f64,
    limit_n: f64,
}

pub(super) fn check(rules: &mut Rules<'_>) {
    let Some(stop) = stop(rules) else { return };
    if stop.threshold_n >= stop.limit_n {
        return; // said by the rule on the two forces
    }
    if let Some(speed) = rules.number("control.safe_speed_m_s") {
        safe_mode(rules, &stop, speed);
    }
    if let Some(speed) = rules.number("control.high_speed_m_s") {
        high_mode(rules, &stop, speed);
    }
}

fn stop(rules: &Rules<'_>) -> Option<Stop> {
    Some(Stop {
        rate_hz: rules.number("control.rate_hz")?,
        deceleration: rules.number("control.stop_deceleration_m_s2")?,
        stiffness: rules.number("control.contact_stiffness_n_per_m")?,
        threshold_n: rules.number("control.force_threshold_n")?,
        limit_n: rules.number("control.force_limit_n")?,
    })
}

/// Safe mode begins its stop at the threshold and must be at rest below the limit.
fn safe_mode(rules: &mut Rules<'_>, stop: &Stop, speed: f64) {
    let Stop {
        threshold_n,
        limit_n,
        ..
    } = *stop;
    let overshoot = stop.overshoot_n(speed);
    let worst = threshold_n + overshoot;
    if worst <= limit_n {
        return;
    }
    rules.fault(
        culprit(rules, "control.safe_speed_m_s"),
        format!(
            "the worst stop in safe mode presses with {worst:.1} N, above force_limit_n, {limit_n} N: {threshold_n} N + {}",
            stop.arithmetic(speed)
        ),
        stop.cure("safe_speed_m_s"),
    );
}

/// High-force mode must stop this much before the limit, and still push harder than safe mode.
fn high_mode(rules: &mut Rules<'_>, stop: &Stop, speed: f64) {
    let Stop {
        threshold_n,
        limit_n,
        ..
    } = *stop;
    let left = limit_n - stop.overshoot_n(speed);
    if left > threshold_n {
        return;
    }
    if left <= 0.0 {
        rules.fault(
            culprit(rules, "control.high_speed_m_s"),
            format!(
                "a stop in high-force mode adds more force than the whole of force_limit_n, {limit_n} N: {}",
                stop.arithmetic(speed)
            ),
            stop.cure("high_speed_m_s"),
        );
        return;
    }
    rules.fault(
        culprit(rules, "control.high_speed_m_s"),
        format!(
            "high-force mode has to begin its stop at {left:.1} N to stay below force_limit_n, and so could not push harder than safe mode, which stops at force_threshold_n, {threshold_n} N: {limit_n} N − {}",
            stop.arithmetic(speed)
        ),
        stop.cure("high_speed_m_s"),
    );
}

/// The key to show: the speed, unless it is a default and another of the numbers is not.
fn culprit(rules: &Rules<'_>, speed: &'static str) -> &'static str {
    rules.stated(&[
        speed,
        "control.force_limit_n",
        "control.force_threshold_n",
        "control.contact_stiffness_n_per_m",
        "control.stop_deceleration_m_s2",
        "control.rate_hz",
    ])
}

impl Stop {
    fn overshoot_n(&self, speed: f64) -> f64 {
        stop_overshoot_n(speed, self.rate_hz, self.deceleration, self.stiffness)
    }

    fn arithmetic(&self, speed: f64) -> String {
        format!(
            "{} N/m · ({speed} m/s · 2 / {} Hz + ({speed} m/s)² / (2 · {} m/s²)) = {:.1} N",
            self.stiffness,
            self.rate_hz,
            self.deceleration,
            self.overshoot_n(speed)
        )
    }

    /// The speed whose overshoot is just what lies between threshold and limit, rounded down to
    /// mm/s: the positive root of v²/2a + 2v/rate = margin / stiffness.
    fn largest_speed_mm_s(&self) -> f64 {
        let margin_m = (self.limit_n - self.threshold_n) / self.stiffness;
        let reaction_s = 2.0 / self.rate_hz;
        let a = self.deceleration;
        let speed = a * ((reaction_s * reaction_s + 2.0 * margin_m / a).sqrt() - reaction_s);
        let rounded = (speed * 1000.0).floor();
        // A bound that falls on a whole mm/s is excluded for high-force mode.
        if self.overshoot_n(rounded / 1000.0) < self.limit_n - self.threshold_n {
            rounded
        } else {
            rounded - 1.0
        }
    }

    fn cure(&self, key: &str) -> String {
        let largest = self.largest_speed_mm_s();
        if largest < 1.0 {
            return "no speed of 1 mm/s or more would pass: raise force_limit_n, or write the stiffness that was measured".to_owned();
        }
        format!(
            "write {key} = {} or less; a higher stop_deceleration_m_s2 or a softer contact allows more",
            largest / 1000.0
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overshoot_of_the_default_speeds_worked_by_hand() {
        // 5000 · (0.05 · 0.02 + 0.0025 / 10) = 5000 · 0.00125 = 6.25
        // 5000 · (0.15 · 0.02 + 0.0225 / 10) = 5000 · 0.00525 = 26.25
        for (speed, expected) in [(0.05, 6.25), (0.15, 26.25), (0.0, 0.0)] {
            let overshoot = stop_overshoot_n(speed, 100.0, 5.0, 5000.0);
            assert!(
                (overshoot - expected).abs() < 1e-12,
                "{speed} m/s: {overshoot} N"
            );
        }
    }

    #[test]
    fn the_largest_speed_is_the_last_that_passes() {
        let stop = Stop {
            rate_hz: 100.0,
            deceleration: 5.0,
            stiffness: 5000.0,
            threshold_n: 15.0,
            limit_n: 60.0,
        };
        // v² / 10 + 0.02 v = 45 / 5000  =>  v = -0.1 + √(0.01 + 0.09) = 0.2162…
        assert_eq!(stop.largest_speed_mm_s(), 216.0);
        assert!(stop.overshoot_n(0.216) < 45.0);
        assert!(stop.overshoot_n(0.217) > 45.0);
    }
}
