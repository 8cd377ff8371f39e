// The object as it is believed to be: a hinge seen along its axis, a slide from the side.

import { cleared, colour } from "./plot.js";

const TEXT_ROOM = 26;

/** Draws the object. */
export function drawObject(canvas, scene, run) {
  const { pen, width, height } = cleared(canvas);
  const view = { pen, width, height, scene, run };
  pen.lineCap = "round";
  if (scene.joint.type === "revolute") {
    drawHinge(view);
  } else {
    drawSlide(view);
  }
}

/** Parts of the range with the mass of the particles in each, relative to the greatest. */
function cloud({ run }) {
  if (!run.belief?.valid) {
    return [];
  }
  const { lower, upper, mass } = run.belief.histogram;
  const size = (upper - lower) / mass.length;
  const most = Math.max(...mass);
  const part = (share, bin) => ({ from: lower + bin * size, to: lower + (bin + 1) * size, share: share / most });
  return mass.map(part).filter(({ share }) => share > 0);
}

/** A text around a place, but within the picture. */
function label({ pen, width, height }, text, x, y) {
  const half = pen.measureText(text).width / 2 + 2;
  pen.fillStyle = colour("faint");
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  const within = (value, room, size) => Math.min(Math.max(value, room), size - room);
  pen.fillText(text, within(x, half, width), within(y, 8, height));
}

/** Of an arc around the hinge: angles are mathematical, the closed door points to the right. */
function hingePlace({ width, height, scene }) {
  const { lower, upper } = scene.joint;
  const corners = [[0, 0]];
  for (let index = 0; index <= 40; index += 1) {
    const angle = lower + (index / 40) * (upper - lower);
    corners.push([Math.cos(angle), Math.sin(angle)]);
  }
  const ends = (axis) => [Math.min(...corners.map((corner) => corner[axis])), Math.max(...corners.map((corner) => corner[axis]))];
  const [left, right] = ends(0);
  const [low, high] = ends(1);
  const room = TEXT_ROOM + 14;
  const radius = Math.min((width - 2 * room) / (right - left), (height - 2 * room) / Math.max(high - low, 0.3));
  return {
    x: width / 2 - ((left + right) / 2) * radius,
    y: height / 2 + ((low + high) / 2) * radius,
    radius,
  };
}

function drawHinge(view) {
  const { pen, scene, run } = view;
  const { lower, upper, shown_per_si } = scene.joint;
  const { x, y, radius } = hingePlace(view);
  const at = (angle, far) => [x + far * Math.cos(angle), y - far * Math.sin(angle)];
  const ring = (from, to, inner, outer, name, opacity) => {
    pen.globalAlpha = opacity;
    pen.fillStyle = colour(name);
    pen.beginPath();
    pen.arc(x, y, outer, -from, -to, true);
    pen.arc(x, y, inner, -to, -from, false);
    pen.fill();
    pen.globalAlpha = 1;
  };
  const leaf = (angle, name, thickness, dashes) => {
    pen.strokeStyle = colour(name);
    pen.lineWidth = thickness;
    pen.setLineDash(dashes);
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(...at(angle, radius));
    pen.stroke();
    pen.setLineDash([]);
  };
  const goal = scene.goals[run.goal] ?? scene.goals[0];
  ring(goal.from, goal.to, 0, radius, "goal", 0.22);
  leaf(goal.state, "goal", 1, [3, 3]);
  leaf(lower, "line", 2, []);
  leaf(upper, "line", 2, []);
  cloud(view).forEach(({ from, to, share }) => ring(from, to, radius + 2, radius + 2 + 12 * share, "cloud", 0.45));
  if (run.truth !== null) {
    leaf(run.truth, "truth", 2, [6, 4]);
  }
  if (run.belief?.valid) {
    leaf(run.belief.mean, "believed", 5, []);
    pen.fillStyle = colour("believed");
    pen.beginPath();
    pen.arc(...at(run.belief.mean, radius), 6, 0, 2 * Math.PI);
    pen.fill();
  }
  pen.fillStyle = colour("ink");
  pen.beginPath();
  pen.arc(x, y, 5, 0, 2 * Math.PI);
  pen.fill();
  const name = (word, state) => `${word} ${(state * shown_per_si).toFixed(0)}°`;
  const [closedX, closedY] = at(lower, radius);
  label(view, name("closed", lower), closedX, closedY + 14);
  label(view, name("open", upper), ...at(upper, radius + TEXT_ROOM));
}

function drawSlide(view) {
  const { pen, width, height, scene, run } = view;
  const { lower, upper, shown_per_si, shown_unit } = scene.joint;
  const [left, right] = [Math.min(90, width * 0.2), width - 30];
  const at = (state) => left + 12 + ((state - lower) / (upper - lower)) * (right - left - 12);
  const middle = height / 2;
  const half = Math.min(46, height * 0.25);
  const goal = scene.goals[run.goal] ?? scene.goals[0];
  pen.fillStyle = colour("goal");
  pen.globalAlpha = 0.22;
  pen.fillRect(at(goal.from), middle - half - 16, Math.max(2, at(goal.to) - at(goal.from)), 2 * half + 32);
  pen.globalAlpha = 1;
  const upright = (state, name, reach, dashes) => {
    pen.strokeStyle = colour(name);
    pen.lineWidth = 1.5;
    pen.setLineDash(dashes);
    pen.beginPath();
    pen.moveTo(at(state), middle - reach);
    pen.lineTo(at(state), middle + reach);
    pen.stroke();
    pen.setLineDash([]);
  };
  upright(goal.state, "goal", half + 16, [3, 3]);
  upright(lower, "line", half + 16, []);
  upright(upper, "line", half + 16, []);
  // The cabinet, and the drawer that comes out of it.
  pen.strokeStyle = colour("ink");
  pen.lineWidth = 2;
  pen.strokeRect(left - 70, middle - half - 8, 70, 2 * half + 16);
  pen.fillStyle = colour("cloud");
  for (const { from, to, share } of cloud(view)) {
    pen.globalAlpha = 0.45;
    pen.fillRect(at(from), middle - half - 4 - 16 * share, at(to) - at(from), 16 * share);
  }
  pen.globalAlpha = 1;
  if (run.truth !== null) {
    upright(run.truth, "truth", half + 8, [6, 4]);
  }
  if (run.belief?.valid) {
    const front = at(run.belief.mean);
    pen.fillStyle = colour("believed");
    pen.globalAlpha = 0.15;
    pen.fillRect(left - 60, middle - half, front - left + 60, 2 * half);
    pen.globalAlpha = 1;
    pen.fillRect(front - 3, middle - half, 6, 2 * half);
    pen.fillRect(front + 3, middle - 3, 12, 6);
  }
  const name = (word, state) => `${word} ${(state * shown_per_si).toFixed(1)} ${shown_unit}`;
  label(view, name("closed", lower), at(lower), height - 10);
  label(view, name("open", upper), at(upper), height - 10);
}
