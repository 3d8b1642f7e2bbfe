"""Output for people: records, rows and reports as cells, drawn as a table or as markdown.

`Report` is the class of all reports: budget, Monte Carlo, compare, fit, stability and bench.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal, localcontext
from typing import Any, NamedTuple

from ..arithmetic.text import csv_text, double_text, value_text
from ..arithmetic.values import Key
from .terminal import View, spelt

Keys = Mapping[str, Key]
"""Keys of a record by name, in the order of a table."""
RECORD_HEADINGS = ("Symbol", "Name", "Value", "Unit", "Equation")


class Field(NamedTuple):
    """A column of a report: the key of its values in CSV and JSON, and its format in a table."""

    key: str
    heading: str = ""
    """Heading in a table; a field without a heading is not shown in tables."""
    show: Callable[[Any], str] = str
    is_text: bool = False
    names_the_row: bool = False
    """Whether every block of a folded table begins with this column."""

    def cell(self, row: Any) -> str:
        """Return the text in a table, for the object of a row."""
        value = getattr(row, self.key)
        return "" if value is None else self.show(value)


def fields_of(keys: Sequence[str], *shown: Field) -> list[Field]:
    """Return a field for each key, in this order; only the `shown` ones are columns of a table."""
    named = {field.key: field for field in shown}
    return [named.get(key, Field(key)) for key in keys]


class Report(NamedTuple):
    """Conditions, rows and conclusions, in every format."""

    conditions: dict[str, str]
    """Conditions of the measurement, by name."""
    fields: Sequence[Field]
    rows: Sequence[Any]
    """Objects with an attribute for every field."""
    conclusions: Sequence[str]
    units: Mapping[str, str] = {}
    """Units of numbers by name, if they are known."""

    def values(self) -> list[dict[str, Any]]:
        """Return every row by key."""
        return [{field.key: getattr(row, field.key) for field in self.fields} for row in self.rows]

    def text(self, fmt: str, view: View) -> bytes:
        """Return the report in a format.

        CSV and ndjson hold only the rows.  JSON is one object, in which infinite numbers are null.
        """
        if fmt in {"table", "markdown"}:
            return self._shown(fmt, view)
        if fmt == "csv":
            lines = [[field.key for field in self.fields], *(row.values() for row in self.values())]
            return "".join(",".join(map(csv_text, line)) + "\n" for line in lines).encode()
        import orjson

        if fmt == "ndjson":
            return b"".join(orjson.dumps(row) + b"\n" for row in self.values())
        whole: dict[str, Any] = {
            "conditions": self.conditions,
            "rows": self.values(),
            "conclusions": self.conclusions,
        }
        if self.units:
            whole["units"] = self.units
        return orjson.dumps(whole, option=orjson.OPT_APPEND_NEWLINE)

    def _shown(self, fmt: str, view: View) -> bytes:
        shown = [field for field in self.fields if field.heading]
        rows = [[field.cell(row) for field in shown] for row in self.rows]
        if fmt == "table":
            return _drawn(shown, rows, view, self.conditions, self.conclusions)
        conditions = "".join(f"- {name}: {text}\n" for name, text in self.conditions.items())
        table = markdown([field.heading for field in shown], rows)
        conclusions = "".join(f"\n{line}\n" for line in self.conclusions)
        return f"{conditions}\n{table}{conclusions}".encode()


def _drawn(
    fields: Sequence[Field],
    rows: Sequence[Sequence[str]],
    view: View,
    conditions: Mapping[str, str],
    conclusions: Sequence[str],
) -> bytes:
    """Return rows of cells as a table between conditions and conclusions."""
    from .tables import DrawnColumn, drawn_table  # start-up

    columns: dict[bool, list[DrawnColumn]] = {True: [], False: []}
    for i, field in enumerate(fields):
        cells = [spelt(row[i], view) for row in rows]
        column = DrawnColumn(spelt(field.heading, view), cells, not field.is_text)
        columns[field.names_the_row].append(column)
    return drawn_table(conditions, columns[True], columns[False], conclusions, view)


def record_cells(record: Mapping[str, Any], keys: Keys, view: View) -> dict[str, list[list[str]]]:
    """Return five cells for each key that has a value, by group; a remark is no cell.

    If there is a radius, it replaces the equation.
    """
    groups: dict[str, list[list[str]]] = {}
    for name, key in keys.items():
        if record.get(name) is not None and name != "remark":
            last = record.get(f"{name}_radius") or key.equation
            cells = (key.symbol, key.meaning, value_text(record[name]), key.unit, last)
            groups.setdefault(key.group, []).append([spelt(cell, view) for cell in cells])
    return groups


def record_text(record: Mapping[str, Any], keys: Keys, fmt: str, view: View) -> bytes:
    """Return a record as a `table` or as `markdown`: its summary, its groups, and its remark."""
    groups = record_cells(record, keys, view)
    if fmt == "table":
        from .tables import drawn_record  # start-up

        return drawn_record(record, RECORD_HEADINGS, groups, view)
    rows = []
    for group, lines in groups.items():
        rows += [["", f"**{group}**", "", "", ""], *lines]
    texts = [record.get("summary"), markdown(RECORD_HEADINGS, rows).rstrip(), record.get("remark")]
    return ("\n\n".join(filter(None, texts)) + "\n").encode()


def rows_text(names: Sequence[str], rows: Sequence[Sequence[str]], fmt: str, view: View) -> bytes:
    """Return rows as a `table` or as `markdown`."""
    if fmt == "markdown":
        return markdown(names, rows).encode()
    fields = [Field(name, name, names_the_row=not i) for i, name in enumerate(names)]
    return _drawn(fields, rows, view, {}, ())


def markdown(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table in GitHub's markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    escaped = ([cell.replace("|", "\\|") for cell in line] for line in lines)
    return "".join(f"| {' | '.join(line)} |\n" for line in escaped)


def with_unit(text: str, unit: str | None) -> str:
    """Return a name with its unit in brackets, unless it has none or ends in it."""
    return f"{text} [{unit}]" if unit and not text.endswith(f"_{unit}") else text


def short(value: float) -> str:
    """Return a number with two significant digits."""
    return f"{value:.1e}"


_LEAST_EXPONENT = -4
"""Bound below which numbers have an exponent, as they do if a rounded digit is before the point."""


def uncertain_text(value: float, std: float) -> str:
    """Return a number with its standard uncertainty, such as 0.4293(48) or 73.9(1.2).

    The uncertainty is rounded by the rule of the Particle Data Group.  It has two digits if its
    first three are at most 354, and one digit up to 949; beyond, it is rounded up to 1000.  A
    number without uncertainty is written in full.
    """
    if not std:
        return double_text(value)
    with localcontext() as context:
        context.prec = 800
        context.rounding = ROUND_HALF_EVEN
        last = last_place(std)
        number, spread = (Decimal(repr(x)).quantize(Decimal(1).scaleb(last)) for x in (value, std))
        leading = max(x.adjusted() for x in (number, spread) if x)
        if leading >= _LEAST_EXPONENT and last <= 0:
            return _in_brackets(number, spread, last)
        number, spread = number.scaleb(-leading), spread.scaleb(-leading)
        return f"{_in_brackets(number, spread, last - leading)}e{leading:+03d}"


def last_place(std: float) -> int:
    """Return the power of ten of the last digit that an uncertainty keeps."""
    exact = Decimal(repr(std))
    leading = exact.adjusted()
    first_three = int(exact.scaleb(2 - leading))
    return leading - 1 if first_three <= 354 else leading  # beyond 949 rounding makes it 1000


def _in_brackets(number: Decimal, spread: Decimal, last: int) -> str:
    """Return value and uncertainty with digits down to a place, as in 0.4293(48)."""
    places = max(-last, 0)
    inside = f"{spread:.{places}f}" if spread >= 1 else f"{spread.scaleb(places):.0f}"
    return f"{number:.{places}f}({inside})"
