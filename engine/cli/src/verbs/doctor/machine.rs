//! What the program finds on this machine.

use pubs_core::vector::VectorUnit;
use pubs_host::{Listed, Registry};
use pubs_plugin::{CheckState, DriverCheck};

use super::check;
use crate::options::RuntimeOptions;

/// Program, vector unit, runtime of policies, scheduling.
pub fn checks(runtime: &RuntimeOptions) -> Vec<DriverCheck> {
    vec![
        check(
            "program",
            CheckState::Ok,
            format!("pubs-engine {}", env!("CARGO_PKG_VERSION")),
            "",
        ),
        check(
            "vector unit",
            CheckState::Ok,
            VectorUnit::best().to_string(),
            "",
        ),
        policies(runtime),
        scheduling(),
    ]
}

fn policies(options: &RuntimeOptions) -> DriverCheck {
    match options.runtime() {
        Ok(runtime) => check(
            "policy runtime",
            CheckState::Ok,
            runtime.version().to_owned(),
            "",
        ),
        Err(failure) => check(
            "policy runtime",
            CheckState::Fault,
            failure.in_a_line(),
            "name an ONNX Runtime library that fits with --onnxruntime, or unset ORT_DYLIB_PATH for the built-in one",
        ),
    }
}

/// Asked for in a thread of its own, which it ends with.
fn scheduling() -> DriverCheck {
    let granted = std::thread::spawn(pubs_run::clock::make_timely)
        .join()
        .unwrap_or(false);
    if granted {
        return check(
            "real time",
            CheckState::Ok,
            "the control loop gets real-time scheduling".to_owned(),
            "",
        );
    }
    check(
        "real time",
        CheckState::Warn,
        "the kernel grants no real-time scheduling; the loops come later under load".to_owned(),
        "sudo setcap cap_sys_nice+ep \"$(command -v pubs-engine)\", or raise rtprio in /etc/security/limits.conf and log in again",
    )
}

/// What lies on the search path.
pub fn plugins(registry: &Registry) -> Vec<DriverCheck> {
    let listed = registry.list();
    let found = listed.iter().map(|listed| match listed {
        Listed::Plugin(plugin) => check(
            plugin.name(),
            CheckState::Ok,
            format!(
                "{} {}, {}",
                plugin.kind(),
                plugin.version(),
                plugin.origin()
            ),
            "",
        ),
        Listed::Refused { place, reason } => check(
            "refused",
            CheckState::Warn,
            format!("{place}: {reason}"),
            "build it anew against this program's plugins/abi, or take it off the search path",
        ),
        Listed::NotAPlugin(path) => check(
            "no plugin",
            CheckState::Skipped,
            path.display().to_string(),
            "",
        ),
    });
    found.collect()
}
