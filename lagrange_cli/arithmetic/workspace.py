"""Arrays for the steps of a computation on a block, which are used again and again.

Memory that is new costs more than most steps that write to it: the system hands it out in pages,
each of them cleared when it is first touched, and takes it back when an array is freed.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from math import prod

import numpy as np

from .blocks import BLOCK
from .types import Array

ROWS = 16
_IDLE: list[Array] = []
"""Workspaces that nobody uses; taking one out and putting one in are safe in threads."""


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
