// The motion of one top in closed form, in plain doubles.  Equation numbers are Chrapan's.
// The two halves of the quaternion are quotients of theta functions (Klein and Sommerfeld).

const DEGREE = 180 / Math.PI;
const clamped = (x, least, most) => Math.min(Math.max(x, least), most);

/** Carlson's integral R_F by duplication. */
function carlsonF(x, y, z) {
  const mean = (x + y + z) / 3;
  const apart = Math.max(...[x, y, z].map((each) => Math.abs(1 - each / mean)));
  if (!(apart >= 1e-8)) return 1 / Math.sqrt(mean);
  const [p, q, r] = [x, y, z].map(Math.sqrt);
  const shift = p * q + p * r + q * r;
  return carlsonF((x + shift) / 4, (y + shift) / 4, (z + shift) / 4);
}

/** Legendre's integral F of the first kind, from the squares of sn, cn and dn. */
const legendreF = (sn2, cn2, dn2) => Math.sqrt(sn2) * carlsonF(cn2, dn2, 1);

/** The two numbers x, y >= 0 with x - y = 2 half and this product. */
function pairOf(half, product) {
  const greater = Math.abs(half) + Math.sqrt(half * half + product);
  const pair = [greater, product / greater || 0];
  return half < 0 ? pair.reverse() : pair;
}

/** The roots of (4,9) by distances without cancellation: u1 - u0, u0 - u2, 1 - u1, 1 - u2, u3 - 1, u3 - u1. */
function rootsOf({ a, b, u0, above, sin, swing, along, rise, N }) {
  const [p, q, r] = [2 * u0 - (swing + b * b) / a, (2 * (b * along - u0 * swing)) / a - sin * sin, rise / a];
  const radius = Math.sqrt(Math.max(p * p - 3 * q, 0)) / 3;
  const ratio = ((p * q) / 6 - (p / 3) ** 3 - r / 2) / radius ** 3 || 0;
  const isNear = ratio < 0;  // u1 is next to u3, so that only u2 has all digits
  const angle = Math.acos(clamped(ratio, -1, 1)) / 3 + (isNear ? (2 * Math.PI) / 3 : 0);
  let root = 2 * radius * Math.cos(angle) - p / 3;  // Viète's, polished by Newton's method
  for (let i = 0; i < 3; i += 1) root -= (((root + p) * root + q) * root + r) / ((3 * root + 2 * p) * root + q) || 0;
  let [toTop, fromLow] = isNear ? [0, Math.max(-root, 0)] : pairOf((q + r / root) / (2 * root), r / root);
  const low = above + fromLow;
  const [beyond, top] = pairOf((fromLow - p) / 2 - above, N ** 2 / (a * low) || 0);
  const gap = beyond + top;
  if (isNear) {
    toTop = Math.max(above - top, 0);
    if (toTop < fromLow) toTop = rise / (a * fromLow * (gap + toTop));
  }
  return { toTop, fromLow, top, low, beyond, gap };
}

/** The half of the quaternion with a zero at these sn^2, cn^2, dn^2: its size and its angle without the mean rate. */
function halfOf(squares, quarter, nome) {
  const [p, terms] = [Math.exp((-Math.PI * legendreF(...squares)) / quarter), []];
  for (let [n, up, down] = [0, p, 1]; down > 1e-18; n += 1) {
    terms.push([n, up, down]);
    [up, down] = [up * p * nome ** (2 * n + 2), (down / p) * nome ** (2 * n + 2)];
  }
  const total = (term) => terms.reduce((sum, each) => sum + term(...each), 0);
  const whole = total((n, up, down) => up + down);
  function at(x) {
    const real = total((n, up, down) => up * Math.cos((2 * n + 2) * x) + down * Math.cos(2 * n * x));
    const other = total((n, up, down) => up * Math.sin((2 * n + 2) * x) - down * Math.sin(2 * n * x));
    return [Math.hypot(real, other) / whole, Math.atan2(other, real)];
  }
  return { at, slope: 1 - total((n, up, down) => (2 * n + 1) * (down - up)) / whole };
}

/** The motion of a scene: its numbers, `angles(t)` in radians, and whether it is only a sketch. */
export function motionOf(scene) {
  const { m, A, C, s, g, r0, theta0_deg: tilt, thetadot0, psidot0 } = scene;
  const [torque, b, half] = [(2 * m * g * s) / A, (C * r0) / A, (tilt * Math.PI) / 360];
  const [u0, sin] = [Math.cos(2 * half), tilt === 180 ? 0 : Math.sin(2 * half)];
  const [above, up] = [2 * Math.sin(half) ** 2, tilt === 180 ? 0 : 2 * Math.cos(half) ** 2];  // 1 -+ u0
  const along = psidot0 * sin * sin;
  const swing = thetadot0 ** 2 + psidot0 * along;
  const rise = (thetadot0 * sin) ** 2;
  const isVertical = !sin && !thetadot0;
  const isStill = isVertical || !(torque || b || swing);
  const a = torque || 1e-16 * (swing + b * b) || 1;  // hardly any torque instead of none
  const [N, S] = [along - b * above, along + b * up];  // beta - b, beta + b
  const { toTop, fromLow, top, low, beyond, gap } = rootsOf({ a, b, u0, above, sin, swing, along, rise, N });
  const [high, most] = [up + toTop, up + toTop + gap];  // 1 + u1, 1 + u3
  const foot = S ** 2 / (a * high * most);  // 1 + u2
  const band = Math.max(toTop + fromLow, 1e-30);
  const width = gap + band;
  const [m0, m1] = [band / width, Math.max(gap / width, 1e-30)];  // k^2, k'^2
  const quarter = carlsonF(0, m1, 1);
  const cycle = (4 * quarter) / Math.sqrt(a * width);  // (5,1)

  // The north counts from the lowest point and the south from the highest, where they are greatest.
  const nome = Math.exp((-Math.PI * carlsonF(0, m0, 1)) / quarter);
  const north = halfOf([(top * width) / (low * gap), (beyond * band) / (low * gap), band / low], quarter, nome);
  const south = halfOf([foot / high, band / high, (most * band) / (high * width)], quarter, nome);
  const [signN, signS] = [N < 0 ? -1 : 1, S < 0 ? -1 : 1];
  const minusRate = N / (2 * low) + (signN * north.slope * Math.PI) / cycle;
  const plusRate = S / (2 * high) + (signS * south.slope * Math.PI) / cycle;
  const start = legendreF(fromLow / band, toTop / band, (gap + toTop) / width) * (thetadot0 > 0 ? -1 : 1);
  function place(t) {
    const x = Math.PI * (start / (2 * quarter) + t / cycle);
    return [north.at(x), south.at(x - Math.PI / 2)];
  }
  // Angles at a pole are their limits, before it if the axis leaves 0 to 180 degrees through it.
  const [[, minus0], [, plus0]] = place((thetadot0 < 0 === tilt < 90 ? -1e-14 : 1e-14) * cycle);
  function angles(time) {
    const t = Math.max(time, 0);
    if (isStill || !t) return { theta: 2 * half, phi: r0 * t, psi: 0 };
    const [[side, minus], [upright, plus]] = place(t);
    const p = plusRate * t - signS * (plus - plus0);
    const q = minusRate * t - signN * (minus - minus0);
    const theta = 2 * Math.atan2(Math.sqrt(low * Math.sqrt(m1)) * side, Math.sqrt(high) * upright);
    return { theta, phi: p - q + (r0 - b) * t, psi: p + q };
  }

  const period = !isStill && m1 > 1e-16 ? cycle : null;
  const spin = isVertical ? r0 : period && plusRate - minusRate + r0 - b;
  const turn = period && plusRate + minusRate;
  const turnTime = (rate) => (rate ? (2 * Math.PI) / Math.abs(rate) : null);
  const tiltOf = (down, upward) => (isVertical ? tilt : 2 * DEGREE * Math.atan2(Math.sqrt(down), Math.sqrt(upward)));
  const fromVertical = Math.min(tilt, 180 - tilt);
  const isSwinging = !isVertical && torque > 0;
  const k = Math.sqrt(m0);
  const [atTop, atLow] = [N + b * top, N + b * low];  // beta - b u, as the precession
  const curved = atTop * atLow < 0 ? "looping" : "wavy";
  const constant = isStill || band < 1e-7;  // a double root has half of the digits
  const plane = !r0 && !along;
  const usual = (2 * Math.PI) / (Math.sqrt(torque) + Math.abs(b) + Math.sqrt(swing) || 1);
  let regime = period || constant ? "regular" : "separatrix";
  if (isVertical) regime = tilt ? "hanging" : "sleeping";
  return {
    scene,
    angles,
    span: period ?? 20 * usual,
    isSketch: !isVertical && ((fromVertical > 0 && fromVertical < 1e-3) || (torque > 0 && 1 - k < 5e-8)),
    facts: {
      regime, constant, plane, spin: r0, spins: r0 !== 0, stable: b * b >= 2 * torque,
      turns_over: plane && top === 0 && toTop > 0,
      precesses: Math.abs(turn) > 1e-9 * Math.sqrt(a * width),
      path: constant || plane ? null : Math.abs(atTop) < 1e-9 * Math.abs(atLow) ? "cusped" : curved,
    },
    record: {
      a: torque, b, u1: isVertical ? u0 : 1 - top, u2: isVertical ? u0 : u0 - fromLow,
      u3: isSwinging ? 1 + beyond : null, k: isSwinging && !constant ? k : null,
      T_nutation: period, T_spin: turnTime(spin), T_precession: turnTime(turn),
      theta_min_deg: tiltOf(top, high), theta_max_deg: tiltOf(low, foot),
      mean_spin_rate: spin, mean_precession_rate: turn,
    },
  };
}

/** A number in so many digits, as printf writes it with %#g. */
function figures(x, digits) {
  const [mantissa, power] = x.toExponential(digits - 1).split("e").map((part, i) => (i ? Number(part) : part));
  if (power >= -4 && power < digits) return x.toFixed(digits - 1 - power);
  return `${mantissa}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
}

/** The motion in one sentence by the table of `lagtop solve`; `unit` names the unit of time. */
export function sentence({ record, facts }, phrases, unit) {
  const { theta_min_deg: low, theta_max_deg: high, T_nutation: nutation, mean_precession_rate: turns } = record;
  let digits = 4;
  while (digits < 17 && figures(low, digits) === figures(high, digits)) digits += 1;
  const [least, most] = [low, high].map((x) => figures(x, digits));
  const words = { least, most, angle: "deg", unit };
  const numbers = { low, high, spin: facts.spin, turns, nutation };
  function part(_, name) {
    if (name in words) return words[name];
    if (name in numbers) return figures(numbers[name], 4);
    const all = { ...facts, unit };
    const isTrue = ([when]) => Object.entries(when).every(([fact, value]) => all[fact] === value);
    return phrases[name].find(isTrue)[1].replace(/\{(\w+)\}/g, part);
  }
  return part("", "sentence");
}
