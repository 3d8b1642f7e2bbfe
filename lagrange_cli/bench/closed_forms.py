"""Closed forms to compare: lagtop, Legendre's integrals by scipy.special, and the paper's series.

The last two use plain doubles, with the formulas of a handbook and of the paper.  The scipy.special
form starts from the roots of lagtop.  A new closed form is one entry in CLOSED_FORMS.  Equation
numbers in parentheses are Chrapan's.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np

from ..arithmetic.numbers import DOUBLES
from ..arithmetic.types import Array
from ..elliptic.many_digits import ManyDigits
from ..inputs.names import ANGLES
from ..inputs.top import Top
from ..motion.solve import solve
from .method import AngleFunction, Method, NotApplicableError, Run


def _ours(top: Top, _: str) -> AngleFunction:
    sampler = solve(top).sampler()
    return lambda t: Run(sampler.angles(t))


def _ours_in_digits(top: Top, digits: int) -> AngleFunction:
    import mpmath

    from ..motion.over_time.proved_table import ProvedTable  # start-up

    def sample(t: Array) -> Run:
        table = ProvedTable(solve(top), ANGLES, digits, radians=True)
        rows = [table.row(Fraction(time)) for time in t.tolist()]
        with mpmath.workdps(digits + 10):
            return Run(
                [[mpmath.mpf(x.value) for x in column] for column in zip(*rows, strict=True)]
            )

    return sample


def _legendre(top: Top, _: str) -> AngleFunction:
    """Return sn^2 by ellipj, and Legendre's third integral by Carlson's R_F and R_J.

    With sn^2 counted from u1 and n = k^2 (1 +- u3)/(1 +- u1):

        1/(1 +- u) = 1/(1 +- u3) + (1/(1 +- u1) - 1/(1 +- u3))/(1 - n sn^2).
    """
    from scipy import special

    motion: Any = solve(top)  # a nutating motion has all these numbers
    u0 = math.cos(top.tilt(DOUBLES).degrees(DOUBLES) * math.pi / 180)
    r0, b, (u1, u2, u3) = float(top.r0), motion.b, (motion.u1, motion.u2, motion.u3)
    beta = float(top.psidot0) * (1 - u0 * u0) + b * u0
    K, T, m = motion.K, motion.T_nutation, motion.k**2
    speed = 2 * K / T

    def third(sign: int, w: Array) -> Array:
        at_u1, at_u3 = 1 + sign * u1, 1 + sign * u3
        n = m * at_u3 / at_u1
        turns = np.rint(w / (2 * K))
        sn, cn, dn, _ = special.ellipj(w - turns * 2 * K, m)
        whole = K + n / 3 * special.elliprj(0.0, 1 - m, 1.0, 1 - n)
        part = special.elliprf(cn * cn, dn * dn, 1.0)
        part += n / 3 * sn * sn * special.elliprj(cn * cn, dn * dn, 1.0, 1 - n * sn * sn)
        integral = 2 * turns * whole + sn * part
        result: Array = (w / at_u3 + (1 / at_u1 - 1 / at_u3) * integral) / speed
        return result

    def halves(w: Array) -> tuple[Array, Array]:
        return (beta + b) / 2 * third(1, w), (beta - b) / 2 * third(-1, w)

    start = 0.0
    if top.thetadot0 or abs(u0 - u2) < abs(u0 - u1):
        sn2 = (u1 - u0) * (u3 - u2) / ((u3 - u0) * (u1 - u2))
        start = float(special.ellipkinc(math.asin(math.sqrt(min(max(sn2, 0), 1))), m))
        start = math.copysign(start, top.thetadot0)
    first = halves(np.array(start))

    def sample(t: Array) -> Run:
        w = start + speed * t
        plus, minus = (now - then for now, then in zip(halves(w), first, strict=True))
        sn, _, dn, _ = special.ellipj(w - np.rint(w / (2 * K)) * 2 * K, m)
        u = u1 - (u1 - u2) * (1 - m) * (sn / dn) ** 2  # (4,20)
        return Run([np.arccos(u), (r0 - b) * t + plus - minus, plus + minus])

    return sample


class _Paper:
    """Constants of sections 4 to 7 in doubles, and the tilt."""

    def __init__(self, top: Top) -> None:
        if not top.is_released:
            raise NotApplicableError("the paper's formulas are for a top released from rest")
        ar = ManyDigits(17)  # for the tables of elliptic integrals; everything else is in doubles
        a = 2 * float(top.m) * float(top.g) * float(top.s) / float(top.A)
        r0, b = float(top.r0), float(top.C) * float(top.r0) / float(top.A)
        self.u1, self.sigma = top.tilt(DOUBLES).cos, 1 if r0 > 0 else -1
        root = math.sqrt(b**4 - 4 * a * b * b * self.u1 + 4 * a * a)
        u2, self.u3 = (b * b - root) / (2 * a), (b * b + root) / (2 * a)  # (4,11)
        gap = self.u3 - u2
        m, mc = (self.u1 - u2) / gap, (self.u3 - self.u1) / gap  # (4,19), (4,21)
        K, E = float(ar.ellipk(m)), float(ar.ellipe(m))
        self.k_prime, self.q = math.sqrt(mc), math.exp(-math.pi * float(ar.ellipk(mc)) / K)
        self.T = 4 * K / math.sqrt(a * gap)  # (5,1)
        amplitude = math.asin(math.sqrt(gap / (self.u3 + 1)))  # (7,2)
        alpha, E_amplitude = float(ar.ellipf(amplitude, mc)), float(ar.ellipe(amplitude, mc))
        self.y = math.pi * alpha / (2 * K)
        bracket = K * E_amplitude - (K - E) * alpha - math.pi / 4
        self.mean_spin = r0 - b / 2 + self.sigma * math.pi / self.T  # (6,3)
        self.mean_precession = a / (2 * b) * (2 - self.u3 + u2)
        self.mean_precession += self.sigma * 4 / self.T * bracket  # (7,3)

    def phase(self, t: Array) -> Array:
        """Return pi t/T without whole turns."""
        periods = t / self.T
        return np.pi * (periods - np.rint(periods))

    def tilt(self, x: Array, terms: int) -> Array:
        """Return (4,20), with dn^2 = k' (theta3/theta4)^2 from `terms` terms of both series."""
        theta3, theta4 = np.ones_like(x), np.ones_like(x)
        for h in range(1, terms + 1):
            wave = 2 * self.q ** (h * h) * np.cos(2 * h * x)
            theta3 += wave
            theta4 += -wave if h % 2 else wave
        u: Array = self.u3 - (self.u3 - self.u1) * (theta4 / theta3) ** 2 / self.k_prime
        return np.arccos(u)


def _mean_rates(top: Top, _: str) -> AngleFunction:
    """Return (6,3) and (7,3) without the periodic remainders."""
    p = _Paper(top)
    return lambda t: Run([p.tilt(p.phase(t), 3), p.mean_spin * t, p.mean_precession * t])


def _theta_series(top: Top, terms: int) -> AngleFunction:
    """Return (6,1) and (7,1) in the form for all times, with sums over h cut after `terms`."""
    p = _Paper(top)
    z = math.exp(-2 * p.y)

    def sample(t: Array) -> Run:
        x = p.phase(t)
        sin, cos = np.sin(2 * x), np.cos(2 * x)
        front = np.arctan2(z * sin, 1 - z * cos)
        spin, precession = np.zeros_like(x), np.zeros_like(x)
        for h in range(1, terms + 1):
            sign, twice = (1 if h % 2 else -1), 2 * p.q**h
            below = 1 + p.q ** (2 * h) + sign * twice * cos * math.cosh(2 * p.y)
            wave = np.arctan(twice * sin * math.sinh(2 * p.y) / below)
            spin += wave
            precession += sign * wave
        spin = p.mean_spin * t + p.sigma * (front - spin)
        return Run([p.tilt(x, terms), spin, p.mean_precession * t - p.sigma * (front + precession)])

    return sample


CLOSED_FORMS: dict[str, Method] = {
    "lagtop": Method(["double"], _ours),
    "lagtop-digits": Method([20, 30, 50], _ours_in_digits, costly=True),
    "scipy.special": Method(["double"], _legendre, package="scipy.special"),
    "mean-rates": Method(["double"], _mean_rates),
    "theta-series": Method([1, 2, 3, 6, 12], _theta_series),
}
