"""Many tops at once: arrays in place of the numbers of a `Top`.

`motion.gaps` and `Top.tilt` compute their numbers from exact fractions.  Here the same numbers are
computed from pairs of doubles and rounded once, so that the formulas start from equal values.  The
measured inputs A_cm and phidot0 are converted to A and r0 in the same way, with fractions if a
cancellation could show.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import factorial
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.angle import Tilt
from ..arithmetic.arrays import PAIRS
from ..arithmetic.numbers import R, polynomial
from ..arithmetic.pairs import DoubleDouble, two_sum
from ..arithmetic.types import Array, Mask
from ..solver.gaps import State
from ..solver.regime import FAST, Facts, Regime, regimes
from ..top.derived import spin

_LARGE, _SMALL = 1e30, 1e-30
"""Sizes between which no formula leaves the range of doubles."""
_DEGREE = DoubleDouble(np.array([np.pi / 180]), np.array([2.9486522708701687e-19]))
_LEAST_DISTANCE = 2.0**-45
"""Distance of lambda from 1 beyond which a pair of doubles gives lambda - 1 to its last bit."""
_RATIONAL = (60, 90, 120)
"""Tilts in degrees whose cosines are rational, where a sum may be 0 or a tie."""
PAIR_EPS = 2.0**-100
"""Relative error of a few operations on pairs."""
_LITTLE_LEFT = 1e-10
"""Ratio of a sum to its parts, below which the sum has lost digits of its pairs."""


class TopArrays(NamedTuple):
    """The inputs of `Top`, an array each; the tilt is NaN in the unit that is not given."""

    m: Array
    A: Array
    C: Array
    s: Array
    g: Array
    r0: Array
    theta0_deg: Array
    thetadot0: Array
    psidot0: Array
    theta0_rad: Array

    def part(self, rows: Any) -> TopArrays:
        """Return some of the tops, by a slice, a mask or their row numbers."""
        return TopArrays(*(x[rows] for x in self))

    def one(self, row: int) -> dict[str, float]:
        """Return the inputs of one top, with the tilt in the given unit."""
        inputs = {name: float(x[row]) for name, x in zip(self._fields, self, strict=True)}
        unused = "theta0_rad" if np.isnan(inputs["theta0_rad"]) else "theta0_deg"
        if np.isnan(inputs[unused]):
            del inputs[unused]
        return inputs

    def tilt_in(self, radians: bool) -> Array:
        """Return theta0 in degrees or in radians."""
        if radians:
            return np.where(np.isnan(self.theta0_rad), np.radians(self.theta0_deg), self.theta0_rad)
        return np.where(np.isnan(self.theta0_deg), np.degrees(self.theta0_rad), self.theta0_deg)

    def regimes(self) -> dict[Regime, Mask]:
        """Return the rows of each regime, for tops released from rest with usual sizes.

        Tops with other initial rates, out of range or invalid belong to no regime here.
        """
        usual = self._usual() & (self.thetadot0 == 0) & (self.psidot0 == 0)
        none = np.zeros_like(usual)
        named = regimes(
            upright=(self.theta0_deg == 0) | (self.theta0_rad == 0),
            hanging=self.theta0_deg == 180,
            free=(self.s == 0) | (self.g == 0),
            separatrix=none,
            steady=none,
            no_spin=self.r0 == 0,
        )
        rows = {regime: usual & holds for regime, holds in named}
        return {regime: mask for regime, mask in rows.items() if mask.any()}

    def moving(self) -> Mask:
        """Return the moving tops of usual sizes, with a torque and off the vertical."""
        moving = self._usual() & (self.g > 0) & (self.s > 0)
        moving &= (self.theta0_deg != 0) & (self.theta0_rad != 0) & (self.theta0_deg != 180)
        moving &= (self.thetadot0 != 0) | (self.psidot0 != 0)
        return moving

    def _usual(self) -> Mask:
        """Return the valid tops of usual sizes, not next to the threshold of sleeping."""
        with np.errstate(all="ignore"):  # of wrong inputs too
            usual: Mask = 2 * self.A >= self.C
            for x in (self.m, self.A, self.C):
                usual &= (x >= _SMALL) & (x <= _LARGE)
            for x in (self.s, self.g, abs(self.r0), abs(self.thetadot0), abs(self.psidot0)):
                usual &= (x == 0) | (x >= _SMALL) & (x <= _LARGE)
            one_tilt = np.zeros_like(usual)
            for tilt, other, most in (
                (self.theta0_deg, self.theta0_rad, 180),
                (self.theta0_rad, self.theta0_deg, np.pi),
            ):
                one_tilt |= np.isnan(other) & ((tilt == 0) | (tilt >= _SMALL) & (tilt <= most))
            torque = self.m * self.g * self.s
            lam = (self.C * self.r0) ** 2 / (4 * self.A * torque)
            usual &= (torque == 0) | (lam == 0) | (lam >= _SMALL**2) & (lam <= _LARGE**2)
            usual &= one_tilt & ~(abs(lam - 1) < 2 * _LEAST_DISTANCE)
            return usual

    def fast(self) -> Mask:
        """Return which tops released from rest precess pseudo-regularly, b^2 >= 50 a."""
        a, b, *_ = self._constants().values()
        threshold = DoubleDouble(np.full_like(self.m, float(FAST)))
        fast: Mask = (b * b - a * threshold).high >= 0
        return fast

    def _constants(self) -> dict[str, DoubleDouble]:
        """Return the constants of the motion by their names in `State`."""
        m, A, C, s, g, r0 = (DoubleDouble(x) for x in self[:6])
        a, b = (m * g * s / A).scaled(2), C * r0 / A
        more = DoubleDouble(*two_sum(2 * self.A, -self.C))
        return {
            "a": a,
            "b": b,
            "r0": r0,
            "sleep": (b * b).scaled(0.5) - a,
            "spin_drift": (r0 * more / A).scaled(0.5),
            "pole_drift": r0 - b,
        }

    def state(self) -> State[Array]:
        """Return constants and start of tops released from rest, each rounded once."""
        constants = {name: x.high for name, x in self._constants().items()}
        return _state(constants, self.tilt(), np.zeros_like(self.m), np.zeros_like(self.m))

    def pair_state(self) -> State[DoubleDouble]:
        """Return constants and start of tops in pairs of doubles."""
        rates = DoubleDouble(self.thetadot0), DoubleDouble(self.psidot0)
        return _state(self._constants(), self._tilt_in_pairs(), *rates)

    def tilt(self) -> Tilt[Array]:
        """Return sines and cosines of theta0 and theta0/2, each with full relative accuracy."""
        tilt, rad = _tilt_of_degrees(self.theta0_deg), self.theta0_rad
        in_radians = ~np.isnan(rad)
        if not in_radians.any():
            return tilt
        given = np.sin(rad), np.cos(rad), np.sin(rad / 2), np.cos(rad / 2)
        return Tilt(*(np.where(in_radians, x, y) for x, y in zip(given, tilt, strict=True)))

    def _tilt_in_pairs(self) -> Tilt[DoubleDouble]:
        """Return sines and cosines of theta0 and theta0/2 in pairs, from the nearer pole."""
        in_radians = ~np.isnan(self.theta0_rad)
        down = np.where(in_radians, self.theta0_rad > np.pi / 2, self.theta0_deg > 90)
        nearer = DoubleDouble(np.where(down, 180 - self.theta0_deg, self.theta0_deg)) * _DEGREE
        if in_radians.any():
            given = DoubleDouble(np.where(in_radians, self.theta0_rad, 0.0))
            other = DoubleDouble(np.full_like(given.high, 180.0)) * _DEGREE - given
            given = DoubleDouble.choose(down, other, given)
            nearer = DoubleDouble.choose(in_radians, given, nearer)
        sine = _sine(nearer.scaled(0.5))
        cosine = (1.0 - sine * sine).sqrt()
        sine, cosine = (
            DoubleDouble.choose(down, *both) for both in ((cosine, sine), (sine, cosine))
        )
        return Tilt((sine * cosine).scaled(2), (cosine - sine) * (cosine + sine), sine, cosine)


def _state(constants: Mapping[str, R], tilt: Tilt[R], theta_rate: R, psi_rate: R) -> State[R]:
    """Return the start of tops from their constants, tilts and rates."""
    return State(
        **constants,
        **tilt._asdict(),
        below=2 * tilt.cos_half * tilt.cos_half,
        above=2 * tilt.sin_half * tilt.sin_half,
        theta_rate=theta_rate,
        psi_rate=psi_rate,
    )


def _tilt_of_degrees(tilt: Array) -> Tilt[Array]:
    """Return sines and cosines of a pair high + low, such as sin(high) + low cos(high)."""
    nearer = np.minimum(tilt, 180 - tilt)
    arc, up = DoubleDouble(nearer) * _DEGREE, DoubleDouble(*two_sum(90.0, -nearer)) * _DEGREE
    sin, sin_half, cos_half = np.sin(arc.high), np.sin(arc.high / 2), np.cos(arc.high / 2)
    cos = np.sin(up.high) + up.low * sin
    sin += arc.low * cos
    near, far = sin_half + arc.low / 2 * cos_half, cos_half - arc.low / 2 * sin_half
    low = tilt > 90
    return Tilt(sin, np.where(low, -cos, cos), np.where(low, far, near), np.where(low, near, far))


def _sine(x: DoubleDouble) -> DoubleDouble:
    """Return the sine by its Taylor series, for |x| <= pi/4; small terms need doubles only."""
    square = x * x
    total = DoubleDouble(polynomial([x.high for x in _SINE_TAIL], square.high))
    for coefficient in reversed(_SINE):
        total = total * square + coefficient
    return total * x


_TERMS = [PAIRS.convert(Fraction((-1) ** n, factorial(2 * n + 1))) for n in range(15)]
_SINE, _SINE_TAIL = _TERMS[:8], _TERMS[8:]
"""Coefficients of the sine; from x^17 on they are below eps of the first."""


def facts_at_rest(regime: Regime, r0: Array) -> Facts:
    """Return the facts common to all tops of a regime that are released from rest."""
    plane = regime is Regime.NO_SPIN
    sign = np.where(r0 < 0, -1.0, 1.0)
    return Facts(
        regime=regime,
        at_rest=True,
        steady=regime not in {Regime.REGULAR, Regime.NO_SPIN},
        free=regime is Regime.TORQUE_FREE,
        spins=regime is Regime.REGULAR,
        pole={Regime.SLEEPING: 1, Regime.HANGING: -1}.get(regime, 0),
        upper_root=3 if plane else 0,
        over_bottom=plane,
        cusp=regime is Regime.REGULAR,
        sign_plus=sign,
        sign_minus=1 if plane else -sign,
    )


def top_arrays(inputs: Mapping[str, Any], size: int) -> TopArrays:
    """Return the inputs of tops, numbers or arrays, as arrays; A_cm and phidot0 are resolved.

    A missing input is NaN.
    """

    def filled(name: str) -> Array:
        values = inputs.get(name)
        return np.broadcast_to(np.float64(np.nan if values is None else values), (size,))

    tops = TopArrays(*map(filled, TopArrays._fields))
    A_cm, phi_rate = filled("A_cm"), filled("phidot0")
    if not np.isnan(A_cm).all():  # Steiner's theorem; `Top` refuses a negative A_cm
        with np.errstate(all="ignore"):
            s = DoubleDouble(tops.s)
            moment = (DoubleDouble(A_cm) + DoubleDouble(tops.m) * (s * s)).high
        cases = [np.isnan(A_cm), A_cm < 0]
        tops = tops._replace(A=np.select(cases, [tops.A, A_cm], moment))
    if not np.isnan(phi_rate).all():
        tops = tops._replace(r0=_spins(tops, phi_rate))
    return tops


def _spins(tops: TopArrays, phi_rate: Array) -> Array:
    """Return phi' + psi' cos(theta0) (4,1), or r0 if phi' is missing."""
    psi_rate = tops.psidot0
    with np.errstate(all="ignore"):
        precession = DoubleDouble(psi_rate) * tops.pair_state().cos
        spins = np.where(psi_rate == 0, phi_rate, (DoubleDouble(phi_rate) + precession).high)
        unsure = ~(abs(spins) > _LITTLE_LEFT * abs(phi_rate)) | np.isin(tops.theta0_deg, _RATIONAL)
        unsure &= (psi_rate != 0) & np.isfinite(phi_rate) & np.isfinite(psi_rate)
    for row in np.flatnonzero(unsure).tolist():
        spins[row] = spin(tops.one(row) | {"phidot0": float(phi_rate[row])})
    return np.where(np.isnan(phi_rate), tops.r0, spins)
