//! Tables of measured doors.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::{Path, PathBuf};

use pubs_calibrate::pulls::{self, Door};
use pubs_calibrate::spread::Settings;
use pubs_calibrate::survey::{overall, survey};

/// A file of the measured data; `None`, said aloud, where it is absent.
fn data(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/data")
        .join(name);
    if !path.exists() {
        println!("skipped: no data ({name})");
        return None;
    }
    Some(path)
}

#[test]
fn measured_doors_are_covered_honestly_by_the_defaults_and_not_by_independent_readings() {
    let Some(path) = data("door_forces.csv") else {
        return;
    };
    let doors = pulls::read(&path).unwrap();
    let pulls: usize = doors.iter().map(|door| door.pulls.len()).sum();
    assert_eq!((doors.len(), pulls), (18, 105));
    let settings = [Settings::INDEPENDENT, Settings::DEFAULT];
    let reports = survey(&doors, &settings).unwrap();
    let [independent, shipped] = <[_; 2]>::try_from(overall(&reports, &settings)).unwrap();
    assert!(
        (0.4..0.65).contains(&independent.coverage),
        "independent readings cover {:.3}; published studies of this data found 0.21 to 0.54",
        independent.coverage
    );
    assert!(
        shipped.is_honest(),
        "the defaults cover {:.3}, outside 0.85 to 0.97",
        shipped.coverage
    );
    assert!(
        shipped.median_error <= 1.6 * independent.median_error,
        "median error {:.2} degrees against {:.2} of independent readings",
        shipped.median_error,
        independent.median_error
    );
}

#[test]
fn a_log_of_one_pull_is_fitted_and_cannot_be_held_out() {
    for name in ["pr2_ikea_cabinet_log.csv", "pr2_lab_cabinet_log.csv"] {
        let Some(path) = data(name) else { return };
        let doors = pulls::read(&path).unwrap();
        assert_eq!((doors.len(), doors[0].pulls.len()), (1, 1), "{name}");
        let reports = survey(&doors, &[Settings::DEFAULT]).unwrap();
        assert!(
            reports[0].judgements.is_none(),
            "{name}: one pull cannot be held out"
        );
        let felt = doors[0].pulls[0]
            .force_n
            .iter()
            .copied()
            .fold(0.0, f64::max);
        let share = reports[0].peak_n / felt;
        // The lab cabinet's catch is a bump of two degrees: the smoothed mean keeps most of it.
        assert!(
            (0.7..1.0).contains(&share),
            "{name}: the peak is {:.1} N, up to {felt:.1} N were felt",
            reports[0].peak_n
        );
    }
}

#[test]
fn a_made_up_door_with_independent_noise_is_covered_as_it_says() {
    // Force 10 - 0.25 N per degree, noise of 0.5 N that is independent from reading to reading: then
    // the filter of independent readings is the right one.
    let mut noise = common_noise(7);
    let pull = |label: usize, noise: &mut dyn FnMut() -> f64| {
        let angle_deg: Vec<f64> = (0..36).map(f64::from).collect();
        let force_n = angle_deg
            .iter()
            .map(|angle| 10.0 - 0.25 * angle + 0.5 * noise())
            .collect();
        pulls::Pull {
            label: label.to_string(),
            angle_deg,
            force_n,
        }
    };
    let door = Door {
        name: "made up".to_owned(),
        class: None,
        pulls: (0..30).map(|label| pull(label, &mut noise)).collect(),
    };
    let reports = survey(&[door], &[Settings::INDEPENDENT]).unwrap();
    let judged = &reports[0].judgements.as_ref().unwrap()[0];
    assert!(
        (0.85..0.96).contains(&judged.coverage),
        "90 % intervals cover {:.3} of {} windows",
        judged.coverage,
        judged.windows
    );
    // Ten readings of slope 0.25 N per degree and sigma 0.5 N place the door to 0.63 degrees; the
    // median of |error| is 0.674 of that.
    assert!(
        (0.3..0.6).contains(&judged.median_error),
        "median error {:.2} degrees, expected 0.43",
        judged.median_error
    );
}

/// Standard normals by Box and Muller from a linear congruential generator.
fn common_noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    };
    move || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

#[test]
fn bad_tables_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("no-columns.csv", "a,b\n1,2\n", "mechanism"),
        (
            "empty.csv",
            "mechanism,agent,pull,angle_deg,tangential_force_n\n",
            "row",
        ),
        (
            "nan.csv",
            "mechanism,agent,pull,angle_deg,tangential_force_n\nd,a,0,0,1.0\nd,a,0,1,NaN\n",
            "line 3, column tangential_force_n: found `NaN`",
        ),
        (
            "word.csv",
            "angle_deg_fit,f_list_ati_tangential_N\n0.0,1.0\nx,2.0\n",
            "line 3, column angle_deg_fit: found `x`",
        ),
    ];
    for (name, text, words) in cases {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let error = pulls::read(&path).unwrap_err().to_string();
        assert!(
            error.contains(words) && error.contains(name),
            "{name}: {error}"
        );
    }
}

#[test]
fn the_defaults_are_those_that_the_engine_ships() {
    let table: toml::Table = pubs_core::object::DEFAULTS.parse().unwrap();
    let number = |key: &str| table["belief"][key].as_float().unwrap();
    assert_eq!(number("tempering"), Settings::DEFAULT.tempering);
    assert_eq!(
        number("reading_spacing_m"),
        Settings::DEFAULT.reading_spacing_m
    );
}
