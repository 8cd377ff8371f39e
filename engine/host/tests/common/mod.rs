//! Plugins for the tests: the C one compiled here, the Rust ones built as this crate's examples.
#![allow(dead_code, clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

use pubs_host::conformance::setup;
use pubs_host::{HostError, ModelInstance, ModelPlugin, Plugin, library};
use pubs_plugin::{DriverSetup, ModelSetup};
use serde_json::{Value, json};

/// Compiles `spring.c` with the given macros into `directory`.
pub fn compile_spring(directory: &Path, file: &str, macros: &[&str]) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let library = directory.join(file);
    let output = Command::new("cc")
        .args([
            "-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC",
        ])
        // A broken one leaves something unused.
        .arg(if macros.is_empty() {
            "-Wunused"
        } else {
            "-Wno-unused"
        })
        .args(macros.iter().map(|name| format!("-D{name}")))
        .arg("-I")
        .arg(root.join("../../plugins/abi/include"))
        .arg("-o")
        .arg(&library)
        .arg(root.join("tests/fixtures/spring.c"))
        .output()
        .expect("these tests need the system's C compiler `cc`");
    assert!(
        output.status.success(),
        "cc {macros:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    library
}

/// A plugin written in Rust, which `cargo test` builds as an example of this crate.
pub fn rust_library(example: &str) -> PathBuf {
    // target/PROFILE/deps/TEST -> target/PROFILE/examples/libEXAMPLE.so
    let test = std::env::current_exe().unwrap();
    let profile = test.parent().and_then(Path::parent).unwrap();
    let (prefix, suffix) = (std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let library = profile
        .join("examples")
        .join(format!("{prefix}{example}{suffix}"));
    assert!(
        library.is_file(),
        "{} is missing; `cargo build --release -p pubs-host --examples` builds it",
        library.display()
    );
    library
}

pub fn load(path: &Path) -> Arc<Plugin> {
    Arc::new(library::load(path).unwrap_or_else(|error| panic!("{error}")))
}

pub fn model_setup(model: &str, params: Value) -> ModelSetup {
    let mut setup = setup::door(model);
    setup.observation["params"] = params;
    setup
}

pub fn driver_setup(driver: &str, params: Value) -> DriverSetup {
    let mut setup = setup::door_driver(driver);
    setup.driver = json!({ "plugin": driver, "params": params });
    setup
}

pub fn create(library: &Path, params: Value) -> Result<ModelInstance, HostError> {
    let plugin = load(library);
    let setup = model_setup(plugin.name(), params);
    ModelPlugin::new(plugin)?.create(&setup)
}
