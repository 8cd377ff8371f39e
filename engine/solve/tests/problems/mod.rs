//! Problems made by code, for tests and benchmarks.

// Each test uses some of them.
#![allow(dead_code)]

use pubs_solve::{Pomdp, PomdpParts, Rows, parse};

/// One of the files in `problems/`.
pub fn file(name: &str) -> Pomdp {
    let path = format!("{}/problems/{name}.pomdp", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    match parse(&text) {
        Ok(pomdp) => pomdp.named(name),
        Err(faults) => panic!("{path}: {}", faults[0]),
    }
}

fn names(items: impl IntoIterator<Item = impl ToString>) -> Vec<String> {
    items.into_iter().map(|item| item.to_string()).collect()
}

/// Light-Dark on the integers from -60 to 60 and a terminal state: the position is seen with a
/// deviation of |s - 10| + 0.001, rounded to an integer. Stopping at 0 earns 100, elsewhere it
/// costs 100; a move costs 1.
pub fn light_dark() -> Pomdp {
    const RADIUS: i64 = 60;
    let positions: Vec<i64> = (-RADIUS..=RADIUS).collect();
    let terminal = positions.len();
    let moves = [0, -10, -1, 1, 10];
    let place = |position: i64| (position.clamp(-RADIUS, RADIUS) + RADIUS) as usize;
    let mut observation_row: Rows = positions
        .iter()
        .map(|&s| seen_from(s, &positions))
        .collect();
    observation_row.push(vec![(0, 1.0)]);
    let transitions = moves.map(|step| {
        let mut rows: Rows = positions
            .iter()
            .map(|&s| vec![(if step == 0 { terminal } else { place(s + step) }, 1.0)])
            .collect();
        rows.push(vec![(terminal, 1.0)]);
        rows
    });
    let rewards = moves.map(|step| {
        let reward = |&s: &i64| match (step, s) {
            (0, 0) => 100.0,
            (0, _) => -100.0,
            _ => -1.0,
        };
        let mut row: Vec<f64> = positions.iter().map(reward).collect();
        row.push(0.0);
        row
    });
    let begins = |s: &i64| if s.abs() <= 30 { 1.0 / 61.0 } else { 0.0 };
    let mut start: Vec<f64> = positions.iter().map(begins).collect();
    start.push(0.0);
    let mut states = names(&positions);
    states.push("stopped".to_owned());
    made(PomdpParts {
        name: "light_dark".to_owned(),
        states,
        actions: names(["stop", "left_10", "left_1", "right_1", "right_10"]),
        observations: names(&positions),
        discount: 0.99,
        start,
        transitions: transitions.to_vec(),
        observation_rows: vec![observation_row; moves.len()],
        rewards: rewards.to_vec(),
    })
}

fn seen_from(position: i64, bins: &[i64]) -> Vec<(usize, f64)> {
    let mean = position as f64;
    let deviation = (mean - 10.0).abs() + 1e-3;
    let below = |edge: f64| normal_cdf((edge - mean) / deviation);
    let last = bins.len() - 1;
    let share = |(index, &bin): (usize, &i64)| {
        let from = if index == 0 {
            0.0
        } else {
            below(bin as f64 - 0.5)
        };
        let to = if index == last {
            1.0
        } else {
            below(bin as f64 + 0.5)
        };
        (index, (to - from).max(0.0))
    };
    bins.iter().enumerate().map(share).collect()
}

/// Of the standard normal distribution, by the series around 0 and the continued fraction beyond.
fn normal_cdf(z: f64) -> f64 {
    let density = (-z * z / 2.0).exp() / (2.0 * std::f64::consts::PI).sqrt();
    if z.abs() < 5.0 {
        let (mut term, mut sum, mut odd) = (z, z, 1.0);
        while term.abs() > 1e-17 {
            odd += 2.0;
            term *= z * z / odd;
            sum += term;
        }
        return 0.5 + density * sum;
    }
    let fraction = (1..60)
        .rev()
        .fold(z.abs(), |below, n| z.abs() + f64::from(n) / below);
    let tail = density / fraction;
    if z > 0.0 { 1.0 - tail } else { tail }
}

/// Sim Object: states 1 to 100, of which only the two ends are felt. Careful steps of 1 stay
/// inside; steps of `jump` past an end break the object. Stopping within 5 of 50 earns 1.
pub fn sim_object(jump: i64) -> Pomdp {
    let places: Vec<i64> = (1..=100).collect();
    let terminal = places.len();
    let moves = [None, Some(1), Some(-1), Some(jump), Some(-jump)];
    let time = -0.001;
    let breaks = |step: i64, s: i64| step.abs() > 1 && !(1..=100).contains(&(s + step));
    let transitions = moves.map(|step| {
        let next = |&s: &i64| match step {
            None => terminal,
            Some(step) if breaks(step, s) => terminal,
            Some(step) => ((s + step).clamp(1, 100) - 1) as usize,
        };
        let mut rows: Rows = places.iter().map(|s| vec![(next(s), 1.0)]).collect();
        rows.push(vec![(terminal, 1.0)]);
        rows
    });
    let rewards = moves.map(|step| {
        let reward = |&s: &i64| match step {
            None if (s - 50).abs() <= 5 => 1.0 + time,
            None => -1.0 + time,
            Some(step) if breaks(step, s) => -1.0 + time,
            Some(_) => time,
        };
        let mut row: Vec<f64> = places.iter().map(reward).collect();
        row.push(0.0);
        row
    });
    let felt = |s: &i64| vec![(usize::from(*s == 1 || *s == 100), 1.0)];
    let mut observation_row: Rows = places.iter().map(felt).collect();
    observation_row.push(vec![(0, 1.0)]);
    let mut start = vec![0.01; 100];
    start.push(0.0);
    let mut states = names(&places);
    states.push("ended".to_owned());
    made(PomdpParts {
        name: "sim_object".to_owned(),
        states,
        actions: names(["stop", "open", "close", "high_open", "high_close"]),
        observations: names(["free", "limit"]),
        discount: 0.99,
        start,
        transitions: transitions.to_vec(),
        observation_rows: vec![observation_row; moves.len()],
        rewards: rewards.to_vec(),
    })
}

/// Rock sampling (Smith & Simmons 2004) on a square of `side` with rocks at these places.
pub fn rock_sample(side: usize, rocks: &[(usize, usize)]) -> Pomdp {
    let patterns = 1 << rocks.len();
    let terminal = side * side * patterns;
    let state = |x: usize, y: usize, rocks: usize| (x * side + y) * patterns + rocks;
    let mut actions = names(["north", "south", "east", "west", "sample"]);
    actions.extend((0..rocks.len()).map(|rock| format!("check_{rock}")));
    let half_distance = 20.0;
    let (mut transitions, mut observation_rows, mut rewards) = (vec![], vec![], vec![]);
    for action in 0..actions.len() {
        let mut next_rows: Rows = Vec::new();
        let mut seen: Rows = Vec::new();
        let mut earned = Vec::new();
        for (x, y, good) in
            (0..terminal).map(|s| (s / patterns / side, s / patterns % side, s % patterns))
        {
            let here = rocks.iter().position(|&rock| rock == (x, y));
            let (next, reward) = match action {
                0 => (
                    state(x, (y + 1).min(side - 1), good),
                    if y + 1 < side { 0.0 } else { -100.0 },
                ),
                1 => (
                    state(x, y.saturating_sub(1), good),
                    if y > 0 { 0.0 } else { -100.0 },
                ),
                2 if x + 1 == side => (terminal, 10.0),
                2 => (state(x + 1, y, good), 0.0),
                3 => (
                    state(x.saturating_sub(1), y, good),
                    if x > 0 { 0.0 } else { -100.0 },
                ),
                4 => match here {
                    None => (state(x, y, good), -100.0),
                    Some(rock) if good >> rock & 1 == 1 => (state(x, y, good & !(1 << rock)), 10.0),
                    Some(_) => (state(x, y, good), -10.0),
                },
                _ => (state(x, y, good), 0.0),
            };
            next_rows.push(vec![(next, 1.0)]);
            earned.push(reward);
            seen.push(match action.checked_sub(5) {
                None => vec![(0, 1.0)],
                Some(rock) => {
                    let (dx, dy) = (
                        rocks[rock].0 as f64 - x as f64,
                        rocks[rock].1 as f64 - y as f64,
                    );
                    let right = 0.5 + 0.5 * (-dx.hypot(dy) / half_distance).exp2();
                    let is_good = if good >> rock & 1 == 1 {
                        right
                    } else {
                        1.0 - right
                    };
                    vec![(1, is_good), (0, 1.0 - is_good)]
                }
            });
        }
        next_rows.push(vec![(terminal, 1.0)]);
        seen.push(vec![(0, 1.0)]);
        earned.push(0.0);
        transitions.push(next_rows);
        observation_rows.push(seen);
        rewards.push(earned);
    }
    let mut start = vec![0.0; terminal + 1];
    for good in 0..patterns {
        start[state(0, side / 2, good)] = 1.0 / patterns as f64;
    }
    made(PomdpParts {
        name: format!("rock_sample_{side}_{}", rocks.len()),
        states: names(0..=terminal),
        actions,
        observations: names(["bad", "good"]),
        discount: 0.95,
        start,
        transitions,
        observation_rows,
        rewards,
    })
}

/// Tag (Pineau, Gordon & Thrun 2003): 29 cells, ten by two with three by three on top. The robot
/// sees itself, and the opponent only in the same cell; the opponent moves away four times in five.
pub fn tag() -> Pomdp {
    let mut cells: Vec<(i64, i64)> = (0..20).map(|cell| (cell % 10, cell / 10)).collect();
    cells.extend((0..9).map(|cell| (5 + cell % 3, 2 + cell / 3)));
    let count = cells.len();
    let place = |at: (i64, i64)| cells.iter().position(|&cell| cell == at);
    let moved = |cell: usize, (dx, dy): (i64, i64)| {
        place((cells[cell].0 + dx, cells[cell].1 + dy)).unwrap_or(cell)
    };
    let tagged = count * count;
    let flight = |robot: usize, opponent: usize| -> Vec<(usize, f64)> {
        let (from, at) = (cells[robot], cells[opponent]);
        let away = |difference: i64| match difference.signum() {
            0 => vec![-1, 1],
            sign => vec![sign],
        };
        let across = away(at.0 - from.0);
        let along = away(at.1 - from.1);
        let mut row = vec![(opponent, 0.2)];
        row.extend(
            across
                .iter()
                .map(|&dx| (moved(opponent, (dx, 0)), 0.4 / across.len() as f64)),
        );
        row.extend(
            along
                .iter()
                .map(|&dy| (moved(opponent, (0, dy)), 0.4 / along.len() as f64)),
        );
        row
    };
    let steps = [(0, 1), (0, -1), (1, 0), (-1, 0)];
    let (mut transitions, mut rewards) = (vec![], vec![]);
    for action in 0..5 {
        let (mut rows, mut earned): (Rows, Vec<f64>) = (vec![], vec![]);
        for (robot, opponent) in (0..tagged).map(|state| (state / count, state % count)) {
            let met = action == 4 && robot == opponent;
            let goes = steps.get(action).map_or(robot, |&step| moved(robot, step));
            let fled = flight(robot, opponent).into_iter();
            rows.push(if met {
                vec![(tagged, 1.0)]
            } else {
                fled.map(|(next, share)| (goes * count + next, share))
                    .collect()
            });
            earned.push(match action {
                4 if met => 10.0,
                4 => -10.0,
                _ => -1.0,
            });
        }
        rows.push(vec![(tagged, 1.0)]);
        earned.push(0.0);
        transitions.push(rows);
        rewards.push(earned);
    }
    let seen = |state: usize| {
        if state / count == state % count {
            count
        } else {
            state / count
        }
    };
    let mut observation_row: Rows = (0..tagged).map(|state| vec![(seen(state), 1.0)]).collect();
    observation_row.push(vec![(count, 1.0)]);
    let mut start = vec![1.0 / tagged as f64; tagged];
    start.push(0.0);
    made(PomdpParts {
        name: "tag".to_owned(),
        states: names(0..=tagged),
        actions: names(["north", "south", "east", "west", "tag"]),
        observations: names(0..=count),
        discount: 0.95,
        start,
        transitions,
        observation_rows: vec![observation_row; 5],
        rewards,
    })
}

fn made(parts: PomdpParts) -> Pomdp {
    Pomdp::new(parts).unwrap_or_else(|error| panic!("{error}"))
}
