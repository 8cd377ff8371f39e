//! `pubs_plugin.h` compiles as C and as C++ and lays every struct out as Rust does.
#![allow(clippy::unwrap_used, missing_docs)]

use std::fmt::Write;
use std::mem::offset_of;
use std::path::Path;
use std::process::Command;

use pubs_plugin::table::{
    ABI, CHANNEL_BERNOULLI, CHANNEL_GAUSSIAN, ChannelEntry, DriverTable, KIND_DRIVER,
    KIND_OBSERVATION_MODEL, ObservationModelTable, PluginTable, RawReading, STATUS_ABSENT,
    STATUS_ERROR, STATUS_OK, STATUS_PANIC, Text,
};
use pubs_plugin::{DriverStatus, Twist};

/// `[(C expression, value in Rust)]` for a struct and its fields, which have the same names.
macro_rules! layout {
    ($c:literal, $rust:ty, $($field:ident)*) => {
        vec![
            (concat!("sizeof(", $c, ")").to_owned(), size_of::<$rust>()),
            $((concat!("offsetof(", $c, ", ", stringify!($field), ")").to_owned(), offset_of!($rust, $field)),)*
        ]
    };
}

fn expected() -> Vec<(String, usize)> {
    let constants = [
        ("PUBS_PLUGIN_ABI", ABI as usize),
        (
            "PUBS_KIND_OBSERVATION_MODEL",
            KIND_OBSERVATION_MODEL as usize,
        ),
        ("PUBS_KIND_DRIVER", KIND_DRIVER as usize),
        ("PUBS_CHANNEL_GAUSSIAN", CHANNEL_GAUSSIAN as usize),
        ("PUBS_CHANNEL_BERNOULLI", CHANNEL_BERNOULLI as usize),
        ("PUBS_DRIVER_READY", DriverStatus::Ready as usize),
        ("PUBS_DRIVER_STOPPED", DriverStatus::Stopped as usize),
        ("PUBS_DRIVER_FAULT", DriverStatus::Fault as usize),
        ("PUBS_OK", STATUS_OK as usize),
        ("PUBS_ABSENT", STATUS_ABSENT as usize),
        ("PUBS_ERROR", STATUS_ERROR as usize),
        ("PUBS_PANIC", STATUS_PANIC as usize),
    ];
    [
        constants.map(|(name, value)| (name.to_owned(), value)).to_vec(),
        layout!("pubs_text", Text, data length),
        layout!("pubs_channel", ChannelEntry, name kind),
        layout!("pubs_twist", Twist, linear_m_s angular_rad_s),
        layout!("pubs_reading", RawReading, time_ns position_m orientation_xyzw force_n torque_nm status reserved),
        layout!("pubs_plugin_table", PluginTable, size abi kind reserved name version params_schema observation_model driver),
        layout!("pubs_observation_model_table", ObservationModelTable, size reserved create destroy channels moments moments_grid log_likelihood sample),
        layout!("pubs_driver_table", DriverTable, size reserved open close sensor read command tare stop advance_to truth diagnose),
    ]
    .concat()
}

fn program() -> String {
    let mut source =
        "#include <stdio.h>\n#include \"pubs_plugin.h\"\nint main(void) {\n".to_owned();
    for (expression, _) in expected() {
        writeln!(
            source,
            "    printf(\"{expression} %lu\\n\", (unsigned long)({expression}));"
        )
        .unwrap();
    }
    source + "    return 0;\n}\n"
}

/// Compiles the printing program and returns what it prints.
fn printed(compiler: &str, standard: &str, suffix: &str) -> String {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let binary = directory.join(format!("header-{}", standard.replace('+', "x")));
    let source = binary.with_extension(suffix);
    std::fs::write(&source, program()).unwrap();
    let include = concat!(env!("CARGO_MANIFEST_DIR"), "/include");
    let output = Command::new(compiler)
        .args([
            &format!("-std={standard}"),
            "-Wall",
            "-Wextra",
            "-pedantic",
            "-Werror",
            "-I",
            include,
            "-o",
        ])
        .args([&binary, &source])
        .output()
        .unwrap_or_else(|error| {
            panic!("this test needs the system's compiler `{compiler}`: {error}")
        });
    assert!(
        output.status.success(),
        "{compiler} {standard}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(Command::new(binary).output().unwrap().stdout).unwrap()
}

#[test]
fn header_and_rust_agree() {
    let expected: Vec<String> = expected()
        .iter()
        .map(|(name, value)| format!("{name} {value}"))
        .collect();
    for (compiler, standard, suffix) in [
        ("cc", "c99", "c"),
        ("cc", "c17", "c"),
        ("c++", "c++11", "cpp"),
        ("c++", "c++20", "cpp"),
    ] {
        let printed = printed(compiler, standard, suffix);
        let printed: Vec<&str> = printed.lines().collect();
        assert_eq!(
            printed, expected,
            "layout by {compiler} -std={standard} (left), by Rust (right)"
        );
    }
}
