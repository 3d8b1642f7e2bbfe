"""Arrays for the steps of a computation on a block, which are used again and again.

Memory that is new costs more than most steps that write to it: the system hands it out in pages,
each of them cleared when it is first touched, and takes it back when an array is freed.
"""

from __future__ import annotations

from math import prod
from typing import Protocol, Self

import numpy as np

from .blocks import BLOCK
from .types import Array

_IDLE: list[Array] = []
"""Arrays of a block that nobody uses; taking one out and putting one in are safe in threads."""


class Space(Protocol):
    """Where the results of the steps of a computation go."""

    def new(self) -> Array | None:
        """Return an array to be written, for the `out` of a step; None for one of NumPy's own."""

    def free(self, *arrays: Array | None) -> None:
        """Take back arrays that are not needed any more."""


class Heap:
    """No workspace: every step makes a new array."""

    def new(self) -> None:
        """Return None, so that NumPy makes an array of the shape that comes out."""

    def free(self, *arrays: Array | None) -> None:
        """Leave the arrays to Python."""


HEAP = Heap()


class Workspace:
    """Arrays of one shape, lent by a stock that all blocks share.

    At the end of a `with` all of them go back, so none of them may be used after it.
    """

    def __init__(self, *shape: int) -> None:
        self.shape, self.size = shape, prod(shape)
        self._lent: list[Array] = []

    def new(self) -> Array:
        """Return an array whose content is arbitrary."""
        if self.size > BLOCK:
            return np.empty(self.shape)
        try:
            whole = _IDLE.pop()
        except IndexError:
            whole = np.empty(BLOCK)
        self._lent.append(whole)
        return whole[: self.size].reshape(self.shape)

    def free(self, *arrays: Array | None) -> None:
        """Take back arrays of `new` that are not needed any more."""
        for array in arrays:
            for i, whole in enumerate(self._lent):
                if array is not None and whole is array.base:
                    _IDLE.append(self._lent.pop(i))
                    break

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        _IDLE.extend(self._lent)
        self._lent.clear()
