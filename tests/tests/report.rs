//! `pubs-engine report`: pages on runs, trainings, evaluations and calibrations, and what it makes
//! of everything else.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;
use std::process::Stdio;

use common::{Answer, all, command, door2, door2_policy, forgive, path_text, pubs, root, words};
use serde_json::Value;
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// `run` of door2 with the shipped policy, recorded.
fn run(folder: &Path, line: &str) -> Answer {
    let (object, policy) = (door2(), door2_policy());
    let mut arguments = vec!["run", &object, "--policy", &policy, "--json", "--lockstep"];
    arguments.extend(words(line));
    pubs(folder, &arguments)
}

/// `report` with `--json`; its answer and the page.
fn report(folder: &Path, code: i32, line: &str) -> (Value, String) {
    let mut arguments = vec!["report", "--json"];
    arguments.extend(words(line));
    let answer = pubs(folder, &arguments).assert_code(code).json();
    let page = fs::read_to_string(folder.join(answer["report"].as_str().unwrap())).unwrap();
    assert_alone(line, &page);
    (answer, page)
}

/// A page needs nothing beside it, has its parts in order, and is whole HTML.
fn assert_alone(name: &str, page: &str) {
    let bare = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    let tags = bare
        .split('<')
        .skip(1)
        .map(|rest| rest.split('>').next().unwrap());
    for tag in tags {
        for attribute in [" src=", " href=", " onload=", " onclick="] {
            assert!(!tag.contains(attribute), "{name}: <{tag}>");
        }
        let element = tag.split([' ', '\n']).next().unwrap();
        for fetched in ["script", "link", "iframe", "img", "image", "object", "use"] {
            assert_ne!(element, fetched, "{name}: <{tag}>");
        }
    }
    for fetched in ["url(", "@import"] {
        assert!(!bare.contains(fetched), "{name}: {fetched}");
    }
    assert!(page.contains("prefers-color-scheme: dark"), "{name}");
    for tag in [
        "svg", "figure", "table", "tr", "td", "h2", "details", "pre", "p",
    ] {
        let opened = all(page.as_bytes(), &format!("<{tag}>")).len()
            + all(page.as_bytes(), &format!("<{tag} ")).len();
        let closed = all(page.as_bytes(), &format!("</{tag}>")).len();
        assert_eq!(opened, closed, "{name}: <{tag}>");
    }
    let parts = ["<h2>Figures", "<svg", "<h2>Numbers", "<h2>Provenance"];
    let places: Vec<_> = parts
        .iter()
        .map(|part| {
            page.find(part)
                .unwrap_or_else(|| panic!("{name}: no {part}"))
        })
        .collect();
    assert!(places.is_sorted(), "{name}: {places:?}");
}

/// The fields of the first row that begins with this one.
fn row(page: &str, first: &str) -> Vec<String> {
    let bare = |text: &str| text.replace("<b>", "").replace("</b>", "");
    let fields = |line: &str| -> Vec<String> {
        let fields = line.split("<td>").skip(1);
        fields
            .map(|field| bare(field.split("</td>").next().unwrap()))
            .collect()
    };
    let rows = page.lines().map(fields);
    let found = rows
        .into_iter()
        .find(|row| row.first().is_some_and(|found| found == first));
    found.unwrap_or_else(|| panic!("no row {first:?}"))
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

fn degrees(value: &Value) -> String {
    minus(format!("{:.2} deg", number(value).to_degrees()))
}

fn minus(text: String) -> String {
    text.replace('-', "\u{2212}")
}

/// The folded text under a summary.
fn details(page: &str, summary: &str) -> String {
    let mark = format!("<summary>{summary}</summary>\n<pre>");
    let (_, rest) = page
        .split_once(&mark)
        .unwrap_or_else(|| panic!("no {summary}"));
    let text = rest.split_once("</pre>").unwrap().0;
    let plain = text
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&quot;", "\"");
    plain.replace("&amp;", "&")
}

#[test]
fn the_page_of_a_run_has_the_numbers_of_the_run() {
    let folder = folder();
    let line = "--goal 0.5 --goal 0.3 --seed 1 --set control.acceleration_m_s2=0.8 --record a.mcap";
    let ran = run(folder.path(), line).assert_code(0).json();
    let (answer, page) = report(folder.path(), 0, "a.mcap");
    assert_eq!(answer["report"], "a.report.html");
    assert_eq!(
        (&answer["kind"], &answer["missing"]),
        (&"run".into(), &Value::Array(vec![]))
    );
    for figure in [
        "Joint state",
        "Entropy of the belief",
        "Force along the motion",
        "Forces across the motion",
        "Actions in force",
        "Commanded speed",
        "true state",
        "±2 sigma of it",
    ] {
        assert!(page.contains(figure), "{figure}");
    }
    // A virtual clock is never late.
    assert!(!page.contains("late by, ms"));

    let mut told: Value = serde_json::from_str(&details(&page, "report.json")).unwrap();
    told["recording"] = ran["recording"].clone();
    assert_eq!(told, ran);
    let pairs = [
        ("outcome", "reached".to_owned()),
        ("time", format!("{:.3} s", number(&ran["time_s"]))),
        ("policy steps", ran["policy_steps"].to_string()),
        ("last goal", degrees(&ran["goal"])),
        ("believed at the end", degrees(&ran["belief"]["mean"])),
        (
            "entropy at the end",
            format!("{:.3}", number(&ran["belief"]["entropy"])),
        ),
        ("true at the end", degrees(&ran["true_state"])),
        ("off the goal by", degrees(&ran["goal_error"])),
        ("safety violations", ran["safety_violations"].to_string()),
        ("stops by the guard", ran["guard_stops"].to_string()),
        ("seed", "1".to_owned()),
        (
            "overrides",
            "--set control.acceleration_m_s2=0.8".to_owned(),
        ),
    ];
    for (name, expected) in pairs {
        assert_eq!(row(&page, name)[1], expected, "{name}");
    }
    let goals = page.split_once("<h3>Goals").unwrap().1;
    for (index, goal) in ran["goals"].as_array().unwrap().iter().enumerate() {
        let expected = [
            (index + 1).to_string(),
            degrees(&goal["goal"]),
            "reached".to_owned(),
            "the true state".to_owned(),
            format!("{:.2}", number(&goal["time_s"])),
            goal["policy_steps"].to_string(),
            degrees(&goal["belief"]["mean"]),
            format!("{:.3}", number(&goal["belief"]["entropy"])),
            degrees(&goal["true_state"]),
            degrees(&goal["goal_error"]),
        ];
        assert_eq!(row(goals, &expected[0]), expected);
    }
    let chosen = page.split_once("<h3>Actions chosen").unwrap().1;
    let high_open = ran["goals"][0]["actions"]["high_open"].to_string();
    assert_eq!(row(chosen, "1")[4], high_open);
    assert_eq!(
        details(&page, "The object file as it was"),
        fs::read_to_string(door2()).unwrap()
    );
}

#[test]
fn a_stop_by_the_guard_is_marked_and_explained_and_stays_text() {
    let folder = folder();
    let line = "--goal 0.9 --seed 1 --set driver.params.start=0.1 \
                --set driver.params.trouble.jams_at_s=0.5 --record jam.mcap";
    let ran = run(folder.path(), line).assert_code(4).json();
    let (_, page) = report(folder.path(), 0, "jam.mcap");
    let reason = ran["reason"].as_str().unwrap();
    let stops = page.split_once("why the guard stopped the arm").unwrap().1;
    let found = row(stops, "1");
    assert_eq!(found[2], reason);
    let noticed_s: f64 = found[1].parse().unwrap();
    assert!(
        (0.5..number(&ran["time_s"])).contains(&noticed_s),
        "{found:?}"
    );
    assert_eq!(row(&page, "outcome")[1], "stopped for safety");
    assert!(page.contains("stop by the guard"));

    // Words of a foreign driver may hold anything.
    let file = folder.path().join("jam.mcap");
    let mut bytes = fs::read(&file).unwrap();
    let at = all(&bytes, reason)[0];
    forgive(&mut bytes, at);
    bytes[at..at + 8].copy_from_slice(b"<script>");
    fs::write(&file, bytes).unwrap();
    let (_, page) = report(folder.path(), 0, "jam.mcap --overwrite");
    let stops = page.split_once("why the guard stopped the arm").unwrap().1;
    assert_eq!(
        row(stops, "1")[2],
        format!("&lt;script&gt;{}", &reason[8..])
    );
}

#[test]
fn what_is_left_of_a_recording_is_reported_on() {
    let folder = folder();
    run(folder.path(), "--goal 0.5 --seed 1 --record whole.mcap").assert_code(0);
    let bytes = fs::read(folder.path().join("whole.mcap")).unwrap();
    fs::write(
        folder.path().join("cut.mcap"),
        &bytes[..bytes.len() * 2 / 3],
    )
    .unwrap();
    let (answer, page) = report(folder.path(), 3, "cut.mcap");
    let missing = answer["missing"].as_array().unwrap();
    assert_eq!(missing.len(), 2, "{answer}");
    for missing in missing {
        let notice = format!("<p class=\"notice\">{}</p>", missing.as_str().unwrap());
        assert!(page.contains(&notice), "{notice}");
    }
    assert_eq!(row(&page, "outcome")[1], "not recorded");
    assert_eq!(row(&page, "goals asked for")[1], "62.50 deg");
    let ticks: usize = row(&page, "ticks of the controller")[1].parse().unwrap();
    assert!(ticks > 50, "{ticks} ticks");
}

#[test]
fn a_page_is_not_overwritten_unasked() {
    let folder = folder();
    run(folder.path(), "--goal 0.5 --seed 1 --record a.mcap").assert_code(0);
    let there = folder.path().join("a.report.html");
    fs::write(&there, "mine").unwrap();
    pubs(folder.path(), &["report", "a.mcap"])
        .assert_code(2)
        .assert_says(&["a.report.html exists", "--overwrite", "--out"]);
    assert_eq!(fs::read_to_string(&there).unwrap(), "mine");
    let answer = pubs(folder.path(), &["report", "a.mcap", "--out", "b.html"]);
    assert_eq!(answer.assert_code(0).stdout, "b.html\n");
    pubs(folder.path(), &["report", "a.mcap", "--overwrite"]).assert_code(0);
    let page = fs::read_to_string(&there).unwrap();
    assert_eq!(
        page,
        fs::read_to_string(folder.path().join("b.html")).unwrap()
    );
    let recording = fs::read(folder.path().join("a.mcap")).unwrap();
    let onto_itself = ["report", "a.mcap", "--out", "./a.mcap", "--overwrite"];
    pubs(folder.path(), &onto_itself)
        .assert_code(2)
        .assert_says(&["is the input itself"]);
    assert_eq!(recording, fs::read(folder.path().join("a.mcap")).unwrap());
}

#[test]
fn a_training_keeps_its_curves_and_they_are_drawn() {
    let folder = folder();
    let object = door2();
    let mut arguments = vec!["train", &object, "--json"];
    let line = "--goal 0.5 --steps 40000 --seeds 2 --trials 200 --output p.onnx";
    arguments.extend(words(line));
    let trained = pubs(folder.path(), &arguments).assert_code(0).json();
    let kept = fs::read(folder.path().join("p.training.json")).unwrap();
    let curves: Value = serde_json::from_slice(&kept).unwrap();
    assert_eq!(curves["best"], trained["best"]);
    let seeds = curves["seeds"].as_array().unwrap();
    assert_eq!(seeds.len(), 2);
    for (curve, told) in seeds.iter().zip(trained["seeds"].as_array().unwrap()) {
        assert_eq!(curve["seed"], told["seed"]);
        let found = &curve["selection"]["mean_discounted_reward"];
        assert_eq!(found, &told["evaluation"]["mean_discounted_reward"]);
        let steps: Vec<u64> = serde_json::from_value(curve["steps"].clone()).unwrap();
        assert!(steps.len() > 5 && steps.len() <= 201, "{steps:?}");
        assert!(steps.is_sorted_by(|one, next| one < next), "{steps:?}");
        assert_eq!(steps.last(), trained["steps"].as_u64().as_ref());
        let success: Vec<Option<f64>> =
            serde_json::from_value(curve["success_rate"].clone()).unwrap();
        let [first, last] = [success.first(), success.last()].map(|rate| rate.unwrap().unwrap());
        assert!(last > first, "it learned nothing: {success:?}");
    }

    let (answer, page) = report(folder.path(), 0, "p.onnx");
    assert_eq!(answer["kind"], "training");
    for part in [
        "mean return",
        "success, %",
        "violations, %",
        "Choices for the goal 62.5 deg",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let fresh = format!("{}, fresh trials", trained["best"]);
    let figures = &trained["evaluation"];
    let found = row(&page, &fresh);
    let expected = format!(
        "{:.3} ± {:.3}",
        number(&figures["mean_discounted_reward"]),
        number(&figures["mean_discounted_reward_se"])
    );
    assert_eq!(found[2], minus(expected));
    assert_eq!(
        found[4],
        format!("{:.2} %", 100.0 * number(&figures["success_rate"]))
    );

    // Curves of another policy, curves that are damaged, none at all.
    let told = [
        (Some(kept.as_slice()), 3, "belongs to another policy"),
        (Some(b"{}".as_slice()), 3, "holds no learning curves"),
        (None, 0, ""),
    ];
    for (curves, code, words) in told {
        fs::copy(door2_policy(), folder.path().join("q.onnx")).unwrap();
        let beside = folder.path().join("q.training.json");
        match curves {
            Some(curves) => fs::write(&beside, curves).unwrap(),
            None => fs::remove_file(&beside).unwrap(),
        }
        let (answer, page) = report(folder.path(), code, "q.onnx --overwrite");
        assert!(answer["missing"].to_string().contains(words), "{answer}");
        assert!(page.contains("No learning curve was kept"), "{words}");
        for goal in ["0.0 deg", "62.5 deg", "125.0 deg"] {
            assert!(
                page.contains(&format!("Choices for the goal {goal}")),
                "{goal}"
            );
        }
    }
}

#[test]
fn the_page_of_an_evaluation_has_its_numbers() {
    let folder = folder();
    let (policy, other) = (
        door2_policy(),
        path_text(&root().join("policies/paper/door2-0.5.onnx")),
    );
    let line = "--trials 400 --goal 0.5 --json";
    let mut arguments = vec!["evaluate", &policy, &other];
    arguments.extend(words(line));
    let answer = pubs(folder.path(), &arguments);
    let judged = answer.assert_code(0).json();
    fs::write(folder.path().join("two.json"), &answer.stdout).unwrap();
    let (answer, page) = report(folder.path(), 0, "two.json");
    assert_eq!(
        (&answer["kind"], &answer["report"]),
        (&"evaluation".into(), &"two.report.html".into())
    );
    let (rewards, ends) = {
        let numbers = page.split_once("<h2>Numbers").unwrap().1;
        numbers.split_once("<th>trials</th>").unwrap()
    };
    for (index, one) in judged["evaluations"].as_array().unwrap().iter().enumerate() {
        let first = (index + 1).to_string();
        let estimate = |name: &str| {
            let se = number(&one[format!("{name}_se")]);
            minus(format!("{:.4} ± {se:.4}", number(&one[name])))
        };
        let found = row(rewards, &first);
        assert_eq!(
            found[3..5],
            [estimate("mean_reward"), estimate("mean_discounted_reward")]
        );
        let found = row(ends, &first);
        assert_eq!(
            found[2],
            format!("{:.2} %", 100.0 * number(&one["success_rate"]))
        );
        let counts = ["safety_violations", "time_outs", "failed_stops"];
        assert_eq!(found[3..6], counts.map(|count| one[count].to_string()));
        let error_deg = number(&one["mean_goal_error"]).to_degrees();
        assert_eq!(found[6], format!("{error_deg:.3} deg"));
        // Every trial that stopped is in one bin.
        let errors: Vec<u64> =
            serde_json::from_value(one["goal_errors"]["counts"].clone()).unwrap();
        let stopped = 400.0 * number(&one["success_rate"]) + number(&one["failed_stops"]);
        assert_eq!(errors.iter().sum::<u64>() as f64, stopped.round());
    }
    assert!(page.contains("Goal error of 2 door2-0.5"));

    // The same through a pipe.
    let mut piped = command(folder.path(), &["report", "-", "--out", "piped.html"]);
    piped.stdin(Stdio::from(
        fs::File::open(folder.path().join("two.json")).unwrap(),
    ));
    Answer::of(&mut piped).assert_code(0);
    let piped = fs::read_to_string(folder.path().join("piped.html")).unwrap();
    assert_eq!(piped.replace("standard input", "two.json"), page);
}

#[test]
fn an_evaluation_of_alpha_vectors_has_a_page_without_what_it_does_not_know() {
    let folder = folder();
    let problem = path_text(&root().join("engine/solve/problems/tiger.pomdp"));
    pubs(
        folder.path(),
        &["solve", &problem, "--output", "tiger.policy.json"],
    )
    .assert_code(0);
    let line = [
        "evaluate",
        "tiger.policy.json",
        "--object",
        &problem,
        "--trials",
        "50",
        "--json",
    ];
    let answer = pubs(folder.path(), &line);
    answer.assert_code(0);
    fs::write(folder.path().join("tiger.json"), &answer.stdout).unwrap();
    let (_, page) = report(folder.path(), 0, "tiger.json");
    assert!(page.contains("mean reward of a trial") && !page.contains("How trials ended"));
}

#[test]
fn names_in_an_evaluation_stay_text() {
    let folder = folder();
    let wild = "<script>alert(\"1\")</script>";
    let text = serde_json::json!({
        "policy": format!("<img src=x onerror=alert(1)>/{wild}.onnx"), "object": wild, "goal": wild,
        "runtime": wild, "vector_unit": wild, "shield": true, "seed": 1, "trials": 10,
        "mean_reward": 0.5, "mean_reward_se": 0.1, "mean_discounted_reward": 0.4,
        "mean_discounted_reward_se": 0.1, "success_rate": 0.9, "safety_violations": 0,
        "time_outs": 1, "failed_stops": 0,
    });
    fs::write(folder.path().join("wild.json"), text.to_string()).unwrap();
    let (_, page) = report(folder.path(), 0, "wild.json");
    assert!(page.contains("&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;"));
}

#[test]
fn a_calibration_is_reported_from_its_recording_and_from_its_object() {
    let folder = folder();
    let objects = folder.path().join("objects");
    fs::create_dir(&objects).unwrap();
    let object = objects.join("door2.toml");
    let text = fs::read_to_string(door2()).unwrap();
    fs::write(&object, format!("# <script>alert(1)</script>\n{text}")).unwrap();
    let line = [
        "calibrate",
        "objects/door2.toml",
        "--lockstep",
        "--seed",
        "1",
        "--json",
    ];
    let fitted = pubs(folder.path(), &line).assert_code(0).json();

    let recording = "recordings/door2-calibration.mcap";
    let (answer, page) = report(folder.path(), 0, recording);
    assert_eq!(answer["kind"], "calibration");
    for part in [
        "segment starts",
        "Where readings were taken",
        "&lt;script&gt;alert(1)",
    ] {
        assert!(page.contains(part), "{part}");
    }
    let channels = page.split_once("<h3>Channels").unwrap().1;
    let rows: Vec<&str> = channels
        .lines()
        .filter(|line| line.contains("<td>"))
        .collect();
    for (told, line) in fitted["channels"].as_array().unwrap().iter().zip(rows) {
        let name = told["action"].as_str().unwrap();
        let found = row(line, name);
        assert_eq!(found[1], told["channel"].as_str().unwrap());
        assert_eq!(found[2], told["segments"].to_string(), "{found:?}");
        // Values are rounded in the object file and in the table.
        let [low, high] = [0, 1].map(|end| number(&told["mean"][end]));
        let (from, to) = found[3].split_once(" .. ").unwrap();
        for (found, told) in [(from, low), (to, high)] {
            let off = (found.parse::<f64>().unwrap() - told).abs();
            assert!(off < 0.0151, "{name}: {found} for {told}");
        }
        assert_eq!(found[11], "yes", "{found:?}");
    }
    let coverage = row(page.split_once("<h3>Coverage").unwrap().1, "stored");
    let share = 100.0 * number(&fitted["spread"]["coverage"]);
    assert_eq!(coverage[4], format!("{share:.1} %"));
    assert_eq!(coverage[5], fitted["spread"]["windows"].to_string());

    let (answer, page) = report(folder.path(), 0, "objects/door2.toml");
    assert_eq!(answer["kind"], "calibration");
    assert!(page.contains("which holds for these recordings in all 16 channels judged"));

    // Without the object's file, that in the recording; with another one, a refusal.
    fs::copy(
        folder.path().join(recording),
        folder.path().join("alone.mcap"),
    )
    .unwrap();
    fs::remove_dir_all(&objects).unwrap();
    let (_, page) = report(folder.path(), 0, "alone.mcap");
    assert!(page.contains("alone.mcap: object.toml, as it was before"));
    let drawer = path_text(&root().join("objects/drawer1.toml"));
    pubs(
        folder.path(),
        &["report", "alone.mcap", "--object", &drawer, "--overwrite"],
    )
    .assert_code(2)
    .assert_says(&["`door2`", "`drawer1`", "--object"]);
}

#[test]
fn what_is_not_understood_is_refused_in_words() {
    let folder = folder();
    let put = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let policy = fs::read(door2_policy()).unwrap();
    put("note.txt", b"hello");
    put("empty.json", b"");
    put("other.json", b"{\"a\": 1}");
    put("cut.json", b"{\"policy\":");
    put("none.json", b"{\"evaluations\": []}");
    put("some.bin", &[0, 159, 146, 150, 1, 2, 3]);
    put("cut.onnx", &policy[..policy.len() / 2]);
    put("head.mcap", b"\x89MCAP0\r\n");
    put("faulty.toml", b"schema = 1\nname = \"x\"\n");
    put(
        "plain.toml",
        fs::read(root().join("objects/light_dark.toml"))
            .unwrap()
            .as_slice(),
    );
    let cases = [
        ("gone.mcap", 2, "cannot read gone.mcap"),
        (".", 2, "cannot read"),
        ("note.txt", 2, "a report needs a recording"),
        ("empty.json", 2, "is empty"),
        ("other.json", 2, "not what `evaluate --json` prints"),
        ("cut.json", 2, "no JSON"),
        ("none.json", 2, "no policy"),
        ("some.bin", 2, "a report needs a recording"),
        ("cut.onnx", 5, "damaged"),
        ("head.mcap", 2, "nothing can be read"),
        ("faulty.toml", 2, "is missing"),
        ("plain.toml", 2, "no calibration segments"),
    ];
    for (input, code, words) in cases {
        let answer = pubs(folder.path(), &["report", input, "--out", "page.html"]);
        answer.assert_code(code).assert_says(&[words]);
        assert!(!folder.path().join("page.html").exists(), "{input}");
    }
    // Told by what is in them, not by their names.
    put("policy", &policy);
    let (answer, _) = report(folder.path(), 0, "policy --out policy.html");
    assert_eq!(answer["kind"], "training");
}
