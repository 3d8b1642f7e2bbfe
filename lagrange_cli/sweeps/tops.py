"""The inputs of many tops as arrays, and the start of their motions.

`solve` takes the constants of a motion from exact fractions.  Here they are computed in pairs of
doubles and rounded once, so that the formulas begin with equal numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import factorial
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.bounded import EPS, PAIR_EPS, Bounded, size_of
from ..arithmetic.bounded import choose as bounded_choice
from ..arithmetic.pairs import DoubleDouble, pair
from ..arithmetic.types import Array, Mask
from ..solver.facts import Regime
from ..top.top import Top
from ..top.values import STEADY_WORDS

_SMALL, _LARGE = 1e-30, 1e30
"""Sizes between which no formula leaves the range of doubles."""
_DEGREE = DoubleDouble(np.array([np.pi / 180]), np.array([2.9486522708701687e-19]))
_NEAR_1 = 2.0**-44
"""Distance of lambda = b^2/2a from 1 below which a pair of doubles may lose lambda - 1."""
_LITTLE_LEFT = 1e-10
"""Ratio of a sum to its parts below which the sum has lost digits of its pairs."""
_MOST_SPIN = 1e150
"""Size of a rate up to which sums and products of pairs cannot overflow."""


class TopArrays(NamedTuple):
    """The inputs of `Top`, an array each; NaN where an input is not given.

    Only the tilt may be NaN, in the unit that is not given, and `A_cm` and `phidot0`, which are
    kept for tops whose r0 only `solve` computes.
    """

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
    phidot0: Array
    steady: Array
    """1 or 2 for the words of a steady precession, for which psidot0 is NaN; else 0."""

    def part(self, rows: Any) -> TopArrays:
        """Return some of the tops, by a slice, a mask or their row numbers."""
        return TopArrays(*(x[rows] for x in self))

    def one(self, row: int) -> Top:
        """Return one top.  Raises LagtopError if it is invalid."""
        inputs: dict[str, Any] = {x: float(y[row]) for x, y in self._asdict().items()}
        del inputs["phidot0" if np.isnan(inputs["phidot0"]) else "r0"]
        del inputs["theta0_rad" if np.isnan(inputs["theta0_rad"]) else "theta0_deg"]
        if word := int(inputs.pop("steady")):
            inputs["psidot0"] = STEADY_WORDS[word - 1]
        return Top(**inputs)

    def tilt_in(self, *, radians: bool) -> Array:
        """Return theta0 in degrees or in radians."""
        if radians:
            return np.where(np.isnan(self.theta0_rad), np.radians(self.theta0_deg), self.theta0_rad)
        return np.where(np.isnan(self.theta0_deg), np.degrees(self.theta0_rad), self.theta0_deg)

    def groups(self) -> dict[Regime | None, Mask]:
        """Return the tops of ordinary size that the formulas of sweeps compute.

        Tops released from rest, and steady ones given by a word, are keyed by their regime; None
        has those with other initial rates, with a torque and off the vertical.
        """
        ordinary, steady, falls = self._are_ordinary(), self.steady > 0, self.thetadot0 != 0
        upright, hanging = (self.theta0_deg == 0) | (self.theta0_rad == 0), self.theta0_deg == 180
        inclined, torque = ordinary & ~(upright | hanging), (self.s > 0) & (self.g > 0)
        at_rest = ~falls & (self.psidot0 == 0)
        return {
            Regime.SLEEPING: ordinary & at_rest & upright,
            Regime.HANGING: ordinary & at_rest & hanging,
            Regime.TORQUE_FREE: inclined & at_rest & ~torque,
            Regime.NO_SPIN: inclined & at_rest & torque & (self.r0 == 0),
            Regime.REGULAR: inclined & at_rest & torque & (self.r0 != 0),
            Regime.STEADY: inclined & steady & torque & ~falls,
            None: inclined & ~steady & torque & (falls | (self.psidot0 != 0)),
        }

    def _are_ordinary(self) -> Mask:
        """Return the valid tops whose sizes fit, and that are not next to the sleeping threshold.

        Comparisons with NaN are false: tops that lack an input are not among them.
        """

        def fits(x: Array, most: float = _LARGE) -> Mask:
            return (x >= _SMALL) & (x <= most)

        ordinary: Mask = (2 * self.A >= self.C) & fits(self.m) & fits(self.A) & fits(self.C)
        rate: Array = np.where(self.steady > 0, 0.0, self.psidot0)
        for x in (self.s, self.g, abs(self.r0), abs(self.thetadot0), np.abs(rate)):
            ordinary &= (x == 0) | fits(x)
        deg, rad = self.theta0_deg, self.theta0_rad
        ordinary &= (np.isnan(rad) & ((deg == 0) | fits(deg, 180))) | (
            np.isnan(deg) & ((rad == 0) | fits(rad, np.pi))
        )
        torque = self.m * self.g * self.s
        lam = (self.C * self.r0) ** 2 / (4 * self.A * torque)
        ordinary &= (torque == 0) | (lam == 0) | (lam >= _SMALL**2) & (lam <= _LARGE**2)
        return ordinary & ~(abs(lam - 1) < _NEAR_1)

    def half_tilt(self, *, pairs: bool) -> tuple[Bounded, Bounded]:
        """Return sine and cosine of theta0/2, in doubles or in pairs of doubles.

        The half angle is taken from the nearer pole, so that its relative error is that of both.
        """
        deg, rad = self.theta0_deg, self.theta0_rad
        given = ~np.isnan(rad)
        down = np.where(given, rad > np.pi / 2, deg > 90)
        arc = DoubleDouble(np.where(down, 180 - deg, deg)) * _DEGREE
        if given.any():
            own = DoubleDouble(rad)
            other = DoubleDouble(np.full_like(rad, 180.0)) * _DEGREE - own
            choose = DoubleDouble.choose
            arc = choose(given, choose(down, other, own), arc)
        half = arc.scaled(0.5)
        if pairs:
            near = _sine(half)
            far = (1.0 - near * near).sqrt()
        else:
            near, far = np.sin(half.high), np.cos(half.high)
            near, far = near + half.low * far, far - half.low * near
        unit = 8 * PAIR_EPS if pairs else 3 * EPS
        of_difference = np.where(given & down, 4 * PAIR_EPS, 0.0)  # pi - theta0
        near = Bounded(near, unit * size_of(near) + of_difference)
        far = Bounded(far, unit * size_of(far))
        return bounded_choice(down, far, near), bounded_choice(down, near, far)


_SINE = [pair(Fraction((-1) ** n, factorial(2 * n + 1))) for n in range(15)]
"""Coefficients of the sine in x^2; from x^17 on, their low parts do not count."""


def _sine(x: DoubleDouble) -> DoubleDouble:
    """Return the sine by its Taylor series, for |x| <= pi/4."""
    square = x * x
    tail = np.zeros_like(square.high)
    for term in _SINE[:7:-1]:
        tail = tail * square.high + term.high
    total = DoubleDouble(tail)
    for term in _SINE[7::-1]:
        total = total * square + DoubleDouble(*map(np.array, term))
    return total * x


def top_arrays(inputs: Mapping[str, Any], size: int) -> TopArrays:
    """Return the inputs of tops, numbers or arrays; A_cm and phidot0 are converted to A and r0.

    A missing input is NaN.  psidot0 may be a word of a steady precession, or an array of objects
    with such words among its numbers.
    """
    rate, (slow, fast) = inputs.get("psidot0"), STEADY_WORDS
    steady = np.float64(rate == slow) + 2 * np.float64(rate == fast)
    if steady.any():
        rate = np.where(steady > 0, np.nan, np.array(rate, dtype=object)).astype(float)
    numbers = {**inputs, "psidot0": rate}

    def filled(name: str) -> Array:
        value = numbers.get(name)
        return np.broadcast_to(np.float64(np.nan if value is None else value), (size,))

    A_cm, no_rate = filled("A_cm"), np.broadcast_to(np.nan, (size,))
    tops = TopArrays(
        *[*map(filled, TopArrays._fields[:-2]), no_rate, np.broadcast_to(steady, (size,))]
    )
    if not np.isnan(A_cm).all():  # Steiner's theorem; `Top` refuses a negative A_cm
        with np.errstate(all="ignore"):
            s = DoubleDouble(tops.s)
            moment = (DoubleDouble(A_cm) + DoubleDouble(tops.m) * (s * s)).high
        cases = [np.isnan(A_cm), A_cm < 0]
        tops = tops._replace(A=np.select(cases, [tops.A, A_cm], moment))
    if not np.isnan(phi_rate := filled("phidot0")).all():
        tops = _with_spins(tops, phi_rate)
    return tops


def _with_spins(tops: TopArrays, phi_rate: Array) -> TopArrays:
    """Return tops with r0 = phi' + psi' cos(theta0) (4,1) where phi' is given.

    Where the sum may have lost digits, or psi' is a word, r0 is NaN and phidot0 is kept.
    """
    psi_rate, given = tops.psidot0, ~np.isnan(phi_rate)
    with np.errstate(all="ignore"):
        sine, cosine = (x.value for x in tops.half_tilt(pairs=True))
        along = DoubleDouble(psi_rate) * (cosine - sine) * (cosine + sine)
        spins = (DoubleDouble(phi_rate) + along).high
        size = abs(phi_rate) + abs(psi_rate)
        lost = ~(abs(spins) > _LITTLE_LEFT * size) & (psi_rate != 0) | ~(size < _MOST_SPIN)
    return tops._replace(
        r0=np.where(given, np.where(lost, np.nan, spins), tops.r0),
        phidot0=np.where(given & lost, phi_rate, np.nan),
    )
