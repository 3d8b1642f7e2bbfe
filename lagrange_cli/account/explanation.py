"""The meaning and the formula of every key and column, for `lagtop explain`.

A formula is declared once, with its key or column, in names of keys: `2*m*g*s/A`.  This module
prints it in the symbols of the paper, and with the numbers of a motion.  Angles are named without a
unit, `P where P = ...` defines an abbreviation, and `left = right` is an equation that the key
satisfies.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

from ..names import Key, check_names
from ..solver.columns import shown_columns
from ..solver.facts import Facts
from ..solver.keys import KEYS, LINES, all_keys, key_of, shown_keys
from ..solver.record import record_in_range
from ..solver.solve import Motion
from ..top.units import DEGREES, Units, bare_name
from .worked import worked

_NAME = r"[A-Za-z_]\w*"
_WORDS = {
    "pi": "π",
    "acos": "arccos",
    "asin": "arcsin",
    "atan": "arctan",
    "sqrt": "√",
    "ellint_F": "F",
    "ellint_E": "E",
    "ellint_Pi": "Π",
    "integral": "∫",
    "t1": "t₁",
}
"""The printed forms of functions and constants."""


class Explained(NamedTuple):
    """A key or a column: its name, its meaning and its formula."""

    name: str
    kind: str
    """`record`, `further` or `column`."""
    symbol: str
    meaning: str
    unit: str
    equation: str
    formula: str
    """The formula in symbols."""
    text: str
    """The formula as declared."""
    numbers: str = ""
    """The formula with the numbers of a motion; empty without numbers, or if one is undefined."""
    value: Any = None
    missing: str = ""
    """The numbers that the motion does not have, among the value and its formula, and why."""


def listed(units: Units = DEGREES) -> list[Explained]:
    """Return all keys and columns."""
    of_record = units.keys(KEYS)
    symbols = _symbols()

    def row(name: str, kind: str, key: Key) -> Explained:
        shown = key.symbol, key.meaning, key.unit, key.equation, _shown(key.formula, symbols)
        return Explained(name, kind, *shown, key.formula)

    keys = shown_keys(units, requested=True)
    columns = shown_columns(units)
    return [
        *(row(name, "record" if name in of_record else "further", keys[name]) for name in keys),
        *(row(name, "column", columns[name]) for name in columns),
    ]


def explanations(motion: Motion, names: Sequence[str], units: Units = DEGREES) -> list[Explained]:
    """Return some keys and columns, with formulas that show the numbers of a motion.

    A symbol stands for its key or column, if there is only one.  Raises LagtopError for an unknown
    name.
    """
    rows = listed(units)
    known = list(dict.fromkeys(row.name for row in rows))
    columns = shown_columns(units).items()
    names = [key_of(word, units, columns) for word in names]
    check_names("KEY", names, known)
    chosen = [
        row._replace(text=_with_limits(row.text, motion.facts))
        for name in names
        for row in rows
        if row.name == name
    ]
    keys = {bare_name(name): name for name in all_keys(units)}
    parts = [[keys[x] for x in re.findall(_NAME, row.text) if x in keys] for row in chosen]
    wanted = {*chain(names, *parts)} & {*keys.values()}
    record, beyond = record_in_range(motion, units=units, keys=wanted)
    if beyond:
        raise beyond[0]
    found = []
    for row, used in zip(chosen, parts, strict=True):
        own = [row.name] if row.kind != "column" else []
        absent = [x for x in dict.fromkeys([*own, *used]) if record[x] is None and x != "remark"]
        found.append(
            row._replace(
                numbers="" if absent or not used else _with_numbers(motion, row, used),
                value=record[row.name] if own else None,
                missing=_reasons(motion, absent),
            )
        )
    return found


def _with_numbers(motion: Motion, row: Explained, used: Sequence[str]) -> str:
    """Return a formula with the numbers of a motion; small differences are named at its end."""
    names, symbols = {bare_name(name): name for name in used}, _symbols()
    key = "" if row.kind == "column" else row.name
    formula, gaps, texts = worked(motion, key, row.text, names)
    numbers = {x: f"{texts[x]}{'°' * y.endswith('_deg')}" for x, y in names.items()}
    shown, differences = _shown(formula, symbols | numbers, "·"), list[str]()
    for name, part in gaps.items():
        shown = shown.replace(name, _shown(part, symbols))
        differences.append(f"{_shown(part, symbols)} = {texts[name]}")
    before = ", " if " where " in shown else " where "
    return before.join([shown, ", ".join(differences)]) if differences else shown


def _reasons(motion: Motion, absent: Sequence[str]) -> str:
    """Return the names of numbers that a motion does not have, with the reason of each."""
    names: dict[str, list[str]] = {}
    for name in absent:
        names.setdefault(motion.absence(name), []).append(name)
    return "; ".join(f"{', '.join(some)}: {why}" for why, some in names.items())


def _symbols() -> dict[str, str]:
    keys = shown_keys(requested=True).items()
    symbols = {bare_name(name): key.symbol for name, key in keys if key.symbol}
    return symbols | {name: key.symbol for name, key in shown_columns().items()} | _WORDS


def _with_limits(formula: str, facts: Facts) -> str:
    """Return a formula with the limits of P and Q for a pole that the axis passes over.

    P and Q are 0 times infinity or 0/0.  At the pole, psi jumps by half a turn once in a period.
    """
    for name, pole, passes in (("P", "upper", facts.over_top), ("Q", "lower", facts.over_bottom)):
        limit = f"2*pi*K/T_nutation (limit over the {pole} pole)"
        formula = formula.replace(LINES[name].formula, limit) if passes else formula
    return formula


def _shown(formula: str, words: Mapping[str, str], times: str = " ") -> str:
    """Return a formula with `words` for its names, sums in parentheses, and `times` for `*`."""

    def word(match: re.Match[str]) -> str:
        text = words.get(match[0], match[0])
        is_sum = text.startswith("-") or re.search(r" [+-] ", re.sub(r"\(.*?\)", "", text))
        return f"({text})" if is_sum else text

    text = re.sub(_NAME, word, formula)
    return text.replace("**2", "²").replace("*", times)
