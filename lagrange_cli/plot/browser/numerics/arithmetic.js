// Numbers of 32 digits, unevaluated sums of two doubles (Dekker 1971), and elliptic integrals.
//
// Everything that is computed once per scene is computed with them, so that differences of nearly
// equal numbers, next to a pole or to the separatrix, keep more digits than the screen can show.
// The incomplete integral of a place in the period is a double.  Every loop adds and multiplies
// positive numbers only.  It also ends at NaN, because no comparison with NaN is true.

/** The exact sum of two doubles, as the nearest double and what it lacks. */
function twoSum(x, y) {
  const sum = x + y;
  const back = sum - x;
  return [sum, (x - (sum - back)) + (y - back)];
}

/** A double as the sum of two halves of 26 bits, whose products are exact. */
function split(x) {
  const shifted = 134217729 * x;  // 2^27 + 1
  const high = shifted - (shifted - x);
  return [high, x - high];
}

/** The exact product of two doubles, as the nearest double and what it lacks. */
function twoProduct(x, y) {
  const product = x * y;
  const [a, b] = split(x);
  const [c, d] = split(y);
  return [product, ((a * c - product) + a * d + b * c) + b * d];
}

/** A number of 32 digits.  Its methods take such numbers, or doubles. */
class Pair {
  constructor(high, low = 0) {
    this.high = high + low;
    this.low = low - (this.high - high);
  }

  plus(other) {
    const y = pair(other);
    const [high, lost] = twoSum(this.high, y.high);
    const [low, rest] = twoSum(this.low, y.low);
    const sum = new Pair(high, lost + low);
    return new Pair(sum.high, sum.low + rest);
  }

  minus(other) {
    return this.plus(pair(other).negative());
  }

  times(other) {
    const y = pair(other);
    const [high, lost] = twoProduct(this.high, y.high);
    return new Pair(high, lost + (this.high * y.low + this.low * y.high));
  }

  over(other) {
    const y = pair(other);
    const first = this.high / y.high;
    const rest = this.minus(y.times(first));
    const second = rest.high / y.high;
    const third = rest.minus(y.times(second)).high / y.high;
    return new Pair(first, second).plus(third);
  }

  negative() {
    return new Pair(-this.high, -this.low);
  }

  size() {
    return this.high < 0 ? this.negative() : this;
  }

  squared() {
    return this.times(this);
  }

  sqrt() {
    if (!(this.high > 0)) {
      return new Pair(Math.sqrt(this.high));
    }
    const root = Math.sqrt(this.high);
    const rest = this.minus(new Pair(root).squared());
    return new Pair(root, rest.high / (2 * root));
  }

  valueOf() {
    return this.high;  // so that pairs can be compared, and stand where a double will do
  }
}

export function pair(x) {
  return x instanceof Pair ? x : new Pair(x);
}

export const PI = new Pair(3.141592653589793, 1.2246467991473532e-16);

/** The sine of an angle up to a right angle, in degrees, by its power series. */
export function sineOfDegrees(degrees) {
  const angle = pair(degrees).times(PI).over(180);
  const square = angle.squared();
  let term = angle;
  let sum = angle;
  for (let n = 2; Math.abs(term) > 1e-34 * Math.abs(sum); n += 2) {
    term = term.times(square).over(-n * (n + 1));
    sum = sum.plus(term);
  }
  return sum;
}

const CLOSE = 1e-17;  // the mean of two numbers as close as that is their arithmetic-geometric mean

/** The arithmetic-geometric mean of two positive numbers (DLMF 19.8.1). */
function agm(x, y) {
  let [a, b] = [pair(x), pair(y)];
  while (Math.abs(a.minus(b)) > CLOSE * a) {
    [a, b] = [a.plus(b).over(2), a.times(b).sqrt()];
  }
  return a.plus(b).over(2);
}

/** The quarter period K = F(pi/2, k), from the complement k' of the modulus (DLMF 19.8.5). */
export function completeK(kPrime) {
  return PI.over(agm(1, kPrime).times(2));
}

/** The mean over a period of (a cn^2 + b sn^2)/(cn^2 + p sn^2), Bulirsch's cel over K. */
export function periodMean(kPrime, p, a, b) {
  let [mean, geometric, root] = [pair(1), kPrime, p.sqrt()];
  let [first, second] = [a, b.over(root)];
  for (let close = false; !close;) {
    const product = mean.times(geometric);
    const quotient = product.over(root);
    [first, second] = [
      first.plus(second.over(root)).over(2),
      second.plus(first.times(quotient)).over(2),
    ];
    root = root.plus(quotient).over(2);
    close = !(Math.abs(mean.minus(geometric)) > CLOSE * mean);
    [mean, geometric] = [mean.plus(geometric).over(2), product.sqrt()];
  }
  return first.times(mean).plus(second).over(mean.plus(root));
}

/**
 * The integral of the first kind whose sn^2 : cn^2 is s2 : c2, where the complement of the modulus
 * has the square mc: Carlson's R_F by duplication (DLMF 19.36.1), until its series will do.
 */
export function firstKind(s2, c2, mc) {
  const [sn2, cn2] = [s2 / (+s2 + +c2), c2 / (+s2 + +c2)];
  let all = [cn2, cn2 + mc * sn2, 1];
  for (let turn = 0; turn < 100; turn += 1) {
    const mean = (all[0] + all[1] + all[2]) / 3;
    const [x, y, z] = all.map((number) => 1 - number / mean);
    if (Math.max(Math.abs(x), Math.abs(y), Math.abs(z)) < 1e-4) {
      return Math.sqrt(sn2 / mean) * (1 - (x * y - z * z) / 10 + x * y * z / 14);
    }
    const [r, s, t] = all.map(Math.sqrt);
    all = all.map((number) => (number + r * s + s * t + t * r) / 4);
  }
  throw new RangeError("an integral does not converge: ask lagtop solve");
}
