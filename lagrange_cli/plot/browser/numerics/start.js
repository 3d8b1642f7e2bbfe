// The start of a scene of nine inputs, which scenes the page computes, and the regime of a motion.
// Every degenerate motion is a polynomial in cos(theta0) that vanishes; it is evaluated in 32
// digits, and counts as 0 if nothing but rounding remains.

import { INPUTS, LIMITS } from "../data.js";
import { pair, sineOfDegrees, vanishes } from "./pair.js";

const RANGES = {
  positive: "from 1e-30 to 1e30",
  "not negative": "0, or from 1e-30 to 1e30",
  any: "0, or from 1e-30 to 1e30 in size",
};

/** Raise an error that names the input, its range and the value that is out of range. */
export function checkScene(scene) {
  for (const [name, { sign }] of Object.entries(INPUTS)) {
    const x = scene[name];
    const size = sign === "any" ? Math.abs(x) : x;
    const inside = LIMITS.least <= size && size <= LIMITS.largest;
    const known = name === "theta0_deg" || inside || (x === 0 && sign !== "positive");
    if (!known) throw new RangeError(`${name} must be ${RANGES[sign]}, got ${x}`);
  }
  const { A, C, theta0_deg: tilt, psidot0 } = scene;
  if (C > 2 * A) {
    throw new RangeError(`C must be at most 2A = ${2 * A}, got ${C}`);
  }
  const near = Math.min(tilt, 180 - tilt);
  if (!(near === 0 || near >= LIMITS.tilt)) {
    throw new RangeError(`theta0_deg must be 0, 180, or 1e-12 to 180 - 1e-12, got ${tilt}`);
  }
  if (near === 0 && psidot0 !== 0) {
    throw new RangeError(
      `psidot0 must be 0 where the axis is vertical, got ${psidot0} (count it as spin)`);
  }
}

/** The constants of the motion and the state at t = 0, in 32 digits. */
export function startOf(scene) {
  const { m, A, C, s, g, r0, theta0_deg: tilt, thetadot0, psidot0 } = scene;
  const a = pair(m).times(g).times(s).times(2).over(A);  // (4,4)
  const b = pair(C).times(r0).over(A);                   // (4,5)
  const nearer = sineOfDegrees(pair(Math.min(tilt, 180 - tilt)).over(2));
  const farther = pair(1).minus(nearer.squared()).sqrt();
  const [sinHalf, cosHalf] = tilt > 90 ? [farther, nearer] : [nearer, farther];
  return {
    a, b, r0: pair(r0), thetaRate: pair(thetadot0), psiRate: pair(psidot0),
    pole: tilt === 0 ? 1 : tilt === 180 ? -1 : 0,
    sinHalf, cosHalf,
    sin: sinHalf.times(cosHalf).times(2),
    cos: sineOfDegrees(pair(90).minus(tilt)),
    below: cosHalf.squared().times(2),   // 1 + cos
    above: sinHalf.squared().times(2),   // 1 - cos
    sleep: b.squared().over(2).minus(a),
    spinDrift: pair(r0).minus(b.over(2)),
    poleDrift: pair(r0).minus(b),
  };
}

/** The sign of a sum of terms; 0 where they cancel. */
function signOf(...terms) {
  const sum = terms.reduce((x, y) => x.plus(y), pair(0));
  const size = Math.max(...terms.map((term) => Math.abs(term)));
  return vanishes(sum, size) ? 0 : sum.sign();
}

/** The facts of a motion; see `lagrange_cli/motion/regime.py`. */
export function factsOf(start) {
  const { a, b, thetaRate, psiRate, pole, cos, below, above } = start;
  const still = !+thetaRate;
  const vertical = pole !== 0 && still;
  // beta - b = (1 - u) (psi' (1 + u) - b) and beta + b = (1 + u) (psi' (1 - u) + b) (4,5)
  const minus = pole === 1 ? 0 : signOf(psiRate.times(below), b.negative());
  const plus = pole === -1 ? 0 : signOf(psiRate.times(above), b);
  // where beta = b, 1 is a root, and alpha - a = theta'^2 - (1 - u) (a - psi' b) says which
  const over = minus ? 0 : signOf(
    thetaRate.squared(), above.times(a).negative(), above.times(psiRate).times(b));
  // u'' = 0 at rest: 2 b psi' - a - 2 u psi'^2
  const level = signOf(
    b.times(psiRate).times(2), a.negative(), cos.times(psiRate.squared()).times(-2));
  const steady = still && (vertical || level === 0);
  const separatrix = !minus && !over && +a !== 0 && !vertical;
  const onTop = !minus && !vertical && !separatrix;
  const facts = {
    atRest: still && !+psiRate,
    steady,
    free: +a === 0,
    spins: +b !== 0,
    pole,
    separatrix,
    upperRoot: !onTop ? 0 : over < 0 ? 3 : steady ? 0 : 1,
    overBottom: !plus && !steady,
    signPlus: plus || 1,
    signMinus: minus || 1,
    stable: +start.sleep >= 0,
    cusp: standsAtU1(start, minus),
    plane: !plus && !steady && !+b,
    fast: still && !+psiRate && b * b >= 50 * a,
  };
  const turnsOver = facts.plane && facts.upperRoot === 1;
  return { ...facts, vertical, turns_over: turnsOver, regime: regimeOf(facts, vertical) };
}

/** Whether the precession stands still at u1: beta/b is a root of the cubic, and not u3. */
function standsAtU1({ a, b, psiRate, thetaRate, sin }, minus) {
  const around = psiRate.times(sin.squared());
  return minus * b < 0 && signOf(
    around.times(b).times(psiRate), around.times(a).negative(), b.times(thetaRate.squared())) === 0;
}

function regimeOf(facts, vertical) {
  if (vertical) return facts.pole > 0 ? "sleeping" : "hanging";
  if (facts.free) return "torque-free";
  if (facts.separatrix) return "separatrix";
  if (facts.steady) return "steady precession";
  return facts.spins ? "regular" : "no spin";
}
