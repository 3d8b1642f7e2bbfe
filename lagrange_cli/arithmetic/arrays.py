"""Arrays of doubles: arguments that are arrays, and blocks of them."""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import ArrayLike

from ..errors import LagtopError
from .text import quoted
from .types import Array


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
np.empty(2**19)  # glibc keeps freed memory from now on: pages are not faulted again in each call
