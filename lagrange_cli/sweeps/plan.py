"""The plan of a sweep, from a scene, ranges or a file of tops, and its parts.

A part is a block of tops that any process can compute, in any order.  The bytes of a part depend
only on the sweep and on the number of the part.  The parts in order are therefore the output of a
single run, wherever they were computed.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from hashlib import sha256
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from .. import __version__
from ..errors import LagtopError, SomeFailedError
from ..file_bytes import read_bytes
from ..files.tops import Product, TopsFile, read_tops
from ..output.formats import Columns, block_text
from ..top.given import Given, gather
from ..top.inputs import checked_double, overridden
from ..top.ranges import Points
from ..top.values import Value
from .records import BLOCK_ROWS, check_keys, column_keys, empty_columns, records
from .results import ResultColumn
from .tops import top_arrays

NumberedBlock = tuple[int, Product | TopsFile]
"""The number of a part, and the tops that it is made of."""


class Part(NamedTuple):
    """One part, computed."""

    number: int
    text: bytes
    size: int
    """The number of tops."""
    failed: int
    """The number of tops that have an error."""
    first_error: str


class Sweep(NamedTuple):
    """Instructions for every part: the keys to compute and the format of the output."""

    header: Sequence[str]
    """The names of the columns that are written: copied columns, and the keys."""
    shared: Mapping[str, Any]
    """Inputs of tops that do not have their own; psidot0 may be a word."""
    keys: Sequence[str]
    radians: bool
    fmt: str
    si: bool = False
    """Whether inputs have units."""

    def part(self, numbered: NumberedBlock) -> Part:
        """Compute one part."""
        number, block = numbered
        given = block.arrays(self.shared)
        tops = top_arrays(given.inputs, given.size)
        columns = empty_columns(self.keys, given.size)
        columns = records(tops, columns, given.errors, radians=self.radians)
        errors = [(row, error) for row, error in enumerate(columns["error"]) if error]
        if given.lines is not None:
            errors = [(row, f"line {given.lines[row]}: {error}") for row, error in errors]
        for row, error in errors:
            columns["error"][row] = error
        computed = runs_of([columns[key] for key in self.keys])
        text = block_text([*given.carried, *computed], self.header, self.fmt)
        return Part(number, text, given.size, len(errors), errors[0][1] if errors else "")


class Plan(NamedTuple):
    """A sweep, and its blocks."""

    sweep: Sweep
    blocks: Iterator[NumberedBlock]
    size: int
    """The number of tops; 0 if the tops come from a file."""
    description: Mapping[str, Any]
    """Everything that the bytes of the parts depend on, for the folder of parts."""
    given: Given
    """Inputs that all tops share, and which of them are defaults."""


def plan(
    path: str | None,
    axes: Mapping[str, Value],
    scene: str | None = None,
    *,
    keys: Sequence[str] | None = None,
    radians: bool = False,
    fmt: str = "csv",
    described: bool = False,
    decimal: str = "",
) -> Plan:
    """Return the plan for a grid or, with a `path`, for a file of tops.

    The last axis varies fastest.  If `described`, the description has a digest of the file.  Raises
    LagtopError, also if standard input should be described.
    """
    chosen = list(check_keys(keys, radians=radians))
    if path is None:
        found = gather(axes, scene)
        points = {name: x for name, x in found.inputs.items() if isinstance(x, Points)}
        grid, ranges = Product(points), ranges_of(points)
        shared = shared_inputs(found, varying=ranges)
        sweep = Sweep(chosen, shared, chosen, radians, fmt, found.si)
        inputs = shared | {name: str(axis) for name, axis in ranges.items()}
        blocks = enumerate(grid.blocks(BLOCK_ROWS))
        return Plan(sweep, blocks, grid.size, _described(sweep, inputs), found)
    if names := ranges_of({name: x.number for name, x in axes.items()}):
        raise LagtopError(f"a range of {min(names)} and a file of tops exclude each other")
    digest = digest_of(path) if described else ""
    computed = {*column_keys(), *column_keys(radians=True), *chosen, "error"}
    source = read_tops(path, computed, decimal)
    found = source.shared(axes, scene)
    shared = shared_inputs(found, varying=source.columns)
    with_error = list(dict.fromkeys([*chosen, "error"]))
    sweep = Sweep([*source.carried, *with_error], shared, with_error, radians, fmt, found.si)
    of_file = enumerate(source.blocks(BLOCK_ROWS))
    return Plan(sweep, of_file, 0, _described(sweep, shared, digest), found)


def digest_of(path: str) -> str:
    """Return the SHA-256 digest of a file.  Raises LagtopError for a pipe."""
    if path == "-" or (os.path.exists(path) and not os.path.isfile(path)):
        wanted = "a file of tops that can be read again"
        raise LagtopError(f"parts needs {wanted}, got {path}", "parts")
    return f"sha256:{sha256(read_bytes(path)).hexdigest()}"


def _described(sweep: Sweep, inputs: Mapping[str, Any], digest: str = "") -> dict[str, Any]:
    """Return everything that the bytes of the parts depend on."""
    return {
        **{"lagtop": __version__, "format": sweep.fmt, "radians": sweep.radians},
        **{"keys": list(sweep.keys), "inputs": dict(inputs), "file": digest},
        "units": sweep.si,
    }


def ranges_of(axes: Mapping[str, Points]) -> dict[str, Points]:
    """Return the axes that have more than one value."""
    return {name: axis for name, axis in axes.items() if axis.count > 1}


def shared_inputs(found: Given, *, varying: Collection[str] = ()) -> dict[str, Any]:
    """Return inputs by key as doubles; the worked example gives the missing ones.

    A word for psidot0 stays one.  Raises LagtopError for an invalid input; inputs in `varying`, and
    a steady rate, are not checked.
    """
    loose = set(varying)
    if loose & {"A", "A_cm", "C"} or ("A_cm" in found.inputs and loose & {"m", "s"}):
        loose |= {"A", "A_cm", "C"}  # C <= 2A
    numbers = {
        name: x.bounds()[0] if isinstance(x, Points) else x for name, x in found.inputs.items()
    }
    words = {name: x for name, x in numbers.items() if isinstance(x, str)}
    values = {name: found.values[name]._replace(number=x) for name, x in numbers.items()}
    top = found._replace(values=values).top(without={*loose, *words})
    inputs = {name: float(x) for name, x in top.as_dict().items() if x is not None}
    doubles = {name: checked_double(name, x) for name, x in numbers.items() if name not in words}
    return overridden(inputs, doubles) | words


def runs_of(columns: Iterable[ResultColumn]) -> Columns:
    """Return neighbouring columns of numbers as one array of rows, and texts as lists."""
    runs: list[Any] = []
    for are_numbers, run in groupby(columns, lambda column: column.dtype == np.float64):
        if are_numbers:
            runs.append(np.stack([*run], axis=1))
        else:
            runs += [column.tolist() for column in run]
    return runs


class ErrorCount:
    """A count of the tops that have an error."""

    def __init__(self, remedy: str = "") -> None:
        self.remedy = remedy
        self.tops = self.failed = 0
        self.first: tuple[int, str] | None = None
        """The number of the part with the first error, and the error."""

    def add(self, part: Part) -> None:
        """Count one part."""
        self.tops, self.failed = self.tops + part.size, self.failed + part.failed
        if part.failed:
            found = part.number, part.first_error
            self.first = min(self.first, found) if self.first else found

    def passing(self, parts: Iterable[Part]) -> Iterator[Part]:
        """Yield the parts, counted."""
        for part in parts:
            self.add(part)
            yield part

    def check(self) -> None:
        """Raise SomeFailedError if there was any error."""
        if self.first:
            found = f"{self.failed} of {self.tops} tops have an error"
            raise SomeFailedError(f"{found}; the first: {self.first[1]}{self.remedy}")
