//! Filter updates and surrogate steps per second, on door2's observation model through the plugin
//! table, with the plain filter and with one that estimates what readings are off by: `cargo bench -p pubs-evaluate --bench filter`.
#![allow(missing_docs, clippy::unwrap_used, reason = "a bench is no interface")]

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use pubs_core::belief::{Filter, Model};
use pubs_core::object::{self, Overrides};
use pubs_core::task::compile;
use pubs_core::{Input, Motion, Task};
use pubs_host::Registry;
use pubs_train::surrogate::{Episode, Senses, draw_goal, draw_start};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

const RUNS: usize = 9;

fn main() {
    for particles in [100, 300, 3000] {
        let [plain, biased] = ["sis", "rao_blackwell"].map(|filter| report(particles, filter));
        println!(
            "N = {particles:<5} rao_blackwell / sis: update {:.2}, step {:.2}",
            biased.0 / plain.0,
            biased.1 / plain.1
        );
    }
    println!(
        "vector unit {}, median of {RUNS} runs (least..most)",
        pubs_core::vector::VectorUnit::best()
    );
}

/// Prints what an update and a step cost, and gives the medians, ns.
fn report(particles: u32, filter: &str) -> (f64, f64) {
    let door = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../objects/door2.toml");
    let overrides = Overrides::from_process([
        format!("belief.particles={particles}"),
        format!("belief.filter={filter}"),
    ]);
    let file = object::load(&door, &overrides).unwrap().file;
    let task = Arc::new(compile(&file).unwrap());
    let registry = Registry::new(&[pubs_segments::table()], Vec::new());
    let plugin = registry.observation_model(&task.observation.model).unwrap();
    let model: Arc<dyn Model> = Arc::new(plugin.create(&task.model_setup(0)).unwrap());
    let update_ns = measure(|| updates(&task, &model));
    let step_ns = measure(|| steps(&task, &model));
    println!(
        "N = {particles:<5} {filter:<13} update {:>6.0} ns ({:.0}..{:.0}), {:.2} million/s; surrogate policy step {:>6.0} ns ({:.0}..{:.0})",
        update_ns.1,
        update_ns.0,
        update_ns.2,
        1e3 / update_ns.1,
        step_ns.1,
        step_ns.0,
        step_ns.2,
    );
    (update_ns.1, step_ns.1)
}

/// Least, median and most of several runs, ns per operation.
fn measure(mut run: impl FnMut() -> (f64, u32)) -> (f64, f64, f64) {
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| run())
        .map(|(ns, count)| ns / f64::from(count))
        .collect();
    times.sort_by(f64::total_cmp);
    (times[0], times[RUNS / 2], times[RUNS - 1])
}

/// The handle goes to and fro over the flat part of the range.
fn updates(task: &Task, model: &Arc<dyn Model>) -> (f64, u32) {
    const COUNT: u32 = 20_000;
    let mut filter = Filter::new(task, Arc::clone(model));
    let begun = Instant::now();
    for update in 0..COUNT {
        let closing = update / 100 % 2 == 1;
        let (action, displacement) = if closing { (2, -0.005) } else { (1, 0.005) };
        filter
            .update(action, displacement, &[1.6, 1.0, 0.2, 1.0])
            .unwrap();
    }
    (begun.elapsed().as_nanos() as f64, COUNT)
}

/// Whole policy steps of the simulator, with any movement action.
fn steps(task: &Arc<Task>, model: &Arc<dyn Model>) -> (f64, u32) {
    const COUNT: u32 = 5_000;
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let senses = Senses::new([Input::MeanState, Input::Entropy], false);
    let mut episode = Episode::new(Arc::clone(task), Arc::clone(model), senses);
    let moves: Vec<usize> = (0..task.actions.len())
        .filter(|&index| matches!(task.actions[index].motion, Motion::Move { .. }))
        .collect();
    let begin = |episode: &mut Episode, rng: &mut Xoshiro256PlusPlus| {
        let (start, goal) = (draw_start(&task.joint, rng), draw_goal(&task.joint, rng));
        episode.begin(start, goal, rng);
    };
    begin(&mut episode, &mut rng);
    let begun = Instant::now();
    for _ in 0..COUNT {
        let action = moves[rng.random_range(0..moves.len())];
        if episode.step(action, &mut rng).unwrap().stopped.is_some() {
            begin(&mut episode, &mut rng);
        }
    }
    (begun.elapsed().as_nanos() as f64, COUNT)
}
