"""Rows of JSON: objects whose entries, also those of objects and lists in them, are columns."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

import orjson

from ..arithmetic.text import parse_number, quoted, shortened
from ..errors import DataError, LagtopError
from ..names import repeated

MOST_CELLS = 1 << 17
"""Most cells of a row: names and cells take more memory than the text of a file."""
_MOST_DEPTH = 20
"""Most levels of JSON in a row; the rows themselves may be two levels down."""
_MAYBE_TINY = re.compile(r"[eE]-\d{3}|\d{323}")


def json_value(text: str, line: int | None = None) -> Any:
    """Return a JSON value.

    Raises LagtopError, or DataError with the line of a file if the text begins on its `line`.
    """
    try:
        value = orjson.loads(text)
    except orjson.JSONDecodeError as error:
        wrong = f"not JSON: {error.msg} at character {error.colno}"
        if line is None:
            raise LagtopError(wrong) from None
        raise DataError(f"line {line + error.lineno - 1}: {wrong}") from None
    if text.count(":") != _keys_in(value):  # a key is named twice, or a text has a colon
        json.loads(text, object_pairs_hook=_once)
    if _MAYBE_TINY.search(text):  # orjson rounds 1e-400 to 0
        json.loads(text, parse_float=parse_number)
    return value


def _once(pairs: list[tuple[str, Any]]) -> None:
    """Raise LagtopError if an object of JSON names a key twice."""
    if (twice := repeated(key for key, _ in pairs)) is not None:
        raise LagtopError(f"an object must name each key once, got {quoted(twice)} twice")


def _keys_in(value: Any, depth: int = -2) -> int:
    """Return the number of keys in a value.  Raises LagtopError for too many levels."""
    if depth > _MOST_DEPTH:
        raise LagtopError(f"JSON must have at most {_MOST_DEPTH} levels, it has more")
    is_object = isinstance(value, dict)
    inner = value.values() if is_object else value if isinstance(value, list) else ()
    count = len(value) if is_object else 0
    return count + sum([_keys_in(x, depth + 1) for x in inner if type(x) in {dict, list}])


def rows_of_value(value: Any, known: Callable[[list[str]], int], depth: int = 2) -> list[Any]:
    """Return the rows in the JSON value of a file: an array, an object of columns, or one object.

    An array may be an object whose keys are 0, 1, ..., as `DataFrame.to_json` of pandas writes it.
    Columns are lists, among which `known` counts known names.  The rows may be in an entry such as
    `data`, as lists below their names in `columns`.  Raises LagtopError for columns of different
    lengths.
    """
    value = _array(value)
    if not isinstance(value, dict):
        return value if isinstance(value, list) else [value]
    value = {x: _array(y) for x, y in value.items()}
    if isinstance(value.get("columns"), list) and _are_lists(value.get("data")):
        return [value["columns"], *value["data"]]
    lists = {x: y for x, y in value.items() if isinstance(y, list)}
    texts = [x for x, y in lists.items() if not y or isinstance(y[0], str)]
    columns = {x: y for x, y in lists.items() if x not in texts or known([x])}
    if known([x for x, y in columns.items() if {*map(type, y[:1])} != {dict}]):
        sizes = {x: len(y) for x, y in columns.items()}
        if len({*sizes.values()}) > 1:
            raise LagtopError(f"columns must have equal lengths, got {shown(sizes)}")
        count = {*sizes.values()}.pop()
        columns = {x: y for x, y in lists.items() if len(y) == count}  # texts, too
        return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    is_row = known([x for x in value if x not in lists])
    inside = [x for name, x in value.items() if depth and not is_row and name != "schema"]
    for inner in inside:
        rows = rows_of_value(inner, known, depth - 1) if isinstance(inner, dict) else inner
        if isinstance(rows, list) and len(rows) > 1 and isinstance(rows[0], dict):
            return rows
    return [value]


def _are_lists(value: Any) -> bool:
    return isinstance(value, list) and {*map(type, value)} == {list}


def _array(value: Any) -> Any:
    """Return an object whose keys are 0, 1, ... as a list, and other values as they are."""
    is_numbered = isinstance(value, dict) and [*value] == [*map(str, range(len(value)))] != []
    return [*value.values()] if is_numbered else value


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
