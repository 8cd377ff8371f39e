//! probe
#![allow(clippy::unwrap_used, missing_docs)]
use pubs_calibrate::pulls::{Door, Pull};
use pubs_calibrate::spread::Settings;
use std::collections::BTreeMap;
#[test]
fn survey_probe() {
    let text = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../../shared/data/door_forces.csv"
    ))
    .unwrap();
    let mut doors: BTreeMap<String, (String, BTreeMap<String, (Vec<f64>, Vec<f64>)>)> =
        BTreeMap::new();
    for line in text.lines().skip(1) {
        let f: Vec<&str> = line.split(',').collect();
        let d = doors
            .entry(format!("{} {}", f[1], f[2]))
            .or_insert((f[0].to_owned(), BTreeMap::new()));
        let p = d.1.entry(f[3].to_owned()).or_default();
        p.0.push(f[4].parse().unwrap());
        p.1.push(f[5].parse().unwrap());
    }
    let doors: Vec<Door> = doors
        .into_iter()
        .map(|(name, (class, pulls))| Door {
            name,
            class: Some(class),
            pulls: pulls
                .into_iter()
                .map(|(label, (angle_deg, force_n))| Pull {
                    label,
                    angle_deg,
                    force_n,
                })
                .collect(),
        })
        .collect();
    let s = |tempering, reading_spacing_m| Settings {
        tempering,
        reading_spacing_m,
    };
    let settings: Vec<Settings> = vec![
        Settings::INDEPENDENT,
        s(0.5, 0.0),
        s(0.25, 0.0),
        s(0.125, 0.0),
        s(0.18, 0.005),
        s(1.0, 0.01),
        s(0.5, 0.01),
        s(0.35, 0.01),
        s(0.25, 0.01),
        s(1.0, 0.02),
        s(0.7, 0.02),
        s(0.5, 0.02),
        s(0.35, 0.02),
        s(1.0, 0.03),
        s(0.7, 0.03),
        s(0.5, 0.03),
    ];
    let began = std::time::Instant::now();
    let reports = pubs_calibrate::survey::survey(&doors, &settings).unwrap();
    println!("{:?}", began.elapsed());
    for r in &reports {
        print!(
            "{:40} {:10} {} pulls {} seg peak {:.1} sigma {:.2?}",
            r.door,
            r.class.clone().unwrap(),
            r.pulls,
            r.segments,
            r.peak_n,
            r.sigma_n
        );
        if let Some(j) = &r.judgements {
            for i in [0, 3, 6, 11] {
                print!(" | {:.2} {:.0}%", j[i].median_error, 100.0 * j[i].coverage);
            }
        }
        println!();
    }
    for j in pubs_calibrate::survey::overall(&reports, &settings) {
        println!(
            "{:?} windows {} median {:.2} cover {:.3}",
            j.settings, j.windows, j.median_error, j.coverage
        );
    }
}
