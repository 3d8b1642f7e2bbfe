"""Arrays of doubles and of pairs of doubles: their arithmetics, blocks, and order by parity.

The functions of `elliptic` take `ARRAYS` for NumPy arrays.  It is silent about overflow and 0/0,
whatever the host's `numpy.errstate` is.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager
from fractions import Fraction
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import LagtopError
from .pairs import PI, DoubleDouble, pair
from .text import quoted
from .types import Array


class Arrays:
    """The part of the arithmetic of float64 arrays that both kinds of arrays share."""

    eps, magnitude = 2.0**-52, -15.65
    pi: Any = np.pi
    nan: Any = np.nan
    sqrt: Any = staticmethod(np.sqrt)
    sin = staticmethod(np.sin)
    cos = staticmethod(np.cos)
    atan2: Any = staticmethod(np.arctan2)
    where: Any = staticmethod(np.where)

    @staticmethod
    def either(condition: Any) -> Any:
        """Return a condition that chooses between two valid methods; for balls it may be open."""
        return condition

    @staticmethod
    def working() -> AbstractContextManager[object]:
        """Return a context manager in which NumPy is silent about overflow and 0/0."""
        return np.errstate(all="ignore")

    @staticmethod
    def convert(value: Any) -> Any:
        """Return the double nearest to an exact value, or an array of doubles unchanged."""
        return value if isinstance(value, np.ndarray) else float(value)

    @staticmethod
    def anywhere(condition: Any) -> bool:
        """Return whether a condition holds for any element; NaN compares false, so loops end."""
        return bool(np.any(condition))

    @staticmethod
    def everywhere(condition: Any) -> bool:
        """Return whether a condition holds for every element."""
        return bool(np.all(condition))


class Pairs(Arrays):
    """The arithmetic of arrays of pairs of doubles, with the operations that are needed."""

    eps, magnitude = 2.0**-104, -31.31
    pi = DoubleDouble(np.array([PI.high]), np.array([PI.middle]))

    @staticmethod
    def convert(value: Any) -> Any:
        """Return an exact value as a pair with one element, which broadcasts with any array."""
        exact = Fraction(value) if isinstance(value, float | int) else value
        return DoubleDouble(*(np.array([part]) for part in pair(exact)))

    @staticmethod
    def sqrt(x: Any) -> Any:
        """Return the square roots; of a plain number, as a double."""
        return x.sqrt() if isinstance(x, DoubleDouble) else np.sqrt(float(x))

    @staticmethod
    def atan2(y: Any, x: Any) -> Any:
        """Return the angles of the points (x, y), to the accuracy of doubles."""
        return DoubleDouble(np.arctan2(y.high, x.high))

    where = staticmethod(DoubleDouble.choose)


ARRAYS, PAIRS = Arrays(), Pairs()


def doubles_of(name: str, values: ArrayLike) -> Array:
    """Return the argument `name` as an array of doubles, infinite where a number overflows.

    Raises LagtopError for anything but an array of real numbers, and for masked elements.
    """
    masked = sys.modules.get("numpy.ma")  # start-up: without it no array is masked
    if masked and masked.isMaskedArray(values) and masked.getmaskarray(values).any():
        raise LagtopError(f"{name} must not be masked: fill it or leave the elements out", name)
    try:
        array = np.asarray(values)
        if array.size and array.dtype.kind not in "iufO":
            raise TypeError(array.dtype)
        with np.errstate(over="ignore"):  # of long doubles
            return array.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise LagtopError(f"{name} must be real numbers, got {quoted(values)}", name) from None


BLOCK = 16384
"""Elements of an array that are computed together."""


def blocks(size: int) -> Iterator[slice]:
    """Yield slices that cover an array of `size` elements; one slice if it is empty."""
    return (slice(start, start + BLOCK) for start in range(0, max(size, 1), BLOCK))


Order = NDArray[np.intp] | list[slice]
"""The places of elements, one by one or in runs."""
_RUN = 250
"""Mean length of a run from which on it costs less to copy whole runs."""


def order_by_parity(whole: Array) -> tuple[int, Order | None]:
    """Return the number of even whole numbers, and their order; None if all have one parity."""
    ends = np.flatnonzero(whole[1:] != whole[:-1]) + 1
    if ends.size * _RUN > whole.size:
        half = 0.5 * whole
        odd = half != np.rint(half)
        even = np.flatnonzero(~odd)
        return even.size, np.concatenate([even, np.flatnonzero(odd)])
    runs: list[list[slice]] = [[], []]
    for start, stop in pairwise([0, *ends.tolist(), whole.size]):
        if start < stop:
            runs[int(whole[start]) % 2].append(slice(start, stop))
    return sum(run.stop - run.start for run in runs[0]), runs[0] + runs[1] if all(runs) else None


def taken(values: Array, order: Order, out: Array) -> Array:
    """Write values in the given order."""
    if isinstance(order, list):
        return np.concatenate([values[run] for run in order], out=out)
    return np.take(values, order, out=out, mode="clip")  # all are in range


def placed(values: Array, order: Order, out: Array) -> Array:
    """Write ordered values back to their places."""
    if isinstance(order, list):
        ends = accumulate((run.stop - run.start for run in order), initial=0)
        for run, (start, stop) in zip(order, pairwise(ends), strict=True):
            out[run] = values[start:stop]
    else:
        out[order] = values
    return out
