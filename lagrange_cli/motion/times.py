"""Times that are given in Python: real numbers within reach."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.points import MAX_TIME
from ..arithmetic.text import quoted
from ..arithmetic.types import Array
from ..errors import LagtopError


def times_of(t: ArrayLike) -> Array:
    """Return times as float64.  Raises LagtopError for what is not an array of real numbers."""
    if np.ma.isMaskedArray(t) and np.ma.getmaskarray(t).any():
        raise LagtopError("t must not be masked: fill it or leave the elements out", "t")
    try:
        times = np.asarray(t)
        if times.size and times.dtype.kind not in "iufO":
            raise TypeError(times.dtype)
        return times.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise LagtopError(f"t must be real numbers, got {quoted(t)}", "t") from None


def check_times(times: Array, most: float, name: str = "t") -> float:
    """Return the greatest |t|.

    Raises LagtopError, by the `name` of the argument, if a time is not finite or beyond the last
    that names a phase.
    """
    if not times.size:
        return 0.0
    limit, low, high = min(most, MAX_TIME), float(times.min()), float(times.max())
    if low >= -limit and high <= limit:
        return max(-low, high)
    bad = times[~(np.abs(times) <= limit)]
    raise LagtopError(
        f"{name} must be finite and within 2^50 periods = {limit:.3g}, got {bad.flat[0]}", name
    )
