"""What a report has found: conditions, rows and conclusions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import orjson

from ..inputs.top import Top


class Field(NamedTuple):
    """A column: the key of its values in CSV and JSON, and how a table shows it."""

    key: str
    heading: str = ""
    """Empty: not in the table."""
    show: Callable[[Any], str] = str
    is_text: bool = False

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


def as_options(top: Top) -> str:
    """A top as the options that give it to any command."""
    words = [f"--{name} {getattr(top, name)!r}" for name in ("m", "A", "C", "s", "g", "r0")]
    if top.theta0_rad is None:
        words.append(f"--theta0 {top.theta0_deg!r}")
    else:
        words.append(f"--rad --theta0 {top.theta0_rad!r}")
    for name in ("thetadot0", "psidot0"):
        if getattr(top, name):
            words.append(f"--{name} {getattr(top, name)!r}")
    return " ".join(words)
