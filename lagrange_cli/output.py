"""The only place that writes: rich tables, CSV and JSON, to a standard output that is watched for
failure or to a file that is replaced whole or not at all."""

from __future__ import annotations

import io
import os
import stat
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, BinaryIO, NoReturn

if TYPE_CHECKING:
    from .angles import Array

Record = Mapping[str, Any]

MAX_TABLE_ROWS = 10_000
"""A rich table of more rows is neither read nor quickly made."""


class CannotWriteError(Exception):
    """The output could not be written; the message says where and why."""


class Terminated(BaseException):
    """SIGTERM, raised so that a temporary file is removed on the way out."""


@contextmanager
def sink(path: str) -> Iterator[BinaryIO]:
    """A binary stream to `path`, or to standard output for `-`.

    An existing file is replaced when the block ends well and left alone when it does not.  Raises
    CannotWriteError; a reader that went away raises BrokenPipeError.
    """
    try:
        with _standard_output() if path == "-" else _file(path) as stream:
            yield stream
    except BrokenPipeError:
        raise
    except OSError as error:
        name = "standard output" if path == "-" else path
        raise CannotWriteError(f"cannot write {name}: {error.strerror or error}") from None


@contextmanager
def _standard_output() -> Iterator[BinaryIO]:
    # A duplicate with a buffer of its own: unlike sys.stdout under PYTHONUNBUFFERED it neither
    # drops what a full disk or a slow reader did not take nor hides the failure.
    if sys.stdout is None:
        raise OSError("it is closed")
    try:
        descriptor = os.dup(sys.stdout.fileno())
    except io.UnsupportedOperation:  # replaced in-process, as by click's test runner
        yield sys.stdout.buffer
        sys.stdout.buffer.flush()
        return
    with open(descriptor, "wb") as stream:
        yield stream


@contextmanager
def _file(path: str) -> Iterator[BinaryIO]:
    import signal

    target = os.path.realpath(path)
    exists = os.path.exists(target)
    if exists and not stat.S_ISREG(os.stat(target).st_mode):  # a device, a pipe
        with open(target, "wb") as stream:
            yield stream
        return
    signal.signal(signal.SIGTERM, _terminate)
    temporary = f"{target}.{os.getpid()}.tmp"
    with open(temporary, "xb") as stream:
        try:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
            if exists:
                os.chmod(temporary, stat.S_IMODE(os.stat(target).st_mode))
            os.replace(temporary, target)
        except BaseException:
            os.unlink(temporary)
            raise


def _terminate(*_: Any) -> NoReturn:
    raise Terminated


def write_record(record: Record, style: str, path: str) -> None:
    """One record as a rich `table`, as `csv` (header and row) or as `json` (one line)."""
    if style == "table":
        from .report import record_table

        text = record_table(record, terminal=_is_terminal(path), encoding=_encoding(path))
    elif style == "csv":
        text = f"{','.join(record)}\n{','.join(map(_cell, record.values()))}\n".encode()
    else:
        members = (f'"{key}": {_json_value(value)}' for key, value in record.items())
        text = f"{{{', '.join(members)}}}\n".encode()
    with sink(path) as stream:
        stream.write(text)


def _cell(value: Any) -> str:
    return "" if value is None else str(value)


def _json_value(value: Any) -> str:
    # By hand, because importing json takes 4 % of the run; our only strings are plain words.
    if isinstance(value, str):
        return f'"{value}"'
    return "null" if value is None else str(value)


def _is_terminal(path: str) -> bool:
    return path == "-" and sys.stdout is not None and sys.stdout.isatty()


def _encoding(path: str) -> str:
    return (path == "-" and getattr(sys.stdout, "encoding", None)) or "utf-8"


def write_rows(names: Sequence[str], blocks: Iterable[Array], style: str, path: str) -> None:
    """Blocks of rows as `csv`, as a `json` array of objects (a row a line) or as a rich `table`."""
    with sink(path) as stream:
        if style == "csv":
            _csv_rows(stream, names, blocks)
        elif style == "json":
            _json_rows(stream, names, blocks)
        else:
            from .report import rows_table

            rows = (row for block in blocks for row in block.tolist())
            terminal, encoding = _is_terminal(path), _encoding(path)
            stream.write(rows_table(names, rows, terminal=terminal, encoding=encoding))


def _csv_rows(stream: BinaryIO, names: Sequence[str], blocks: Iterable[Array]) -> None:
    import orjson

    stream.write(",".join(names).encode() + b"\n")
    for block in blocks:
        text = orjson.dumps(block, option=orjson.OPT_SERIALIZE_NUMPY)
        stream.write(text[2:-2].replace(b"],[", b"\n") + b"\n")


def _json_rows(stream: BinaryIO, names: Sequence[str], blocks: Iterable[Array]) -> None:
    import orjson

    separator = b"["
    for block in blocks:
        for row in block.tolist():
            stream.write(separator + orjson.dumps(dict(zip(names, row, strict=True))))
            separator = b",\n"
    stream.write(b"]\n")
