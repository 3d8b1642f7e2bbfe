// From a motion to its angles at any time: the mean rates in 32 digits, and theta series about a
// turning point in doubles.  A far time costs no more than a near one, and is as exact.
//
// X = cos(theta/2) exp(i (psi + phi)/2) goes as theta2(x - i s+ y+) and
// Y = sin(theta/2) exp(i (psi - phi)/2) as theta1(x - i s- y-), with x = pi t/T counted from a
// passage of u1.  While K <= K' the series run in the nome q; beyond, Jacobi's imaginary
// transformation gives series in q' = exp(-pi K/K').  The nome in use is at most exp(-pi): four
// terms are enough for doubles.  See `lagrange_cli/motion/over_time/theta_series.py`.

import { firstKind, pair, PI } from "./arithmetic.js";

const TURN = PI.times(2);
const TERMS = 4;
const indices = [...Array(TERMS).keys()];

/**
 * The series about u1 and about u2, each with X and Y as sums of cosines and sines of multiples of
 * the argument z, which grows by `scale` per half period; and how far they wind per half period.
 */
function thetaSeries(motion) {
  const { gaps, m, kPrime, K, KPrime, facts } = motion;
  // the parameters of X and Y: eta with sn^2(eta, k') : cn^2(eta, k') as these, and K' - eta
  const plus = place(gaps.belowU2, gaps.band, m);
  const minus = place(gaps.aboveU1.times(gaps.aU3FromU2), gaps.aU3Above.times(gaps.band), m);
  const sizeX = Math.sqrt(gaps.belowU1 / 2);
  const sizeY = Math.sqrt(kPrime * gaps.aboveU2 / 2);
  const sizes = [[plus, sizeX, facts.signPlus], [minus, sizeY, facts.signMinus]];
  if (KPrime !== null && K > KPrime) return hyperbolicSeries(sizes, K, KPrime);
  const nome = KPrime === null ? 0 : Math.exp(-Math.PI * KPrime / K);
  return circularSeries(sizes, K, nome);
}

function place(s2, c2, m) {
  return { eta: firstKind(s2, c2, m), rest: m > 0 ? firstKind(c2, m * s2, m) : null };
}

/** Series in q (2,2), (2,3), which wind by half a turn, up or down, per period. */
function circularSeries(sizes, K, nome) {
  const weights = indices.map((n) => nome ** (n * (n + 1)));
  const components = sizes.map(([{ eta }, size, sign]) => {
    const y = Math.PI / 2 * eta / K;
    const [cosh, sinh] = [Math.cosh, Math.sinh].map((f) => indices.map((n) => f((2 * n + 1) * y)));
    const theta2 = component(1, weights, cosh, sign, sinh);
    const theta1 = component(1, alternate(weights), sinh, sign, cosh);
    return normalised(size, theta2, theta1);
  });
  const [slopeX, slopeY] = sizes.map((size) => -size[2] * Math.PI / 2);
  return series(components, false, Math.PI / 2, slopeX, slopeY);
}

/** Series in q' after Jacobi's transformation, whose exponent is linear in the time. */
function hyperbolicSeries(sizes, K, KPrime) {
  const nome = Math.exp(-Math.PI * K / KPrime);
  const even = alternate(indices.map((n) => (n ? 2 : 1) * nome ** (n * n)));
  const odd = alternate(indices.map((n) => 2 * nome ** (n * (n + 1) + 0.25)));
  const slopes = [];
  const components = sizes.map(([{ eta, rest }, size, sign]) => {
    const angle = Math.PI / 2 * eta / KPrime;
    const complement = Math.PI / 2 * rest / KPrime;
    const [cos, sin] = multiples(Math.sin(complement), Math.sin(angle));
    const [cosEven, sinEven, cosOdd, sinOdd] = [0, 1].flatMap((first) => (
      [cos, sin].map((all) => all.filter((_, n) => n % 2 === first))));
    slopes.push(-sign * complement);
    const theta4 = component(0, even, cosEven, -sign, sinEven);
    const theta1 = component(1, odd, sinOdd, sign, cosOdd);
    return normalised(size, theta4, theta1);
  });
  return series(components, true, Math.PI / 2 * K / KPrime, ...slopes);
}

/** Cosines and sines of 0, 1, 2 ... times an angle; all keep the digits of its cosine and sine. */
function multiples(cosine, sine) {
  const [cos, sin] = [[1], [0]];
  for (let n = 1; n < 2 * TERMS; n += 1) {
    cos.push(cos[n - 1] * cosine - sin[n - 1] * sine);
    sin.push(sin[n - 1] * cosine + cos[n - 1] * sine);
  }
  return [cos, sin];
}

/** The real part sum re_n cos((2n + first) z), the imaginary part sum im_n sin((2n + first) z). */
function component(first, weights, real, sign, imaginary) {
  return {
    first,
    real: weights.map((weight, n) => weight * real[n]),
    imaginary: weights.map((weight, n) => sign * weight * imaginary[n]),
  };
}

/** Components in a unit in which the first one is `size` at z = 0. */
function normalised(size, ...components) {
  const unit = size / components[0].real.reduce((x, y) => x + y, 0);
  return components.map(({ first, real, imaginary }) => (
    { first, real: real.map((x) => unit * x), imaginary: imaginary.map((x) => unit * x) }));
}

/** Half a period turns theta2 into theta1 and back. */
function series([x, y], hyperbolic, scale, slopeX, slopeY) {
  return {
    hyperbolic,
    scale: +scale,
    frames: [{ x: x[0], y: y[1] }, { x: x[1], y: y[0] }],
    spinSlope: slopeX - slopeY,
    precessionSlope: slopeX + slopeY,
  };
}

function alternate(terms) {
  return terms.map((term, n) => (n % 2 ? -term : term));
}

/** Size and argument of X and of Y at a phase from -1/2 to 1/2 half periods about a frame. */
function evaluate({ hyperbolic, scale, frames }, frame, phase, rises) {
  const z = phase * scale;
  const [sin, cos] = hyperbolic ? [Math.sinh(z), Math.cosh(z)] : [Math.sin(z), Math.cos(z)];
  const twice = hyperbolic ? 2 + 4 * sin * sin : 2 - 4 * sin * sin;  // 2 cos 2z
  const { x, y } = frames[frame];
  return { x: polar(x, sin, cos, twice, -rises), y: polar(y, sin, cos, twice, rises) };
}

/** Size and argument of one component; on a pole, where it is 0, the argument just beside. */
function polar({ first, real, imaginary }, sin, cos, twice, side) {
  // the first two cosines and sines; the others by cos(n + 2) = 2 cos 2z cos n - cos(n - 2)
  let [c, cBefore] = first ? [cos, cos] : [1, twice / 2];
  let [s, sBefore] = first ? [sin, -sin] : [0, -2 * sin * cos];
  let [re, im] = [0, 0];
  for (let n = 0; n < TERMS; n += 1) {
    re += real[n] * c;
    im += imaginary[n] * s;
    [c, cBefore] = [twice * c - cBefore, c];
    [s, sBefore] = [twice * s - sBefore, s];
  }
  const direction = re || im ? im : side * imaginary[0];
  return { size: Math.hypot(re, im), argument: Math.atan2(direction, re) };
}

/** Half periods from the nearest passage of u1 to t = 0, with the sign of the nutation rate. */
export function offsetOf(start, gaps, kPrime, K) {
  if (!(gaps.u1FromStart > 0)) return 0;
  if (!(gaps.startFromU2 > 0)) return 1;
  // sn^2 w = (u1 - u)(u3 - u2)/((u3 - u)(u1 - u2)) (4,22)
  const w = firstKind(
    gaps.u1FromStart.times(gaps.aU3FromU2), gaps.aU3FromU1.times(gaps.startFromU2),
    kPrime.squared());
  return w / K * (start.thetaRate < 0 ? -1 : 1);
}

/** An angle without whole turns, in (-pi, pi]. */
function within(angle) {
  return +angle.minus(TURN.times(Math.round(angle.over(TURN))));
}

/** Tilt, spin and precession, from uniform turns and their periodic parts (6,4), (7,4). */
function anglesAt(theta, spin, precession, dphi = 0, dpsi = 0) {
  const [phi, psi] = [spin.plus(dphi), precession.plus(dpsi)];
  return {
    theta, phi: +phi, psi: +psi, phiWithin: within(phi), psiWithin: within(psi), dphi, dpsi,
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
    const theta = 2 * Math.atan2(y.size, x.size);
    return anglesAt(theta, spinRate.times(t), precessionRate.times(t), dphi, dpsi);
  };
}

/** A tilt that stays, with constant rates. */
export function constantSampler({ start, spinRate, precessionRate }) {
  const theta = 2 * Math.atan2(start.sinHalf, start.cosHalf);
  return (t) => anglesAt(theta, spinRate.times(t), precessionRate.times(t));
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
    return anglesAt(theta, start.spinDrift.times(t), rate.times(t), turned, turned);
  };
}
