"""Rows of JSON: objects whose entries, also those of objects and lists in them, are columns."""

from __future__ import annotations

import json
from typing import Any

import orjson

from ..arithmetic.text import quoted, shortened
from ..errors import LagtopError
from ..names import repeated

MOST_CELLS = 1 << 17
"""Most cells of a row: names and cells take more memory than the text of a file."""
_MOST_DEPTH = 20
"""Most levels of JSON objects in a row."""


def json_value(text: str, line: int | None = None) -> Any:
    """Return a JSON value; an error names the line of an array.  Raises LagtopError."""
    try:
        value = orjson.loads(text)
    except orjson.JSONDecodeError as error:
        place = "" if line is None else f"line {line + error.lineno - 1}: "
        raise LagtopError(f"{place}not JSON: {error.msg} at character {error.colno}") from None
    if text.count(":") != _keys_in(value):  # a key is named twice, or a text has a colon
        json.loads(text, object_pairs_hook=_once)
    return value


def _once(pairs: list[tuple[str, Any]]) -> None:
    """Raise LagtopError if an object of JSON names a key twice."""
    if (twice := repeated(key for key, _ in pairs)) is not None:
        raise LagtopError(f"an object must name each key once, got {quoted(twice)} twice")


def _keys_in(value: Any) -> int:
    if isinstance(value, dict):
        return len(value) + sum(_keys_in(x) for x in value.values() if isinstance(x, dict | list))
    return sum(map(_keys_in, value)) if isinstance(value, list) else 0


def entries_of(row: Any, sizes: dict[str, int]) -> dict[str, Any]:
    """Return the entries of a JSON object, or of its text: `rotation.x` and `axis_0` are names.

    A list is as long as the first one of its name, whose length is in `sizes`.  Raises LagtopError.
    """
    row = json_value(row) if isinstance(row, str) else row
    if not isinstance(row, dict):
        raise LagtopError("a row must be a JSON object")
    found: dict[str, Any] = {}

    def add(name: str, value: Any, depth: int) -> None:
        size = len(value) if isinstance(value, list) else 0
        if value not in (None, []) and sizes.setdefault(name, size) != size:
            must = f"{sizes[name]} numbers" if sizes[name] else "a number"
            raise LagtopError(f"{name} must be {must}, got {shown(value)}")
        if len(found) > MOST_CELLS or depth > _MOST_DEPTH:
            most = f"{MOST_CELLS} entries in {_MOST_DEPTH} levels"
            raise LagtopError(f"a row must have at most {most}, {quoted(name)} has more")
        if isinstance(value, dict):
            for key, x in value.items():
                add(f"{name}.{key}", x, depth + 1)
        elif isinstance(value, list):
            for i, x in enumerate(value):
                add(f"{name}_{i}", x, depth + 1)
        else:
            found[name] = value

    for name, value in row.items():
        if isinstance(value, dict | list) or name in sizes:
            add(name, value, 1)
        else:
            found[name] = value
    return found


def shown(value: Any) -> str:
    """Return a cell as text for a message, a value of JSON as it writes it."""
    return quoted(value) if isinstance(value, str) else shortened(json.dumps(value))
