"""The unit of the error of a value that changes with time, as the READMEs define it."""

from __future__ import annotations

import math
from typing import Any

import mpmath

EPS = 2.0**-52


def error_in_units(computed: float, exact: Any, rate: Any, tau: Any) -> float:
    """Return |computed - exact| over eps (max(1, |exact|) + |tau rate|); NaN has an infinite one.

    The second term is the effect of one rounding of tau, the time since the last whole period.
    """
    if not math.isfinite(computed):
        return math.inf
    unit = EPS * float(max(1, abs(exact)) + abs(tau * rate))
    return float(abs(mpmath.mpf(computed) - exact)) / unit
