// Tilt, spin and precession over time.

import { prepared, stroke, write } from "./look.js";
import { ticksBetween } from "./ticks.js";

const MARGIN = { left: 54, right: 10, top: 8, bottom: 30, gap: 12 };
const DEGREES = 180 / Math.PI;

/** The three rows of the plot; `waves` shows their periodic parts. */
function rowsOf({ motion }, look, waves) {
  const { facts } = motion;
  const undefinedWhy = facts.vertical ? "not defined: all is spin" : null;
  const still = waves && (facts.steady || facts.vertical) ? "no waves: the rate is constant" : null;
  return [
    { name: "ϑ", colour: look.blue, value: (at) => at.theta },
    {
      name: waves ? "Δφ" : "φ", colour: look.red, why: still,
      value: (at) => (waves ? at.dphi : at.phi),
      mean: waves ? null : (t) => +motion.spinRate * t,
    },
    {
      name: waves ? "Δψ" : "ψ", colour: look.green, why: undefinedWhy ?? still,
      value: (at) => (waves ? at.dpsi : at.psi),
      mean: waves ? null : (t) => +motion.precessionRate * t,
    },
  ];
}

/** Draw the window of the curves; returns where a time is on the canvas. */
export function drawPlots(canvas, look, curves, waves) {
  const { context, width, height } = prepared(canvas);
  const { left, right, top, bottom, gap } = MARGIN;
  const rows = rowsOf(curves, look, waves);
  const rowHeight = (height - top - bottom - (rows.length - 1) * gap) / rows.length;
  const x = (t) => left + (t - curves.from) / curves.span * (width - left - right);
  drawTimes(context, look, curves, x, { width, height });
  rows.forEach((row, i) => {
    const box = { left, width: width - left - right, top: top + i * (rowHeight + gap), rowHeight };
    drawRow(context, look, curves, row, x, box);
  });
  return { left, right: width - right, timeAt: (px) => (
    curves.from + (px - left) / (width - left - right) * curves.span) };
}

/** Draw lines of time and their numbers, and the nutation periods as thin marks above. */
function drawTimes(context, look, { from, until }, x, { width, height }) {
  for (const { x: t, text } of ticksBetween(from, until, width / 90)) {
    stroke(context, [[x(t), MARGIN.top], [x(t), height - MARGIN.bottom]], {
      colour: look.quiet, width: 0.6, alpha: 0.35,
    });
    write(context, text, [x(t), height - MARGIN.bottom + 10], look.ink, { size: 11 });
  }
  write(context, "time t", [width - MARGIN.right, height - 8], look.quiet, {
    size: 11, align: "right",
  });
}

function drawRow(context, look, curves, row, x, { left, width, top, rowHeight }) {
  const bottom = top + rowHeight;
  stroke(context, [[left, top], [left, bottom], [left + width, bottom]], { colour: look.quiet });
  if (row.why) {
    write(context, row.name, [left + 6, top + 7], row.colour, { align: "left" });
    write(context, row.why, [left + width / 2, (top + bottom) / 2], look.quiet, { size: 12 });
    return;
  }
  const inside = curves.samples.filter((_, i) => curves.times[i] >= curves.from);
  const times = curves.times.filter((t) => t >= curves.from);
  const values = inside.map((at) => row.value(at) * DEGREES);
  const [low, high] = rangeOf(values);
  const y = (value) => bottom - 3 - (value - low) / (high - low) * (rowHeight - 6);
  for (const { x: tick, text } of ticksBetween(low, high, rowHeight / 28)) {
    stroke(context, [[left - 4, y(tick)], [left, y(tick)]], { colour: look.quiet });
    write(context, text, [left - 7, y(tick)], look.ink, { size: 11, align: "right" });
  }
  if (row.mean) {
    const ends = [curves.from, curves.until].map((t) => [x(t), y(row.mean(t) * DEGREES)]);
    stroke(context, ends, { colour: look.quiet, width: 0.9 });
  }
  const points = times.map((t, i) => [x(t), y(values[i])]);
  stroke(context, points, { colour: row.colour, width: 1.8 });
  write(context, `${row.name}  (°)`, [left + 6, top + 7], row.colour, {
    align: "left", halo: look.paper,
  });
}

/** A range that holds all values, and is wide enough to be shown. */
function rangeOf(values) {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const least = Math.max(1e-9, 1e-12 * Math.abs(high));
  if (high - low > least) return [low, high];
  const middle = (low + high) / 2;
  const half = Math.max(Math.abs(middle) * 1e-3, 0.5);
  return [middle - half, middle + half];
}
