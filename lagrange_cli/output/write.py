"""The only place that writes: rich tables, CSV, JSON and Parquet, into a `destination`.

A double has the same text in all of them (see `numerals`).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from io import BytesIO
from itertools import chain
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import json_text, value_text
from .destination import opened

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .findings import Findings

MAX_TABLE_ROWS = 10_000
"""A rich table of more rows is neither read nor quickly made."""

QUOTE = '"'
_SPECIAL = {QUOTE, ",", "\n", "\r"}

Columns = Sequence["Array | Sequence[Any]"]
"""The columns of a block: arrays of numbers, one or several columns each, where NaN stands for
none; or lists of texts and JSON values."""


def write_value(value: Any, path: str) -> None:
    """One value, bare."""
    with opened(path) as stream:
        stream.write(f"{value_text(value)}\n".encode())


def write_bytes(path: str, make: Callable[[], bytes]) -> None:
    """A picture, made only when it is known that there is a place for it."""
    with opened(path) as stream:
        stream.write(make())


def write_record(record: Mapping[str, Any], style: str, path: str, kind: str = "top") -> None:
    """One record as a rich `table` of its kind, as `csv` (header and row) or as `json` (a line)."""
    if style == "table":
        from .layouts import record_table

        text = record_table(record, kind, terminal=_is_terminal(path), encoding=_encoding(path))
    elif style == "csv":
        text = f"{','.join(record)}\n{','.join(map(value_text, record.values()))}\n".encode()
    else:
        text = _object((key, _json_value(value)) for key, value in record.items()) + b"\n"
    with opened(path) as stream:
        stream.write(text)


def _object(members: Iterable[tuple[str, str]]) -> bytes:
    inside = ", ".join(f'"{name}": {text}' for name, text in members)
    return f"{{{inside}}}".encode()


def _json_value(value: Any) -> str:
    # By hand, because importing json takes 4 % of the run, and our only strings are plain words.
    if type(value) is str:
        return f'"{value}"'
    return value_text(value) or "null"


def _is_terminal(path: str) -> bool:
    return path == "-" and sys.stdout is not None and sys.stdout.isatty()


def _encoding(path: str) -> str:
    return (path == "-" and getattr(sys.stdout, "encoding", None)) or "utf-8"


def write_rows(names: Sequence[str], blocks: Iterable[Array], style: str, path: str) -> None:
    """Blocks of rows as `csv`, as a `json` array of objects (a row a line) or as a rich `table`."""
    if style == "table":
        rows = (map(value_text, row) for block in blocks for row in block.tolist())
        write_texts(names, rows, style, path)
    else:
        write_text_blocks(style, names, (block_text([x], names, style) for x in blocks), path)


def write_text_blocks(style: str, names: Sequence[str], blocks: Iterable[bytes], path: str) -> None:
    """Texts made by `block_text`, with what stands before, between and after them."""
    with opened(path) as stream:
        if style == "parquet":
            from .parquet import write_parquet

            write_parquet(stream, names, filter(None, blocks))
            return
        stream.write(opening(style, names))
        between = b""
        for text in filter(None, blocks):
            stream.write(between)
            stream.write(text)
            between = b",\n" if style == "json" else b""
        stream.write(b"]\n" if style == "json" else b"")


def part_file(style: str, names: Sequence[str], number: int, text: bytes) -> bytes:
    """Return the content of the file of a part, from the text that `block_text` made.

    One after the other they are what `write_text_blocks` writes (but for Parquet, where each is
    whole).
    """
    if style == "parquet":
        from .parquet import write_parquet

        stream = BytesIO()
        write_parquet(stream, names, filter(None, [text]))
        return stream.getvalue()
    return text if number else opening(style, names) + text


def opening(style: str, names: Sequence[str]) -> bytes:
    """What stands before the rows."""
    if style == "csv":
        return (",".join(map(csv_text, names)) + "\n").encode()
    return b"[" if style == "json" else b""


def block_text(columns: Columns, names: Sequence[str], style: str) -> bytes:
    """A block of rows: `csv` and `ndjson` are lines, `json` the inside of an array; for `parquet`
    an Arrow stream."""
    import numpy as np
    import orjson

    if not len(columns[0]):
        return b""
    if style == "parquet":
        from .parquet import arrow_block

        return arrow_block(columns, names)
    if style != "csv":
        lists = (x.T.tolist() if isinstance(x, np.ndarray) else [x] for x in columns)
        rows = zip(*chain.from_iterable(lists), strict=True)
        objects = [orjson.dumps(dict(zip(names, row, strict=True))) for row in rows]
        return b",\n".join(objects) if style == "json" else b"".join(x + b"\n" for x in objects)
    if len(columns) == 1 < len(names) and isinstance(columns[0], np.ndarray):
        return _array_lines(columns[0])
    cells = [
        _array_lines(x).splitlines()
        if isinstance(x, np.ndarray)
        else [csv_text(y).encode() for y in x]
        for x in columns
    ]
    lines = list(map(b",".join, zip(*cells, strict=True)))
    if len(names) == 1:  # an empty line would be lost to its reader
        lines = [line or b'""' for line in lines]
    return b"\n".join(lines) + b"\n"


def _array_lines(rows: Array) -> bytes:
    """An array of rows of numbers, a line each; nothing for NaN."""
    import numpy as np
    import orjson

    text = bytearray(orjson.dumps(rows.ravel(), option=orjson.OPT_SERIALIZE_NUMPY))
    if b"n" in text:
        text = text.replace(b"null", b"")
    # Commas at the ends of rows become line ends in place: to look for `],[` takes twice as long.
    view = np.frombuffer(text, dtype=np.uint8)
    commas = np.flatnonzero(view == ord(","))
    view[commas[rows.shape[1] - 1 :: rows.shape[1]]] = ord("\n")
    view[-1] = ord("\n")
    return bytes(view[1:])


def csv_text(value: Any) -> str:
    """A cell, in quotes where it has to be; what is neither text nor number as JSON."""
    if type(value) is str:
        return f'"{value.replace(QUOTE, QUOTE * 2)}"' if set(value) & _SPECIAL else value
    if value is None or isinstance(value, float):
        return value_text(value)
    return csv_text(json_text(value))


def write_texts(names: Sequence[str], rows: Iterable[Iterable[str]], style: str, path: str) -> None:
    """Rows of numbers written out, in the same three styles; an empty text stands for none."""
    if style == "table":
        from .layouts import rows_table

        with opened(path) as stream:
            terminal, encoding = _is_terminal(path), _encoding(path)
            stream.write(rows_table(names, rows, terminal=terminal, encoding=encoding))
    elif style == "csv":
        write_text_blocks(style, names, (f"{','.join(row)}\n".encode() for row in rows), path)
    else:
        objects = (_object(zip(names, (x or "null" for x in row), strict=True)) for row in rows)
        write_text_blocks(style, names, objects, path)


def write_findings(find: Callable[[], Findings], style: str, path: str) -> Findings:
    """What a report finds, in the same three styles.

    It is made when the place to write is open already: long work must not end before a closed door.
    """
    with opened(path) as stream:
        findings = find()
        if style == "table":
            from .layouts import findings_table

            terminal, encoding = _is_terminal(path), _encoding(path)
            stream.write(findings_table(findings, terminal=terminal, encoding=encoding))
        else:
            stream.write(_findings_csv(findings) if style == "csv" else findings.as_json())
    return findings


def _findings_csv(findings: Findings) -> bytes:
    """The rows alone, with a header."""
    lines = [[field.key for field in findings.fields], *(x.values() for x in findings.values())]
    return "".join(",".join(map(csv_text, line)) + "\n" for line in lines).encode()
