// Numbers of 32 digits: unevaluated sums of two doubles (Dekker 1971).
//
// Everything that is computed once per scene is computed with them, so that differences of nearly
// equal numbers, next to a pole or to the separatrix, keep more digits than the screen can show.

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

  /** -1, 0 or 1. */
  sign() {
    return Math.sign(this.high);
  }

  valueOf() {
    return this.high;  // so that pairs can be compared, and stand where a double will do
  }
}

export function pair(x) {
  return x instanceof Pair ? x : new Pair(x);
}

export const PI = new Pair(3.141592653589793, 1.2246467991473532e-16);

/** Whether a sum is 0 but for the rounding of its terms, the greatest of which has this size. */
export function vanishes(sum, size) {
  return Math.abs(sum) <= 2 ** -96 * Math.abs(size);
}

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
