// Elliptic integrals of numbers of 32 digits, by the arithmetic-geometric mean and by duplication.
// Every loop adds and multiplies positive numbers only.

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

/** Carlson's R_F(x, y, z) by duplication (DLMF 19.36.1), until two terms of its series will do. */
function carlsonRF(x, y, z) {
  let all = [pair(x), pair(y), pair(z)];
  for (;;) {
    const mean = all[0].plus(all[1]).plus(all[2]).over(3);
    const [dx, dy] = all.map((number) => pair(1).minus(number.over(mean)));
    if (Math.max(Math.abs(dx), Math.abs(dy)) < 1e-9) {
      const e2 = dx.times(dy).minus(dx.plus(dy).squared());
      return pair(1).minus(e2.over(10)).over(mean.sqrt());
    }
    const [r, s, t] = all.map((number) => number.sqrt());
    const shift = r.times(s).plus(s.times(t)).plus(t.times(r));
    all = all.map((number) => number.plus(shift).over(4));
  }
}

/**
 * The integral of the first kind whose sn^2 : cn^2 is s2 : c2, where the complement of the modulus
 * has the square mc.
 */
export function firstKind(s2, c2, mc) {
  const whole = s2.plus(c2);
  const [sn2, cn2] = [s2.over(whole), c2.over(whole)];
  return sn2.sqrt().times(carlsonRF(cn2, cn2.plus(mc.times(sn2)), 1));
}
