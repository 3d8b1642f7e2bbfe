"""Arrays of real numbers, given in Python."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import LagtopError
from .text import quoted
from .types import Array


def doubles_of(name: str, values: ArrayLike) -> Array:
    """Return the argument `name` as an array of doubles, infinite if a number is beyond them.

    Raises LagtopError for anything but an array of real numbers, and for masked elements.
    """
    if np.ma.isMaskedArray(values) and np.ma.getmaskarray(values).any():
        raise LagtopError(f"{name} must not be masked: fill it or leave the elements out", name)
    try:
        array = np.asarray(values)
        if array.size and array.dtype.kind not in "iufO":
            raise TypeError(array.dtype)
        with np.errstate(over="ignore"):  # of long doubles
            return array.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise LagtopError(f"{name} must be real numbers, got {quoted(values)}", name) from None
