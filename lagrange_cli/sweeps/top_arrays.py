"""Many tops at once: arrays in place of the numbers of a `Top`.

What `motion.gaps` and `Top.tilt` form from exact fractions is formed here from pairs of doubles and
rounded once, so that the formulas start from the same numbers.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.double_double import DoubleDouble, two_sum
from ..arithmetic.exact_cosine import Tilt
from ..arithmetic.types import Array, Mask
from ..motion.gaps import State
from ..motion.regime import FAST, Regime, regimes

_LARGE, _SMALL = 1e30, 1e-30
"""Between these sizes no formula leaves the range of doubles."""
_DEGREE = DoubleDouble(np.array([np.pi / 180]), np.array([2.9486522708701687e-19]))
_LEAST_DISTANCE = 2.0**-45
"""Distance of lambda from 1 from which on a pair of doubles gives lambda - 1 to its last bit."""


class TopArrays(NamedTuple):
    """The inputs of `Top`, an array each; the tilt is NaN in the unit it is not given in."""

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
        """Return the inputs of one top, with the tilt in the unit that it is given in."""
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
        """Return the rows of each regime, of tops released from rest whose sizes are usual.

        The others start with other rates, are out of range or invalid; they belong to none here.
        """
        with np.errstate(all="ignore"):  # of wrong inputs too
            usual = self._usual()
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
        """Return the tops of usual sizes, with a torque, off the vertical, that start moving."""
        with np.errstate(all="ignore"):
            usual = self._usual_sizes() & (self.g > 0) & (self.s > 0)
            for rate in (self.thetadot0, self.psidot0):
                usual &= (rate == 0) | (abs(rate) >= _SMALL) & (abs(rate) <= _LARGE)
            tilt = np.where(np.isnan(self.theta0_deg), self.theta0_rad, self.theta0_deg)
            usual &= (tilt != 0) & (self.theta0_deg != 180)
            usual &= (self.thetadot0 != 0) | (self.psidot0 != 0)
            return usual

    def arc_from_pole(self) -> tuple[DoubleDouble, Mask]:
        """Return the angle from the nearer pole in radians, and whether that is the lower one."""
        in_radians = ~np.isnan(self.theta0_rad)
        down = np.where(in_radians, self.theta0_rad > np.pi / 2, self.theta0_deg > 90)
        degrees = np.where(down, 180 - self.theta0_deg, self.theta0_deg)
        arc = DoubleDouble(degrees) * _DEGREE
        if not in_radians.any():
            return arc, down
        given = DoubleDouble(np.where(in_radians, self.theta0_rad, 0.0))
        other = DoubleDouble(np.full_like(given.high, 180.0)) * _DEGREE - given
        high = np.where(in_radians, np.where(down, other.high, given.high), arc.high)
        low = np.where(in_radians, np.where(down, other.low, given.low), arc.low)
        return DoubleDouble(high, low), down

    def _usual(self) -> Mask:
        usual = self._usual_sizes()
        usual &= (self.thetadot0 == 0) & (self.psidot0 == 0)
        return usual

    def _usual_sizes(self) -> Mask:
        usual: Mask = 2 * self.A >= self.C
        for x in (self.m, self.A, self.C):
            usual &= (x >= _SMALL) & (x <= _LARGE)
        for x in (self.s, self.g, abs(self.r0)):
            usual &= (x == 0) | (x >= _SMALL) & (x <= _LARGE)
        tilts = ((self.theta0_deg, self.theta0_rad, 180), (self.theta0_rad, self.theta0_deg, np.pi))
        one_tilt = np.zeros_like(usual)
        for tilt, other, most in tilts:
            one_tilt |= np.isnan(other) & ((tilt == 0) | (tilt >= _SMALL) & (tilt <= most))
        torque = self.m * self.g * self.s
        lam = (self.C * self.r0) ** 2 / (4 * self.A * torque)
        ratio = (torque == 0) | (lam == 0) | (lam >= _SMALL**2) & (lam <= _LARGE**2)
        far = ~(abs(lam - 1) < 2 * _LEAST_DISTANCE)
        usual &= one_tilt & ratio & far
        return usual

    def state(self) -> State[Array]:
        """Return constants and start of tops released from rest, each rounded once."""
        m, A, C, s, g, r0 = (DoubleDouble(x) for x in self[:6])
        a, b = (m * g * s / A).scaled(2), C * r0 / A
        more = DoubleDouble(*two_sum(2 * self.A, -self.C))
        sin, cos, sin_half, cos_half = self.tilt()
        zero = np.zeros_like(sin)
        return State(
            a=a.high,
            b=b.high,
            r0=self.r0,
            sleep=((b * b).scaled(0.5) - a).high,
            spin_drift=(r0 * more / A).high / 2,
            pole_drift=(r0 - b).high,
            sin=sin,
            cos=cos,
            sin_half=sin_half,
            cos_half=cos_half,
            below=2 * cos_half * cos_half,
            above=2 * sin_half * sin_half,
            theta_rate=zero,
            psi_rate=zero,
        )

    def fast(self) -> Mask:
        """Return which tops released from rest precess pseudo-regularly, b^2 >= 50 a."""
        m, A, C, s, g, r0 = (DoubleDouble(x) for x in self[:6])
        b, threshold = C * r0 / A, DoubleDouble(np.full_like(self.m, float(FAST)))
        fast: Mask = (b * b - (m * g * s / A).scaled(2) * threshold).high >= 0
        return fast

    def tilt(self) -> Tilt[Array]:
        """Return sines and cosines of theta0 and theta0/2, each with full relative accuracy."""
        in_radians = ~np.isnan(self.theta0_rad)
        if in_radians.all():
            return _tilt_of_radians(self.theta0_rad)
        tilt = _tilt_of_degrees(self.theta0_deg)
        if not in_radians.any():
            return tilt
        other = _tilt_of_radians(self.theta0_rad)
        return Tilt(*(np.where(in_radians, x, y) for x, y in zip(other, tilt, strict=True)))


def _tilt_of_radians(tilt: Array) -> Tilt[Array]:
    return Tilt(np.sin(tilt), np.cos(tilt), np.sin(tilt / 2), np.cos(tilt / 2))


def _tilt_of_degrees(tilt: Array) -> Tilt[Array]:
    nearer = np.minimum(tilt, 180 - tilt)
    arc, rest = _in_radians(DoubleDouble(nearer))
    sin, sin_half, cos_half = np.sin(arc), np.sin(arc / 2), np.cos(arc / 2)
    up, up_rest = _in_radians(DoubleDouble(*two_sum(90.0, -nearer)))
    cos = np.sin(up) + up_rest * sin
    sin += rest * cos
    near, far = sin_half + rest / 2 * cos_half, cos_half - rest / 2 * sin_half
    low = tilt > 90
    return Tilt(sin, np.where(low, -cos, cos), np.where(low, far, near), np.where(low, near, far))


def _in_radians(degrees: DoubleDouble) -> tuple[Array, Array]:
    arc = degrees * _DEGREE
    return arc.high, arc.low
