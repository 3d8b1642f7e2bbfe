"""What a report has found: conditions, rows and conclusions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import orjson


class Field(NamedTuple):
    """A column: the key of its values in CSV and JSON, and how a table shows it."""

    key: str
    heading: str = ""
    """Empty: not in the table."""
    show: Callable[[Any], str] = str
    is_text: bool = False
    names_the_row: bool = False
    """Whether every block of a folded table begins with this column."""

    def cell(self, value: Any) -> str:
        """The text in a table."""
        return "" if value is None else self.show(value)


class Findings(NamedTuple):
    """A report."""

    conditions: dict[str, str]
    """Under which it holds, by name."""
    fields: Sequence[Field]
    rows: Sequence[Any]
    """Objects with an attribute for every field."""
    conclusions: Sequence[str]

    def values(self) -> list[dict[str, Any]]:
        """Each row by key."""
        return [{field.key: getattr(row, field.key) for field in self.fields} for row in self.rows]

    def as_json(self) -> bytes:
        """One object; infinite numbers are null."""
        whole = {
            "conditions": self.conditions,
            "rows": self.values(),
            "conclusions": self.conclusions,
        }
        return orjson.dumps(whole, option=orjson.OPT_INDENT_2 | orjson.OPT_APPEND_NEWLINE)


def short(value: float) -> str:
    """Two significant digits."""
    return f"{value:.1e}"
