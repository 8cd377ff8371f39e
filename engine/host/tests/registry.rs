//! Plugins by name: built in, on the search path, twice, unknown.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::path::Path;

use common::{compile_spring, model_setup, rust_library};
use pubs_host::{HostError, Listed, Origin, Registry};
use pubs_plugin::table::PluginTable;
use pubs_plugin::{
    Channel, ChannelKind, ModelSetup, ObservationModel, PluginError, Support, Transitions,
};
use serde_json::json;

struct Still {
    channels: Vec<Channel>,
}

impl ObservationModel for Still {
    const NAME: &'static str = "still";
    const VERSION: &'static str = "0.0.1";
    const PARAMS_SCHEMA: &'static str = "{}";

    fn create(_: &ModelSetup) -> Result<Self, PluginError> {
        Ok(Self {
            channels: vec![Channel {
                name: "f_d".into(),
                kind: ChannelKind::Gaussian,
            }],
        })
    }
    fn channels(&self) -> &[Channel] {
        &self.channels
    }
    fn moments(
        &self,
        _: Transitions<'_>,
        mean: &mut [f32],
        sigma: &mut [f32],
    ) -> Result<Support, PluginError> {
        mean.fill(0.0);
        sigma.fill(1.0);
        Ok(Support::Given)
    }
}

fn built_ins() -> [&'static PluginTable; 1] {
    [pubs_plugin::observation_model_table::<Still>()]
}

fn registry(directories: &[&Path]) -> Registry {
    Registry::new(
        &built_ins(),
        directories
            .iter()
            .map(|directory| directory.to_path_buf())
            .collect(),
    )
}

#[test]
fn built_in_and_loaded_plugins_are_found_by_name() {
    let directory = tempfile::tempdir().unwrap();
    compile_spring(directory.path(), "a.so", &[]);
    std::fs::copy(rust_library("rust_driver"), directory.path().join("b.so")).unwrap();
    std::fs::write(directory.path().join("notes.txt"), "not even a library").unwrap();
    // The same directory twice is no conflict.
    let registry = registry(&[directory.path(), directory.path()]);
    let still = registry.observation_model("still").unwrap();
    assert_eq!(still.plugin().origin(), &Origin::BuiltIn);
    still
        .create(&model_setup("still", json!(null)))
        .unwrap_err();
    let spring = registry.observation_model("c-spring").unwrap();
    assert!(matches!(spring.plugin().origin(), Origin::File(path) if path.ends_with("a.so")));
    registry.driver("pen").unwrap();
    let wrong = registry.driver("still").unwrap_err().to_string();
    assert_eq!(
        wrong,
        "plugin `still` (built in) is an observation model, not a driver"
    );
    let names: Vec<&str> = registry
        .list()
        .iter()
        .map(|listed| match listed {
            Listed::Plugin(plugin) => plugin.name(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(names, ["still", "c-spring", "pen"]);
}

#[test]
fn one_name_in_two_places_is_an_error_that_names_both() {
    let directory = tempfile::tempdir().unwrap();
    compile_spring(directory.path(), "a.so", &["NAME=\"still\""]);
    compile_spring(directory.path(), "b.so", &[]);
    compile_spring(directory.path(), "c.so", &["NAME=\"c-\" \"spring\""]);
    let registry = registry(&[directory.path()]);
    let text = registry.observation_model("still").unwrap_err().to_string();
    assert!(
        text.contains("two plugins named `still`: built in and") && text.contains("a.so"),
        "{text}"
    );
    let error = registry.observation_model("c-spring").unwrap_err();
    assert!(matches!(error, HostError::Duplicate { .. }), "{error}");
}

#[test]
fn an_unknown_name_shows_what_there_is() {
    let directory = tempfile::tempdir().unwrap();
    compile_spring(directory.path(), "old.so", &["FAULT_ABI"]);
    std::fs::write(directory.path().join("text.so"), "hello").unwrap();
    let nowhere = directory.path().join("nowhere");
    let registry = registry(&[directory.path(), &nowhere]);
    let text = registry.observation_model("stil").unwrap_err().to_string();
    for words in [
        "no plugin `stil` is known as an observation model; did you mean `still`?",
        "known: still",
        &format!("searched: {}", directory.path().display()),
        "old.so: the ABI differs: engine",
        "text.so: it is not a shared library",
        "nowhere: this directory cannot be searched",
        "--plugin-dir",
    ] {
        assert!(text.contains(words), "{text}\nshould hold: {words}");
    }
    // Nobody asked for those files, so a plugin that is there still works.
    registry.observation_model("still").unwrap();
}

#[test]
fn a_foreign_library_is_listed_and_harmless() {
    let directory = tempfile::tempdir().unwrap();
    compile_spring(directory.path(), "foreign.so", &["FAULT_SYMBOL"]);
    let registry = registry(&[directory.path()]);
    let listed = registry.list();
    assert!(
        matches!(&listed[1], Listed::NotAPlugin(path) if path.ends_with("foreign.so")),
        "{listed:?}"
    );
    let text = registry.driver("x").unwrap_err().to_string();
    assert!(
        !text.contains("foreign.so") && text.contains("none is known"),
        "{text}"
    );
}
