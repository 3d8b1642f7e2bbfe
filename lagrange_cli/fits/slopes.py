"""Derivatives of the numbers of a record by the inputs of a search."""

from __future__ import annotations

import numpy as np

from ..arithmetic.types import Array
from .search import Search

_STEP = 1e-5
"""Steps over the range of an unknown: the error of a central difference is about their square."""


def number_slopes(search: Search, point: Array) -> Array:
    """Return the derivatives of the numbers, a row each, by the unknowns, a column each."""
    low, high = search.ends
    steps = np.diag(_STEP * (high - low))
    above, below = np.minimum(point + steps, high), np.maximum(point - steps, low)
    found = search.swept(np.concatenate([above, below]))
    count = len(point)
    slopes: Array = ((found[:count] - found[count:]) / np.diag(above - below)[:, np.newaxis]).T
    return slopes
