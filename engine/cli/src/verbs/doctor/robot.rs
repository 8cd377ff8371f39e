//! What an object file's driver says of its robot.

use std::path::Path;

use pubs_core::Task;
use pubs_core::object::Overrides;
use pubs_core::seed::stream;
use pubs_host::Registry;
use pubs_plugin::{CheckState, DriverCheck};

use super::check;
use crate::object;

/// The object file, and where it can be used the robot behind its driver.
pub fn checks(
    path: &Path,
    overrides: &Overrides,
    registry: &Registry,
) -> (Vec<DriverCheck>, Vec<DriverCheck>) {
    match object::ready(path, overrides, None, registry, 0) {
        Ok(ready) => {
            let found = format!("{}: object `{}`", path.display(), ready.task.name);
            let fine = check("file", CheckState::Ok, found, "");
            (vec![fine], of_driver(&ready.task, registry))
        }
        Err(failure) => {
            let cure = "`pubs-engine check` shows every fault at its line";
            let fault = check("file", CheckState::Fault, failure.in_a_line(), cure);
            let skipped = "the object file comes first".to_owned();
            let driver = check("driver", CheckState::Skipped, skipped, "");
            (vec![fault], vec![driver])
        }
    }
}

fn of_driver(task: &Task, registry: &Registry) -> Vec<DriverCheck> {
    let (Some(driver), Some(setup)) = (&task.driver, task.driver_setup(stream(0, "driver"))) else {
        return vec![check(
            "driver",
            CheckState::Fault,
            format!("object `{}` names none", task.name),
            "add a [driver] table, or name one with --driver",
        )];
    };
    let diagnosed = registry
        .driver(&driver.plugin)
        .and_then(|plugin| plugin.diagnose(&setup));
    match diagnosed {
        Ok(Some(checks)) => checks,
        Ok(None) => vec![check(
            &driver.plugin,
            CheckState::Ok,
            "looks at nothing before it is opened".to_owned(),
            "",
        )],
        Err(error) => vec![check(
            &driver.plugin,
            CheckState::Fault,
            error.to_string(),
            "see `pubs-engine plugins list --schema` for its parameters",
        )],
    }
}
