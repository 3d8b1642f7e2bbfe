// The start of a scene of nine inputs, which scenes the page computes, the regime of a motion, and
// the roots of its cubic.
// In every degenerate motion a polynomial in cos(theta0) vanishes.  It is evaluated in 32 digits,
// and counts as 0 if nothing but rounding remains.

import { INPUTS, LIMITS } from "../data.js";
import { pair, sineOfDegrees } from "./arithmetic.js";

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

/** The sign of a sum of terms; 0 if they cancel up to rounding. */
function signOf(...terms) {
  const sum = +terms.reduce((x, y) => x.plus(y));
  const size = Math.max(...terms.map((term) => Math.abs(term)));
  return Math.abs(sum) <= 2 ** -96 * size ? 0 : Math.sign(sum);
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

// The cubic f(u) = u'^2 (4,9): its roots u2 <= u1 <= 1 <= u3, as distances from the start, from
// each other and from the poles.  Gaps to u3 carry the factor a, so that they stay finite without
// torque.  See `lagrange_cli/motion/gaps.py`.

const NEAR = 1e-3;  // how near a root is to a pole where differences give way to products

/** The gaps of a start: with x = u - u0 the cubic is a x^3 + c2 x^2 + c1 x + c0. */
export function gapsOf(start, facts) {
  const { a, b, above, below, psiRate } = start;
  const { far, x1, x2 } = rootsFromStart(start, facts);
  const touches = facts.upperRoot || facts.separatrix;
  const gaps = {
    u1FromStart: x1,
    startFromU2: x2.negative(),
    band: x1.minus(x2),
    belowU1: below.plus(x1),
    belowU2: below.plus(x2),
    aboveU1: above.minus(x1),
    aboveU2: above.minus(x2),
    aU3FromU1: far.minus(a.times(x1)),
    aU3FromU2: far.minus(a.times(x2)),
    aU3Above: far.minus(a.times(above)),
    betaPlusB: facts.overBottom ? pair(0) : below.times(psiRate.times(above).plus(b)),
    betaMinusB: touches ? pair(0) : above.times(psiRate.times(below).minus(b)),
  };
  if (!facts.separatrix && !facts.steady) {
    nextToPoles(a, gaps);
    if (gaps.aU3FromU1 < NEAR * a) nextToSeparatrix(start, gaps);
  }
  return withMomenta(start, facts, gaps);
}

/**
 * Gaps next to a pole, which differences would spoil, from the values of the cubic there:
 * a (u3 - 1) (1 - u1) (1 - u2) = (beta - b)^2 and a (1 + u3) (1 + u1) (1 + u2) = (beta + b)^2.
 */
function nextToPoles(a, gaps) {
  const { aboveU1, aboveU2, aU3Above, belowU1, belowU2, betaPlusB, betaMinusB } = gaps;
  const [up, down] = [betaMinusB.squared(), betaPlusB.squared()];
  if (+up && aboveU1 < NEAR && a * aboveU1 < +aU3Above) {
    gaps.aboveU1 = up.over(aU3Above.times(aboveU2));
  } else if (+up && aU3Above < NEAR * a) {
    gaps.aU3Above = up.over(aboveU1.times(aboveU2));
  }
  if (+down && belowU2 < NEAR) {
    gaps.belowU2 = down.over(aU3Above.plus(a.times(2)).times(belowU1));
  }
}

/**
 * Gaps next to the separatrix, where u1 and u3 both come close to 1: a (u3 - 1) and -a (1 - u1)
 * are the roots of a quadratic equation, whose sum follows from the slope of the cubic at 1.
 */
function nextToSeparatrix({ a, b, sin, above, psiRate, thetaRate }, gaps) {
  const { betaMinusB, aboveU2 } = gaps;
  const energy = thetaRate.squared().plus(psiRate.times(sin).squared());
  const slope = energy.minus(a.times(above)).minus(b.times(betaMinusB)).times(2);
  const product = betaMinusB.squared().over(aboveU2);  // a (u3 - 1) (1 - u1)
  const sum = slope.minus(product).over(aboveU2);      // a (u3 - 1) - a (1 - u1)
  const [up, down] = twoRoots(sum, product.times(a).negative());
  gaps.aU3Above = up;
  gaps.aboveU1 = down.negative().over(a);
  gaps.aU3FromU1 = up.minus(down);
  gaps.u1FromStart = above.minus(gaps.aboveU1);
}

/** Adds beta - b u1 and beta - b u2, counted from the start or from the pole that is nearer. */
function withMomenta({ b, sin, psiRate }, facts, gaps) {
  const momentum = psiRate.times(sin.squared());
  const stands = facts.cusp || facts.upperRoot === 1 || facts.separatrix;
  const atU1 = gaps.aboveU1 < +gaps.u1FromStart
    ? gaps.betaMinusB.plus(b.times(gaps.aboveU1)) : momentum.minus(b.times(gaps.u1FromStart));
  const atU2 = gaps.belowU2 < +gaps.startFromU2
    ? gaps.betaPlusB.minus(b.times(gaps.belowU2)) : momentum.plus(b.times(gaps.startFromU2));
  return {
    ...gaps,
    momentumU1: stands ? pair(0) : atU1,
    momentumU2: facts.overBottom ? pair(0) : atU2,
  };
}

/** a (u3 - u0), u1 - u0 and u2 - u0; a root that is exactly on a pole is put there. */
function rootsFromStart({ a, b, sin, cos, above, below, psiRate, thetaRate }, facts) {
  const around = psiRate.times(sin);
  const energy = thetaRate.squared().plus(around.squared());
  const c0 = sin.times(thetaRate).squared();
  const c1 = b.times(around).times(sin).times(2)
    .minus(a.times(sin.squared())).minus(cos.times(energy).times(2));
  const c2 = a.times(cos).times(2).minus(energy).minus(b.squared());
  let far;
  if (facts.separatrix || facts.upperRoot === 3) far = a.times(above);
  else if (facts.steady) far = c2.negative();
  else {
    const bound = energy.plus(b.squared()).plus(a.times(2));
    far = largestRoot(c2, a.times(c1), a.squared().times(c0), bound);
  }
  let [x1, x2] = [pair(0), pair(0)];
  if (facts.separatrix) [x1, x2] = [above, c0.over(far.times(above)).negative()];
  else if (!facts.steady) {
    [x1, x2] = twoRoots(c1.plus(a.times(c0).over(far)).over(far), c0.over(far).negative());
  }
  return {
    far,
    x1: facts.upperRoot === 1 ? above : x1,
    x2: facts.overBottom ? below.negative() : x2,
  };
}

/** The roots x1 >= 0 >= x2 of x^2 - total x + product, for product <= 0. */
function twoRoots(total, product) {
  const spread = total.squared().minus(product.times(4)).sqrt();
  const larger = total.size().plus(spread).over(2);
  const smaller = product.negative().over(larger);
  return total >= 0 ? [larger, smaller.negative()] : [smaller, larger.negative()];
}

/** The largest root of x^3 + c2 x^2 + c1 x + c0 by Newton's method, which falls from a bound. */
function largestRoot(c2, c1, c0, bound) {
  let x = bound;
  for (let i = 0; i < 500; i += 1) {
    const slope = x.times(3).plus(c2.times(2)).times(x).plus(c1);
    const value = x.plus(c2).times(x).plus(c1).times(x).plus(c0);
    const next = x.minus(value.over(slope));
    if (!(next.minus(x) < 0)) return x;
    x = next;
  }
  return x;
}

/** Raise an error where 32 digits do not tell the roots apart that are not exactly one. */
export function checkRoots(facts, gaps) {
  if (facts.steady) return;
  const zeros = {
    band: false,
    aboveU1: facts.upperRoot === 1 || facts.separatrix,
    belowU2: facts.overBottom,
    aU3FromU1: facts.separatrix,
    aU3Above: facts.upperRoot === 3 || facts.separatrix,
  };
  for (const [name, zero] of Object.entries(zeros)) {
    if (!zero && !(gaps[name] > 0)) {
      throw new RangeError("32 digits do not tell the roots apart: ask lagtop solve");
    }
  }
}
