#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;

use pubs_plugin::{DriverStatus, JointType, Reading};
use pubs_run::recording::{Done, FORMAT_VERSION, Frame, Header, Recording};

use super::read::time_ns;
use super::{read, write};
use crate::Place;

fn recording() -> Recording {
    let frame = |index: u32| Frame {
        reading: Reading {
            time_ns: 987_654_321_000_000_001 + u64::from(index) * 10_000_000,
            position_m: [0.1 + 0.2, -0.0, 1e-300],
            orientation_xyzw: [1.0 / 3.0, 0.0, f64::MIN_POSITIVE, 0.942_809_041_582_063_4],
            force_n: [f64::MAX, -5e-324, f64::from(index)],
            torque_nm: [1e21, 123_456_789.123_456_79, -1e-7],
            status: [
                DriverStatus::Ready,
                DriverStatus::Stopped,
                DriverStatus::Fault,
            ][index as usize % 3],
        },
        action: index as usize % 3,
        demonstration: index,
        speed_m_s: -0.05,
        settled: index.is_multiple_of(2),
        truth: index.is_multiple_of(3).then_some(0.1 * f64::from(index)),
    };
    Recording {
        header: Header {
            format: FORMAT_VERSION,
            engine: "0.1.0".to_owned(),
            object: "drawer, \"old\"".to_owned(),
            joint: JointType::Prismatic,
            sensor: "virtual-arm".to_owned(),
            actions: ["stop", "safe_open", "safe_close"]
                .map(str::to_owned)
                .to_vec(),
            rate_hz: 100.0,
            seed: u64::MAX,
        },
        frames: (0..30).map(frame).collect(),
        done: (1..3)
            .map(|demonstration| Done {
                action: "safe_open".to_owned(),
                demonstration,
            })
            .collect(),
        loss: Some("the file ends in the middle of a chunk, after 12.3 s".to_owned()),
    }
}

/// The written recording as text; `name` is its path.
fn written(recording: &Recording) -> (tempfile::TempDir, PathBuf, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("pull.csv");
    write(&file, recording).unwrap();
    let text = fs::read_to_string(&file).unwrap();
    (folder, file, text)
}

#[test]
fn every_bit_survives() {
    let plain = recording();
    let mut awkward = recording();
    awkward.header.actions[1] = "pull, gently".to_owned();
    awkward.done[0].action = "pull, gently".to_owned();
    awkward.done[1].action = "stop".to_owned();
    awkward.loss = None;
    let mut bare = recording();
    bare.done.clear();
    bare.frames.clear();
    for recording in [plain, awkward, bare] {
        let (_folder, file, _) = written(&recording);
        let (back, _) = read(&file).unwrap();
        assert_eq!(back, recording);
        // A negative zero equals a positive one, and must stay what it was.
        let signs = |recording: &Recording| -> Vec<bool> {
            let frames = recording.frames.iter();
            frames
                .map(|frame| frame.reading.position_m[1].is_sign_negative())
                .collect()
        };
        assert_eq!(signs(&back), signs(&recording));
    }
}

#[test]
fn a_person_can_read_it() {
    let (_folder, _, text) = written(&recording());
    let mut lines = text.lines();
    let expected = [
        "# format = 1",
        "# engine = 0.1.0",
        "# object = \"drawer, \\\"old\\\"\"",
        "# joint = prismatic",
        "# sensor = virtual-arm",
        "# actions = stop, safe_open, safe_close",
        "# rate_hz = 100.0",
        "# seed = 18446744073709551615",
        "# done = safe_open 1, safe_open 2",
        "# loss = \"the file ends in the middle of a chunk, after 12.3 s\"",
        "time_s,action,demonstration,x_m,y_m,z_m,qx,qy,qz,qw,force_x_n,force_y_n,force_z_n,torque_x_nm,torque_y_nm,torque_z_nm,speed_m_s,settled,status,true_state",
        "987654321.000000001,stop,0,0.30000000000000004,-0.0,1e-300,0.3333333333333333,0.0,2.2250738585072014e-308,0.9428090415820634,1.7976931348623157e308,-5e-324,0.0,1e21,123456789.12345679,-1e-7,-0.05,true,ready,0.0",
        "987654321.010000001,safe_open,1,0.30000000000000004,-0.0,1e-300,0.3333333333333333,0.0,2.2250738585072014e-308,0.9428090415820634,1.7976931348623157e308,-5e-324,1.0,1e21,123456789.12345679,-1e-7,-0.05,false,stopped,",
    ];
    for expected in expected {
        assert_eq!(lines.next(), Some(expected));
    }
}

#[test]
fn times_are_exact_to_the_nanosecond() {
    for (text, expected) in [
        ("0", Some(0)),
        ("1.5", Some(1_500_000_000)),
        ("12.340000001", Some(12_340_000_001)),
        ("987654321.000000001", Some(987_654_321_000_000_001)),
        ("1e-3", Some(1_000_000)),
        ("0.0000000014", Some(1)),
        ("-1", None),
        ("NaN", None),
        ("inf", None),
        ("", None),
        (".", None),
        ("99999999999999", None),
        ("12:34", None),
    ] {
        assert_eq!(time_ns(text), expected, "{text:?}");
    }
}

#[test]
fn columns_may_stand_in_any_order_beside_others() {
    let (_folder, file, text) = written(&recording());
    let turned: String = text
        .lines()
        .map(|line| match line.strip_prefix('#') {
            Some(_) => format!("{line}\r\n"),
            None => {
                let mut cells: Vec<&str> = line.split(',').rev().collect();
                cells.insert(3, "remark");
                format!("{}\r\n\r\n", cells.join(" , "))
            }
        })
        .collect();
    fs::write(&file, turned.replacen("remark", "notes", 1)).unwrap();
    let (back, source) = read(&file).unwrap();
    assert_eq!(back, recording());
    // Ten lines of header, the names, and a blank line after each row.
    let place = source.cell(&back.frames, 4, crate::column::Column::Force(0));
    let expected = Place::Cell {
        line: 21,
        column: "force_x_n".to_owned(),
    };
    assert_eq!(place, expected);
}

#[test]
fn the_truth_may_be_left_out_altogether() {
    let mut known = recording();
    for frame in &mut known.frames {
        frame.truth = None;
    }
    let (_folder, file, text) = written(&known);
    let without: String = text
        .lines()
        .map(|line| match line.strip_prefix('#') {
            Some(_) => format!("{line}\n"),
            None => format!("{}\n", line.rsplit_once(',').unwrap().0),
        })
        .collect();
    fs::write(&file, without).unwrap();
    assert_eq!(read(&file).unwrap().0, known);
}

#[test]
fn what_is_missing_or_wrong_is_named_with_its_cure() {
    let (_folder, file, text) = written(&recording());
    let cases: [(&str, &str, &[&str]); 12] = [
        (
            "# sensor = virtual-arm\n",
            "",
            &[
                "`# sensor`: this line is missing",
                "add a line such as `# sensor = virtual-arm` at the top",
            ],
        ),
        (
            "# rate_hz = 100.0",
            "# rate_hz = fast",
            &["line 7, `# rate_hz`: found `fast`; expected a positive number"],
        ),
        (
            "# format = 1",
            "# format = 2",
            &["line 1, `# format`: found `2`; expected the version 1"],
        ),
        (
            "# joint = prismatic",
            "# joint = slide",
            &["line 4, `# joint`: found `slide`; expected revolute, prismatic or abstract"],
        ),
        (
            "safe_open 2\n",
            "safe_open two\n",
            &[
                "line 9, `# done`: found `safe_open 1, safe_open two`",
                "write a line such as",
            ],
        ),
        (
            "safe_open 2\n",
            "pull 2\n",
            &["line 9, `# done`", "an action of `# actions`"],
        ),
        (
            "force_x_n",
            "force_x",
            &[
                "the column `force_x_n` is missing",
                "is `force_x` meant? Rename it to `force_x_n`",
            ],
        ),
        (
            "987654321.010000001,safe_open",
            "12:30,safe_open",
            &["pull.csv: line 13, column time_s: found `12:30`; expected seconds from 0 on"],
        ),
        (
            "987654321.010000001,safe_open",
            "1,pull",
            &[
                "line 13, column action: found `pull`; expected one of `# actions`: stop, safe_open, safe_close",
            ],
        ),
        (
            "-1e-7,-0.05,false,stopped",
            "NaN,,maybe,happy",
            &[
                "line 13, column torque_z_nm: found `NaN`; expected a finite number",
                "line 13, column speed_m_s: the cell is empty; expected a finite number",
                "line 13, column settled: found `maybe`; expected true or false",
                "line 13, column status: found `happy`; expected ready, stopped or fault",
            ],
        ),
        (
            "-0.05,true,ready,0.0\n",
            "-0.05,true,ready,inf\n",
            &["line 12, column true_state: found `inf`", "empty the cell"],
        ),
        (
            "987654321.010000001,safe_open,1",
            "1,safe_open,-1",
            &["line 13, column demonstration: found `-1`"],
        ),
    ];
    for (from, to, expected) in cases {
        assert!(text.contains(from), "{from}");
        fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let said = read(&file).unwrap_err().to_string();
        for expected in expected {
            assert!(said.contains(expected), "`{said}` should say `{expected}`");
        }
    }
}

#[test]
fn twenty_bad_cells_are_told_and_the_others_counted() {
    let (_folder, file, text) = written(&recording());
    fs::write(&file, text.replace(",1e21,", ",x,")).unwrap();
    let refused = read(&file).unwrap_err();
    assert_eq!((refused.faults.len(), refused.more), (20, 10));
    assert!(refused.to_string().ends_with("\nand 10 more"), "{refused}");
}

#[test]
fn files_that_are_none_are_refused_and_none_is_overwritten() {
    let (folder, file, text) = written(&recording());
    let said = write(&file, &recording()).unwrap_err().to_string();
    assert!(said.contains("pull.csv: this file exists"), "{said}");
    assert_eq!(fs::read_to_string(&file).unwrap(), text);
    let said = read(&folder.path().join("nowhere.csv"))
        .unwrap_err()
        .to_string();
    assert!(
        said.contains("nowhere.csv: cannot be read: No such file"),
        "{said}"
    );
    fs::write(&file, b"time_s\n1\n\xff\n").unwrap();
    let said = read(&file).unwrap_err().to_string();
    assert!(said.contains("line 3 is not text"), "{said}");
}
