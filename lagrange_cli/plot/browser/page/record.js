// The record of the scene: its numbers under the keys of `lagtop solve`, in groups.

import { KEYS } from "../data.js";

/** Fill the table; numbers to ten digits, units by their names in `units`. */
export function showRecord(table, record, units) {
  const rows = [];
  let last = "";
  for (const [name, { group, symbol, meaning, unit, equation }] of Object.entries(KEYS)) {
    const value = record[name];
    if (typeof value !== "number") continue;
    if (group !== last) rows.push(rowOf([["th", group]]));
    last = group;
    const named = unit === "angle" ? "°" : unit.replace(/[a-z]+/g, (word) => units[word] ?? word);
    const cells = [["th", symbol], ["td", meaning], ["td", `${textOf(value)} ${named}`]];
    rows.push(rowOf(cells, `${name} ${equation}`));
  }
  table.replaceChildren(...rows);
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
  if (!title) row.firstChild.colSpan = 3;
  return row;
}

/** A number to ten digits. */
export function textOf(x) {
  return String(Number(x.toPrecision(10))).replace("e+", "e").replace(/-/g, "−");
}
