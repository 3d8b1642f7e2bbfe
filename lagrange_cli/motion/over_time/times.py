"""Times that are given in Python: real numbers within reach."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...arithmetic.arrays import doubles_of
from ...arithmetic.points import MAX_TIME
from ...arithmetic.types import Array
from ...errors import LagtopError


def times_of(t: ArrayLike) -> Array:
    """Return times as float64.  Raises LagtopError for what is not an array of real numbers."""
    return doubles_of("t", t)


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
