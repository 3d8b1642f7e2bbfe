"""Rich tables: records in the order of the papers, and rows.  No digit is ever cut."""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping, Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any, NamedTuple

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from ..arithmetic.text import value_text

if TYPE_CHECKING:
    from .findings import Findings


class Row(NamedTuple):
    """How a key is shown: symbol, name, unit and the equation it comes from."""

    key: str
    symbol: str
    name: str
    unit: str = ""
    equation: str = ""


_TOP: dict[str, list[Row]] = {
    "Inputs": [
        Row("m", "m", "mass", "mass"),
        Row("A", "A", "equatorial moment", "mass len²"),
        Row("C", "C", "polar moment", "mass len²"),
        Row("s", "s", "pivot to mass centre", "len"),
        Row("g", "g", "gravity", "len/time²"),
        Row("r0", "r0", "spin", "rad/time"),
        Row("theta0", "ϑ0", "tilt at the start", "angle"),
        Row("thetadot0", "ϑ'0", "nutation rate at start", "rad/time"),
        Row("psidot0", "ψ'0", "precession rate at start", "rad/time"),
    ],
    "Constants": [
        Row("regime", "", "regime"),
        Row("path", "", "path of the axis"),
        Row("a", "a", "2mgs/A", "1/time²", "(4,4)"),
        Row("b", "b", "C r0/A", "1/time", "(4,5)"),
    ],
    "Roots": [
        Row("u1", "u1", "cos ϑ, highest", "", "(4,9)"),
        Row("u2", "u2", "cos ϑ, lowest", "", "(4,11)"),
        Row("u3", "u3", "third root", "", "(4,11)"),
    ],
    "Moduli and integrals": [
        Row("k", "k", "modulus", "", "(4,19)"),
        Row("k_prime", "k'", "complementary modulus", "", "(4,21)"),
        Row("modular_angle", "arcsin k", "modular angle", "angle", "(4,19)"),
        Row("nome", "q", "nome", "", "(2,4)"),
        Row("K", "K", "first kind, k", "", "(5,1)"),
        Row("K_prime", "K'", "first kind, k'", "", "(2,4)"),
        Row("E", "E", "second kind, k", "", "(7,3)"),
        Row("amplitude", "am α", "amplitude of α", "angle", "(7,2)"),
        Row("alpha", "α", "parameter", "", "(1,6)"),
    ],
    "Periods": [
        Row("T_nutation", "T", "of the nutation", "time", "(5,1)"),
        Row("T_spin", "Tφ", "of the mean spin", "time", "§8"),
        Row("T_precession", "Tψ", "of the mean precession", "time", "§8"),
    ],
    "Mean rates": [
        Row("mean_spin_rate", "φ' mean", "spin", "rad/time", "(6,3)"),
        Row("mean_precession_rate", "ψ' mean", "precession", "rad/time", "(7,3)"),
    ],
    "Turning points and rates": [
        Row("u_quarter", "u(T/4)", "cos ϑ at T/4", "", "(5,2)"),
        Row("theta_min", "ϑ min", "least tilt", "angle", "(4,9)"),
        Row("theta_max", "ϑ max", "greatest tilt", "angle", "(4,9)"),
        Row("spin_rate_start", "φ'(0)", "spin", "rad/time", "(6,2)"),
        Row("spin_rate_half", "φ'(T/2)", "spin", "rad/time", "(6,2)"),
        Row("precession_rate_start", "ψ'(0)", "precession", "rad/time", "(4,7)"),
        Row("precession_rate_half", "ψ'(T/2)", "precession", "rad/time", "(4,7)"),
    ],
}

_JACOBI: dict[str, list[Row]] = {
    "Moduli": [
        Row("k", "k", "modulus"),
        Row("k_prime", "k'", "complementary modulus"),
        Row("modular_angle", "arcsin k", "modular angle", "angle"),
        Row("nome", "q", "nome", "", "(3.1.6)"),
        Row("nome_prime", "q'", "nome of k'", "", "(3.1.6)"),
    ],
    "Complete integrals": [
        Row("K", "K", "first kind, k", "", "(3.1.2)"),
        Row("K_prime", "K'", "first kind, k'", "", "(3.1.2)"),
        Row("E", "E", "second kind, k"),
        Row("E_prime", "E'", "second kind, k'"),
    ],
}

_ETA: dict[str, list[Row]] = {
    "Roots": [
        Row("delta", "δ", "upper end of the band", "", "(3.2.1)"),
        Row("delta_star", "δ*", "lower end of the band", "", "(3.2.1)"),
        Row("p", "p'", "middle of the outer roots", "", "(3.2.1)"),
        Row("q", "q'", "half their distance", "", "(3.2.1)"),
        Row("outer_root", "", "the finite outer root"),
        Row("layout", "", "outer roots"),
        Row("g", "g", "-2 α1 c²", "1/time²", "(3.2.1)"),
    ],
    "Constants": [
        Row("m_prime", "m'", "at δ", "", "(3.2.3)"),
        Row("m_double_prime", 'm"', "at δ*", "", "(3.2.3)"),
        Row("k", "k", "modulus of (3.2.4)", "", "(3.2.5)"),
        Row("k1", "k1", "modulus", "", "(3.2.8)"),
        Row("k1_prime", "k1'", "complementary modulus"),
        Row("K1", "K1", "first kind, k1", "", "(3.2.8)"),
        Row("sigma1", "σ1", "rate of the argument", "1/time", "(3.2.8)"),
        Row("s", "s", "amplitude of sn", "", "(3.2.12)"),
        Row("d", "d", "of the denominator", "", "(3.2.12)"),
        Row("gamma", "γ", "shift", "", "(3.2.12)"),
        Row("period", "T", "of η, 4 K1/σ1", "time", "(3.2.10)"),
    ],
}

LAYOUTS = {"top": _TOP, "jacobi": _JACOBI, "eta": _ETA}

_ASCII = str.maketrans(
    {"ϑ": "theta", "φ": "phi", "ψ": "psi", "α": "alpha", "²": "^2", "§": "sec. "}
    | {"δ": "delta", "γ": "gamma", "σ": "sigma", "η": "eta"}
)


def record_table(record: Mapping[str, Any], kind: str, *, terminal: bool, encoding: str) -> bytes:
    """A record by the groups of its kind, a line for each key that has a value; its remark last."""
    angle = "rad" if any(key.endswith("_rad") for key in record) else "deg"
    spelling = _spelling(encoding)
    headings = ("Symbol", "Name", "Value", "Unit", "Equation")
    table = _table((heading, heading == "Value") for heading in headings)
    for group, rows in LAYOUTS[kind].items():
        shown = [
            [cell.translate(spelling) for cell in line]
            for row in rows
            if (line := _line(record, row, angle))
        ]
        if shown:
            # One row of many lines a group: rich takes its time for every cell.
            symbols, names, *rest = ("\n".join(column) for column in zip(*shown, strict=True))
            name_cell = Text.assemble((f"{group}\n", "bold"), names)
            table.add_row(f"\n{symbols}", name_cell, *(f"\n{column}" for column in rest))
    remark = f"\n{record['remark']}\n" if record.get("remark") else ""
    return _rendered(table, terminal, encoding) + remark.encode()


def _line(record: Mapping[str, Any], row: Row, angle: str) -> tuple[str, ...] | None:
    is_angle = row.unit == "angle"
    value = record[f"{row.key}_{angle}" if is_angle else row.key]
    if value is None:
        return None
    return row.symbol, row.name, value_text(value), angle if is_angle else row.unit, row.equation


def rows_table(
    names: Sequence[str], rows: Iterable[Iterable[str]], *, terminal: bool, encoding: str
) -> bytes:
    """A column for each name, a line for each row."""
    table = _table((name, True) for name in names)
    for row in rows:
        table.add_row(*row)
    return _rendered(table, terminal, encoding)


def findings_table(findings: Findings, *, terminal: bool, encoding: str) -> bytes:
    """The conditions as lines, the rows as a table of short numbers, and the conclusions."""
    shown = [field for field in findings.fields if field.heading]
    table = _table((field.heading, not field.is_text) for field in shown)
    for row in findings.rows:
        table.add_row(*(field.cell(getattr(row, field.key)) for field in shown))
    spelling = _spelling(encoding)
    heads = (_condition(name, text) for name, text in findings.conditions.items())
    above = "\n".join(heads).translate(spelling) + "\n\n"
    below = "".join(f"\n{line}" for line in findings.conclusions).translate(spelling)
    return above.encode() + _rendered(table, terminal, encoding) + f"{below}\n".encode()


def _table(columns: Iterable[tuple[str, bool]]) -> Table:
    """No rows yet; each column by its heading, and whether it holds numbers."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for heading, numeric in columns:
        table.add_column(heading, justify="right" if numeric else "left", no_wrap=True)
    return table


def _spelling(encoding: str) -> dict[int, str]:
    return {} if encoding.lower().startswith("utf") else _ASCII


def _condition(name: str, text: str) -> str:
    """The name, and the text beside it in lines of 100 columns."""
    return fill(f"{name:11}{text}", 100, subsequent_indent=" " * 11, break_on_hyphens=False)


def _rendered(table: Table, terminal: bool, encoding: str) -> bytes:
    """The table at its natural width, whatever the terminal's; colour only on a terminal."""
    file = io.StringIO()
    Console(
        file=file, force_terminal=terminal, width=10_000, highlight=False, markup=False, emoji=False
    ).print(table)
    lines = [line.rstrip() for line in file.getvalue().splitlines()]
    text = "\n".join(lines).strip("\n") + "\n"
    if encoding.lower().startswith("utf"):
        return text.encode()
    return text.replace("─", "-").encode("ascii", "replace")
