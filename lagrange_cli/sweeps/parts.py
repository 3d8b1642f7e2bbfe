"""A sweep cut into parts: blocks of tops that any process can compute, in any order.

The bytes of a part depend on nothing but its number, so a run on one machine writes what all parts
hold in their order, wherever each of them was made.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..errors import SomeFailedError
from ..inputs.ranges import Block
from ..output.row_texts import Columns
from ..output.write import block_text
from .measured_arrays import top_arrays
from .records import records
from .results import Column

if TYPE_CHECKING:
    from ..inputs.units import System

NumberedBlock = tuple[int, Block]
"""The number of a part, and the tops that it is made of."""
Make = Callable[[NumberedBlock], "Part"]
"""What computes a part; a worker that is sent it must be able to unpickle it."""


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
    """Whether the worker that computed it wrote it into its folder, and sent no text back."""


class Sweep(NamedTuple):
    """What to do with every part: what to compute of it and how to write it."""

    header: Sequence[str]
    """The names of the columns that are written: what is carried through, and the keys."""
    shared: Mapping[str, float]
    """Inputs of all tops that have none of their own."""
    keys: Sequence[str]
    radians: bool
    fmt: str
    until_error: bool = False
    """Whether the rows of a part end before the first top that has an error."""
    stds: Sequence[tuple[str, float]] = ()
    """Standard uncertainties of inputs that all tops share, by name."""
    system: System | None = None
    """The units of the output, which remarks name, where inputs have units."""

    @property
    def computed_keys(self) -> list[str]:
        """The keys, and after them their uncertainties."""
        if not self.stds:
            return list(self.keys)
        from .uncertain_rows import std_keys

        return [*self.keys, *std_keys(self.keys)]

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
            from .uncertain_rows import std_columns

            columns |= std_columns(columns, tops, given.inputs, dict(self.stds))
        computed = runs_of([columns[key][rows] for key in self.computed_keys])
        text = block_text([*carried, *computed], self.header, self.fmt)
        return Part(number, text, given.size, len(errors), errors[0][1] if errors else "")


def runs_of(columns: Iterable[Column]) -> Columns:
    """Return neighbouring columns of numbers as one array of rows, and texts as lists."""
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


def shard_of(
    blocks: Iterable[NumberedBlock], shard: tuple[int, int] | None
) -> Iterator[NumberedBlock]:
    """Return every N-th block from the I-th on, for the shard (I, N), or all blocks."""
    first, step = shard or (1, 1)
    return (block for block in blocks if block[0] % step == first - 1)


class Tally:
    """A count of the tops that have an error, taken as the parts pass by."""

    def __init__(self, *, fail_fast: bool = False) -> None:
        self.fail_fast = fail_fast
        self.count = self.failed = self.shown = 0
        self.first: tuple[int, str] | None = None
        """The part with the first error, and that error."""

    def add(self, part: Part) -> None:
        """Count one part."""
        self.count, self.failed = self.count + part.size, self.failed + part.failed
        if part.failed:
            found = part.number, part.first_error
            self.first = min(self.first, found) if self.first else found

    def passing(self, parts: Iterable[Part]) -> Iterator[Part]:
        """Yield the parts, counted."""
        for part in parts:
            self.add(part)
            yield part

    def until_error(self, parts: Iterable[Part], *, ended: bool) -> Iterator[Part]:
        """Yield the parts, counted, to the first error and no further.

        There the parts end, or SomeFailedError is raised before the part with the error.
        """
        for part in self.passing(parts):
            if not ended:
                self.check()
            yield part
            if self.failed:
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
            raise SomeFailedError(
                f"{self.failed} of {self.count} tops have an error; the first: {self.first[1]}"
            )
