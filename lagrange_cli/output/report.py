"""Output for people: records, rows and reports, drawn as tables by rich.

`Report` is the class of all reports: budget, compare, fit, explain, stability and bench.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping, Sequence
from decimal import ROUND_HALF_EVEN, Decimal, localcontext
from io import StringIO
from itertools import groupby
from textwrap import fill
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.text import double_text, value_text
from ..file_bytes import utf8_path
from ..names import Key
from .terminal import printable
from .text import csv_text

if TYPE_CHECKING:
    from rich.text import Text

Keys = Mapping[str, Key]
"""Keys of a record by name, in the order of a table."""


class Field(NamedTuple):
    """A column of a report: the key of its values in CSV and JSON, and its format in a table."""

    key: str
    heading: str = ""
    """Heading in a table; a field without a heading is not shown in tables."""
    show: Callable[[Any], str] = str
    is_text: bool = False

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
        values = [{x.key: getattr(row, x.key) for x in self.fields} for row in self.rows]
        return [
            {x: utf8_path(y) if isinstance(y, str) else y for x, y in z.items()} for z in values
        ]

    def text(self, fmt: str, width: int | None = None) -> bytes:
        """Return the report in a format, in the `width` of a terminal if there is one.

        CSV and NDJSON hold only the rows.  JSON is one object, in which infinite numbers are null.
        """
        if fmt == "table":
            return self._drawn(width).encode()
        if fmt == "csv":
            lines = [[field.key for field in self.fields], *(row.values() for row in self.values())]
            text = "".join(",".join(map(csv_text, line)) + "\n" for line in lines)
            return (printable(text) if width else text).encode()
        import orjson

        if fmt == "ndjson":
            return b"".join(orjson.dumps(row) + b"\n" for row in self.values())
        conditions = {name: utf8_path(x) for name, x in self.conditions.items()}
        conclusions = [*map(utf8_path, self.conclusions)]
        whole = {"conditions": conditions, "rows": self.values(), "conclusions": conclusions}
        whole |= {"units": self.units} if self.units else {}
        return orjson.dumps(whole, option=orjson.OPT_APPEND_NEWLINE)

    def _drawn(self, width: int | None) -> str:
        """Return the rows as a table between conditions and conclusions."""
        shown = [field for field in self.fields if field.heading]
        rows = [[field.cell(row) for field in shown] for row in self.rows]
        numbers = [i for i, field in enumerate(shown) if not field.is_text]
        table = drawn([field.heading for field in shown], rows, numbers, width) if rows else ""
        conditions = [_filled(f"{x:11}{y}", width or 100, 11) for x, y in self.conditions.items()]
        conclusions = [_filled(text, width) for text in self.conclusions]
        texts = ["\n".join(conditions), table.rstrip("\n"), "\n".join(conclusions)]
        return "\n\n".join(filter(None, texts)) + "\n"


def _filled(text: str, width: int | None, indent: int = 0) -> str:
    """Return running text, in lines that fit if there is a width."""
    hanging = " " * indent
    return fill(printable(text), width or 10**6, subsequent_indent=hanging, break_on_hyphens=False)


WIDE = 110
"""Width of a terminal, in columns, from which on the table of a record has the names too."""


def record_text(record: Mapping[str, Any], keys: Keys, width: int | None) -> str:
    """Return a record as a table: its summary, a line for each key with a value, and its remark.

    If there is a radius, it replaces the equation.
    """
    from rich.text import Text

    shown = ["Key", "Symbol", "Name", "Value", "Unit", "Equation"]
    if (width or 0) < WIDE:
        shown.remove("Name")
    rows: list[list[str | Text]] = []
    with_value = (x for x in keys.items() if record.get(x[0]) is not None and x[0] != "remark")
    for group, items in groupby(with_value, lambda x: x[1].group):
        rows.append([Text(group, "bold"), *[""] * (len(shown) - 1)])
        for name, key in items:
            cells = {"Key": name, "Symbol": key.symbol, "Name": key.meaning, "Unit": key.unit}
            cells["Value"] = value_text(record[name])
            cells["Equation"] = record.get(f"{name}_radius") or key.equation
            rows.append([cells[heading] for heading in shown])
    table = drawn(shown, rows, (shown.index("Value"),), width)
    summary, remark = record.get("summary"), record.get("remark")
    texts = [summary and fill(summary, width or 80), table.rstrip("\n"), remark and f"{remark}"]
    return "\n\n".join(filter(None, texts)) + "\n"


def rows_text(names: Sequence[str], rows: Sequence[Sequence[str]], width: int | None) -> str:
    """Return rows as a table; it has a line per name if only that fits the width of a terminal."""
    from rich.cells import cell_len

    def fits(lines: Sequence[Sequence[str]]) -> bool:
        widths = (max(map(cell_len, column)) + 2 for column in zip(*lines, strict=True))
        return width is None or sum(widths) - 2 <= width

    numbers = [str(i) for i in range(1, len(rows) + 1)]
    upright = [["key", *numbers], *(x for x in zip(names, *rows, strict=True) if any(x[1:]))]
    if rows and not fits([names, *rows]) and fits(upright):
        return drawn(upright[0], upright[1:], range(1, len(rows) + 1), width)
    return drawn(names, rows, range(len(names)), width)


def drawn(
    headings: Sequence[str],
    rows: Sequence[Sequence[str | Text]],
    numbers: Container[int],
    width: int | None = None,
) -> str:
    """Return a table drawn by rich; `numbers` are the places of columns that hold numbers.

    On a terminal of a `width`, texts are wrapped and headings are bold.  No digit is ever cut.
    """
    from rich import box
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    for i, heading in enumerate(headings):
        justify: Any = "right" if i in numbers else "left"
        table.add_column(Text(printable(heading)), justify=justify, no_wrap=i in numbers)
    texts = [[x if isinstance(x, Text) else Text(printable(x)) for x in row] for row in rows]
    columns = list(zip(*texts, strict=True))
    spaces = 3 * (len(headings) - 1)
    if sum(max(x.cell_len for x in column) for column in columns) + spaces <= (width or 10**6):
        texts = [[Text("\n").join(column) for column in columns]]  # rich is slow for many cells
    for row in texts:
        table.add_row(*row)
    console = Console(file=StringIO(), width=10**6, force_terminal=width is not None)
    least = Measurement.get(console, console.options, table).minimum
    console.width = max(width or 10**6, least)
    with console.capture() as captured:
        console.print(table, crop=False)
    return "".join(f"{line.rstrip()}\n" for line in captured.get().splitlines())


def with_unit(text: str, unit: str | None) -> str:
    """Return a name with its unit in brackets, unless it has none or ends in it."""
    return f"{text} [{unit}]" if unit and not text.endswith(f"_{unit}") else text


def short(value: float) -> str:
    """Return a number with two significant digits."""
    return f"{value:.1e}"


def uncertain_text(value: float | str, std: float) -> str:
    """Return a number with its standard uncertainty, such as 0.4293(48) or 73.9(1.2).

    The uncertainty is rounded by the rule of the Particle Data Group.  It has two digits if its
    first three are at most 354, and one digit up to 949; beyond, it is rounded up to 1000.  Numbers
    below 1e-4, or rounded before the point, have an exponent.  A number without uncertainty is
    written in full.  A value with more digits than a double has is given as a text.
    """
    if not std:
        return double_text(float(value))
    with localcontext(prec=800, rounding=ROUND_HALF_EVEN):
        exact = Decimal(repr(std))
        leading = exact.adjusted()
        last = leading - 1 if int(exact.scaleb(2 - leading)) <= 354 else leading
        number, spread = (Decimal(str(x)).quantize(Decimal(1).scaleb(last)) for x in (value, std))
        leading = max(x.adjusted() for x in (number, spread) if x)
        shift = 0 if leading >= -4 and last <= 0 else leading
        places = max(shift - last, 0)
        number, spread = number.scaleb(-shift), spread.scaleb(-shift)
        inside = f"{spread:.{places}f}" if spread >= 1 else f"{spread.scaleb(places):.0f}"
        return f"{number:.{places}f}({inside})" + (f"e{shift:+03d}" if shift else "")
