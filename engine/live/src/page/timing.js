// How punctual the loops are, from the times in their messages.

const SHOWN_S = 10;

/** The median of a sorted list. */
const median = (sorted) => sorted[Math.floor((sorted.length - 1) / 2)] ?? 0;

/**
 * How late the steps of a loop were, s, against the most punctual of them, and how many never came.
 * Steps are due one period apart; a gap of more than one and a half periods is a step that was
 * missed.
 */
export function lateness(steps, rateHz) {
  if (steps.length < 2) {
    return null;
  }
  const period = 1 / rateHz;
  const start = steps[0].time;
  const missed = steps.slice(1).reduce((sum, { time }, index) => {
    return sum + Math.max(0, Math.round((time - steps[index].time) / period) - 1);
  }, 0);
  // Each step less the due time nearest before it; the offset of the most punctual is unknown.
  const phases = steps.map(({ time }) => {
    const count = Math.round((time - start) / period);
    return time - start - count * period;
  });
  const best = Math.min(...phases);
  const late = phases.map((phase) => phase - best).sort((a, b) => a - b);
  return { median: median(late), worst: late.at(-1), missed };
}

const LOOPS = [
  ["controller", (run) => run.ticks],
  ["filter", (run) => run.beliefs],
  ["policy", (run) => run.choices],
];

const ms = (time) => `${(1e3 * time).toFixed(2)} ms`;

/** Fills the table and the line below it. */
export function showTiming(table, losses, scene, run) {
  const rows = LOOPS.map(([name, stepsOf]) => {
    const steps = stepsOf(run).filter(({ time }) => time > run.time - SHOWN_S);
    const late = lateness(steps, scene.rates_hz[name]);
    const cells = late === null ? ["–", "–", "–"] : [ms(late.median), ms(late.worst), late.missed];
    return [name, `${scene.rates_hz[name]} Hz`, ...cells];
  });
  table.replaceChildren(
    ...rows.map((cells) => {
      const row = document.createElement("tr");
      row.append(...cells.map((text) => Object.assign(document.createElement("td"), { textContent: text })));
      return row;
    }),
  );
  const lost = [
    [run.dropped, "entries were dropped by the recorder"],
    [run.missed, "messages did not reach this page, which is too slow or came late"],
  ];
  losses.textContent = lost
    .filter(([count]) => count > 0)
    .map(([count, what]) => `${count} ${what}`)
    .join("; ");
}
