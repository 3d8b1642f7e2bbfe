// The motion in words, and the record of the scene: its numbers under the keys of `lagtop solve`.

import { KEYS, PHRASES } from "../data.js";
import { textOf } from "../drawing/canvas.js";

/** Fill the table; numbers to ten digits, units by their names in `units`. */
export function showRecord(table, record, units) {
  const rows = [];
  let last = "";
  for (const [name, key] of Object.entries(KEYS)) {
    const value = record[name];
    if (typeof value !== "number") continue;
    if (key.group !== last) rows.push(rowOf([key.group]));
    last = key.group;
    const shown = Number.isNaN(value)
      ? "ask lagtop solve" : `${textOf(value)} ${named(key.unit, units)}`;
    rows.push(rowOf([key.symbol, key.meaning, shown], explained(name, key)));
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

/** The units of a scene in words. */
export function unitsText({ mass = "mass", len, time }) {
  return mass === "mass" ? "in any consistent units" : `in ${mass}, ${len} and ${time}`;
}

/** A row of a key, which can be selected, or of a group of keys, with one cell. */
function rowOf([name, ...cells], title) {
  const row = document.createElement("tr");
  const first = document.createElement("th");
  Object.assign(first, title ? { scope: "row" } : { scope: "rowgroup", colSpan: 3 });
  first.textContent = name;
  row.append(first);
  for (const text of cells) row.insertCell().textContent = text;
  return Object.assign(row, title && { title, tabIndex: 0 });
}

/** The title of a motion and the sentence of `lagtop solve`. */
export function wordsOf({ facts, record, scene }, units) {
  const { theta_min_deg: low, theta_max_deg: high, mean_precession_rate: turns } = record;
  const unit = units.time ?? "time";
  const numbers = { low, high, turns, spin: scene.r0, nutation: record.T_nutation };
  const words = { angle: "deg", unit, ...apart(low, high) };
  const holds = {
    ...facts, path: record.path, precesses: turns !== 0, constant: high - low <= 1e-15 * high, unit,
  };
  const part = (name) => {
    if (name in words) return words[name];
    if (name in numbers) return figures(numbers[name]);
    const fits = ([when]) => Object.entries(when).every(([fact, value]) => holds[fact] === value);
    return PHRASES[name].find(fits)[1].replace(/\{(\w+)\}/g, (_, inner) => part(inner));
  };
  const title = part("title");
  return [title[0].toUpperCase() + title.slice(1), part("sentence")];
}

/** A number of the sentence; a rate whose digits are lost is near 0. */
function figures(x, digits = 4) {
  if (Number.isNaN(x)) return "about 0";
  const text = Math.abs(x) < 1e-4 && x ? x.toExponential(digits - 1) : x.toPrecision(digits);
  return text.replace("e+", "e").replace(/-/g, "−");
}

/** Two numbers with four digits, or with as many as distinguish them. */
function apart(low, high) {
  const texts = [...Array(14).keys()].map((n) => [figures(low, n + 4), figures(high, n + 4)]);
  const [least, most] = texts.find(([x, y]) => x !== y) ?? texts[0];
  return { least, most };
}
