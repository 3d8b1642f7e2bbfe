"""Numbers derived from a fitted motion: periods, mean rates and turning points.

Their uncertainties follow from the full covariance of the fit, by the exact derivatives of the
record.  The elementary formulas of fast tops are added for comparison.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..inputs.top import Top
from ..motion.record import KEYS, requested_keys
from ..motion.sensitivity.sensitivities import sensitivities
from ..motion.solve import solve
from .model import STATE, inputs_of

_SPIN = "mean_spin_rate"
_STANDS_FOR = {
    "T_nutation_elementary": "T_nutation",
    "precession_rate_elementary": "mean_precession_rate",
}
"""The exact numbers that elementary formulas stand for."""
_DERIVED = [
    *f"T_nutation T_precession mean_precession_rate {_SPIN} theta_min_deg theta_max_deg".split(),
    *("stability_factor", *_STANDS_FOR),
]
"""Keys of the record that are derived."""
_BY = {"a": ("g", 0.5), "b": ("r0", 1.0), "theta0": ("theta0_rad", 1.0)}
"""The inputs of a top with A = C = m = s = 1 that stand for a, b and theta0, and their slopes."""


class DerivedNumber(NamedTuple):
    """A number that follows from the fitted motion."""

    key: str
    value: float
    gradient: Array
    """Derivatives by the quantities of the fit, NaN if there is none."""
    meaning: str
    exact: str
    """The key of the exact number that an elementary formula approximates, or empty."""


def derived_numbers(values: Mapping[str, float], *, spins: bool) -> Iterator[DerivedNumber]:
    """Yield the numbers that follow from values of a, b and the start, and of r0 if it is known.

    The derivatives are in the order of the values.  Keys that the motion does not have are omitted.
    """
    top = Top(**inputs_of(*(values[name] for name in STATE)))
    motion, slopes = solve(top), sensitivities(top, _DERIVED).derivatives
    declared = KEYS | requested_keys()
    for key in _DERIVED:
        if key not in slopes or (key == _SPIN and not spins):
            continue
        by = [_BY.get(name, (name, 1.0)) for name in STATE]
        gradient = {name: slopes[key][x] * n for name, (x, n) in zip(STATE, by, strict=True)}
        value = float(getattr(motion, key))
        if key == _SPIN:  # the top has r0 = b: the spin of the body grows by (r0 - b) t more
            value += values["r0"] - values["b"]
            gradient |= {"r0": 1.0, "b": gradient["b"] - 1}
        in_order = np.array([gradient.get(name, 0.0) for name in values])
        yield DerivedNumber(key, value, in_order, declared[key].meaning, _STANDS_FOR.get(key, ""))
