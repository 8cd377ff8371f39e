//! Where the numbers of a run come from.

use pubs_draw::document::{Block, Details, Table};

use super::RunInput;
use crate::report::text::yes_or_no;
use crate::reproduce::numbers::NOTHING;

pub(super) fn provenance(input: &RunInput<'_>) -> Vec<Block> {
    let mut blocks = vec![Block::Table(setup(input)), Block::Table(policies(input))];
    let recording = input.recording;
    let as_json = |value: Result<String, serde_json::Error>| value.ok();
    let report = recording.report.as_ref();
    let texts = [
        ("The object file as it was", recording.object_toml.clone()),
        (
            "The object file with defaults and overrides in it",
            Some(recording.resolved_toml.clone()),
        ),
        (
            "The driver's table",
            as_json(serde_json::to_string_pretty(
                &recording.run.driver_parameters,
            )),
        ),
        (
            "report.json",
            report.and_then(|report| as_json(serde_json::to_string_pretty(report))),
        ),
    ];
    blocks.extend(texts.into_iter().filter_map(|(summary, text)| {
        Some(Block::Details(Details {
            summary: summary.to_owned(),
            text: text?,
        }))
    }));
    blocks
}

fn setup(input: &RunInput<'_>) -> Table {
    let (header, run) = (&input.recording.header, &input.recording.run);
    let nothing = || NOTHING.to_owned();
    let overrides = match run.overrides.as_slice() {
        [] => "none".to_owned(),
        overrides => overrides.join(", "),
    };
    let shield = run.shield.map_or_else(
        || "off".to_owned(),
        |(mass, flattening)| format!("mass {mass}, flattening {flattening}"),
    );
    Table::pairs([
        ("recording", input.file.display().to_string()),
        ("format", header.format.to_string()),
        ("engine", header.engine.clone()),
        ("started", run.started.clone().unwrap_or_else(nothing)),
        ("on a virtual clock", yes_or_no(run.lockstep)),
        ("seed", header.seed.to_string()),
        ("driver", run.driver.clone()),
        ("force sensor", header.sensor.clone()),
        ("observation model", run.model.clone()),
        ("policies run by", run.runtime.clone()),
        ("vector unit", run.vector_unit.clone()),
        ("overrides", overrides),
        ("shield", shield),
        ("policy steps allowed per goal", run.max_steps.to_string()),
        (
            "filter updates per policy step",
            run.belief_frequency
                .map_or_else(|| "the object's own".to_owned(), |times| times.to_string()),
        ),
    ])
}

fn policies(input: &RunInput<'_>) -> Table {
    let mut table = Table::new(&["policy", "sha256 of its weights"]);
    for policy in &input.recording.run.policies {
        table.push([policy.name.clone(), policy.sha256.clone()]);
    }
    table
}
