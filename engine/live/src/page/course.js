// Mean and spread, entropy, and the actions over time.

import { Plot, cleared, colour } from "./plot.js";

/** The pictures show so much, s. */
const SHOWN_S = 30;
const LEFT = 46;
const RIGHT = 10;

function times(run) {
  const end = Math.max(run.time, 5);
  return [Math.max(0, end - SHOWN_S), end];
}

/** Mean ± one standard deviation, the goal regions and, where it is known, the truth. */
export function drawMean(canvas, scene, run) {
  const { lower, upper, shown_per_si, shown_unit } = scene.joint;
  const shown = (state) => state * shown_per_si;
  const plot = new Plot(canvas, {
    x: times(run),
    y: [shown(lower), shown(upper)],
    yLabel: `state, ${shown_unit}`,
  });
  scene.goals.forEach((goal, index) => {
    const region = plot.x.map((time) => [time, shown(goal.from), shown(goal.to)]);
    plot.band(region, "goal", index === run.goal ? 0.22 : 0.08);
  });
  const valid = run.beliefs.filter((belief) => belief.valid);
  plot.band(valid.map(({ time, mean, sigma }) => [time, shown(mean - sigma), shown(mean + sigma)]), "believed", 0.25);
  plot.line(run.truths.map(({ time, state }) => [time, shown(state)]), "truth");
  plot.line(run.beliefs.map(({ time, mean, valid: known }) => [time, known ? shown(mean) : null]), "believed", 2);
  run.guards.forEach(({ time }) => plot.upright(time, "felt"));
}

/** Entropy, from 0 (sure) to 1 (knows nothing). */
export function drawEntropy(canvas, scene, run) {
  const plot = new Plot(canvas, { x: times(run), y: [0, 1], xLabel: "time, s", yLabel: "entropy" });
  plot.line(run.beliefs.map(({ time, entropy, valid }) => [time, valid ? entropy : null]), "believed", 2);
  run.guards.forEach(({ time }) => plot.upright(time, "felt"));
}

/** Colour of an action. */
export function actionColour(scene, name) {
  return `a${Math.max(0, scene.actions.findIndex((action) => action.name === name)) % 5}`;
}

/** One box for as long as an action was in force; high-force actions are taller. */
export function drawRibbon(canvas, scene, run) {
  const { pen, width, height } = cleared(canvas);
  const [begin, end] = times(run);
  const at = (time) => LEFT + ((time - begin) / (end - begin)) * (width - LEFT - RIGHT);
  for (const { name, from, until } of run.actions) {
    if (until < begin) {
      continue;
    }
    const strong = scene.actions.find((action) => action.name === name)?.high_force;
    const inset = strong ? 0 : height * 0.25;
    const left = Math.max(LEFT, at(from));
    pen.fillStyle = colour(actionColour(scene, name));
    pen.fillRect(left, inset, Math.max(1, at(until) - left), height - 2 * inset);
  }
}
