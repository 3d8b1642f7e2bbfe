"""The plan of a sweep, from a scene, ranges or a file of tops, and its parts.

A part is a block of tops that any process can compute, in any order.  The bytes of a part depend
only on the sweep and on the number of the part.  The parts in order are therefore the output of a
single run, wherever they were computed.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import compress, groupby
from typing import Any, NamedTuple

import numpy as np

from ..errors import LagtopError, Message, SomeFailedError, marked
from ..files.tops import Product, TopsFile, read_tops
from ..names import RADIUS
from ..output.formats.base import format_of
from ..solver.keys import shown_keys
from ..top.given import Given, gather
from ..top.inputs import (
    EXAMPLE,
    FORMS,
    STEADY_WORDS,
    all_replaced,
    checked_double,
    overridden,
    replaced_by,
)
from ..top.ranges import Points
from ..top.units import DEGREES, RADIANS, Units
from ..top.values import Value
from .conditions import Condition, read_condition
from .records import check_keys, column_keys, records, with_radii

BLOCK_ROWS = 4096
"""Number of tops in a part, but for files of Parquet."""
NumberedBlock = tuple[int, Product | TopsFile]
"""The number of a part, and the tops that it is made of."""


class Part(NamedTuple):
    """One part, computed."""

    number: int
    text: Any
    """Its rows, as the format encodes them."""
    size: int
    """The number of tops."""
    rows: int
    """The number of rows: of the tops that satisfy the conditions."""
    failed: int
    """The number of tops that have an error."""
    first_error: str
    not_bodies: int = 0
    """The number of tops that are computed although no rigid body has C > 2A."""


class Sweep(NamedTuple):
    """Instructions for every part: the keys to compute and the format of the output.

    The bytes of the parts depend only on these, and on the content of a file of tops.
    """

    header: Sequence[str]
    """The names of the columns that are written: copied columns, and the keys."""
    ranges: Mapping[str, str]
    """The ranges of a grid, as texts."""
    shared: Mapping[str, Any]
    """Inputs of tops that do not have their own; psidot0 may be a word."""
    keys: Sequence[str]
    units: Units
    fmt: str
    is_body: bool
    """Whether a top that no body is has an error: inputs have units, or defaults of a body."""
    where: Sequence[Condition] = ()
    """The conditions that the tops of all rows satisfy."""

    def part(self, numbered: NumberedBlock) -> Part:
        """Compute one part."""
        number, block = numbered
        given = block.arrays(self.shared)
        keys = [*self.keys, *(x.key for x in self.where)]
        columns, errors, not_bodies = records(given, keys, are_bodies=self.is_body)
        if given.places is not None:
            places = {row: f"{given.places[row]}: " for row in errors}
            errors = {row: Message(places[row] + marked(errors[row])) for row in errors}
        if "error" in columns:
            columns["error"][[*errors]] = [*map(str, errors.values())]
        first = errors[min(errors)] if errors else ""
        counts = len(errors), first, not_bodies * (not self.is_body)
        written, rows = list[Any](given.carried), given.size
        if self.where:
            kept = np.logical_and.reduce([x.holds(columns[x.key]) for x in self.where])
            columns = {key: column[kept] for key, column in columns.items()}
            written = [[*compress(column, kept)] for column in written]
            rows = int(kept.sum())
        every = (columns[key] for key in self.keys)  # neighbouring columns of numbers as one array
        for are_numbers, run in groupby(every, lambda column: column.dtype == np.float64):
            some = [*run]
            written += [np.stack(some, axis=1)] if are_numbers else [x.tolist() for x in some]
        form = format_of(self.fmt)
        text = form.with_units(form.block(written, self.header), self._units())
        return Part(number, text, given.size, rows, *counts)

    def _units(self) -> dict[str, str]:
        """Return the units of keys and of their bounds."""
        keys = shown_keys(self.units, requested=True)
        return {x: keys[y].unit for x in self.keys if (y := x.removesuffix(RADIUS)) in keys}


def plan(
    path: str | None,
    axes: Mapping[str, Value],
    scene: str | None = None,
    *,
    keys: Sequence[str] | None = None,
    units: Units = DEGREES,
    fmt: str = "csv",
    decimal: str = "",
    radii: bool = False,
    where: Sequence[str] = (),
    blocks: int = 1,
) -> tuple[Sweep, Iterator[NumberedBlock], int, Given]:
    """Return a sweep, its blocks, size and inputs, for a grid or a `path` to a file of tops.

    The last axis varies fastest.  The size is the number of tops, 0 for a file.  The inputs are
    those that all tops share.  `where` are conditions, such as `T_nutation < 0.4`.  A part
    has `blocks` times 4096 tops.  Raises LagtopError.
    """
    conditions = [read_condition(text, units) for text in where]
    have_units = any(x.has_unit for x in conditions)
    chosen = with_radii(check_keys(keys, units), radii=radii)
    if path is None:
        found = gather(axes, scene, units=have_units)
        points = {name: x for name, x in found.inputs.items() if isinstance(x, Points)}
        grid, ranges = Product(points), _ranges(points)
        shared = shared_inputs(found, varying=ranges)
        units = units._replace(si=found.si)
        sweep = Sweep(chosen, ranges, shared, chosen, units, fmt, found.is_body, conditions)
        return sweep, enumerate(grid.blocks(blocks * BLOCK_ROWS)), grid.size, found
    if ranges := _ranges({name: x.number for name, x in axes.items()}):
        raise LagtopError(f"a file of tops takes no list or range, got one for {min(ranges)}")
    computed = {*column_keys(), *column_keys(RADIANS), *chosen, "error"}
    source = read_tops(path, computed, decimal)
    found = source.shared(axes, scene, units=have_units)
    shared = shared_inputs(found, varying=source.columns)
    with_error = list(dict.fromkeys([*chosen, "error"]))
    header = [*source.carried, *with_error]
    units = units._replace(si=found.si)
    sweep = Sweep(header, {}, shared, with_error, units, fmt, found.is_body, conditions)
    return sweep, enumerate(source.blocks(blocks * BLOCK_ROWS)), 0, found


def _ranges(axes: Mapping[str, Points | str]) -> dict[str, str]:
    """Return the axes that have more than one value, as texts; a word for psidot0 has one."""
    points = {name: axis for name, axis in axes.items() if isinstance(axis, Points)}
    return {name: str(axis) for name, axis in points.items() if axis.count > 1}


def shared_inputs(found: Given, *, varying: Collection[str] = ()) -> dict[str, Any]:
    """Return inputs by key as doubles; the worked example gives the missing ones.

    A word for psidot0 stays one.  Raises LagtopError for an invalid input; inputs in `varying`, and
    a steady rate, are not checked.
    """
    loose = set(varying)
    moments = {name for name in found.inputs if replaced_by(name) in {"A", "C"}}
    if all_replaced(loose) & {"A", "C"} or (moments & FORMS.keys() and loose & {"m", "s"}):
        loose |= moments  # C <= 2A
    numbers = {
        name: x.bounds()[0] if isinstance(x, Points) else x for name, x in found.inputs.items()
    }
    words = {name: x for name, x in numbers.items() if x in STEADY_WORDS}
    values = {name: found.values[name]._replace(number=x) for name, x in numbers.items()}
    found._replace(values=values).top(without={*loose, *words})
    doubles = {name: checked_double(name, x) for name, x in numbers.items() if name not in words}
    defaults = {name: float(x) for name, x in (EXAMPLE | dict(found.body)).items()}
    return overridden(defaults, doubles) | words


def noted(parts: Iterable[Part], done: list[Part]) -> Iterator[Part]:
    """Yield the parts, and add them to `done` without their texts."""
    for part in parts:
        done.append(part._replace(text=b""))
        yield part


def check(done: Sequence[Part], remedy: str = "") -> None:
    """Raise SomeFailedError if a top has an error; `remedy` ends the message."""
    if failed := [part for part in done if part.failed]:
        count, tops = sum(x.failed for x in failed), sum(x.size for x in done)
        first = marked(min(failed).first_error)
        found = f"{count} of {tops} tops have an error; the first: {first}"
        raise SomeFailedError(f"{found}{remedy}")
