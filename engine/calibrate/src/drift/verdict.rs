//! A comparison in words.

use super::region::Region;
use super::{Cause, Drift, Estimate, Finding, Outcome};
use crate::object_text::StateUnit;

/// More residual than this is worth a word beside the cause.
const MUCH_LEFT: f64 = 1.5;

/// A sigma is wider than it need be where the ratio is below this.
const MUCH_TOO_WIDE: f64 = 0.5;

/// One sentence: whether it holds, the figures, and what to do where it does not.
pub(super) fn sentence(drift: &Drift, outcome: &Outcome, unit: StateUnit) -> String {
    match outcome {
        Outcome::Holds => format!("holds: {}", figures(drift)),
        Outcome::Unclear => format!(
            "too few demonstrations to tell ({}): {}; record more of them",
            drift.demonstrations,
            figures(drift)
        ),
        Outcome::Fails(finding) => failure(drift, finding, unit),
    }
}

fn failure(drift: &Drift, finding: &Finding, unit: StateUnit) -> String {
    let ratio = drift.sigma_ratio.unwrap_or_default();
    let offset = drift.offset_n.unwrap_or(Estimate {
        value: 0.0,
        sd: 0.0,
    });
    let (what, cure) = match finding.cause {
        Cause::Offset => (
            format!("forces are {} the stored mean", off(offset)),
            "tare the sensor and check again, or calibrate again",
        ),
        Cause::Gain => (
            format!("forces are {} times the stored mean", pair(drift.gain, 1.0)),
            "check the sensor's scale and the grasp, or calibrate again",
        ),
        Cause::Shift => (
            format!("the curve lies {}", moved(drift.shift, unit)),
            "check the zero at a limit and the grasp, or calibrate again",
        ),
        Cause::Region => (
            place(finding.region, unit, "the mean force", " N"),
            "calibrate again",
        ),
        Cause::Moves => (
            place(finding.region, unit, "the share of moving readings", ""),
            "look for what blocks or no longer blocks it, or calibrate again",
        ),
        Cause::Noise => (
            format!(
                "residuals are {ratio:.1} times the stored sigma, {:.0} % beyond two sigma",
                100.0 * drift.outside.unwrap_or_default()
            ),
            "look for a loose grasp or sensor, or calibrate again",
        ),
    };
    let explains = matches!(finding.cause, Cause::Offset | Cause::Gain | Cause::Shift);
    let left = if explains && finding.left > MUCH_LEFT {
        format!(
            ", which leaves residuals {:.1} times the stored sigma",
            finding.left
        )
    } else {
        String::new()
    };
    format!("no longer holds: {what}{left}; {cure}")
}

fn figures(drift: &Drift) -> String {
    let ratio = drift.sigma_ratio.unwrap_or_default();
    let offset = drift.offset_n.map_or(0.0, |offset| offset.value);
    let Some(outside) = drift.outside else {
        return format!("share of moving readings off by {offset:+.2} in the mean");
    };
    let wide = if ratio < MUCH_TOO_WIDE {
        "; sigma is wider than these readings need"
    } else {
        ""
    };
    format!(
        "offset {offset:+.2} N, residuals {ratio:.2} times the stored sigma, {:.1} % beyond two sigma{wide}",
        100.0 * outside
    )
}

fn off(offset: Estimate) -> String {
    let side = if offset.value > 0.0 { "above" } else { "below" };
    format!("{:.2} ± {:.2} N {side}", offset.value.abs(), offset.sd)
}

fn pair(estimate: Option<Estimate>, scale: f64) -> String {
    let shown = |e: Estimate| format!("{:.2} ± {:.2}", scale * e.value.abs(), scale * e.sd);
    estimate.map(shown).unwrap_or_default()
}

fn moved(shift: Option<Estimate>, unit: StateUnit) -> String {
    let opens = shift.is_some_and(|shift| shift.value > 0.0);
    let side = if opens { "open" } else { "closed" };
    let (scale, name) = shown_unit(unit);
    format!("{} {name} further towards {side}", pair(shift, scale))
}

/// From SI to what people read.
fn shown_unit(unit: StateUnit) -> (f64, &'static str) {
    match unit {
        StateUnit::Degrees => (1f64.to_degrees(), "°"),
        StateUnit::Metres => (1000.0, "mm"),
    }
}

fn place(region: Option<Region>, unit: StateUnit, what: &str, of: &str) -> String {
    let (scale, name) = shown_unit(unit);
    let shown = |region: Region| {
        format!(
            "between {:.1} and {:.1} {name} {what} is {:.2}{of}, and {:.2}{of} is stored",
            scale * region.from,
            scale * region.to,
            region.measured,
            region.stored
        )
    };
    region.map(shown).unwrap_or_default()
}
