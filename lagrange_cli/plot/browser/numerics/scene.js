// The start of a scene of nine inputs, and which scenes the page computes.

import { INPUTS, LIMITS } from "../data.js";
import { pair, sineOfDegrees } from "./pair.js";

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
