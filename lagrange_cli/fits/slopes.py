"""Derivatives of the numbers of a record by the inputs of a search."""

from __future__ import annotations

import math

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..motion.record import NUMBER_KEYS
from ..motion.sensitivity.sensitivities import sensitivities
from .search import Search

_STEP = 1e-5
"""Steps over the range of an unknown: the error of a central difference is about their square."""


def number_slopes(search: Search, point: Array) -> Array:
    """Return the derivatives of the numbers, a row each, by the unknowns, a column each.

    They are exact for the keys of the record, and differences for those on request.
    """
    slopes = _exact(search, point)
    if slopes is None or not np.isfinite(slopes).all():
        return _differences(search, point)
    return slopes


def _exact(search: Search, point: Array) -> Array | None:
    """Return exact derivatives; None where a key has none, or where there is no top."""
    keys = {key: key.replace("_rad", "_deg") for key in search.conditions.numbers}
    if not set(keys.values()) <= set(NUMBER_KEYS):
        return None
    try:
        found = sensitivities(search.top(point.tolist()), list(keys.values())).derivatives
        slopes = [[found[keys[key]][name] for name in search.spans] for key in keys]
    except (LagtopError, KeyError):
        return None
    units = np.array([math.pi / 180 if key.endswith("_rad") else 1.0 for key in keys])
    exact: Array = np.array(slopes) * units[:, np.newaxis]
    return exact


def _differences(search: Search, point: Array) -> Array:
    """Return central differences."""
    low, high = search.ends
    steps = np.diag(_STEP * (high - low))
    above, below = np.minimum(point + steps, high), np.maximum(point - steps, low)
    found = search.swept(np.concatenate([above, below]))
    count = len(point)
    slopes: Array = ((found[:count] - found[count:]) / np.diag(above - below)[:, np.newaxis]).T
    return slopes
