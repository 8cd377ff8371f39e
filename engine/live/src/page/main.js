// The page: it follows a run and shows it, a picture for each thing of which it is asked.

import { actionColour, drawEntropy, drawMean, drawRibbon } from "./course.js";
import { drawForce } from "./forces.js";
import { follow, keepToken, scene as fetchScene, stop } from "./link.js";
import { drawObject } from "./object.js";
import { Run } from "./run.js";
import { showTiming } from "./timing.js";

/** Between two drawings, ms: a phone keeps up with that. */
const FRAME_MS = 66;

const OUTCOMES = {
  reached: "goal reached",
  missed: "goal missed",
  timed_out: "timed out",
  safety_stop: "stopped for safety",
  fault: "failed",
};

const element = (id) => document.getElementById(id);

/** Shows a number: as text for people, as it was recorded for programs. */
function show(id, value, text) {
  element(id).textContent = text;
  element(id).dataset.value = String(value);
}

function setState(state, text) {
  document.body.dataset.state = state;
  element("state").textContent = text;
}

function warn(text) {
  element("banner").textContent = text;
  element("banner").hidden = text === "";
}

const signed = (value, digits) => value.toFixed(digits).replace("-", "−");

/** A state or a spread as people read it. */
function stateText(scene, value) {
  const { shown_per_si: shown, shown_unit: unit } = scene.joint;
  return `${signed(value * shown, 1)}${unit === "deg" ? "°" : ` ${unit}`}`;
}

function showBelief(scene, belief) {
  element("mean").dataset.step = belief.step;
  if (!belief.valid) {
    ["mean", "spread", "entropy"].forEach((id) => show(id, "", "–"));
    return;
  }
  show("mean", belief.mean, stateText(scene, belief.mean));
  show("spread", belief.sigma, stateText(scene, belief.sigma));
  show("entropy", belief.entropy, belief.entropy.toFixed(2));
}

function showObservation(observation) {
  for (const force of ["f_d", "f_z", "f_n"]) {
    show(force, observation[force], `${signed(observation[force], 1)} N`);
  }
}

function showGoal(scene, run) {
  const goal = scene.goals[run.goal] ?? scene.goals[0];
  const which = scene.goals.length > 1 ? ` (${run.goal + 1} of ${scene.goals.length})` : "";
  show("goal", goal.state, `${stateText(scene, goal.state)}${which}`);
}

function showNumbers(scene, run) {
  show("time", run.time, run.time.toFixed(1));
  if (run.belief !== null) {
    showBelief(scene, run.belief);
  }
  if (run.observation !== null) {
    showObservation(run.observation);
  }
  if (run.action !== null) {
    show("action", run.action.action, run.action.action);
    show("speed", run.action.speed_m_s, `${signed(run.action.speed_m_s, 3)} m/s`);
  }
  showGoal(scene, run);
}

function showEnd(report) {
  const stopped = report.outcome === "safety_stop" || report.outcome === "fault";
  setState(stopped ? "stopped" : "ended", OUTCOMES[report.outcome] ?? report.outcome);
  element("stop").disabled = true;
  if (report.reason) {
    warn(`The arm was stopped: ${report.reason}`);
  }
}

function draw(scene, run) {
  showNumbers(scene, run);
  drawObject(element("object-picture"), scene, run);
  for (const force of ["f_d", "f_z", "f_n"]) {
    drawForce(element(`${force}-picture`), scene, run, force);
  }
  drawMean(element("mean-picture"), scene, run);
  drawEntropy(element("entropy-picture"), scene, run);
  drawRibbon(element("ribbon"), scene, run);
  showTiming(element("timing"), element("losses"), scene, run);
  element("truth-key").hidden = run.truth === null;
}

function showKeys(scene) {
  element("action-keys").replaceChildren(
    ...scene.actions.map(({ name, high_force: strong }) => {
      const key = document.createElement("span");
      key.className = "key";
      key.style.setProperty("--key", `var(--${actionColour(scene, name)})`);
      key.textContent = strong ? `${name} (high force)` : name;
      return key;
    }),
  );
}

function watch(scene) {
  let run = new Run();
  let stale = true;
  document.title = `${scene.object}: a run`;
  element("object").textContent = scene.object;
  showKeys(scene);
  setState("waiting", "waiting for the arm");
  const redraw = () => {
    if (stale && !document.hidden) {
      stale = false;
      draw(scene, run);
    }
  };
  window.addEventListener("resize", () => {
    stale = true;
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    stale = true;
  });
  setInterval(redraw, FRAME_MS);
  follow({
    begun: () => {
      run = new Run();
      stale = true;
    },
    heard: (messages) => {
      messages.forEach(([topic, message]) => run.hear(topic, message));
      stale = true;
      if (run.guards.length > 0) {
        warn(`The guard stops the arm: ${run.guards.at(-1).reason}`);
      }
      if (run.report !== null) {
        showEnd(run.report);
      } else if (run.time > 0) {
        setState("live", "live");
      }
    },
    lost: () => {
      if (run.report === null) {
        setState("lost", "connection lost");
        warn("Nothing is heard from the program. What is shown is the last that was; the arm may still move.");
      }
    },
  });
}

function askForToken() {
  setState("refused", "token needed");
  element("token-form").hidden = false;
  element("token-form").onsubmit = (event) => {
    event.preventDefault();
    keepToken(element("token").value.trim());
    element("token-form").hidden = true;
    begin();
  };
}

async function begin() {
  try {
    watch(await fetchScene());
  } catch (error) {
    if (error.message === "refused") {
      askForToken();
    } else {
      setState("lost", "no run");
      warn(`The program does not answer: ${error.message}`);
    }
  }
}

element("stop").onclick = async () => {
  element("stop").disabled = true;
  element("stop").textContent = "Stopping …";
  try {
    await stop();
    element("stop").textContent = "Stop was asked for";
  } catch (error) {
    element("stop").disabled = false;
    element("stop").textContent = "Stop the arm";
    warn(`The stop was not heard (${error.message}). Use the emergency stop.`);
  }
};

begin();
