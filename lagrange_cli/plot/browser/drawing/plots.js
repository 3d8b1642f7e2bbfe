// The plots beside the top: tilt, spin and precession over time, and the cubic.
//
// Samples are even in time from one turning point to the next, so that cusps stay sharp; there are
// more of them where the axis is fast.

import {
  chartOf, dot, drawNumbers, even, prepared, stroke, tickText, ticksBetween, write,
} from "./canvas.js";
import { frameOf } from "./space.js";

const PHASES = 40;  // samples per half period
const MOST = 6000;  // samples of a window
const STEP = 0.08;  // the longest way of the axis between two samples, in radians
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

/** Times from `from` to `until`, with the turning points of a nutation among them. */
function timesBetween({ facts, period, offset }, from, until) {
  if (facts.steady || facts.vertical || facts.separatrix) return even(from, until, 8 * PHASES);
  const step = period / 2 / PHASES;
  const top = -offset * PHASES;  // steps from t = 0 to a time at which the axis is highest
  const [first, last] = [from, until].map((t) => Math.ceil(t / step - top));
  const within = [...Array(last - first).keys()].map((i) => (top + first + i) * step);
  return [from, ...within.filter((t) => t > from && t < until), until];
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

// The cubic f(u) = u'^2 (4,9), its roots, and the top as a point that runs between two of them.

/** f(u) from its product form, with the factor a (u - u3), which without torque is a constant. */
function cubicOf({ start, record, gaps }) {
  return (u) => (u - record.u1) * (u - record.u2) * (start.a * (u - 1) - gaps.aU3Above);
}

/** The range of u to show: the band of the motion, and u3 where it is near. */
function shownRange({ u1, u2, u3 }) {
  const band = u1 - u2;
  const near = u3 !== null && u3 - u1 <= Math.max(4 * band, band ? 0 : 2);
  const width = (near ? u3 : u1) - u2 || 0.4;
  return { low: u2 - 0.5 * width, high: u2 + 1.5 * width, near };
}

/** Draw the cubic; returns where the top is on it at a tilt, if it is on it at all. */
export function drawCubic(canvas, look, motion) {
  const { context, width, height } = prepared(canvas);
  if (motion.facts.vertical) {
    const why = "the axis is vertical: the tilt does not change";
    write(context, why, [width / 2, height / 2], look.quiet);
    return () => null;
  }
  const f = cubicOf(motion);
  const { low, high, near } = shownRange(motion.record);
  const us = even(low, high, 240);
  const { u1, u2, u3 } = motion.record;
  const inside = us.filter((u) => u >= u2 && u <= (near ? u3 : u1)).map((u) => Math.abs(f(u)));
  const most = 1.35 * (Math.max(0, ...inside) || Math.max(...us.map((u) => Math.abs(f(u)))) || 1);
  const box = { left: 14, right: width - 14, top: 12, bottom: height - 32, foot: height - 8 };
  const chart = chartOf(box, [low, high], [-most, most]);
  drawField(context, look, chart, motion.record);
  drawNumbers(context, look, chart, "u = cos ϑ", width / 70);
  context.save();
  context.beginPath();
  context.rect(0, box.top, width, box.bottom - box.top);
  context.clip();
  stroke(context, us.map((u) => [chart.x(u), chart.y(f(u))]), { colour: look.blue, width: 1.8 });
  context.restore();
  drawRoots(context, look, chart, motion.record, near);
  return (theta) => {
    const u = Math.min(Math.max(Math.cos(theta), u2), u1);
    return [chart.x(u), chart.y(Math.max(f(u), 0))];
  };
}

/** Draw the band of the motion, the axis f = 0 and the poles u = 1 and u = -1. */
function drawField(context, look, { x, y, x0, x1, left, right, top, bottom }, { u1, u2 }) {
  context.fillStyle = look.faint;
  context.fillRect(x(u2), top, x(u1) - x(u2), bottom - top);
  stroke(context, [[left, y(0)], [right, y(0)]], { colour: look.quiet });
  for (const pole of [-1, 1].filter((u) => u >= x0 && u <= x1)) {
    stroke(context, [[x(pole), top], [x(pole), bottom]], { colour: look.quiet, dash: [4, 3] });
  }
}

/** Draw the roots with their names; u3 may be out of sight on the right. */
function drawRoots(context, look, { x, y, right, top }, { u1, u2, u3 }, near) {
  const double = u1 - u2 < 1e-12;
  const roots = double
    ? [["u₁ = u₂", u1, 0, 14]] : [["u₂", u2, -13, -11], ["u₁", u1, 13, -11]];
  if (near) roots.push(["u₃", u3, 13, 13]);
  else if (u3 !== null) {
    const far = `u₃ = ${tickText(u3, 1e-4 * Math.abs(u3))} →`;
    write(context, far, [right, top + 8], look.ink, { size: 12, align: "right" });
  }
  for (const [name, u, across, down] of roots) {
    dot(context, [x(u), y(0)], 4, look.ink);
    write(context, name, [x(u) + across, y(0) + down], look.ink, { size: 13 });
  }
}
