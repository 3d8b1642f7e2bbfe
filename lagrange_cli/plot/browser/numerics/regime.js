// What kind of motion a start describes.  Every degenerate motion is a polynomial in cos(theta0)
// that vanishes; it is evaluated in 32 digits, and counts as 0 where nothing but rounding is left.

import { pair, vanishes } from "./pair.js";

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
  };
  return { ...facts, vertical, regime: regimeOf(facts, vertical) };
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
