"""The plan of a sweep, from a scene, ranges and a file of tops, and its parts.

A part is a block of tops that any process can compute, in any order.  The bytes of a part depend
only on the sweep and on the number of the part.  The parts in order are therefore the output of a
single run, wherever they were computed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import __version__
from ..arithmetic.points import Points
from ..arithmetic.text import value_text
from ..errors import LagtopError, SomeFailedError
from ..inputs.files import digested
from ..inputs.given import Given, gather
from ..inputs.input_keys import checked_double, overridden
from ..inputs.ranges import Product
from ..inputs.scene_file import describe, is_scene_file
from ..inputs.text_lines import UNDECIDED, Dialect
from ..inputs.top import INPUTS
from ..inputs.tops_file import Lines, open_tops
from ..inputs.value import Stds, Value, steady_refused, values_of
from ..output.formats import Columns, Header, block_text
from .records import BLOCK_ROWS, check_keys, column_keys, records
from .results import ResultColumn, std_columns, std_keys
from .top_arrays import top_arrays

if TYPE_CHECKING:
    from ..inputs.units import System

NumberedBlock = tuple[int, Product | Lines]
"""The number of a part, and the tops that it is made of."""
Make = Callable[[NumberedBlock], "Part"]
"""A function that computes a part; workers must be able to unpickle it."""


class Part(NamedTuple):
    """One part, computed."""

    number: int
    text: bytes
    size: int
    """The number of tops."""
    failed: int
    """The number of tops that have an error."""
    first_error: str
    is_written: bool = False
    """Whether the worker wrote the part into its folder, and returned no text."""


class Sweep(NamedTuple):
    """Instructions for every part: the keys to compute and the format of the output."""

    header: Sequence[str]
    """The names of the columns that are written: copied columns, and the keys."""
    shared: Mapping[str, float]
    """Inputs of tops that do not have their own."""
    keys: Sequence[str]
    radians: bool
    fmt: str
    until_error: bool = False
    """Whether the rows of a part end before the first top that has an error."""
    stds: Stds = Stds({})
    """Standard uncertainties of inputs that all tops share."""
    system: System | None = None
    """The units of the output, if inputs have units; remarks name them."""
    is_described: bool = False
    """Whether the output begins with a description of the shared inputs."""

    @property
    def computed_keys(self) -> list[str]:
        """The keys, followed by their uncertainties."""
        return [*self.keys, *(std_keys(self.keys) if self.stds else [])]

    def part(self, numbered: NumberedBlock) -> Part:
        """Compute one part."""
        number, block = numbered
        given = block.arrays(self.shared)
        tops = top_arrays(given.inputs, given.size)
        columns = records(tops, [*self.keys, "error"], radians=self.radians, errors=given.errors)
        errors = [(row, error) for row, error in enumerate(columns["error"]) if error]
        if given.lines is not None:
            errors = [(row, f"line {given.lines[row]}: {error}") for row, error in errors]
        for row, error in errors:
            columns["error"][row] = error
        if self.system and "remark" in columns:
            columns["remark"][:] = [x and self.system.in_words(x) for x in columns["remark"]]
        rows = slice(errors[0][0] if errors and self.until_error else given.size)
        carried = [column[rows] for column in given.carried]
        if self.stds:
            columns |= std_columns(columns, tops, given.inputs, self.stds)
        computed = runs_of([columns[key][rows] for key in self.computed_keys])
        text = block_text([*carried, *computed], self.header, self.fmt)
        return Part(number, text, given.size, len(errors), errors[0][1] if errors else "")


class Plan(NamedTuple):
    """A sweep, and its blocks."""

    sweep: Sweep
    blocks: Iterator[NumberedBlock]
    size: int
    """The number of tops; 0 if it is unknown before the end of the file."""
    description: Mapping[str, Any]
    """Everything that the bytes of the parts depend on, for the folder of parts."""
    given: Given
    """Inputs that all tops share, and which of them are defaults."""
    file: str | None = None
    """The file of tops, if there is one."""
    close: Callable[[], None] = lambda: None
    """Closes the file, also if not all of its blocks were taken."""


def plan(
    files: Sequence[str],
    axes: Mapping[str, Value | Points],
    *,
    keys: Sequence[str] | None = None,
    radians: bool = False,
    system: str | None = None,
    fmt: str = "csv",
    until_error: bool = False,
    described: bool = False,
    dialect: Dialect = UNDECIDED,
    is_described: bool = False,
) -> Plan:
    """Return the plan for a scene (a `.toml` file) and a grid, or for a scene and a file of tops.

    The last axis varies fastest.  If `described`, the file is read twice, for its digest, and
    standard input is kept on disk meanwhile.  Raises LagtopError.
    """
    values = values_of(axes)
    scenes = [file for file in files if is_scene_file(file)]
    tables = [file for file in files if file not in scenes]
    if len(scenes) > 1 or len(tables) > 1:
        raise LagtopError(f"a sweep has one scene and one file of tops, got {' '.join(files)}")
    scene = scenes[0] if scenes else None
    chosen = list(check_keys(keys, radians=radians))
    wanted = Sweep((), {}, chosen, radians, fmt, until_error, is_described=is_described)
    if not tables:
        return _of_grid(wanted, gather(values, scene, system=system))
    if ranges := ranges_of({name: x.number for name, x in values.items()}):
        raise LagtopError(f"a range of {min(ranges)} and a file of tops exclude each other")
    stream, digest = digested(tables[0]) if described else (None, "")
    computed = {*column_keys(), *column_keys(radians=True), *chosen, "error"}
    file, lines, close = open_tops(tables[0], computed, BLOCK_ROWS, stream, dialect)
    found, source = file.among(values, scene, system)
    shared = shared_inputs(found, varying=INPUTS if source.columns is None else source.columns)
    stds = found.stds.only(found.stds.keys() - {*file.named})
    wanted = wanted._replace(keys=list(dict.fromkeys([*chosen, "error"])))
    sweep = _with_inputs(wanted, found, shared, stds, varying=file.named, carried=source.carried)
    blocks = (block._replace(file=source) for block in lines)
    description = _described(sweep, inputs=shared, file=digest, parts=None)
    return Plan(sweep, enumerate(blocks), 0, description, found, tables[0], close)


def _of_grid(wanted: Sweep, found: Given) -> Plan:
    """Return the plan for all tops of a grid."""
    points = {name: x for name, x in found.inputs.items() if isinstance(x, Points)}
    grid = Product(points).checked()
    ranges = ranges_of(points)
    shared = shared_inputs(found, varying=ranges)
    sweep = _with_inputs(wanted, found, shared, found.stds, varying=ranges)
    inputs = shared | {name: str(axis) for name, axis in ranges.items()}
    parts = -(-grid.size // BLOCK_ROWS)
    description = _described(sweep, inputs=inputs, file=None, parts=parts)
    return Plan(sweep, enumerate(grid.blocks(BLOCK_ROWS)), grid.size, description, found)


def _with_inputs(
    wanted: Sweep,
    found: Given,
    shared: Mapping[str, float],
    stds: Stds,
    *,
    varying: Collection[str],
    carried: Sequence[str] = (),
) -> Sweep:
    """Return a sweep with the inputs that all tops share, and the columns that are copied."""
    sweep = wanted._replace(shared=shared, stds=stds, system=found.system)
    header = [*carried, *sweep.computed_keys]
    if not sweep.is_described:
        return sweep._replace(header=header)
    texts = {key: value_text(x) for key, x in shared.items() if key not in varying}
    notes = describe(__version__, texts, found.system, radians=sweep.radians, is_whole=False)
    return sweep._replace(header=Header(header, notes))


def _described(sweep: Sweep, **decides: Any) -> dict[str, Any]:
    """Return everything that the bytes of the parts depend on; options only if they are set."""
    told: dict[str, Any] = {"lagtop": __version__, "format": sweep.fmt, "radians": sweep.radians}
    told |= {"keys": sweep.keys, **decides}
    told |= {"header_comments": True} if sweep.is_described and sweep.fmt == "csv" else {}
    told |= {"uncertainties": dict(sweep.stds)} if sweep.stds else {}
    if pairs := sweep.stds.correlations:
        told["correlations"] = {" ".join(sorted(pair)): float(r) for pair, r in pairs.items()}
    return told | ({"units": [sweep.system.mass, sweep.system.length]} if sweep.system else {})


def ranges_of(axes: Mapping[str, Points]) -> dict[str, Points]:
    """Return the axes that have more than one value."""
    return {name: axis for name, axis in axes.items() if axis.count > 1}


def shared_inputs(found: Given, *, varying: Collection[str] = ()) -> dict[str, float]:
    """Return inputs by key as doubles; the worked example gives the missing ones.

    Raises LagtopError for an invalid input; inputs in `varying` are not checked.
    """
    loose = set(varying)
    if loose & {"A", "A_cm", "C"} or ("A_cm" in found.inputs and loose & {"m", "s"}):
        loose |= {"A", "A_cm", "C"}  # C <= 2A
    numbers = {
        name: x.bounds()[0] if isinstance(x, Points) else x for name, x in found.inputs.items()
    }
    if isinstance(word := numbers.get("psidot0"), str):
        raise LagtopError(f"psidot0 {steady_refused(word)}", "psidot0")
    top = found._replace(inputs=numbers).top(without=loose)
    inputs = {name: float(x) for name, x in top.as_dict().items() if x is not None}
    return overridden(inputs, {name: checked_double(name, x) for name, x in numbers.items()})


def runs_of(columns: Iterable[ResultColumn]) -> Columns:
    """Return neighbouring columns of numbers as one array of rows, and texts as lists."""
    runs: list[Any] = []
    for are_numbers, run in groupby(columns, lambda column: column.dtype == np.float64):
        if are_numbers:
            runs.append(np.stack([*run], axis=1))
        else:
            runs += [column.tolist() for column in run]
    return runs


def shard_of(
    blocks: Iterable[NumberedBlock], shard: tuple[int, int] | None
) -> Iterator[NumberedBlock]:
    """Return every N-th block from the I-th on, for the shard (I, N), or all blocks."""
    first, step = shard or (1, 1)
    return (block for block in blocks if block[0] % step == first - 1)


class Tally:
    """A count of the tops that have an error, updated as the parts pass."""

    def __init__(self, *, fail_fast: bool = False, remedy: str = "") -> None:
        self.fail_fast, self.remedy = fail_fast, remedy
        self.count = self.failed = self.shown = 0
        self.first: tuple[int, str] | None = None
        """The number of the part with the first error, and the error."""

    def add(self, part: Part) -> None:
        """Count one part."""
        self.count, self.failed = self.count + part.size, self.failed + part.failed
        if part.failed:
            found = part.number, part.first_error
            self.first = min(self.first, found) if self.first else found

    def passing(self, parts: Iterable[Part], *, ended: bool = True) -> Iterator[Part]:
        """Yield the parts, counted; with `fail_fast`, up to the first error.

        The parts then end there, or SomeFailedError is raised before the part with the error.
        """
        for part in parts:
            self.add(part)
            if self.fail_fast and not ended:
                self.check()
            yield part
            if self.fail_fast and self.failed:
                return

    def progress(self, _: Part) -> int:
        """Return the number of tops that were counted since the last call."""
        more, self.shown = self.count - self.shown, self.count
        return more

    def check(self) -> None:
        """Raise SomeFailedError if there was any error."""
        if self.first and self.fail_fast:
            raise SomeFailedError(self.first[1])
        if self.first:
            found = f"{self.failed} of {self.count} tops have an error"
            raise SomeFailedError(f"{found}; the first: {self.first[1]}{self.remedy}")
