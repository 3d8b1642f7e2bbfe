// Tilt, spin and precession over time: the times at which they are sampled, and their drawing.
//
// Times are even in the amplitude of the nutation, so that cusps stay sharp, and even in time for a
// top that waits; there are more of them where the axis is fast.

import { firstKind } from "../numerics/integrals.js";
import { frameOf } from "./camera.js";
import { even, prepared, stroke, ticksBetween, write } from "./canvas.js";

const PHASES = 40;  // samples per half period
const MOST = 6000;  // samples of a window
const STEP = 0.15;  // the longest way of the axis between two samples, in radians
const MARGIN = { left: 54, right: 10, top: 20, bottom: 30, gap: 24 };
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
export function drawPlots(canvas, look, curves, waves, unit) {
  const { context, width, height } = prepared(canvas);
  const { left, right, top, bottom, gap } = MARGIN;
  const rows = rowsOf(curves, look, waves);
  const rowHeight = (height - top - bottom - (rows.length - 1) * gap) / rows.length;
  const x = (t) => left + (t - curves.from) / curves.span * (width - left - right);
  drawTimes(context, look, curves, x, { width, height, unit });
  rows.forEach((row, i) => {
    const box = { left, width: width - left - right, top: top + i * (rowHeight + gap), rowHeight };
    drawRow(context, look, curves, row, x, box);
  });
  return { left, right: width - right, timeAt: (px) => (
    curves.from + (px - left) / (width - left - right) * curves.span) };
}

/** Draw lines of time and their numbers, and the nutation periods as thin marks above. */
function drawTimes(context, look, { from, until }, x, { width, height, unit }) {
  for (const { x: t, text } of ticksBetween(from, until, width / 90)) {
    stroke(context, [[x(t), MARGIN.top], [x(t), height - MARGIN.bottom]], {
      colour: look.quiet, width: 0.6, alpha: 0.35,
    });
    write(context, text, [x(t), height - MARGIN.bottom + 10], look.ink, { size: 11 });
  }
  write(context, `time t${unit && ` (${unit})`}`, [width - MARGIN.right, height - 8], look.quiet, {
    size: 11, align: "right",
  });
}

function drawRow(context, look, curves, row, x, { left, width, top, rowHeight }) {
  const bottom = top + rowHeight;
  stroke(context, [[left, top], [left, bottom], [left + width, bottom]], { colour: look.quiet });
  if (row.why) {
    write(context, row.name, [left, top - 9], row.colour, { align: "left" });
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
  write(context, `${row.name} (°)`, [left, top - 9], row.colour, { align: "left" });
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
