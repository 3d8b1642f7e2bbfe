"""A sweep cut into parts: blocks of tops that any process can compute, in any order.

The bytes of a part depend on nothing but its number, so a run on one machine writes what all parts
hold in their order, wherever each of them was made.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..errors import SomeFailedError
from ..inputs.ranges import Product
from ..inputs.tops_file import Lines, RowFile
from ..output.write import Columns, block_text
from .records import Column, records
from .top_arrays import Tops

Block = tuple[int, range | Lines]
"""The number of a part, and the points of the grid or the lines of the file that it is made of."""


class Part(NamedTuple):
    """One part, computed."""

    number: int
    text: bytes
    tops: int
    """How many tops it has."""
    failed: int
    """How many of them have an error."""
    first_error: str


class Inputs(NamedTuple):
    """The tops of a part, and what goes with each of them."""

    tops: Tops
    carried: Sequence[Sequence[Any]] = ()
    """Columns that are carried through."""
    lines: Sequence[int] | None = None
    errors: Mapping[int, str] | None = None
    """What is already known to be wrong, by row."""


class Sweep(NamedTuple):
    """What to do with every part: where the inputs stand, what to compute, how to write it."""

    source: Product | RowFile
    given: Mapping[str, float]
    """Inputs that all tops share, or that a row may lack."""
    keys: Sequence[str]
    radians: bool
    style: str

    @property
    def header(self) -> list[str]:
        """The names of the columns."""
        carried = self.source.carried if isinstance(self.source, RowFile) else ()
        return [*carried, *self.keys]

    def part(self, block: Block) -> Part:
        """Compute one part."""
        number, place = block
        inputs = self._inputs(place)
        found = records(
            inputs.tops, [*self.keys, "error"], radians=self.radians, errors=inputs.errors
        )
        errors = [(row, error) for row, error in enumerate(found["error"]) if error]
        if inputs.lines is not None:
            errors = [(row, f"line {inputs.lines[row]}: {error}") for row, error in errors]
        for row, error in errors:
            found["error"][row] = error
        columns = [*inputs.carried, *_runs([found[key] for key in self.keys])]
        text = block_text(columns, self.header, self.style)
        return Part(number, text, inputs.tops.m.size, len(errors), errors[0][1] if errors else "")

    def _inputs(self, place: range | Lines) -> Inputs:
        if isinstance(self.source, Product):
            assert isinstance(place, range)
            given = {**self.given, **self.source.columns(place)}
            return Inputs(Tops(*(_column(given.get(x), len(place)) for x in Tops._fields)))
        assert isinstance(place, Lines)
        rows = list(self.source.rows(place))
        filled = [row.completed(self.given) for row in rows]
        return Inputs(
            Tops(*(np.array([x.get(name, np.nan) for x in filled]) for name in Tops._fields)),
            list(zip(*(row.carried for row in rows), strict=True)),
            [row.line for row in rows],
            {i: row.error for i, row in enumerate(rows) if row.error},
        )


def _column(value: Any, count: int) -> Any:
    return np.broadcast_to(np.float64(np.nan if value is None else value), (count,))


def _runs(columns: Iterable[Column]) -> Columns:
    """Neighbouring columns of numbers as one array of rows, and texts as lists."""
    runs: list[Any] = []
    numbers: list[Column] = []
    for column in columns:
        if column.dtype == np.float64:
            numbers.append(column)
            continue
        if numbers:
            runs.append(np.stack(numbers, axis=1))
            numbers = []
        runs.append(column.tolist())
    return [*runs, np.stack(numbers, axis=1)] if numbers else runs


def shard_of(blocks: Iterable[Block], which: tuple[int, int] | None) -> Iterator[Block]:
    """Every N-th block, from the I-th on."""
    first, step = which or (1, 1)
    return (block for block in blocks if block[0] % step == first - 1)


class Tally:
    """Counts the tops that have an error as the parts pass by."""

    def __init__(self, *, fail_fast: bool = False) -> None:
        self.fail_fast = fail_fast
        self.count = self.failed = 0
        self.first = ""

    def passing(self, parts: Iterable[Part]) -> Iterator[Part]:
        """The parts.  With `fail_fast`, raises SomeFailedError at the first one with an error."""
        for part in parts:
            self.count, self.failed = self.count + part.tops, self.failed + part.failed
            self.first = self.first or part.first_error
            if self.fail_fast:
                self.check()
            yield part

    def texts(self, parts: Iterable[Part]) -> Iterator[bytes]:
        """What there is to write."""
        return (part.text for part in self.passing(parts))

    def check(self) -> None:
        """Raise SomeFailedError if there was any error."""
        if self.failed and self.fail_fast:
            raise SomeFailedError(self.first)
        if self.failed:
            raise SomeFailedError(
                f"{self.failed} of {self.count} tops have an error; the first: {self.first}"
            )
