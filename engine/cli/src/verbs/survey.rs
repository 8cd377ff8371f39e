//! `pubs-engine survey`: tables of measured doors, fitted and judged.

use std::path::PathBuf;

use clap::Args;
use pubs_calibrate::pulls;
use pubs_calibrate::spread::{Judgement, Settings};
use pubs_calibrate::survey::{DoorReport, RADIUS_M, WINDOW_DEG, overall, survey};
use serde::Serialize;

use crate::failure::Failure;
use crate::options::parse_not_negative;
use crate::{Ended, exit, show};

#[derive(Args)]
#[command(after_help = "\
Example: pubs-engine survey door_forces.csv pr2_ikea_cabinet_log.csv
A table has the columns mechanism, agent, pull, angle_deg, tangential_force_n (and class where there is one); the log of one pull has \
angle_deg_fit, f_list_ati_tangential_N. Each pull is held out in turn and located by the others.")]
pub struct Arguments {
    /// Tables of pulls, CSV
    #[arg(value_name = "TABLE", required = true)]
    tables: Vec<PathBuf>,
    /// belief.tempering to judge beside independent readings [default: the engine's]
    #[arg(long, value_name = "EXPONENT", value_parser = parse_not_negative)]
    tempering: Option<f64>,
    /// belief.reading_spacing_m to judge beside independent readings [default: the engine's]
    #[arg(long, value_name = "M", value_parser = parse_not_negative)]
    reading_spacing_m: Option<f64>,
    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// Errors in degrees.
#[derive(Serialize)]
struct Report {
    window_deg: f64,
    radius_m: f64,
    doors: Vec<DoorReport>,
    overall: Vec<Judgement>,
}

pub fn run(arguments: &Arguments) -> Ended {
    let defaults = Settings::DEFAULT;
    let settings = [
        Settings::INDEPENDENT,
        Settings {
            tempering: arguments.tempering.unwrap_or(defaults.tempering),
            reading_spacing_m: arguments
                .reading_spacing_m
                .unwrap_or(defaults.reading_spacing_m),
        },
    ];
    let mut doors = Vec::new();
    for table in &arguments.tables {
        let found = pulls::read(table).map_err(|refused| Failure::each(refused.to_string()))?;
        doors.extend(found);
    }
    let reports = survey(&doors, &settings).map_err(|error| Failure::fault(&error))?;
    let report = Report {
        window_deg: WINDOW_DEG,
        radius_m: RADIUS_M,
        overall: overall(&reports, &settings),
        doors: reports,
    };
    if arguments.json {
        show::print_json(&report)?;
    } else {
        show::print(&text(&report, &settings))?;
    }
    Ok(exit::DONE)
}

fn text(report: &Report, settings: &[Settings; 2]) -> String {
    let mut text = format!(
        "Each pull held out, followed over {} degrees from an even prior; a spacing in m is taken at a radius of {} m.\n\
         independent readings | tempering {}, reading_spacing_m {}: median error in degrees, share of 90 % intervals that hold the truth\n",
        report.window_deg, report.radius_m, settings[1].tempering, settings[1].reading_spacing_m,
    );
    for door in &report.doors {
        let judged = door.judgements.as_ref().map_or_else(
            || "too few pulls to hold one out".to_owned(),
            |judgements| {
                let figures: Vec<String> = judgements.iter().map(figures).collect();
                figures.join(" | ")
            },
        );
        text += &format!(
            "{:<36} {:<16} {:>2} pulls, {} segments, peak {:>4.1} N, sigma {:.2} .. {:.2} N: {judged}\n",
            door.door,
            door.class.as_deref().unwrap_or("-"),
            door.pulls,
            door.segments,
            door.peak_n,
            door.sigma_n[0],
            door.sigma_n[1],
        );
    }
    let all: Vec<String> = report.overall.iter().map(figures).collect();
    let windows = report
        .overall
        .first()
        .map_or(0, |judgement| judgement.windows);
    if windows == 0 {
        text += "all doors: none has pulls enough to hold one out";
    } else {
        text += &format!("all doors ({windows} windows): {}", all.join(" | "));
    }
    text
}

fn figures(judgement: &Judgement) -> String {
    format!(
        "{:.2}° {:.0} %",
        judgement.median_error,
        100.0 * judgement.coverage
    )
}
