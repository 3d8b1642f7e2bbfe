// The times at which curves are drawn: even in the amplitude of the nutation, so that cusps stay
// sharp, and even in time for a top that waits; with more of them where the axis is fast.

import { firstKind } from "../numerics/integrals.js";
import { frameOf } from "./camera.js";

const PHASES = 40;  // samples per half period
const MOST = 6000;  // samples of a window
const STEP = 0.15;  // the longest way of the axis between two samples, in radians

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

function even(from, until, count) {
  return [...Array(count + 1).keys()].map((i) => from + (until - from) * i / count);
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
