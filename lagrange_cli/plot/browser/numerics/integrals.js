// Elliptic integrals: the complete ones, which times and rates are multiplied with, in 32 digits,
// and those of places on the way in doubles.  Every loop adds and multiplies positive numbers only,
// and ends at NaN as well, which no comparison finds larger.

import { pair, PI } from "./pair.js";

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
