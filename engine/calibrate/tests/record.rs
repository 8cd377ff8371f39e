//! Recording demonstrations of the virtual arm.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;
use pubs_calibrate::Values;

#[test]
fn probe() {
    let task = common::task("door2", &[]);
    let (recording, _) = common::recorded(&task, 5, 1);
    let began = std::time::Instant::now();
    let (traces, limits) = pubs_calibrate::traces::traces(&task, &recording, 0).unwrap();
    println!(
        "{:?} {limits:?} range {:?}",
        began.elapsed(),
        limits.range.map(f64::to_degrees)
    );
    let segments = pubs_calibrate::fit::fit(&task, &traces).unwrap();
    println!("{:?}", began.elapsed());
    for s in &segments {
        let d = |v: &Vec<f64>| {
            v.iter()
                .map(|x| format!("{:.2}", x))
                .collect::<Vec<_>>()
                .join(" ")
        };
        match &s.values {
            Values::Force {
                position,
                mean_n,
                sigma_n,
            } => println!(
                "{} {} {:.2}..{:.2} sigma {} | {} | {} {:?}",
                s.action,
                s.channel.name(),
                s.from.to_degrees(),
                s.to.to_degrees(),
                d(sigma_n),
                d(&position.iter().map(|p| p.to_degrees()).collect()),
                d(mean_n),
                s.note
            ),
            Values::Moves { probability } => println!(
                "{} {} {:.2}..{:.2} p {probability:.2} {:?}",
                s.action,
                s.channel.name(),
                s.from.to_degrees(),
                s.to.to_degrees(),
                s.note
            ),
        }
    }
}

#[test]
fn probe2() {
    let task = common::task("door2", &[]);
    let (recording, _) = common::recorded(&task, 5, 1);
    let (traces, _) = pubs_calibrate::traces::traces(&task, &recording, 0).unwrap();
    for t in traces.iter().filter(|t| t.action == 1 && t.pull == 2) {
        for p in t
            .points
            .iter()
            .filter(|p| p.state.to_degrees() > 122.4 && p.state.to_degrees() < 125.0)
        {
            println!(
                "folded {} {:.2} {:.2} settled {} held {}",
                t.folded,
                p.state.to_degrees(),
                p.forces_n[0],
                p.settled,
                p.held
            );
        }
        println!("--");
    }
}

#[test]
fn probe3() {
    use pubs_calibrate::spread::Settings;
    let task = common::task("door2", &[]);
    let (recording, _) = common::recorded(&task, 5, 1);
    let (traces, _) = pubs_calibrate::traces::traces(&task, &recording, 0).unwrap();
    let s = |tempering, reading_spacing_m| Settings {
        tempering,
        reading_spacing_m,
    };
    let settings = [
        Settings::INDEPENDENT,
        s(0.5, 0.0),
        s(0.35, 0.0),
        s(0.25, 0.0),
        s(0.125, 0.0),
        s(1.0, 0.005),
        s(0.5, 0.005),
        s(0.25, 0.005),
        s(0.125, 0.005),
        s(1.0, 0.01),
        s(0.5, 0.01),
        s(0.25, 0.01),
        s(1.0, 0.02),
        s(0.5, 0.02),
        s(0.35, 0.02),
    ];
    let began = std::time::Instant::now();
    for j in pubs_calibrate::spread::judge(&task, &traces, &settings).unwrap() {
        println!(
            "{:?} windows {} median {:.2} cover {:.3}",
            j.settings,
            j.windows,
            j.median_error.to_degrees(),
            j.coverage
        );
    }
    println!("{:?}", began.elapsed());
}

#[test]
fn probe4() {
    let name = std::env::var("OBJ").unwrap_or("door2".to_owned());
    let task = common::task(&name, &[]);
    let rev = task.joint.unit() == "rad";
    let (recording, _) = common::recorded(&task, 5, 1);
    let (traces, limits) = pubs_calibrate::traces::traces(&task, &recording, 0).unwrap();
    println!("{limits:?}");
    let segments = pubs_calibrate::fit::fit(&task, &traces).unwrap();
    let text = std::fs::read_to_string(common::object_path(&name)).unwrap();
    let (head, _) = text.split_once("[[observation.segment]]").unwrap();
    let mut out = head.to_owned();
    let (suffix, k, dec) = if rev {
        ("deg", 1f64.to_degrees(), 2)
    } else {
        ("m", 1.0, 5)
    };
    let list = |v: &[f64], k: f64, d: usize| {
        format!(
            "[{}]",
            v.iter()
                .map(|x| format!("{:.d$}", x * k))
                .collect::<Vec<_>>()
                .join(", ")
        )
    };
    for s in &segments {
        out += &format!(
            "[[observation.segment]]\naction = \"{}\"\nchannel = \"{}\"\nfrom_{suffix} = {:.dec$}\nto_{suffix} = {:.dec$}\n",
            s.action,
            s.channel.name(),
            s.from * k,
            s.to * k
        );
        match &s.values {
            Values::Force {
                position,
                mean_n,
                sigma_n,
            } => {
                out += &if sigma_n.len() == 1 {
                    format!("sigma_n = {:.2}\n", sigma_n[0])
                } else {
                    format!("sigma_n = {}\n", list(sigma_n, 1.0, 2))
                };
                out += &format!(
                    "position_{suffix} = {}\nmean_n = {}\n\n",
                    list(position, k, dec),
                    list(mean_n, 1.0, 2)
                );
            }
            Values::Moves { probability } => out += &format!("probability = {probability:.3}\n\n"),
        }
    }
    std::fs::create_dir_all("/tmp/exp/objects").unwrap();
    std::fs::write(format!("/tmp/exp/objects/{name}.toml"), out).unwrap();
}
