"""Times that are given in Python: real numbers within reach."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.points import MAX_TIME
from ..arithmetic.real_arrays import doubles_of
from ..arithmetic.types import Array
from ..errors import LagtopError


def times_of(t: ArrayLike) -> Array:
    """Return times as float64.  Raises LagtopError for what is not an array of real numbers."""
    return doubles_of("t", t)


def check_times(times: Array, most: float, name: str = "t") -> None:
    """Raise LagtopError where a time is not finite or beyond the last that names a phase.

    `name` is that of the argument.
    """
    limit = min(most, MAX_TIME)
    if not times.size or (times.min() >= -limit and times.max() <= limit):
        return
    bad = times[~(np.abs(times) <= limit)]
    raise LagtopError(
        f"{name} must be finite and within 2^50 periods = {limit:.3g}, got {bad.flat[0]}", name
    )
