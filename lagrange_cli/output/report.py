"""Report of a report: conditions, rows and conclusions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import orjson


class Field(NamedTuple):
    """A column: the key of its values in CSV and JSON, and how a table shows it."""

    key: str
    heading: str = ""
    """Heading in a table; a field without one is not shown there."""
    show: Callable[[Any], str] = str
    is_text: bool = False
    names_the_row: bool = False
    """Whether every block of a folded table begins with this column."""

    def cell(self, row: Any) -> str:
        """Return the text in a table, for the object of a row."""
        value = getattr(row, self.key)
        return "" if value is None else self.show(value)


class Report(NamedTuple):
    """What a report has found."""

    conditions: dict[str, str]
    """Conditions of the measurement, by name."""
    fields: Sequence[Field]
    rows: Sequence[Any]
    """Objects with an attribute for every field."""
    conclusions: Sequence[str]
    units: Mapping[str, str] = {}
    """Units of numbers by name, where they are known."""

    def values(self) -> list[dict[str, Any]]:
        """Return every row by key."""
        return [{field.key: getattr(row, field.key) for field in self.fields} for row in self.rows]

    def as_json(self) -> bytes:
        """Return one JSON object on one line, in which infinite numbers are null."""
        whole: dict[str, Any] = {
            "conditions": self.conditions,
            "rows": self.values(),
            "conclusions": self.conclusions,
        }
        if self.units:
            whole["units"] = self.units
        return orjson.dumps(whole, option=orjson.OPT_APPEND_NEWLINE)


def with_unit(text: str, unit: str | None) -> str:
    """Return a name with its unit between brackets, where it has one and does not end in it."""
    return f"{text} [{unit}]" if unit and not text.endswith(f"_{unit}") else text


def short(value: float) -> str:
    """Return two significant digits."""
    return f"{value:.1e}"
