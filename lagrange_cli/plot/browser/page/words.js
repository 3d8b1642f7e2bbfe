// The motion in words.

import { DESCRIPTIONS } from "../data.js";

/** A title and one or two sentences on a motion. */
export function wordsOf({ facts, record, start }) {
  const fast = facts.atRest && start.b * start.b >= 50 * start.a;
  const kinds = {
    sleeping: facts.stable ? "stable" : "unstable",
    "torque-free": facts.steady && "steady",
    "no spin": facts.overBottom && "plane",
    regular: fast ? "fast" : record.path ?? "wavy",
  };
  const kind = kinds[record.regime];
  const [title, text] = DESCRIPTIONS[kind ? `${record.regime}, ${kind}` : record.regime];
  const numbers = {
    lambda: start.b * start.b / (2 * start.a),
    nutation: record.theta_max_deg - record.theta_min_deg,
  };
  return [title, text.replace(/\{(\w+)\}/g, (_, name) => shortly(numbers[name]))];
}

/** A number to three digits, for a sentence. */
function shortly(x) {
  return x.toPrecision(3).replace(/\.?0+(e|$)/, "$1").replace("e+", "e").replace("-", "−");
}
