"""Arrays of inputs as they are measured, A_cm and phidot0, made into A and r0.

Sums are formed in pairs of doubles and rounded once; where that could show, fractions decide.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..arithmetic.double_double import DoubleDouble
from ..arithmetic.types import Array
from ..inputs.measured import spin
from .start_arrays import pair_state
from .top_arrays import TopArrays

_RATIONAL = (60, 90, 120)
"""Tilts in degrees whose cosines are rational, where a sum may be 0 or a tie."""
_LITTLE_LEFT = 1e-10
"""Share of the parts below which a sum has lost digits of its pairs."""


def top_arrays(inputs: Mapping[str, Any], size: int) -> TopArrays:
    """Return the inputs of tops, numbers or arrays, as arrays; A_cm and phidot0 are resolved.

    An input that is not there is NaN.
    """
    tops = TopArrays(*(_filled(inputs.get(name), size) for name in TopArrays._fields))
    A_cm, phi_rate = (_filled(inputs.get(name), size) for name in ("A_cm", "phidot0"))
    if not np.isnan(A_cm).all():
        tops = tops._replace(A=_moments(tops, A_cm))
    if not np.isnan(phi_rate).all():
        tops = tops._replace(r0=_spins(tops, phi_rate))
    return tops


def _filled(values: Any, size: int) -> Array:
    return np.broadcast_to(np.float64(np.nan if values is None else values), (size,))


def _moments(tops: TopArrays, A_cm: Array) -> Array:
    """Return A_cm + m s^2 (Steiner's theorem), or A where there is no A_cm.

    A negative A_cm is left as it is, for the guards of a top to refuse.
    """
    with np.errstate(all="ignore"):
        s, total = DoubleDouble(tops.s), DoubleDouble(A_cm)
        total = total + DoubleDouble(tops.m) * (s * s)
        moment = np.where(A_cm < 0, A_cm, total.high)
    return np.where(np.isnan(A_cm), tops.A, moment)


def _spins(tops: TopArrays, phi_rate: Array) -> Array:
    """Return phi' + psi' cos(theta0) (4,1), or r0 where there is no phi'."""
    psi_rate = tops.psidot0
    with np.errstate(all="ignore"):
        precession = DoubleDouble(psi_rate) * pair_state(tops).cos
        spins = np.where(psi_rate == 0, phi_rate, (DoubleDouble(phi_rate) + precession).high)
        unsure = ~(abs(spins) > _LITTLE_LEFT * abs(phi_rate)) | np.isin(tops.theta0_deg, _RATIONAL)
        unsure &= (psi_rate != 0) & np.isfinite(phi_rate) & np.isfinite(psi_rate)
    for row in np.flatnonzero(unsure).tolist():
        spins[row] = spin(tops.one(row) | {"phidot0": float(phi_rate[row])})
    return np.where(np.isnan(phi_rate), tops.r0, spins)
