//! The command line.

const USAGE: &str = "usage: segments WORLD [--demonstrations N] [--seed N] [--safe-speed M_S] \
[--high-speed M_S] [--acceleration M_S2] [--stop-deceleration M_S2] [--force-threshold N] \
[--force-limit N] [--contact-stiffness N_PER_M] [--motion-threshold M] \
[--skipped-travel M] [--position-sd FRACTION]";

/// Speeds, forces and counts; the defaults are those of `objects/door2.toml`.
pub struct Arguments {
    pub world: String,
    pub demonstrations: u64,
    pub seed: u64,
    pub safe_speed_m_s: f64,
    pub high_speed_m_s: f64,
    pub acceleration_m_s2: f64,
    pub stop_deceleration_m_s2: f64,
    pub force_threshold_n: f64,
    pub force_limit_n: f64,
    pub contact_stiffness_n_per_m: f64,
    pub motion_threshold_m: f64,
    /// Readings before the tool has gone this far the action's way are left out, m.
    pub skipped_travel_m: f64,
    /// How well a filter knows the state, standard deviation as a fraction of the range: about
    /// half the distance of two particles among 300.
    pub position_sd: f64,
}

impl Arguments {
    pub fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let world = words
            .next()
            .filter(|word| !word.starts_with('-'))
            .ok_or(USAGE)?;
        let mut arguments = Self {
            world,
            demonstrations: 20,
            seed: 1,
            safe_speed_m_s: 0.05,
            high_speed_m_s: 0.15,
            acceleration_m_s2: 1.0,
            stop_deceleration_m_s2: 5.0,
            force_threshold_n: 15.0,
            force_limit_n: 60.0,
            contact_stiffness_n_per_m: 5000.0,
            motion_threshold_m: 0.0005,
            // The filter loop weighs no forces while the arm speeds up or turns round.
            skipped_travel_m: 0.002,
            position_sd: 0.002,
        };
        while let Some(flag) = words.next() {
            let value = words
                .next()
                .ok_or_else(|| format!("{flag} needs a value\n{USAGE}"))?;
            arguments.set(&flag, &value)?;
        }
        Ok(arguments)
    }

    fn set(&mut self, flag: &str, value: &str) -> Result<(), String> {
        match flag {
            "--demonstrations" => self.demonstrations = count(flag, value)?,
            "--seed" => self.seed = count(flag, value)?,
            "--safe-speed" => self.safe_speed_m_s = positive(flag, value)?,
            "--high-speed" => self.high_speed_m_s = positive(flag, value)?,
            "--acceleration" => self.acceleration_m_s2 = positive(flag, value)?,
            "--stop-deceleration" => self.stop_deceleration_m_s2 = positive(flag, value)?,
            "--force-threshold" => self.force_threshold_n = positive(flag, value)?,
            "--force-limit" => self.force_limit_n = positive(flag, value)?,
            "--contact-stiffness" => self.contact_stiffness_n_per_m = positive(flag, value)?,
            "--motion-threshold" => self.motion_threshold_m = positive(flag, value)?,
            "--skipped-travel" => self.skipped_travel_m = positive(flag, value)?,
            "--position-sd" => self.position_sd = positive(flag, value)?,
            _ => return Err(format!("unknown flag {flag}\n{USAGE}")),
        }
        Ok(())
    }
}

fn count(flag: &str, value: &str) -> Result<u64, String> {
    value
        .parse()
        .map_err(|_| format!("{flag} {value}: must be a whole number"))
}

fn positive(flag: &str, value: &str) -> Result<f64, String> {
    let number: Option<f64> = value.parse().ok();
    number
        .filter(|&number| number > 0.0)
        .ok_or_else(|| format!("{flag} {value}: must be a positive number"))
}
