//! A scale from values to the sheet.

/// Values `from..to` on the sheet's `start..end`.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// The value at the start.
    pub from: f64,
    /// The value at the end.
    pub to: f64,
    /// On the sheet.
    pub start: i32,
    /// On the sheet.
    pub end: i32,
    /// Linear up to this size of a value, logarithmic beyond; `None`: linear throughout.
    pub knee: Option<f64>,
}

impl Axis {
    /// Where a value stands.
    pub fn at(&self, value: f64) -> i32 {
        let [from, to, value] = [self.from, self.to, value].map(|value| self.bent(value));
        let part = (value - from) / (to - from);
        (f64::from(self.start) + part * f64::from(self.end - self.start)).round() as i32
    }

    /// Whether a value is between the ends.
    pub fn contains(&self, value: f64) -> bool {
        (self.from..=self.to).contains(&value)
    }

    /// The logarithm goes on with the value and the slope that the line has at the knee.
    fn bent(&self, value: f64) -> f64 {
        match self.knee {
            Some(knee) if value.abs() > knee => {
                value.signum() * knee * (1.0 + (value.abs() / knee).ln())
            }
            _ => value,
        }
    }

    /// At most about `most` round values, with their labels.
    pub fn ticks(&self, most: usize) -> Vec<(f64, String)> {
        let Some(knee) = self.knee else {
            return even_ticks(
                self.from,
                self.to,
                round_step((self.to - self.from) / most as f64),
            );
        };
        let step = round_step(knee / 2.0);
        let mut ticks = even_ticks(self.from.max(-knee), self.to.min(knee), step);
        let beyond = self
            .decades_beyond(knee)
            .into_iter()
            .flat_map(|size| [-size, size])
            .filter(|value| value.abs() > knee && self.contains(*value));
        ticks.extend(beyond.map(|value| (value, String::new())));
        for (value, text) in &mut ticks {
            *text = short_label(*value);
        }
        ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
        ticks
    }

    /// Round sizes from the knee's decade on: four in each of two decades, one in each of more.
    fn decades_beyond(&self, knee: f64) -> Vec<f64> {
        let first = decade(knee);
        let reach = self.from.abs().max(self.to.abs());
        let decades = (reach / first).log10().floor() as i32;
        let digits: &[f64] = if decades < 2 {
            &[1.0, 2.0, 3.0, 5.0]
        } else {
            &[1.0]
        };
        let powers = (0..=decades).map(|power| first * 10f64.powi(power));
        powers
            .flat_map(|power| digits.iter().map(move |digit| digit * power))
            .collect()
    }
}

/// Multiples of `step`.
fn even_ticks(from: f64, to: f64, step: f64) -> Vec<(f64, String)> {
    let first = (from / step).ceil() as i64;
    let last = (to / step).floor() as i64;
    let decimals = if step < 1.0 {
        (-step.log10() + 0.5).ceil() as usize
    } else {
        usize::from(step.fract() > 0.0)
    };
    (first..=last)
        .map(|index| index as f64 * step)
        .map(|value| (value, label(value, decimals)))
        .collect()
}

fn label(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}").replace('-', "\u{2212}")
}

/// With as few decimals as the value has, three at most.
fn short_label(value: f64) -> String {
    let text = label(value, 3);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn decade(value: f64) -> f64 {
    10f64.powf(value.log10().floor())
}

/// The least of 1, 2, 2.5, 5 · 10^k that is not below `least`.
fn round_step(least: f64) -> f64 {
    let decade = decade(least);
    let steps = [1.0, 2.0, 2.5, 5.0, 10.0];
    let fitting = steps
        .iter()
        .find(|&&step| step * decade >= least * (1.0 - 1e-9));
    fitting.unwrap_or(&10.0) * decade
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(from: f64, to: f64, knee: Option<f64>) -> Axis {
        Axis {
            from,
            to,
            start: 500,
            end: 100,
            knee,
        }
    }

    #[test]
    fn ticks_are_round_and_inside() {
        type Case = (f64, f64, Option<f64>, usize, &'static [&'static str]);
        let cases: [Case; 7] = [
            (
                0.0,
                40_000.0,
                Some(10.0),
                8,
                &["0", "5", "10", "100", "1000", "10000"],
            ),
            (-2.5, 127.5, None, 6, &["0", "25", "50", "75", "100", "125"]),
            (-0.6, 28.6, None, 6, &["0", "5", "10", "15", "20", "25"]),
            (-3.0, 17.0, None, 5, &["0", "5", "10", "15"]),
            (
                -1.3,
                1.2,
                None,
                5,
                &["\u{2212}1.0", "\u{2212}0.5", "0.0", "0.5", "1.0"],
            ),
            (0.0, 0.2, None, 4, &["0.00", "0.05", "0.10", "0.15", "0.20"]),
            (
                -12.0,
                55.0,
                Some(5.0),
                9,
                &[
                    "\u{2212}10",
                    "\u{2212}5",
                    "\u{2212}2.5",
                    "0",
                    "2.5",
                    "5",
                    "10",
                    "20",
                    "30",
                    "50",
                ],
            ),
        ];
        for (from, to, knee, most, expected) in cases {
            let ticks = axis(from, to, knee).ticks(most);
            let labels: Vec<_> = ticks.into_iter().map(|(_, label)| label).collect();
            assert_eq!(labels, expected, "{from} to {to}, at most {most}");
        }
    }

    #[test]
    fn values_stand_in_proportion() {
        let linear = axis(-10.0, 30.0, None);
        assert_eq!(
            [-10.0, 0.0, 30.0].map(|value| linear.at(value)),
            [500, 400, 100]
        );
        // 5 e² is 2 knees beyond the knee: as far as three knees on the line.
        let bent = axis(-5.0, 5.0 * 2f64.exp(), Some(5.0));
        assert_eq!(
            [-5.0, 0.0, 5.0, 5.0 * 1f64.exp()].map(|value| bent.at(value)),
            [500, 400, 300, 200]
        );
    }
}
