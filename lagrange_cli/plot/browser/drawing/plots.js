// Tilt, spin and precession over time: the times at which they are sampled, and their drawing.
//
// Times are even in the amplitude of the nutation, so that cusps stay sharp, and even in time for a
// top that waits; there are more of them where the axis is fast.

import { firstKind } from "../numerics/arithmetic.js";
import { frameOf } from "./camera.js";
import { chartOf, drawNumbers, even, prepared, stroke, ticksBetween, write } from "./canvas.js";

const PHASES = 40;  // samples per half period
const MOST = 6000;  // samples of a window
const STEP = 0.15;  // the longest way of the axis between two samples, in radians
const GAP = 24;  // between two rows
const DEGREES = 180 / Math.PI;

/** The length of a window: some nutation periods, the swing of a separatrix, or a turn. */
export function windowOf({ facts, record, argumentRate }, periods) {
  if (facts.separatrix) return 12 / argumentRate;
  if (!facts.steady && !facts.vertical) return periods * record.T_nutation;
  return periods / 2 * (record.T_precession ?? record.T_spin ?? 1);
}

/** The sampled motion over the window that holds t, and over the one before it. */
export function curvesAt(motion, span, t) {
  const number = Math.floor(t / span);
  const from = Math.max(number - 1, Math.min(number, 0)) * span;
  const until = (number + 1) * span;
  const times = refined(motion, timesBetween(motion, from, until));
  const samples = times.map(motion.angles);
  return {
    motion, span, from: number * span, until, times, samples,
    axes: samples.map(axisOf),
  };
}

function axisOf({ theta, psiWithin }) {
  return frameOf({ theta, psi: psiWithin }).axis;
}

function timesBetween(motion, from, until) {
  const { facts, period, offset, kPrime } = motion;
  if (facts.steady || facts.vertical || facts.separatrix) return even(from, until, 8 * PHASES);
  const T = +period;
  const top = -offset / 2 * T;  // a time at which the axis is highest
  const half = halfPeriod(kPrime);
  const later = half.slice(1, -1).map((x) => 1 - x);
  const whole = [...half, ...later, ...even(0, 1, PHASES).slice(1, -1)].sort((x, y) => x - y);
  const [first, last] = [Math.floor((from - top) / T), Math.ceil((until - top) / T)];
  const times = [from];
  for (let n = first; n < last; n += 1) {
    for (const part of whole) {
      const time = top + (n + part) * T;
      if (time > from && time < until) times.push(time);
    }
  }
  return [...times, until];
}

/** Parts of a period from a highest point to the lowest, at even amplitudes am(w) of (4,22). */
function halfPeriod(kPrime) {
  const amplitudes = even(0, Math.PI / 2, PHASES);
  const parts = amplitudes.map((x) => (
    firstKind(Math.sin(x) ** 2, Math.cos(x) ** 2, kPrime * kPrime)));
  return parts.map((part) => 0.5 - part / parts[PHASES] / 2).reverse();
}

/** The times, and more of them where the axis goes far in between. */
function refined(motion, times) {
  let refining = times;
  for (let round = 0; round < 6 && refining.length < MOST; round += 1) {
    const points = refining.map((time) => axisOf(motion.angles(time)));
    const more = [];
    refining.forEach((time, i) => {
      more.push(time);
      const next = points[i + 1];
      if (next && Math.hypot(...next.map((x, j) => x - points[i][j])) > STEP) {
        more.push((time + refining[i + 1]) / 2);
      }
    });
    if (more.length === refining.length) break;
    refining = more;
  }
  return refining;
}

/** The three rows of the plot; `waves` shows the periodic parts of spin and precession. */
function rowsOf({ facts, spinRate, precessionRate }, look, waves) {
  const constant = waves && (facts.steady || facts.vertical);
  const why = constant ? "no waves: the rate is constant" : null;
  const rowOf = (symbol, name, colour, rate) => ({
    name: waves ? `Δ${symbol}` : symbol,
    value: (at) => at[waves ? `d${name}` : name],
    mean: waves ? null : (t) => +rate * t,
    colour, why,
  });
  const precession = rowOf("ψ", "psi", look.green, precessionRate);
  if (facts.vertical) precession.why = "not defined: all is spin";
  const tilt = { name: "ϑ", colour: look.blue, value: (at) => at.theta };
  return [tilt, rowOf("φ", "phi", look.red, spinRate), precession];
}

/** Draw the window of the curves in a row per angle; returns the chart of the whole canvas. */
export function drawPlots(canvas, look, curves, waves, unit) {
  const { context, width, height } = prepared(canvas);
  const box = { left: 54, right: width - 10, top: 20, bottom: height - 30, foot: height - 8 };
  const times = [curves.from, curves.until];
  const whole = chartOf(box, times, [0, 1]);
  drawNumbers(context, look, whole, `time t${unit && ` (${unit})`}`, width / 90, true);
  const rows = rowsOf(curves.motion, look, waves);
  const rowHeight = (box.bottom - box.top + GAP) / rows.length - GAP;
  rows.forEach((row, i) => {
    const top = box.top + i * (rowHeight + GAP);
    drawRow(context, look, curves, row, { ...box, top, bottom: top + rowHeight });
  });
  return whole;
}

/** Draw one angle in its part of the canvas, with its mean rate, or why it has no curve. */
function drawRow(context, look, { times, samples, from, until }, row, box) {
  const { left, right, top, bottom } = box;
  stroke(context, [[left, top], [left, bottom], [right, bottom]], { colour: look.quiet });
  const title = row.why ? row.name : `${row.name} (°)`;
  write(context, title, [left, top - 9], row.colour, { align: "left" });
  if (row.why) {
    const middle = [(left + right) / 2, (top + bottom) / 2];
    write(context, row.why, middle, look.quiet, { size: 12 });
    return;
  }
  const first = times.findIndex((t) => t >= from);
  const values = samples.slice(first).map((at) => row.value(at) * DEGREES);
  const [low, high] = heightsOf(values);
  const inner = { ...box, top: top + 3, bottom: bottom - 3 };
  const { x, y } = chartOf(inner, [from, until], [low, high]);
  for (const { at, text } of ticksBetween(low, high, (bottom - top) / 28)) {
    stroke(context, [[left - 4, y(at)], [left, y(at)]], { colour: look.quiet });
    write(context, text, [left - 7, y(at)], look.ink, { size: 11, align: "right" });
  }
  if (row.mean) {
    const ends = [from, until].map((t) => [x(t), y(row.mean(t) * DEGREES)]);
    stroke(context, ends, { colour: look.quiet, width: 0.9 });
  }
  const points = values.map((value, i) => [x(times[first + i]), y(value)]);
  stroke(context, points, { colour: row.colour, width: 1.8 });
}

/** A range that holds all values, and is wide enough to be shown. */
function heightsOf(values) {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const least = Math.max(1e-9, 1e-12 * Math.abs(high));
  if (high - low > least) return [low, high];
  const middle = (low + high) / 2;
  const half = Math.max(Math.abs(middle) * 1e-3, 0.5);
  return [middle - half, middle + half];
}
