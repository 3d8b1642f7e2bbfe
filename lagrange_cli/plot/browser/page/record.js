// The record of the scene: its numbers, under the keys of `lagtop solve`.

const ROWS = [
  ["a", "a", "2mgs/A"],
  ["b", "b", "C r₀/A"],
  ["u1", "u₁", "cos ϑ, highest"],
  ["u2", "u₂", "cos ϑ, lowest"],
  ["u3", "u₃", "third root"],
  ["k", "k", "modulus"],
  ["k_prime", "k′", "its complement"],
  ["nome", "q", "nome"],
  ["K", "K", "quarter period"],
  ["K_prime", "K′", "of the complement"],
  ["T_nutation", "T", "period of the nutation"],
  ["T_spin", "Tφ", "of the mean spin"],
  ["T_precession", "Tψ", "of the mean precession"],
  ["theta_min_deg", "ϑ min", "least tilt, °"],
  ["theta_max_deg", "ϑ max", "greatest tilt, °"],
  ["mean_spin_rate", "φ̇ mean", "spin"],
  ["mean_precession_rate", "ψ̇ mean", "precession"],
];

/** Fill the table; numbers to ten digits, keys as titles. */
export function showRecord(table, record) {
  const rows = ROWS.filter(([key]) => record[key] !== null);
  table.replaceChildren(...rows.map(([key, symbol, meaning]) => {
    const row = document.createElement("tr");
    row.title = key;
    const cells = [["th", symbol], ["td", meaning], ["td", textOf(record[key])]];
    row.append(...cells.map(([kind, text]) => {
      const cell = document.createElement(kind);
      cell.textContent = text;
      return cell;
    }));
    row.firstChild.scope = "row";
    return row;
  }));
}

/** A number to ten digits. */
export function textOf(x) {
  return String(Number(x.toPrecision(10))).replace("e+", "e").replace(/-/g, "−");
}
