// What is known of the run so far, from the messages of its recording.

/** How much is kept for the pictures, s. */
const KEPT_S = 120;

const seconds = (stamp, first) => stamp.sec - first.sec + (stamp.nsec - first.nsec) * 1e-9;

/** Mean square distance from the mean within a histogram, and its root. */
function spread({ lower, upper, mass }, mean) {
  const width = (upper - lower) / mass.length;
  const square = (sum, part, bin) => sum + part * (lower + (bin + 0.5) * width - mean) ** 2;
  return Math.sqrt(mass.reduce(square, 0));
}

function forget(list, time) {
  const old = list.findIndex((item) => item.time >= time - KEPT_S);
  if (old > 256) {
    list.splice(0, old);
  }
}

export class Run {
  constructor() {
    this.first = null;
    this.time = 0;
    this.belief = null;
    this.beliefs = [];
    this.observation = null;
    this.forces = [];
    this.action = null;
    this.actions = [];
    this.truth = null;
    this.truths = [];
    this.goal = 0;
    this.ticks = [];
    this.choices = [];
    this.guards = [];
    this.dropped = 0;
    this.missed = 0;
    this.report = null;
  }

  /** Takes in one message. */
  hear(topic, message) {
    if (topic === "end") {
      this.report = message;
      return;
    }
    if (topic === "missed") {
      this.missed += message;
      return;
    }
    const take = this[`hear_${topic.slice(1)}`];
    // The scene has the limits, and a run's own summary is its end.
    if (take === undefined) {
      return;
    }
    this.first ??= message.timestamp;
    const time = seconds(message.timestamp, this.first);
    this.time = Math.max(this.time, time);
    take.call(this, message, time);
  }

  hear_belief(message, time) {
    const sigma = message.valid ? spread(message.histogram, message.mean) : 0;
    this.belief = { ...message, time, sigma };
    this.beliefs.push({ time, mean: message.mean, sigma, entropy: message.entropy, valid: message.valid });
    forget(this.beliefs, time);
  }

  hear_observation(message, time) {
    this.observation = { ...message, time };
    const state = this.belief?.valid ? this.belief.mean : null;
    this.forces.push({ time, state, action: null, f_d: message.f_d, f_z: message.f_z, f_n: message.f_n });
    forget(this.forces, time);
  }

  hear_action(message, time) {
    this.action = message;
    const felt = this.forces.at(-1);
    if (felt?.time === time) {
      felt.action = message.action;
    }
    const last = this.actions.at(-1);
    if (last?.name === message.action) {
      last.until = time;
    } else {
      this.actions.push({ name: message.action, from: time, until: time, time });
    }
  }

  hear_truth(message, time) {
    this.truth = message.joint_state;
    this.truths.push({ time, state: message.joint_state });
    forget(this.truths, time);
  }

  hear_policy(message, time) {
    this.goal = message.goal;
    this.choices.push({ time, number: message.step });
    forget(this.choices, time);
  }

  hear_controller(message, time) {
    this.ticks.push({ time, number: message.tick });
    forget(this.ticks, time);
  }

  hear_guard(message, time) {
    this.guards.push({ time, reason: message.reason });
  }

  hear_dropped(message) {
    this.dropped = message.entries;
  }
}
