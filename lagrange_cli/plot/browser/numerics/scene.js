// What is given: the nine inputs of lagtop, their ranges, and the exact start they describe.

import { pair, sineOfDegrees } from "./pair.js";

/** The inputs by key: symbol, meaning and whether each must be positive, or not negative. */
export const INPUTS = {
  m: { symbol: "m", meaning: "mass", least: "positive" },
  A: { symbol: "A", meaning: "equatorial moment (pivot)", least: "positive" },
  C: { symbol: "C", meaning: "polar moment, at most 2A", least: "positive" },
  s: { symbol: "s", meaning: "pivot to centre of mass", least: "zero" },
  g: { symbol: "g", meaning: "gravity", least: "zero" },
  r0: { symbol: "r₀", meaning: "total rate about the axis" },
  theta0_deg: { symbol: "ϑ₀", meaning: "tilt at the start (°)" },
  thetadot0: { symbol: "ϑ̇₀", meaning: "nutation rate at start" },
  psidot0: { symbol: "ψ̇₀", meaning: "precession rate at start" },
};

/** Sizes that the page computes with: others would leave the range of doubles on the way. */
const LARGEST = 1e30;
const LEAST_TILT = 1e-12;

/** Raise an error that names the input, its range and what was given. */
export function checkScene(scene) {
  for (const [name, input] of Object.entries(INPUTS)) {
    const x = scene[name];
    const must = (fine, range) => {
      if (!fine) throw new RangeError(`${name} must be ${range}, got ${x}`);
    };
    must(Number.isFinite(x), "a number");
    must(Math.abs(x) <= LARGEST, "at most 1e30 in size");
    must(input.least !== "positive" || x >= 1 / LARGEST, "at least 1e-30");
    must(input.least !== "zero" || x >= 0, "at least 0");
  }
  checkStart(scene);
}

function checkStart({ A, C, theta0_deg: tilt, psidot0 }) {
  if (C > 2 * A) {
    throw new RangeError(`C must be at most 2A = ${2 * A}, got ${C}`);
  }
  const near = Math.min(tilt, 180 - tilt);
  if (!(near === 0 || near >= LEAST_TILT)) {
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
