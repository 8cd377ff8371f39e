// The three forces against what the observation model expects of the action in force.

import { Plot } from "./plot.js";

/** Readings of so long are shown, s. */
const TAIL_S = 2;
/** How wide the band is, in standard deviations. */
const SIGMAS = 2;

/** The band of a channel for an action; `undefined` where the model has none. */
function bandOf(scene, action, channel) {
  const band = scene.bands.find((candidate) => candidate.action === action);
  return band?.channels.find((candidate) => candidate.name === channel);
}

/** The action whose band is shown: the one in force, or the last that moved. */
function shownAction(scene, run) {
  const moves = (name) => scene.bands.some((band) => band.action === name);
  return [...run.actions].reverse().find(({ name }) => moves(name))?.name ?? scene.bands[0]?.action;
}

/** Ends of the axis: all of the bands of this channel, without the rare peaks of a stop. */
function range(scene, channel) {
  const ends = scene.bands.flatMap((band) => {
    const own = band.channels.find((candidate) => candidate.name === channel);
    return own === undefined ? [] : own.mean.flatMap((mean, index) => [mean - 2 * own.sigma[index], mean + 2 * own.sigma[index]]);
  });
  const sorted = ends.sort((a, b) => a - b);
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))] ?? 0;
  const [low, high] = [Math.min(0, at(0.01)), Math.max(0, at(0.97))];
  const room = 0.15 * Math.max(high - low, 2);
  return [low - room, high + room];
}

const ranges = new Map();

/** Draws one of them. */
export function drawForce(canvas, scene, run, channel) {
  if (!ranges.has(channel)) {
    ranges.set(channel, range(scene, channel));
  }
  const { lower, upper, shown_per_si, shown_unit } = scene.joint;
  const shown = (state) => state * shown_per_si;
  const tail = run.forces.filter(({ time, state }) => time > run.time - TAIL_S && state !== null);
  const [low, high] = ranges.get(channel);
  const felt = tail.map((reading) => reading[channel]);
  const plot = new Plot(canvas, {
    x: [shown(lower), shown(upper)],
    y: [Math.min(low, ...felt), Math.max(high, ...felt)],
    xLabel: `believed state, ${shown_unit}`,
    yLabel: "N",
  });
  const shownName = shownAction(scene, run);
  const band = bandOf(scene, shownName, channel);
  if (band !== undefined) {
    const edge = (state, index) => [shown(state), band.mean[index] - SIGMAS * band.sigma[index], band.mean[index] + SIGMAS * band.sigma[index]];
    plot.band(scene.states.map(edge), "believed", 0.25);
    plot.line(scene.states.map((state, index) => [shown(state), band.mean[index]]), "believed", 1);
  }
  tail.forEach(({ time, state, action, [channel]: force }) => {
    const name = action === shownName ? "felt" : "a0";
    plot.dot(shown(state), force, name, 2, 1 - (run.time - time) / TAIL_S);
  });
  const last = tail.at(-1);
  if (last !== undefined) {
    plot.dot(shown(last.state), last[channel], "felt", 4.5);
  }
}
