"""Cells of CSV and values of JSON as text."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..arithmetic.text import NumberText, value_text


def json_text(value: Any) -> str:
    """Return the text of any JSON value."""
    import orjson

    return orjson.dumps(value).decode()


def json_value(value: Any) -> str:
    """Return a value as orjson would write it, with numbers that are written out already."""
    if isinstance(value, Mapping):
        members = [f'"{key}":{json_value(x)}' for key, x in value.items()]
        return f"{{{','.join(members)}}}"
    if isinstance(value, list):
        return f"[{','.join(map(json_value, value))}]"
    if type(value) is str:
        is_plain = value.isprintable() and not set(value) & {'"', "\\"}
        return f'"{value}"' if is_plain else json_text(value)  # start-up: nearly all are plain
    if value is None or isinstance(value, float | NumberText):
        return (value_text(value) if value not in (math.inf, -math.inf) else "") or "null"
    return json_text(value)


def csv_text(value: Any) -> str:
    """Return a CSV cell, in quotes if necessary; anything but text and numbers is JSON."""
    if type(value) is str:
        return f'"{value.replace(_QUOTE, _QUOTE * 2)}"' if set(value) & _SPECIAL else value
    if value is None or isinstance(value, float | NumberText):
        return value_text(value)
    return csv_text(json_text(value))


_QUOTE = '"'
_SPECIAL = {_QUOTE, ",", "\n", "\r"}
