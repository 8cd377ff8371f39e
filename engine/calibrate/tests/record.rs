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
