"""The only place that writes: rich tables, CSV and JSON, to a standard output that is watched for
failure or to a file that is replaced whole or not at all."""

from __future__ import annotations

import io
import json
import os
import shutil
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

if TYPE_CHECKING:
    from rich.table import Table

    from .angles import Array

Record = Mapping[str, Any]

MAX_TABLE_ROWS = 10_000
"""A rich table of more rows is neither read nor quickly made."""


class CannotWriteError(Exception):
    """The output could not be written; the message says where and why."""


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
    target = os.path.realpath(path)
    exists = os.path.exists(target)
    if exists and not stat.S_ISREG(os.stat(target).st_mode):  # a device, a pipe
        with open(target, "wb") as stream:
            yield stream
        return
    temporary = f"{target}.{os.getpid()}.tmp"
    with open(temporary, "xb") as stream:
        try:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
            if exists:
                shutil.copymode(target, temporary)
            os.replace(temporary, target)
        except BaseException:
            os.unlink(temporary)
            raise


def write_record(record: Record, style: str, path: str) -> None:
    """One record as a rich `table`, as `csv` (header and row) or as `json` (one line)."""
    with sink(path) as stream:
        if style == "table":
            stream.write(_record_table(record, path))
        elif style == "csv":
            cells = ("" if value is None else str(value) for value in record.values())
            stream.write(f"{','.join(record)}\n{','.join(cells)}\n".encode())
        else:
            stream.write(json.dumps(record, allow_nan=False).encode() + b"\n")


def write_rows(names: Sequence[str], blocks: Iterable[Array], style: str, path: str) -> None:
    """Blocks of rows as `csv`, as a `json` array of objects (a row a line) or as a rich `table`."""
    writer: Callable[[BinaryIO, Sequence[str], Iterable[Array]], None]
    writer = {"csv": _csv_rows, "json": _json_rows}.get(style, _table_rows(path))
    with sink(path) as stream:
        writer(stream, names, blocks)


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


def _table_rows(path: str) -> Callable[[BinaryIO, Sequence[str], Iterable[Array]], None]:
    def write(stream: BinaryIO, names: Sequence[str], blocks: Iterable[Array]) -> None:
        from rich import box
        from rich.table import Table

        table = Table(box=box.SIMPLE_HEAD)
        for name in names:
            table.add_column(name, justify="right", no_wrap=True)
        for block in blocks:
            for row in block.tolist():
                table.add_row(*map(repr, row))
        stream.write(_rendered(table, path))

    return write


# The record as a table.


class Row(NamedTuple):
    """How a key is shown: symbol, name, unit and the equation it comes from."""

    key: str
    symbol: str
    name: str
    unit: str = ""
    equation: str = ""


_GROUPS: dict[str, list[Row]] = {
    "Inputs": [
        Row("m", "m", "mass", "mass"),
        Row("A", "A", "equatorial moment", "mass len²"),
        Row("C", "C", "polar moment", "mass len²"),
        Row("s", "s", "pivot to mass centre", "len"),
        Row("g", "g", "gravity", "len/time²"),
        Row("r0", "r0", "spin", "rad/time"),
        Row("theta0", "ϑ0", "tilt at the start", "angle"),
        Row("thetadot0", "ϑ'0", "nutation rate at start", "rad/time"),
        Row("psidot0", "ψ'0", "precession rate at start", "rad/time"),
    ],
    "Constants": [
        Row("regime", "", "regime"),
        Row("a", "a", "2mgs/A", "1/time²", "(4,4)"),
        Row("b", "b", "C r0/A", "1/time", "(4,5)"),
    ],
    "Roots": [
        Row("u1", "u1", "cos ϑ, highest", "", "(4,9)"),
        Row("u2", "u2", "cos ϑ, lowest", "", "(4,11)"),
        Row("u3", "u3", "third root", "", "(4,11)"),
    ],
    "Moduli and integrals": [
        Row("k", "k", "modulus", "", "(4,19)"),
        Row("k_prime", "k'", "complementary modulus", "", "(4,21)"),
        Row("modular_angle", "arcsin k", "modular angle", "angle", "(4,19)"),
        Row("nome", "q", "nome", "", "(2,4)"),
        Row("K", "K", "first kind, k", "", "(5,1)"),
        Row("K_prime", "K'", "first kind, k'", "", "(2,4)"),
        Row("E", "E", "second kind, k", "", "(7,3)"),
        Row("amplitude", "am α", "amplitude of α", "angle", "(7,2)"),
        Row("alpha", "α", "parameter", "", "(1,6)"),
    ],
    "Periods": [
        Row("T_nutation", "T", "of the nutation", "time", "(5,1)"),
        Row("T_spin", "Tφ", "of the mean spin", "time", "§8"),
        Row("T_precession", "Tψ", "of the mean precession", "time", "§8"),
    ],
    "Mean rates": [
        Row("mean_spin_rate", "φ' mean", "spin", "rad/time", "(6,3)"),
        Row("mean_precession_rate", "ψ' mean", "precession", "rad/time", "(7,3)"),
    ],
    "Values at 0, T/4 and T/2": [
        Row("u_quarter", "u(T/4)", "cos ϑ at T/4", "", "(5,2)"),
        Row("theta_min", "ϑ min", "least tilt, at 0", "angle", "(4,9)"),
        Row("theta_max", "ϑ max", "greatest tilt, at T/2", "angle", "(4,9)"),
        Row("spin_rate_start", "φ'(0)", "spin", "rad/time", "(6,2)"),
        Row("spin_rate_half", "φ'(T/2)", "spin", "rad/time", "(6,2)"),
        Row("precession_rate_start", "ψ'(0)", "precession", "rad/time", "(4,7)"),
        Row("precession_rate_half", "ψ'(T/2)", "precession", "rad/time", "(4,7)"),
    ],
}

_ASCII = str.maketrans(
    {"ϑ": "theta", "φ": "phi", "ψ": "psi", "α": "alpha", "²": "^2", "§": "sec. ", "−": "-"}
)


def _record_table(record: Record, path: str) -> bytes:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    angle = "rad" if "theta0_rad" in record else "deg"
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1), pad_edge=False)
    for heading in ("Symbol", "Name", "Value", "Unit", "Equation"):
        table.add_column(heading, justify="right" if heading == "Value" else "left", no_wrap=True)
    for group, group_rows in _GROUPS.items():
        shown = [(row, _value(record, row, angle)) for row in group_rows]
        shown = [(row, value) for row, value in shown if value is not None]
        if shown:
            table.add_row(Text(""), Text(group, style="bold"))
        for row, value in shown:
            unit = angle if row.unit == "angle" else row.unit
            table.add_row(*map(Text, (row.symbol, row.name, str(value), unit, row.equation)))
    return _rendered(table, path)


def _value(record: Record, row: Row, angle: str) -> Any:
    return record[f"{row.key}_{angle}" if row.unit == "angle" else row.key]


def _rendered(table: Table, path: str) -> bytes:
    """The table at its natural width, whatever the terminal's; colour only on a terminal."""
    from rich.console import Console

    terminal = path == "-" and sys.stdout.isatty()
    console = Console(
        file=io.StringIO(), force_terminal=terminal, width=10_000, highlight=False, markup=False
    )
    with console.capture() as captured:
        console.print(table)
    lines = [line.rstrip() for line in captured.get().strip("\n").splitlines()]
    text = "\n".join(lines) + "\n"
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    if path != "-" or encoding.lower().startswith("utf"):
        return text.encode()
    return text.translate(_ASCII).encode("ascii", "replace")
