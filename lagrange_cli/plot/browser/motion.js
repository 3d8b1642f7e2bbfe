// The motion of one top in plain doubles: one nutation by Runge-Kutta, all other times by its period.
// Equation numbers are Chrapan's.

const STEPS = 2500;  // steps of half a nutation, at least
const DEGREE = 180 / Math.PI;

/** Slope of p, q (rates in the frame that does not spin) and of its quaternion w, x, y, z. */
function slope([p, q, w, x, y, z], a, b) {
  const [dp, dq] = [a * (y * z + w * x) - b * q, b * p - a * (x * z - w * y)];
  return [dp, dq, (-x * p - y * q) / 2, (w * p - z * q) / 2, (w * q + z * p) / 2, (x * q - y * p) / 2];
}

/** The state after one step of the classical Runge-Kutta method. */
function step(state, h, a, b) {
  const after = (part, k) => slope(state.map((value, i) => value + part * k[i]), a, b);
  const k1 = slope(state, a, b);
  const k2 = after(h / 2, k1);
  const k3 = after(h / 2, k2);
  const k4 = after(h, k3);
  return state.map((value, i) => value + (h / 6) * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]));
}

/** An angle plus the whole turns that bring it nearest to another angle. */
const near = (angle, other) => angle + 2 * Math.PI * Math.round((other - angle) / (2 * Math.PI));

/** Tilt, and plus, minus = (psi ± phi)/2 without the spin, next to those of the state before. */
function halves([, , w, x, y, z], last) {
  const [up, side] = [Math.hypot(w, z), Math.hypot(x, y)];
  return {
    theta: 2 * Math.atan2(side, up),
    plus: up > 1e-9 ? near(Math.atan2(z, w), last.plus) : last.plus,
    minus: side > 1e-9 ? near(Math.atan2(y, x), last.minus) : last.minus,
  };
}

/** Carlson's integral R_F by duplication. */
function carlsonF(x, y, z) {
  const mean = (x + y + z) / 3;
  const apart = Math.max(...[x, y, z].map((each) => Math.abs(1 - each / mean)));
  if (!(apart >= 1e-8)) return 1 / Math.sqrt(mean);
  const [p, q, r] = [x, y, z].map(Math.sqrt);
  const shift = p * q + p * r + q * r;
  return carlsonF((x + shift) / 4, (y + shift) / 4, (z + shift) / 4);
}

/** The cubic (4,9) about the start: u1 - u0, u0 - u2, 1 - u1, u3 - u1 and a (u3 - u2), without cancellation. */
function cubicOf({ a, b, u0, above, sin, swing, along, rise }) {
  const c1 = 2 * (b * along - u0 * swing) - a * sin * sin;
  const isTop = !rise && c1 <= 0;  // the start is the highest point
  let leading = swing + b * b;  // a (u3 - u0)
  const [p, q, r] = [2 * u0 - leading / a, c1 / a, rise / a];
  const radius = Math.sqrt(Math.max(p * p - 3 * q, 0)) / 3;
  const ratio = ((p * q) / 6 - (p / 3) ** 3 - r / 2) / radius ** 3 || 0;
  const third = Math.acos(Math.max(-1, Math.min(1, ratio))) / 3;
  function root(turn) {  // Viète's, polished by Newton's method
    let x = 2 * radius * Math.cos(third + turn) - p / 3;
    for (let i = 0; i < 3; i += 1) x -= (((x + p) * x + q) * x + r) / ((3 * x + 2 * p) * x + q) || 0;
    return x;
  }
  const isNear = a && ratio < 0;  // u1 is next to u3, so that only u2 has all digits
  let [toTop, fromLow] = [0, isNear ? Math.max(-root((2 * Math.PI) / 3), 0) : 0];
  if (!isNear) {
    if (a) leading = a * root(0);
    const product = rise / leading || 0;  // (u1 - u0)(u0 - u2)
    const half = (c1 + a * product) / (2 * leading) || 0;  // half their difference
    const larger = Math.abs(half) + Math.sqrt(half * half + product);
    const smaller = product / larger || 0;
    [toTop, fromLow] = half > 0 ? [larger, smaller] : [smaller, larger];
  }
  if (!a) return { toTop, fromLow, gap: Math.max(above - toTop, 0), wide: leading };
  // (1 - u1)(u3 - 1) and (u3 - 1) - (1 - u1) keep their digits next to the separatrix
  const [beside, excess] = [(along - b * above) ** 2 / (a * (above + fromLow)) || 0, fromLow - p - 2 * above];
  let far = Math.sqrt(excess * excess + 4 * beside);
  let gap = excess > 0 ? (2 * beside) / (excess + far) || 0 : (far - excess) / 2;
  if (isTop) [gap, far] = [above, Math.max(above + excess, 0) + above];
  else if (isNear) {
    toTop = Math.max(above - gap, 0);
    if (rise && toTop < fromLow) toTop = rise / (a * fromLow * (far + toTop)) || 0;
  }
  return { toTop, fromLow, gap, far, wide: a * (far + toTop + fromLow) };
}

/** The motion of a scene: its numbers, `angles(t)` in radians, and whether it is only a sketch. */
export function motionOf(scene) {
  const { m, A, C, s, g, r0, theta0_deg: tilt, thetadot0, psidot0 } = scene;
  const [a, b, half] = [(2 * m * g * s) / A, (C * r0) / A, (tilt * Math.PI) / 360];
  const sin = tilt === 180 ? 0 : Math.sin(2 * half);
  const u0 = Math.cos(2 * half);
  const swing = thetadot0 ** 2 + (psidot0 * sin) ** 2;
  const along = psidot0 * sin * sin;
  const [alpha, beta] = [swing + a * u0, along + b * u0];
  const rise = (thetadot0 * sin) ** 2;
  const isVertical = !sin && !thetadot0;
  const above = 2 * Math.sin(half) ** 2;
  const { toTop, fromLow, gap, far, wide } = cubicOf({ a, b, u0, above, sin, swing, along, rise });
  const [u1, u2, band] = [1 - gap, u0 - fromLow, toTop + fromLow];
  const usual = (2 * Math.PI) / (Math.sqrt(a) + Math.abs(b) + Math.sqrt(swing) || Math.abs(r0) || 1);
  const kPrime = a ? Math.sqrt((a * far) / wide) : 1;
  const isPeriodic = !isVertical && wide > 0 && kPrime > 1e-8;
  const period = isPeriodic ? (4 * carlsonF(0, kPrime ** 2, 1)) / Math.sqrt(wide) : null;
  const span = period ?? 20 * usual;
  const count = Math.min(Math.max(STEPS, Math.ceil((100 * span) / usual)), 100000);
  const h = span / 2 / count;

  // From the highest point down, where errors do not grow; it rises as it falls.
  const [across, sinTop] = [beta - b * u1, Math.sqrt(gap * (2 - gap))];
  let first = Math.sqrt(Math.max(alpha - a * u1, 0)) * (Math.sign(across) || 1);
  if (sinTop > 1e-6) first = toTop ? across / sinTop : psidot0 * sin;
  const top = [0, first, Math.sqrt(1 - gap / 2), Math.sqrt(gap / 2), 0, 0];
  const start = [thetadot0, psidot0 * sin, Math.cos(half), Math.sin(half), 0, 0];
  const states = [period ? top : start];
  const places = [halves(states[0], { plus: 0, minus: 0 })];
  function grow() {
    for (let i = 0; i <= count; i += 1) {
      states.push(step(states.at(-1), h, a, b));
      places.push(halves(states.at(-1), places.at(-1)));
    }
  }
  grow();
  function fromTop(time) {
    while (time > h * (states.length - 1) && states.length < 1e6) grow();
    const i = Math.min(Math.floor(time / h), states.length - 1);
    return halves(step(states[i], time - i * h, a, b), places[i]);
  }
  const [before, after] = [0.4, 0.6].map((part) => fromTop(part * span));  // not at the vertical
  const gain = { plus: before.plus + after.plus, minus: before.minus + after.minus };
  let since = 0;
  if (period && rise) {
    const [x, y] = a ? [far, far + toTop] : [1, 1];
    since = (2 * Math.sqrt(toTop) * carlsonF(fromLow * x, band * y, band * x)) / Math.sqrt(a || wide);
    since = Math.min(since || 0, period / 2);
  } else if (period && toTop > band / 2) since = period / 2;
  if (thetadot0 < 0) since = -since;
  function place(t) {
    if (!period) return isVertical ? places[0] : fromTop(t);
    const turns = Math.round((t + since) / period);
    const rest = t + since - turns * period;
    const { theta, plus, minus } = fromTop(Math.abs(rest));
    const sign = rest < 0 ? -1 : 1;
    return { theta, plus: sign * plus + turns * gain.plus, minus: sign * minus + turns * gain.minus };
  }
  const zero = period ? place(0) : places[0];
  if (period && tilt === 0) zero.minus = (Math.sign(first) * Math.PI) / 2;  // limits after the start
  if (period && tilt === 180) {
    const [, , w, , , z] = slope(states[count], a, b);
    zero.plus = gain.plus - Math.atan2(-z, -w);
  }
  function angles(t) {
    const { theta, plus, minus } = place(Math.max(t, 0));
    const [p, q] = [plus - zero.plus, minus - zero.minus];
    return { theta, phi: p - q + r0 * t, psi: p + q };
  }
  const degrees = (u) => DEGREE * Math.acos(Math.max(-1, Math.min(1, u)));
  const spin = isVertical ? r0 : period && (gain.plus - gain.minus) / span + r0;
  const turn = period && (gain.plus + gain.minus) / span;
  const turnTime = (rate) => (rate ? (2 * Math.PI) / Math.abs(rate) : null);
  const away = (degree) => Math.min(degree, 180 - degree);
  const most = Math.max(away(degrees(u1)), away(degrees(u2)), away(tilt));
  const k = Math.sqrt(1 - kPrime ** 2);
  const isNear = (tilt && away(tilt) < 0.03) || most < 0.05;
  const [high, low, isSwinging] = isVertical ? [u0, u0, false] : [u1, u2, Boolean(a)];
  const constant = isVertical || band < 1e-7;  // a double root has half of the digits
  function factsOf() {
    const [atTop, atLow] = [beta - b * u1, beta - b * u2];  // as the precession there
    const plane = !r0 && !beta;
    const curved = atTop * atLow < 0 ? "looping" : "wavy";
    let regime = period || constant ? "regular" : "separatrix";
    if (isVertical) regime = tilt ? "hanging" : "sleeping";
    return {
      regime, constant, plane, spin: r0, spins: r0 !== 0, stable: b * b >= 2 * a,
      turns_over: plane && gap === 0 && toTop > 0,
      precesses: Math.abs(turn) > 1e-9 * Math.sqrt(wide),
      path: constant || plane ? null : Math.abs(atTop) < 1e-9 * Math.abs(atLow) ? "cusped" : curved,
    };
  }
  return {
    scene,
    angles,
    span,
    isSketch: Boolean(!isVertical && (isNear || (a && 1 - k < 5e-8))),
    f: (u) => (alpha - a * u) * (1 - u * u) - (beta - b * u) ** 2,
    facts: factsOf(),
    record: {
      a, b, u1: high, u2: low, u3: isSwinging ? u1 + far : null, k: isSwinging ? k : null,
      T_nutation: period, T_spin: turnTime(spin), T_precession: turnTime(turn),
      theta_min_deg: isVertical ? tilt : 2 * DEGREE * Math.asin(Math.sqrt(gap / 2)),
      theta_max_deg: isVertical ? tilt : degrees(u2),
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
