"""`Report`, the class of all reports: budget, compare, fit, explain, stability and bench."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from ..file_bytes import utf8_path
from .document import Document, Grid, Lines


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

    conditions: Mapping[str, str | Sequence[str]]
    """Conditions of the measurement, by name: a text, or several lines."""
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

    def document(self, said: Callable[[str], str] = str) -> Document:
        """Return the report as a document whose conclusions are `said` in another way."""
        lines = {
            name: [utf8_path(said(line)) for line in ([x] if isinstance(x, str) else x)]
            for name, x in self.conditions.items()
        }
        conditions = {name: "; ".join(x) for name, x in lines.items()}
        conclusions = [utf8_path(said(x)) for x in self.conclusions]
        rows = self.values()
        whole = {"conditions": conditions, "rows": rows, "conclusions": conclusions}
        whole |= {"units": self.units} if self.units else {}
        shown = [field for field in self.fields if field.heading]
        cells = [[field.cell(row) for field in shown] for row in self.rows]
        numbers = [i for i, field in enumerate(shown) if not field.is_text]
        texts = [f"{'' if i else name:11}{x}" for name, y in lines.items() for i, x in enumerate(y)]
        page: list[str | Grid | Lines] = [Lines(texts, hanging=11)] if texts else []
        if cells:
            page.append(Grid([field.heading for field in shown], cells, numbers))
        page += conclusions
        asides = [f"{name}: {text}" for name, text in conditions.items()]
        return Document([x.key for x in self.fields], rows, lambda _: page, whole, asides)


def with_unit(text: str, unit: str | None) -> str:
    """Return a name with its unit in brackets, unless it has none or ends in it."""
    return f"{text} [{unit}]" if unit and not text.endswith(f"_{unit}") else text


def short(value: float) -> str:
    """Return a number with two significant digits."""
    return f"{value:.1e}"
