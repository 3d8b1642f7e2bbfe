"""Long arrays, a block at a time, so that the steps of a computation stay in the cache.

The arrays of these steps are used again and again: memory that is new costs more than most steps
that write to it.  The system hands it out in pages, each of them cleared when it is first touched,
and takes it back when an array is freed.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from math import prod

import numpy as np

from .types import Array

BLOCK = 16384
"""Elements of an array that are computed together."""
ROWS = 16
"""Arrays of a workspace."""
_IDLE: list[Array] = []
"""Workspaces that nobody uses; taking one out and putting one in are safe in threads."""


def blocks(size: int) -> Iterator[slice]:
    """Yield slices that cover an array of so many elements; one slice where it is empty."""
    return (slice(start, start + BLOCK) for start in range(0, max(size, 1), BLOCK))


@contextmanager
def workspace(*shape: int) -> Iterator[Array]:
    """Yield `ROWS` arrays of one shape, of at most a block of elements; their content is arbitrary.

    None of them may be used after the `with`.
    """
    try:
        whole = _IDLE.pop()
    except IndexError:
        whole = np.empty((ROWS, BLOCK))
    try:
        yield whole[:, : prod(shape)].reshape(ROWS, *shape)
    finally:
        _IDLE.append(whole)
