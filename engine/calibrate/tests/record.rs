//! Recording demonstrations of the virtual arm.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod common;

#[test]
fn probe() {
    let task = common::task("door2", &[]);
    let began = std::time::Instant::now();
    let (recording, report) = common::recorded(&task, 5, 1);
    println!("{:?} {report:?} frames {}", began.elapsed(), recording.frames.len());
    let mut last = (99, 99);
    for frame in &recording.frames {
        let key = (frame.action, frame.demonstration as usize);
        if key != last {
            println!("{:8.2} s {} {} truth {:.2}", frame.reading.time_ns as f64 * 1e-9, recording.header.actions[frame.action], frame.demonstration, frame.truth.unwrap().to_degrees());
            last = key;
        }
    }
}
