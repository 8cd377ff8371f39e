//! A run in pictures, all on one scale of time.

use pubs_draw::chart::{Chart, Key, Mark, band, ends, trace};
use pubs_draw::style::{ALARM, BAND, BAND_INNER, BELIEF, FRAME, GOAL, GOAL_LINE, TICK_SIZE, TRUTH};
use pubs_draw::{DrawError, HPos, Lettering, Panel, Pen, action};

use super::expected::Expected;
use super::story::{Story, lateness};

const LINE: u32 = 6;
const FINE: u32 = 4;

/// A picture and what is to be seen on it.
pub(super) struct Picture {
    pub svg: String,
    pub caption: String,
}

impl Picture {
    fn new(svg: String, caption: impl Into<String>) -> Self {
        Self {
            svg,
            caption: caption.into(),
        }
    }
}

/// All pictures of a run, in the order of the page.
pub(super) fn pictures(
    story: &Story<'_>,
    expected: Option<&Expected>,
) -> Result<Vec<Picture>, DrawError> {
    let mut pictures = vec![
        joint_state(story)?,
        entropy(story)?,
        force_along(story, expected)?,
        forces_across(story)?,
        actions(story)?,
        speed(story)?,
    ];
    if !story.recording.run.lockstep {
        pictures.push(late(story)?);
    }
    Ok(pictures)
}

/// A chart over the time of the run.
fn chart<'a>(story: &Story<'_>, title: &'a str, height: i32, y_title: &'a str) -> Chart<'a> {
    Chart {
        title,
        height,
        x_title: "time, s",
        y_title,
        x: [0.0, story.end_s().max(0.1)],
        y: [0.0, 1.0],
        x_names: None,
        y_names: None,
        key: guard_key(story),
    }
}

fn guard_key(story: &Story<'_>) -> Vec<Key> {
    let stopped = !story.recording.guard_stops.is_empty();
    let entry = Key::new("stop by the guard", Mark::Upright, ALARM);
    stopped.then_some(entry).into_iter().collect()
}

/// A line across the panel at each stop by the guard, numbered as in the list of reasons.
fn guards(pen: &mut Pen, panel: &Panel, story: &Story<'_>) -> Result<(), DrawError> {
    for (number, stop) in (1..).zip(&story.recording.guard_stops) {
        let x = panel
            .x
            .at(story.time_s(stop.time_ns))
            .clamp(panel.x.start, panel.x.end);
        pen.line(&[[x, panel.y.end], [x, panel.y.start]], ALARM, 5)?;
        let lettering = Lettering::new(TICK_SIZE, ALARM, HPos::Center);
        pen.text(&number.to_string(), [x, panel.y.end - 26], lettering)?;
    }
    Ok(())
}

fn joint_state(story: &Story<'_>) -> Result<Picture, DrawError> {
    let joint = &story.task.joint;
    let limits = [joint.lower, joint.upper].map(|limit| limit * story.factor);
    let truth = story.truth();
    let regions = regions(story);
    let y_title = match story.unit {
        "" => "joint state".to_owned(),
        unit => format!("joint state, {unit}"),
    };
    let mut chart = Chart {
        y: ends(truth.iter().filter_map(|(_, truth)| *truth), limits),
        ..chart(story, "Joint state", 640, &y_title)
    };
    let mut key = vec![
        Key::new("believed mean", Mark::Line(LINE), BELIEF),
        Key::new("5 to 95 % of the belief", Mark::Area, BAND),
        Key::new("25 to 75 %", Mark::Area, BAND_INNER),
        Key::new("goal region", Mark::Area, GOAL),
        Key::new("limits", Mark::Line(3), FRAME),
    ];
    if !truth.is_empty() {
        key.insert(1, Key::new("true state", Mark::Line(LINE), TRUTH));
    }
    chart.key.splice(0..0, key);
    let svg = chart.svg(|pen, panel| {
        for region in &regions {
            pen.rectangle(
                [panel.x.at(region.time_s[0]), panel.y.at(region.edges[1])],
                [panel.x.at(region.time_s[1]), panel.y.at(region.edges[0])],
                GOAL,
                true,
            )?;
        }
        band(pen, panel, story.between([0.05, 0.95]), BAND)?;
        band(pen, panel, story.between([0.25, 0.75]), BAND_INNER)?;
        // The outline is seen where the belief lies over the region.
        for region in &regions {
            let [start, end] = region.time_s.map(|time_s| panel.x.at(time_s));
            for y in region.edges.map(|edge| panel.y.at(edge)) {
                pen.line(&[[start, y], [end, y]], GOAL_LINE, 3)?;
            }
        }
        for limit in limits {
            let y = panel.y.at(limit);
            pen.dashes([panel.x.start, y], panel.x.end, FRAME, 3)?;
        }
        trace(pen, panel, truth, TRUTH, LINE)?;
        trace(pen, panel, story.mean(), BELIEF, LINE)?;
        guards(pen, panel, story)
    })?;
    Ok(Picture::new(
        svg,
        "What the robot believed of the joint state, from the 50 bins of the particle histogram that \
         the recording keeps, and where each goal is met while it is pursued. Closed is at the \
         bottom.",
    ))
}

/// Where a goal is met, and while which it is pursued.
struct Region {
    time_s: [f64; 2],
    /// Lower and upper, in the shown unit.
    edges: [f64; 2],
}

fn regions(story: &Story<'_>) -> Vec<Region> {
    let (joint, run) = (&story.task.joint, &story.recording.run);
    let region = |(index, time_s): (usize, [f64; 2])| {
        let &(goal, _) = run.goals.get(index)?;
        let edge = |side: f64| goal + side * run.goal_tolerance;
        let edges = [-1.0, 1.0].map(edge);
        Some(Region {
            time_s,
            edges: edges.map(|edge| edge.clamp(joint.lower, joint.upper) * story.factor),
        })
    };
    story.goals().into_iter().filter_map(region).collect()
}

fn entropy(story: &Story<'_>) -> Result<Picture, DrawError> {
    let chart = Chart {
        y: [-0.02, 1.05],
        ..chart(story, "Entropy of the belief", 330, "entropy")
    };
    let svg = chart.svg(|pen, panel| {
        trace(pen, panel, story.entropy(), BELIEF, LINE)?;
        guards(pen, panel, story)
    })?;
    let caption = "Shannon entropy of the particles over ln N: 1 knows nothing, 0 is certain.";
    Ok(Picture::new(svg, caption))
}

fn force_along(story: &Story<'_>, expected: Option<&Expected>) -> Result<Picture, DrawError> {
    let felt: Vec<_> = story
        .felt()
        .map(|(time_s, _, [f_d, ..])| (time_s, f_d))
        .collect();
    let control = story.task.control;
    let threshold = control.map(|control| control.force_threshold_n);
    let bands = expected.map(Expected::band).unwrap_or_default();
    let shown = bands.iter().filter_map(|(_, band)| *band).flatten();
    let values = felt
        .iter()
        .map(|(_, f_d)| *f_d)
        .chain(shown)
        .chain(threshold);
    let mut chart = Chart {
        y: ends(values, [0.0, 1.0]),
        ..chart(story, "Force along the motion", 500, "f_d, N")
    };
    let mut key = vec![Key::new("felt", Mark::Line(LINE), TRUTH)];
    if !bands.is_empty() {
        key.push(Key::new(
            "the model at the believed mean",
            Mark::Line(FINE),
            BELIEF,
        ));
        key.push(Key::new("±2 sigma of it", Mark::Area, BAND));
    }
    if threshold.is_some() {
        key.push(Key::new("safe mode stops above", Mark::Line(3), ALARM));
    }
    chart.key.splice(0..0, key);
    let svg = chart.svg(|pen, panel| {
        band(pen, panel, bands, BAND)?;
        if let Some(threshold) = threshold {
            let from = [panel.x.start, panel.y.at(threshold)];
            pen.dashes(from, panel.x.end, ALARM, 3)?;
        }
        let felt = felt.into_iter().map(|(time_s, f_d)| (time_s, Some(f_d)));
        trace(pen, panel, felt, TRUTH, FINE)?;
        let mean = expected.map(Expected::mean).unwrap_or_default();
        trace(pen, panel, mean, BELIEF, FINE)?;
        guards(pen, panel, story)
    })?;
    let caption = "Resistance is positive. The model speaks where the arm moves as the action asks; \
                   while it speeds up or turns round, readings are not counted and no band is drawn.";
    Ok(Picture::new(svg, caption))
}

fn forces_across(story: &Story<'_>) -> Result<Picture, DrawError> {
    let felt: Vec<_> = story
        .felt()
        .map(|(time_s, _, forces)| (time_s, forces))
        .collect();
    let values = felt.iter().flat_map(|(_, [_, f_z, f_n])| [*f_z, *f_n]);
    let mut chart = Chart {
        y: ends(values, [0.0, 1.0]),
        ..chart(story, "Forces across the motion", 380, "force, N")
    };
    let key = [
        Key::new("f_z upwards", Mark::Line(LINE), BELIEF),
        Key::new("f_n sideways", Mark::Line(LINE), TRUTH),
    ];
    chart.key.splice(0..0, key);
    let svg = chart.svg(|pen, panel| {
        for (channel, color) in [(1, BELIEF), (2, TRUTH)] {
            let felt = felt
                .iter()
                .map(|(time_s, forces)| (*time_s, Some(forces[channel])));
            trace(pen, panel, felt, color, FINE)?;
        }
        guards(pen, panel, story)
    })?;
    Ok(Picture::new(
        svg,
        "What the sensor felt up and sideways; the motion does not explain these.",
    ))
}

fn actions(story: &Story<'_>) -> Result<Picture, DrawError> {
    /// Share of a lane that is filled.
    const FILLED: f64 = 0.72;
    let names = &story.recording.header.actions;
    let count = names.len() as f64;
    let middle = |index: usize| count - index as f64 - 0.5;
    let mut chart = Chart {
        y: [0.0, count],
        y_names: Some(
            names
                .iter()
                .enumerate()
                .map(|(index, name)| (middle(index), lane(name)))
                .collect(),
        ),
        ..chart(story, "Actions in force", 84 * names.len() as i32, "")
    };
    let kinds = [
        ("light: safe mode", false),
        ("strong: high-force mode", true),
    ];
    let mut key = Vec::new();
    for (text, high) in kinds {
        let found = story
            .task
            .movements()
            .find(|(_, action)| action.is_high_force() == high);
        key.extend(found.map(|(index, _)| Key::new(text, Mark::Area, action(index))));
    }
    chart.key.splice(0..0, key);
    let svg = chart.svg(|pen, panel| {
        for (index, [from, to]) in story.actions() {
            let [start, end] = [from, to].map(|time_s| panel.x.at(time_s));
            let [below, above] = [-0.5, 0.5].map(|side| panel.y.at(middle(index) + side * FILLED));
            // An action of one tick is seen as well.
            pen.rectangle(
                [start, above],
                [end.max(start + 3), below],
                action(index),
                true,
            )?;
        }
        guards(pen, panel, story)
    })?;
    let caption = "One lane per action, by the reading at which it was in force; opening is blue, closing orange.";
    Ok(Picture::new(svg, caption))
}

/// Fits beside the panel.
fn lane(name: &str) -> String {
    const LONGEST: usize = 15;
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    let short: String = name.chars().take(LONGEST - 1).collect();
    format!("{short}…")
}

fn speed(story: &Story<'_>) -> Result<Picture, DrawError> {
    let speeds: Vec<_> = story
        .felt()
        .map(|(time_s, frame, _)| (time_s, Some(frame.speed_m_s * 100.0)))
        .collect();
    let values = speeds.iter().filter_map(|(_, speed)| *speed);
    let chart = Chart {
        y: ends(values, [-1.0, 1.0]),
        ..chart(story, "Commanded speed", 330, "speed, cm/s")
    };
    let svg = chart.svg(|pen, panel| {
        trace(pen, panel, speeds, BELIEF, LINE)?;
        guards(pen, panel, story)
    })?;
    Ok(Picture::new(
        svg,
        "Of the handle along its path, positive towards open.",
    ))
}

fn late(story: &Story<'_>) -> Result<Picture, DrawError> {
    let recording = story.recording;
    let seconds = |time_ns: &u64| story.time_s(*time_ns);
    let ticks: Vec<u64> = recording.ticks.iter().map(|tick| tick.time_ns).collect();
    let beliefs: Vec<u64> = recording.beliefs.iter().map(|step| step.time_ns).collect();
    let choices: Vec<u64> = recording
        .choices
        .iter()
        .map(|choice| choice.time_ns)
        .collect();
    let loops = [
        ("controller", ticks, recording.header.rate_hz, BELIEF),
        ("filter", beliefs, story.task.belief.rate_hz, TRUTH),
        ("policy", choices, story.task.policy.rate_hz, GOAL_LINE),
    ];
    let series = loops.map(|(name, times_ns, rate_hz, color)| {
        let times_s: Vec<f64> = times_ns.iter().map(seconds).collect();
        (name, lateness(&times_s, rate_hz), color)
    });
    let values = series
        .iter()
        .flat_map(|(_, late, _)| late.iter().map(|(_, late_s)| 1e3 * late_s));
    let mut chart = Chart {
        y: ends(values, [0.0, 0.1]),
        ..chart(story, "Lateness of the loops", 380, "late by, ms")
    };
    let key = series
        .iter()
        .map(|(name, _, color)| Key::new(*name, Mark::Line(LINE), *color));
    chart.key.splice(0..0, key.collect::<Vec<_>>());
    let svg = chart.svg(|pen, panel| {
        for (_, late, color) in series {
            let points = late
                .into_iter()
                .map(|(time_s, late_s)| (time_s, Some(1e3 * late_s)));
            trace(pen, panel, points, color, FINE)?;
        }
        guards(pen, panel, story)
    })?;
    let caption =
        "From the times at which the steps came; each loop's most punctual step counts as on time.";
    Ok(Picture::new(svg, caption))
}
