//! Numbers as they are written in the report.

use super::matrix::Format;
use super::paper::Estimate;

/// Stands for a cell that has not been run.
pub(crate) const NOT_RUN: &str = "not run";

/// Stands where there is nothing to say.
pub(crate) const NOTHING: &str = "\u{2013}";

/// With so many decimals; a true minus sign, and none before zero.
pub(crate) fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(size)
            if size
                .bytes()
                .any(|digit| digit.is_ascii_digit() && digit != b'0') =>
        {
            format!("\u{2212}{size}")
        }
        Some(zero) => zero.to_owned(),
        None => text,
    }
}

/// With its sign.
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    let text = decimal(value, decimals);
    let rounded = text.parse().unwrap_or(-1.0);
    if rounded > 0.0 {
        format!("+{text}")
    } else {
        text
    }
}

/// A share in percent.
pub(crate) fn percent(share: f64) -> String {
    format!("{} %", decimal(100.0 * share, 2))
}

/// Mean ± standard error; the mean alone where the error is not known.
pub(crate) fn estimate(value: Estimate, format: Format) -> String {
    match format {
        Format::Percent => percent(value.mean),
        Format::Decimals(mean, _) if value.se.is_nan() => decimal(value.mean, mean),
        Format::Decimals(mean, se) => {
            format!(
                "{} \u{b1} {}",
                decimal(value.mean, mean),
                decimal(value.se, se)
            )
        }
    }
}

/// Without an error.
pub(crate) fn mean(value: f64, format: Format) -> String {
    match format {
        Format::Percent => percent(value),
        Format::Decimals(decimals, _) => decimal(value, decimals),
    }
}

/// A difference of two means.
pub(crate) fn difference(value: f64, format: Format) -> String {
    match format {
        Format::Percent => format!("{} points", signed(100.0 * value, 2)),
        Format::Decimals(decimals, _) => signed(value, decimals),
    }
}

/// A duration in the unit that suits it.
pub(crate) fn duration(seconds: f64) -> String {
    if seconds < 60.0 {
        format!("{} s", decimal(seconds, 1))
    } else if seconds < 3600.0 {
        format!("{} min", decimal(seconds / 60.0, 1))
    } else {
        format!("{} h", decimal(seconds / 3600.0, 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_as_read() {
        let cases = [
            (decimal(-0.4781, 3), "\u{2212}0.478"),
            (decimal(-0.0001, 3), "0.000"),
            (signed(0.0123, 3), "+0.012"),
            (signed(-0.0123, 3), "\u{2212}0.012"),
            (signed(0.0001, 3), "0.000"),
            (percent(0.9958), "99.58 %"),
            (difference(0.0022, Format::Percent), "+0.22 points"),
            (duration(59.0), "59.0 s"),
            (duration(90.0), "1.5 min"),
            (duration(5400.0), "1.5 h"),
        ];
        for (found, expected) in cases {
            assert_eq!(found, expected);
        }
        let one = Estimate {
            mean: 1.5,
            se: f64::NAN,
        };
        assert_eq!(estimate(one, Format::Decimals(2, 2)), "1.50");
    }
}
