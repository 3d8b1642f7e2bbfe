"""The only place that writes: rich tables, CSV and JSON, to a standard output that is watched for
failure or to a file that is replaced whole or not at all."""

from __future__ import annotations

import io
import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO, NoReturn

if TYPE_CHECKING:
    from .elliptic.twofold import Array
    from .findings import Findings

MAX_TABLE_ROWS = 10_000
"""A rich table of more rows is neither read nor quickly made."""


class CannotWriteError(Exception):
    """The output could not be written; the message says where and why."""


class Terminated(BaseException):
    """A signal to end, raised so that a temporary file is removed on the way out."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


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
    if os.path.exists(path) and not stat.S_ISREG(os.stat(path).st_mode):  # a device, a pipe
        with open(path, "wb") as stream:
            yield stream
        return
    from tempfile import mkstemp

    _catch_signals()
    target = os.path.realpath(path)
    descriptor, temporary = mkstemp(prefix=".lagtop-", dir=os.path.dirname(target))
    with open(descriptor, "wb") as stream:
        try:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
            os.chmod(temporary, _mode(target))
            os.replace(temporary, target)
        except BaseException:
            os.unlink(temporary)
            raise


def _mode(target: str) -> int:
    """The mode of the file that is replaced, or of a new one."""
    if os.path.exists(target):
        return stat.S_IMODE(os.stat(target).st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _catch_signals() -> None:
    """Let the signals that end us remove the temporary file first."""
    import signal

    def end(number: int, _: Any) -> NoReturn:
        raise Terminated(number)

    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), end)


def write_record(record: Mapping[str, Any], style: str, path: str, kind: str = "top") -> None:
    """One record as a rich `table` of its kind, as `csv` (header and row) or as `json` (a line)."""
    if style == "table":
        from .report import record_table

        text = record_table(record, kind, terminal=_is_terminal(path), encoding=_encoding(path))
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
    # By hand, because importing json takes 4 % of the run; our only strings are plain words, and
    # subclasses of str are numbers written out.
    if type(value) is str:
        return f'"{value}"'
    return "null" if value is None else str(value)


def _is_terminal(path: str) -> bool:
    return path == "-" and sys.stdout is not None and sys.stdout.isatty()


def _encoding(path: str) -> str:
    return (path == "-" and getattr(sys.stdout, "encoding", None)) or "utf-8"


def write_rows(names: Sequence[str], blocks: Iterable[Array], style: str, path: str) -> None:
    """Blocks of rows as `csv`, as a `json` array of objects (a row a line) or as a rich `table`."""
    if style == "table":
        rows = (map(repr, row) for block in blocks for row in block.tolist())
        write_texts(names, rows, style, path)
        return
    with sink(path) as stream:
        (_csv_rows if style == "csv" else _json_rows)(stream, names, blocks)


def write_texts(names: Sequence[str], rows: Iterable[Iterable[str]], style: str, path: str) -> None:
    """Rows of numbers written out, in the same three styles."""
    with sink(path) as stream:
        if style == "table":
            from .report import rows_table

            terminal, encoding = _is_terminal(path), _encoding(path)
            stream.write(rows_table(names, rows, terminal=terminal, encoding=encoding))
        elif style == "csv":
            for row in chain([names], rows):
                stream.write(",".join(row).encode() + b"\n")
        else:
            separator = b"["
            for row in rows:
                members = (f'"{name}": {text}' for name, text in zip(names, row, strict=True))
                stream.write(separator + f"{{{', '.join(members)}}}".encode())
                separator = b",\n"
            stream.write(b"]\n")


def write_findings(find: Callable[[], Findings], style: str, path: str) -> Findings:
    """What a report finds, in the same three styles.

    It is made when the place to write is open already: long work must not end before a closed door.
    """
    with sink(path) as stream:
        findings = find()
        if style == "table":
            from .report import findings_table

            terminal, encoding = _is_terminal(path), _encoding(path)
            stream.write(findings_table(findings, terminal=terminal, encoding=encoding))
        else:
            stream.write(findings.as_csv() if style == "csv" else findings.as_json())
    return findings


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
