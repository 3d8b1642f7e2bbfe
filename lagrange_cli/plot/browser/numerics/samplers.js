// From a motion to its angles at any time: the mean rates in 32 digits, and a short series.  A
// time far away costs what a near one costs, and is as exact.

import { PI, pair } from "./pair.js";
import { evaluate, thetaSeries } from "./series.js";

const TURN = PI.times(2);

/** An angle that has grown so much, and on: whole, and without whole turns in (-pi, pi]. */
function grown(growth, rest) {
  const angle = growth.plus(rest);
  return { whole: +angle, within: +angle.minus(TURN.times(Math.round(angle.over(TURN)))) };
}

/** Angles of a motion at t: tilt, spin and precession, and their periodic parts (6,4), (7,4). */
function anglesAt(theta, spin, precession, dphi = 0, dpsi = 0) {
  return {
    theta, phi: spin.whole, psi: precession.whole,
    phiWithin: spin.within, psiWithin: precession.within, dphi, dpsi,
  };
}

/** A tilt that swings between two turning points, by theta series (6,1), (7,1). */
export function nutatingSampler(motion) {
  const { period, spinRate, precessionRate, start, offset } = motion;
  const series = thetaSeries(motion);
  const first = Math.round(offset);
  const sinceFirst = offset - first;
  const stepsPerTime = pair(2).over(period);
  const rises = start.thetaRate < 0 ? -1 : 1;
  const at = (steps, phase) => evaluate(series, Math.abs(first + steps) % 2, phase, rises);
  const beginning = at(0, sinceFirst);
  return (t) => {
    const passed = stepsPerTime.times(t).plus(sinceFirst);
    const steps = Math.round(passed);
    const phase = +passed.minus(steps);
    const { x, y } = at(steps, phase);
    const plus = x.argument - beginning.x.argument;
    const minus = y.argument - beginning.y.argument;
    const since = phase - sinceFirst;
    const dphi = t === 0 ? 0 : plus - minus + since * series.spinSlope;
    const dpsi = t === 0 ? 0 : plus + minus + since * series.precessionSlope;
    const spin = grown(spinRate.times(t), dphi);
    const precession = grown(precessionRate.times(t), dpsi);
    return anglesAt(2 * Math.atan2(y.size, x.size), spin, precession, dphi, dpsi);
  };
}

/** A tilt that stays, with constant rates. */
export function constantSampler({ start, spinRate, precessionRate }) {
  const theta = 2 * Math.atan2(start.sinHalf, start.cosHalf);
  return (t) => anglesAt(theta, grown(spinRate.times(t), 0), grown(precessionRate.times(t), 0));
}

/** The swing up in infinite time: 1 - u = (1 - u2)/cosh^2 h, h = speed t + offset. */
export function separatrixSampler({ start, gaps, argumentRate }) {
  const [rises, sign] = [start.thetaRate < 0 ? -1 : 1, start.b < 0 ? -1 : 1];
  const offset = -rises * Math.asinh(Math.sqrt(gaps.startFromU2.over(gaps.u1FromStart)));
  const [x, y] = [Math.sqrt(gaps.belowU2 / 2), Math.sqrt(gaps.aboveU2 / 2)];
  const turnedAt = (tangent) => Math.atan2(sign * y * tangent, x);
  const beginning = turnedAt(offset || x ? Math.tanh(offset) : -rises);
  const rate = start.b.over(2);
  return (t) => {
    const h = +argumentRate.times(t).plus(offset);
    const tangent = Math.tanh(h);
    const theta = 2 * Math.atan2(y / Math.cosh(h), Math.hypot(x, y * tangent));
    const turned = t === 0 ? 0 : turnedAt(tangent) - beginning;
    const spin = grown(start.spinDrift.times(t), turned);
    return anglesAt(theta, spin, grown(rate.times(t), turned), turned, turned);
  };
}
