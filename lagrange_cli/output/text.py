"""Cells of CSV and values of JSON as text."""

from __future__ import annotations

from typing import Any

from ..arithmetic.text import NumberText, value_text


def json_text(value: Any) -> str:
    """Return the text of any JSON value."""
    import orjson

    return orjson.dumps(value).decode()


def csv_text(value: Any) -> str:
    """Return a CSV cell, in quotes if necessary; anything but text and numbers is JSON."""
    if type(value) is str:
        return f'"{value.replace(_QUOTE, _QUOTE * 2)}"' if set(value) & _SPECIAL else value
    if value is None or isinstance(value, float | NumberText):
        return value_text(value)
    return csv_text(json_text(value))


_QUOTE = '"'
_SPECIAL = {_QUOTE, ",", "\n", "\r"}
