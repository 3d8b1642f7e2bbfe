// The motion in words, and the record of the scene: its numbers under the keys of `lagtop solve`.

import { DESCRIPTIONS, KEYS } from "../data.js";
import { textOf } from "../drawing/canvas.js";

/** Fill the table; numbers to ten digits, units by their names in `units`. */
export function showRecord(table, record, units) {
  const rows = [];
  let last = "";
  for (const [name, key] of Object.entries(KEYS)) {
    const value = record[name];
    if (typeof value !== "number") continue;
    if (key.group !== last) rows.push(rowOf([["th", key.group]]));
    last = key.group;
    const shown = Number.isNaN(value)
      ? "ask lagtop solve" : `${textOf(value)} ${named(key.unit, units)}`;
    rows.push(rowOf([["th", key.symbol], ["td", key.meaning], ["td", shown]], explained(name, key)));
  }
  table.tBodies[0].replaceChildren(...rows);
}

/** Symbol, meaning, formula, equation and name of a key, as in `lagtop explain`. */
function explained(name, { symbol, meaning, formula, equation }) {
  const equal = formula.includes(" = ") && !formula.includes("where") ? "" : `${symbol} = `;
  return `${symbol}, ${meaning}: ${equal}${formula}  ${equation}  (key ${name})`;
}

/** A unit such as `rad/time` with the names of mass, len and time in `units`. */
function named(unit, units) {
  return unit === "angle" ? "°" : unit.replace(/[a-z]+/g, (word) => units[word] ?? word);
}

/** The unit of an input, and nothing if it is any consistent one. */
export function unitText(unit, units) {
  const text = named(unit, units);
  return text === unit && !unit.startsWith("rad") ? "" : text;
}

function rowOf(cells, title = "") {
  const row = document.createElement("tr");
  row.title = title;
  row.append(...cells.map(([kind, text]) => {
    const cell = document.createElement(kind);
    cell.textContent = text;
    return cell;
  }));
  row.firstChild.scope = title ? "row" : "rowgroup";
  if (title) row.tabIndex = 0;
  else row.firstChild.colSpan = 3;
  return row;
}

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
  const description = DESCRIPTIONS[kind ? `${record.regime}, ${kind}` : record.regime];
  const [, title, text] = /^(.*?): (.*)$/.exec(description);
  const numbers = {
    lambda: start.b * start.b / (2 * start.a),
    nutation: record.theta_max_deg - record.theta_min_deg,
  };
  return [title, text.replace(/\{(\w+)\}/g, (_, name) => textOf(numbers[name], 3))];
}
