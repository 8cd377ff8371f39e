//! Paths, and later faults at a key.

use std::fs;
use std::path::Path;

use super::{DOOR, load as load_text};
use crate::object::{Overrides, files, key_of_pointer, load};

fn objects() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../objects")
}

#[test]
fn what_cannot_be_read_is_a_fault() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("latin1.toml"), b"schema = 1\nname = \"T\xfcr\"\n").unwrap();
    fs::write(path("empty.toml"), "").unwrap();
    fs::write(path("blank.toml"), " \n\t\n").unwrap();
    fs::create_dir(path("folder.toml")).unwrap();
    let cases = [
        ("latin1.toml", "not UTF-8 text (line 2)"),
        ("empty.toml", "the file is empty"),
        ("blank.toml", "the file is empty"),
        ("folder.toml", "a folder"),
        ("none.toml", "cannot be read"),
    ];
    for (name, words) in cases {
        let faults = load(&path(name), &Overrides::none()).unwrap_err();
        assert_eq!(faults.0.len(), 1, "{name}: {faults}");
        assert!(faults.0[0].message.contains(words), "{name}: {faults}");
        assert!(faults.0[0].file.ends_with(name), "{faults}");
        assert!(
            crate::object::render(&faults, true).contains(words),
            "{name}"
        );
    }
}

#[test]
fn a_folder_gives_its_object_files_sorted() {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        files(folder.path()).is_err(),
        "an empty folder has no object"
    );
    for name in ["b.toml", "a.toml", "notes.md", "object.schema.json"] {
        fs::write(folder.path().join(name), "").unwrap();
    }
    let names: Vec<_> = files(folder.path())
        .unwrap()
        .into_iter()
        .map(|path| path.file_name().unwrap().to_owned())
        .collect();
    assert_eq!(names, ["a.toml", "b.toml"]);
    let single = folder.path().join("a.toml");
    assert_eq!(files(&single).unwrap(), [single]);
}

#[test]
fn every_shipped_object_loads() {
    for path in files(&objects()).unwrap() {
        let object = match load(&path, &Overrides::none()) {
            Ok(object) => object,
            Err(faults) => panic!("{}", crate::object::render(&faults, false)),
        };
        let stem = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(object.file.name, stem, "an object is named as its file");
    }
}

#[test]
fn what_a_plugin_finds_later_is_shown_at_its_line() {
    let segments = "[[observation.segment]]\naction = \"safe_open\"\nto_deg = 4.5\n";
    let text = format!("{DOOR}{segments}{segments}");
    let object = load_text(&text).unwrap();
    let last_line = text.lines().count();
    let cases = [
        (
            key_of_pointer("observation", "/segment/1/to_deg"),
            last_line,
            10,
        ),
        (
            key_of_pointer("observation", "/segment/1/sigma_n"),
            last_line - 2,
            1,
        ),
        (
            key_of_pointer("observation", "/segment/0"),
            last_line - 5,
            1,
        ),
        ("joint.limits_deg".to_owned(), 7, 14),
        ("driver.params.world".to_owned(), 1, 1),
    ];
    for (key, line, column) in cases {
        let fault = object.fault(&key, "found wanting", "mend it");
        assert_eq!(
            (fault.line, fault.column),
            (Some(line), Some(column)),
            "{key}"
        );
        assert_eq!(fault.key, key);
    }
    let segment = object.file.observation.segment.as_ref().unwrap();
    assert_eq!(segment[1]["to_deg"], 4.5);
    assert!(object.location("observation.segment.1.sigma_n").is_none());
    assert_eq!(object.text(), text);
}

#[test]
fn windows_line_ends_and_a_byte_order_mark_do_no_harm() {
    let text = format!(
        "\u{feff}{}",
        DOOR.replace("0.3", "-1").replace('\n', "\r\n")
    );
    let fault = super::faults_of(&text).remove(0);
    assert_eq!(
        (fault.line, fault.column, fault.key.as_str()),
        (Some(8), Some(12), "joint.radius_m")
    );
}

#[test]
fn a_resolved_text_gives_the_same_object_without_its_overrides() {
    let overrides = Overrides::new(
        [("PUBS_SET__REWARD__DISCOUNT".to_owned(), "0.5".to_owned())],
        ["belief.particles=123".to_owned()],
    );
    assert_eq!(
        overrides.typed(),
        [
            "PUBS_SET__REWARD__DISCOUNT=0.5",
            "--set belief.particles=123"
        ]
    );
    for file in files(&objects()).unwrap() {
        let loaded = load(&file, &overrides).unwrap();
        let text = loaded.resolved_text().unwrap();
        let again = crate::object::load_text("resolved", text, &Overrides::none()).unwrap();
        assert_eq!(
            format!("{:?}", again.file),
            format!("{:?}", loaded.file),
            "{}",
            file.display()
        );
        assert!(
            format!("{:?}", again.file).contains("123"),
            "the override is in it"
        );
    }
}

#[test]
fn a_resolved_text_leaves_out_what_an_overridden_filter_does_not_use() {
    let plain = Overrides::new([], ["belief.filter=sis".to_owned()]);
    for file in files(&objects()).unwrap() {
        let loaded = load(&file, &plain).unwrap();
        let text = loaded.resolved_text().unwrap();
        let again = crate::object::load_text("resolved", text, &Overrides::none()).unwrap();
        let task = |file| format!("{:?}", crate::task::compile(file).unwrap());
        assert_eq!(task(&again.file), task(&loaded.file), "{}", file.display());
    }
}
