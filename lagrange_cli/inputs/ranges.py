"""Grids of inputs: ranges and lists of values, and the product of several."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from math import lcm, prod
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.text import parse_number
from ..arithmetic.types import Array
from ..errors import LagtopError

MAX_ROWS = 10**9


class Axis(NamedTuple):
    """The values of one input; each is formed from its own index and rounded once."""

    ends: tuple[Fraction, ...]
    """The values themselves, or the first and the last of a range."""
    size: int
    spacing: str = "list"
    """`list`, `linear` or `log`."""

    def values(self, index: ArrayLike) -> Array:
        """The values at some indices."""
        found, where = np.unique(index, return_inverse=True)
        return np.array(self._at(found.tolist()), dtype=np.float64)[where]

    def _at(self, index: Sequence[int]) -> list[float]:
        if self.spacing == "list":
            return [float(self.ends[i]) for i in index]
        first, last = self.ends
        steps = max(self.size - 1, 1)
        if self.spacing == "linear":  # integers, whose quotient Python rounds once
            scale = lcm(first.denominator, last.denominator) * steps
            start, step = int(first * scale), int((last - first) * scale) // steps
            return [(start + i * step) / scale for i in index]
        with localcontext(Context(prec=30)):
            growth = (_decimal(last) / _decimal(first)).ln()
            powers = ((growth * i / steps).exp() for i in index)
            return [float(_decimal(first) * power) for power in powers]


def _decimal(value: Fraction) -> Decimal:
    return value.numerator / Decimal(value.denominator)


def parse_axis(text: str) -> Axis:
    """The axis that `start:stop:count`, `log:start:stop:count` or `value,value,...` stands for.

    Raises LagtopError.
    """
    if ":" not in text:
        values = tuple(parse_number(part) for part in text.split(","))
        return Axis(values, len(values))
    spacing = "log" if text.startswith("log:") else "linear"
    parts = text.removeprefix("log:").split(":")
    if len(parts) != 3:
        raise LagtopError(
            f"must be a number, a list 1,2,3 or a range [log:]start:stop:count, got {text!r}"
        )
    first, last, count = map(parse_number, parts)
    if count.denominator != 1 or not 1 <= count <= MAX_ROWS:
        raise LagtopError(f"must have a whole count of 1 to 1e9 in its range, got {text!r}")
    if spacing == "log" and not first * last > 0:
        raise LagtopError(f"must have two ends of one sign, not 0, in a log: range, got {text!r}")
    if count == 1 and first != last:
        raise LagtopError(f"must have a count of 2 or more between different ends, got {text!r}")
    return Axis((first, last), int(count), spacing)


class Grid(NamedTuple):
    """The product of axes by input, the last one fastest."""

    axes: Mapping[str, Axis]

    @property
    def size(self) -> int:
        """How many points it has."""
        return prod(axis.size for axis in self.axes.values())

    def points(self, first: int, stop: int) -> dict[str, Array]:
        """The points from one number to before another, a column for each input."""
        left = np.arange(first, stop)
        columns = {}
        for name, axis in reversed(list(self.axes.items())):
            columns[name] = axis.values(left % axis.size)
            left //= axis.size
        return columns

    def blocks(self, size: int) -> Iterator[range]:
        """The numbers of its points, so many at a time."""
        for first in range(0, self.size, size):
            yield range(first, min(first + size, self.size))

    def check(self) -> None:
        """Raise LagtopError where it has more than 1e9 points."""
        if self.size > MAX_ROWS:
            raise LagtopError(f"a sweep has at most 1e9 tops, this one would have {self.size:.4g}")
