// Round numbers along an axis.

/** At most `most` round numbers `x` from `low` to `high`, each with its `text`. */
export function ticksBetween(low, high, most) {
  const rough = (high - low) / Math.max(most, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((x) => x * power).find((x) => x >= rough * (1 - 1e-9));
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  if (!(last - first < 100)) return [];
  const numbers = [...Array(last - first + 1).keys()].map((i) => (first + i) * step);
  return numbers.map((x) => ({ x, text: tickText(x, step) }));
}

/** A tick as text, with as many digits as tell it from its neighbours. */
export function tickText(x, step) {
  if (x === 0) return "0";
  const digits = Math.max(1, Math.ceil(Math.log10(Math.abs(x) / step)) + 1);
  const short = Number(x.toPrecision(Math.min(digits, 16)));
  const plain = Math.abs(short) < 1e6 && Math.abs(short) >= 1e-4;
  return (plain ? `${short}` : short.toExponential()).replace("e+", "e").replace("-", "−");
}
