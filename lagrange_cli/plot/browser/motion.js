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

/** The roots of (4,9) by distances without cancellation: u1 - u0, u0 - u2, 1 - u1, 1 - u2, u3 - 1, u3 - u1.
 *
 * `loss` bounds the relative error of u1 - u2 and u3 - u1.
 */
function rootsOf({ a, b, u0, above, sin, swing, along, rise, N, turning }) {
  const [p, q, r] = [2 * u0 - (swing + b * b) / a, (2 * (b * along - u0 * swing)) / a - sin * sin, rise / a];
  const radius = Math.sqrt(Math.max(p * p - 3 * q, 0)) / 3;
  const ratio = ((p * q) / 6 - (p / 3) ** 3 - r / 2) / radius ** 3 || 0;
  const isNear = ratio < 0;  // u1 is next to u3, so that only u2 has all digits
  const angle = Math.acos(clamped(ratio, -1, 1)) / 3 + (isNear ? (2 * Math.PI) / 3 : 0);
  let root = 2 * radius * Math.cos(angle) - p / 3;  // Viète's, polished by Newton's method
  for (let i = 0; i < 3; i += 1) root -= (((root + p) * root + q) * root + r) / ((3 * root + 2 * p) * root + q) || 0;
  const half = (q + r / root) / (2 * root);
  let [toTop, fromLow] = isNear ? [0, Math.max(-root, 0)] : pairOf(half, r / root);
  if (turning > 0) toTop = 0;
  if (turning < 0) fromLow = 0;
  const low = above + fromLow;
  const product = N ** 2 / (a * low) || 0;  // of 1 - u1 and u3 - 1
  const middle = (2 * ((swing - b * N) / a - above) - product) / low;
  const [beyond, top] = pairOf(middle / 2, product);
  const gap = beyond + top;
  if (isNear && turning <= 0) toTop = top < above / 2 ? above - top : rise / (a * fromLow * (above + beyond));
  const [size, wide] = [(2 * Math.abs(b * along) + 2 * Math.abs(u0 * swing)) / a + sin * sin, toTop + fromLow];
  const sizeOfGap = (2 * (swing + Math.abs(b * N))) / a + 2 * above + product;
  const loss = 1e-15 * Math.max(isNear ? 0 : size / Math.abs(root * wide) || 0, sizeOfGap / (low * gap) || 0);
  return { toTop, fromLow, top: turning > 0 ? above : top, low, beyond, gap, loss };
}

/** The sign of the sum of the products of `constant`, and of x times those of `slope`; NaN if doubles leave it open.
 *
 * All products have the same number of factors.  An x of `quarters` / 4 is exact.
 */
function signOf(constant, slope, x, quarters) {
  const total = (products, part) => products.reduce((sum, product) => sum + part(product.reduce((y, z) => y * z)), 0);
  const value = total(constant, Number) + x * total(slope, Number);
  const size = total(constant, Math.abs) + total(slope, Math.abs);
  if (Math.abs(value) > 1e-14 * size || !size) return Math.sign(value);
  const whole = (y) => BigInt(y * 2 ** 200);  // inputs are at least 1e-30
  const exact = (products) => products.reduce((sum, product) => sum + product.map(whole).reduce((y, z) => y * z), 0n);
  const [p, q] = [exact(constant), exact(slope)];
  if (q && quarters === null) return NaN;  // no polynomial with such coefficients is 0 at an irrational cosine
  return Math.sign(Number(4n * p + BigInt(quarters ?? 0) * q));
}

/** The signs of the polynomials that decide the motion, as in `solver/facts.py`. */
function signsOf({ m, A, C, s, g, r0, theta0_deg: tilt, thetadot0, psidot0 }, u0) {
  const level = tilt % 60 && tilt % 90 ? null : Math.round(4 * u0);
  const squared = tilt % 30 && tilt % 45 ? null : Math.round(4 * u0 * u0);
  const [pole, torque, spin] = [{ 0: 1, 180: -1 }[tilt] ?? 0, [2 * m, g, s], [C, r0]];
  const minus = pole > 0 ? 0 : signOf([[A, psidot0], [-C, r0]], [[A, psidot0]], u0, level);
  const plus = pole < 0 ? 0 : signOf([[A, psidot0], [C, r0]], [[-A, psidot0]], u0, level);
  const over = minus || (pole && !thetadot0) ? 1 : signOf(
    [[A, thetadot0, thetadot0], [-2 * m, g, s], [psidot0, ...spin]], [torque, [-psidot0, ...spin]], u0, level,
  );
  const start = () => signOf([torque, [-2 * psidot0, ...spin]], [[2 * A, psidot0, psidot0]], u0, level);
  const fall = thetadot0 ? 1 : pole ? 0 : start();
  const turns = [[psidot0, psidot0, ...spin, ...spin], [-2 * m, g, s, psidot0, ...spin]];
  const stop = signOf(  // of f at beta/b, where the precession stops
    [[thetadot0, thetadot0, ...spin, ...spin], ...turns], turns.map(([x, ...rest]) => [-x, ...rest]), u0 * u0, squared,
  );
  const stable = signOf([[...spin, ...spin], [-4 * A, m, g, s]], [], 0, null) >= 0;
  return { pole, minus, plus, over, fall, stop, stable };
}

/** The kind of motion, as `Facts` of the solver decides it. */
function factsOf(scene, u0) {
  const { m, g, s, r0, thetadot0, psidot0 } = scene;
  const { pole, minus, plus, over, stop, stable, ...signs } = signsOf(scene, u0);
  const fall = scene.steady ? 0 : signs.fall;
  const steady = !fall;
  const vertical = pole !== 0 && steady;
  const separatrix = Boolean(m * g * s) && !minus && !over && !vertical;
  const overTop = !steady && !separatrix && !minus && over >= 0;
  const overBottom = !plus && !steady;
  const plane = overBottom && !r0;
  const stops = minus * plus < 0;  // |beta| < |b|
  let path = stops && stop > 0 ? "looping" : "wavy";
  if ((!thetadot0 && !psidot0) || (stops && !stop && !separatrix)) path = "cusped";
  const isOpen = [minus, plus, over, fall, r0 ? stop : 0].some(Number.isNaN);
  return {
    ...{ vertical, steady, separatrix, overTop, overBottom, plane, stable, isOpen, minus, plus },
    path: plane || steady ? null : path,
    turning: pole || (thetadot0 ? 0 : fall),
  };
}

/** The mean precession by the midpoint rule over the amplitude, and a bound of its relative error. */
function meanPrecession({ toTop, fromLow, top, foot, gap, along, b }) {
  const band = toTop + fromLow;
  function meanOf(n) {
    let [sum, size, weights] = [0, 0, 0];
    for (let j = 0; j < n; j += 1) {
      const x = (Math.PI * (j + 0.5)) / (2 * n);
      const [s2, c2] = [Math.sin(x) ** 2, Math.cos(x) ** 2];
      const weight = 1 / Math.sqrt(gap + band * s2);
      const slowed = weight / ((top + band * s2) * (foot + band * c2));  // psi' = (beta - b u)/(1 - u^2)
      sum += slowed * (along + b * (fromLow * s2 - toTop * c2));
      size += slowed * (Math.abs(along) + Math.abs(b) * (fromLow * s2 + toTop * c2));
      weights += weight;
    }
    return [sum / weights, size / weights];
  }
  const [[mean, size], [coarse]] = [meanOf(64), meanOf(32)];
  return { mean, loss: (Math.abs(mean - coarse) + 1e-15 * size) / Math.abs(mean) };
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

/** The motion of a scene: its numbers, `angles(t)` in radians, and why it is only a sketch, if it is. */
export function motionOf(scene) {
  const { m, A, C, s, g, r0, theta0_deg: tilt, thetadot0, psidot0 } = scene;
  const [torque, b, half] = [(2 * m * g * s) / A, (C * r0) / A, (tilt * Math.PI) / 360];
  const ownSpin = (r0 * (A - C)) / A;  // r0 - b
  const isRight = tilt % 60 === 0 || tilt % 90 === 0;
  const u0 = isRight ? Math.round(2 * Math.cos(2 * half)) / 2 : Math.cos(2 * half);
  const sin = tilt === 180 ? 0 : Math.sin(2 * half);
  const facts = factsOf(scene, u0);
  const { vertical, steady, separatrix, turning } = facts;
  const [above, up] = [2 * Math.sin(half) ** 2, tilt === 180 ? 0 : 2 * Math.cos(half) ** 2];  // 1 -+ u0
  const along = psidot0 * sin * sin;
  const swing = thetadot0 ** 2 + psidot0 * along;
  const rise = (thetadot0 * sin) ** 2;
  const isStill = vertical || !(torque || b || swing);
  const a = torque || 1e-16 * (swing + b * b) || 1;  // hardly any torque instead of none
  const N = facts.minus ? along - b * above : 0;  // beta - b
  const S = facts.plus ? along + b * up : 0;  // beta + b
  const found = rootsOf({ a, b, u0, above, sin, swing, along, rise, N, turning });
  const [toTop, fromLow] = steady ? [0, 0] : [found.toTop, found.fromLow];
  const { beyond, loss } = found;
  const [top, low] = [steady ? above : found.top, above + fromLow];
  const gap = beyond + top;
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
    return { theta, phi: p - q + ownSpin * t, psi: p + q };
  }

  const period = isStill || separatrix ? null : cycle;
  const sum = { mean: plusRate + minusRate, loss: 0 };
  sum.loss = (1e-14 * (Math.abs(plusRate) + Math.abs(minusRate))) / Math.abs(sum.mean);
  const other = meanPrecession({ toTop, fromLow, top, foot, gap, along, b });
  const turn = sum.loss < other.loss || period === null || facts.overTop || facts.overBottom ? sum : other;
  const isIdle = isStill && !vertical;
  // Without torque the sum or the difference of both rates is 0; over both poles each is one turn per period.
  const isFree = !torque && !facts.overTop && !facts.overBottom;
  const loops = isFree && facts.minus * facts.plus < 0;
  const alike = (isFree && !loops) || (facts.overTop && facts.overBottom);
  const turns = isIdle || loops ? 0 : period && turn.mean;
  const spin = vertical ? r0 : isIdle ? 0 : period && (alike ? 0 : plusRate - minusRate) + ownSpin;
  const spinSize = Math.abs(plusRate) + Math.abs(minusRate) + Math.abs(r0) + Math.abs(b);
  const turnTime = (rate) => (rate ? (2 * Math.PI) / Math.abs(rate) : null);
  const tiltOf = (down, upward) => 2 * DEGREE * Math.atan2(Math.sqrt(down), Math.sqrt(upward));
  const least = turning > 0 || steady ? tilt : tiltOf(top, high);
  const greatest = turning < 0 || steady ? tilt : tiltOf(low, foot);
  const fromVertical = Math.min(tilt, 180 - tilt);
  const k = Math.sqrt(m0);
  const usual = (2 * Math.PI) / (Math.sqrt(torque) + Math.abs(b) + Math.sqrt(swing) || 1);
  const isLost = (sum, ...terms) => sum && terms.some((each) => Math.abs(each) > 1e7 * Math.abs(sum));
  const doubts = {
    "the axis starts next to the vertical": fromVertical > 0 && fromVertical < 1e-3,
    "the axis passes next to the vertical": isLost(N, along, b * above) || isLost(S, along, b * up),
    "the motion is next to the separatrix": torque > 0 && 1 - k < 5e-8,
    "double precision does not decide the path": facts.isOpen,
    "the nutation is lost in double precision": !steady && (loss > 1e-8 || greatest - least < 1e-12 * greatest),
    "the mean precession is lost in double precision": period && !loops && !(turn.loss < 1e-8),
    "the mean spin is lost in double precision": period && !alike && 1e-15 * spinSize > 1e-8 * Math.abs(spin),
    "the spin is too fast for double precision": period && Math.abs(r0) * period > 1e7,
  };
  let regime = separatrix ? "separatrix" : "regular";
  if (vertical) regime = tilt ? "hanging" : "sleeping";
  return {
    angles,
    span: period ?? 20 * usual,
    doubt: isStill ? undefined : Object.keys(doubts).find((each) => doubts[each]),
    facts: {
      regime, constant: steady, plane: facts.plane, spin: r0, spins: r0 !== 0, stable: facts.stable,
      turns_over: facts.plane && facts.overTop, precesses: turns !== 0, path: facts.path,
    },
    record: {
      a: torque, b, u1: vertical ? u0 : 1 - top, u2: vertical ? u0 : 1 - low,
      u3: !vertical && torque > 0 ? 1 + beyond : null, k: vertical ? null : steady || !torque ? 0 : k,
      T_nutation: period, T_spin: turnTime(spin), T_precession: turnTime(turns),
      theta_min_deg: least, theta_max_deg: greatest,
      mean_spin_rate: spin, mean_precession_rate: turns,
      ...(tilt === 0 && torque > 0
        ? { stability_factor: (b * b) / (2 * torque), r0_sleeping: (2 * Math.sqrt(A * m * g * s)) / C } : {}),
    },
  };
}

/** A number with so many digits, as printf writes it with %#g. */
function figures(x, digits) {
  const rest = Math.abs(x).toPrecision(100).replace(/e.*|[.]/g, "").replace(/^0+/, "").slice(digits);
  const isTie = /^50*$/.test(rest);  // JavaScript rounds a tie up, C and Python to an even digit
  let [mantissa, power] = x.toExponential(digits - 1).split("e");
  if (isTie && Number(mantissa.at(-1)) % 2) mantissa = `${mantissa.slice(0, -1)}${Number(mantissa.at(-1)) - 1}`;
  if (power >= -4 && power < digits) return Number(`${mantissa}e${power}`).toFixed(digits - 1 - power);
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
