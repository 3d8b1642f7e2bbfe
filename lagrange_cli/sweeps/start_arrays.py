"""Arrays of tops that start with any rates: gaps in pairs of doubles, and which to trust.

The formulas are those of `motion.gaps`.  Beside each gap goes a bound of its error, found from the
sizes of the numbers that were subtracted; a top whose digits such a difference has used up is not
trusted, and solved by itself.
"""

from __future__ import annotations

from fractions import Fraction
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import ARRAYS, PAIRS
from ..arithmetic.double_double import DoubleDouble, pair
from ..arithmetic.types import Array, Mask
from ..motion.gaps import Gaps, State, gaps_from_start
from ..motion.kinds import Nutating
from ..motion.record import CANCELLING
from ..motion.regime import Facts, Regime
from .top_arrays import TopArrays

_EPS = 2.0**-100
"""Relative error of a few operations on pairs."""
_GOOD = 2.0**-54
"""Relative error at which a gap is trusted; a rate, whose bound is wider, at eight times it."""
_SURE = 2.0**-10
"""Relative error at which a sign is trusted."""
_FACTS = Facts(regime=Regime.REGULAR, at_rest=False, steady=False, free=False, spins=True)
_NEWTON_STEPS = 200


class StartArrays:
    """Motions of many tops with a torque, off the poles; `trusted` marks those that are sure."""

    def __init__(self, tops: TopArrays) -> None:
        with PAIRS.working():  # what overflows or divides by zero is not trusted
            state = _state(tops)
            root = _LargestRoot(state)
            gaps = gaps_from_start(PAIRS, state, _FACTS, root.largest)
            self.fine = Nutating(PAIRS, _FACTS, state, gaps)
            self.rough = Nutating(ARRAYS, _FACTS, _rounded(state), _rounded(gaps))
            self.errors = _ErrorBounds(state, gaps, root.error)
            self.trusted: Mask = self.errors.small & self._rates_are_sure()

    def number(self, key: str) -> Array | None:
        """Return the numbers of a key, an array over all tops; None where no top has one."""
        with PAIRS.working():
            if key in {"T_spin", "T_precession"}:
                mean = (
                    self.fine.mean_spin_rate if key == "T_spin" else self.fine.mean_precession_rate
                )
                return np.asarray(2 * np.pi / abs(mean.high))
            if key in CANCELLING and key != "u_quarter":
                value: Any = getattr(self.fine, key)
                return None if value is None else value.high
            rough: Array | None = None if key in Nutating.lacks else getattr(self.rough, key)
            return rough

    def paths(self) -> NDArray[np.object_]:
        """Return the paths of the axis."""
        b, gaps = self.fine.b, self.fine.gaps
        looping = ((b * gaps.momentum_u1).high < 0) & ((b * gaps.momentum_u2).high > 0)
        return np.where(looping, "looping", "wavy").astype(object)

    def _rates_are_sure(self) -> Mask:
        """Return where the mean rates keep their digits, however their parts cancel."""
        fine, rough = self.fine, self.rough
        mc, gaps, sizes = rough.k_prime * rough.k_prime, rough.gaps, self.errors.momenta
        noise = self.errors.worst + _EPS

        def size_of_part(from_u1: Array, from_u2: Array) -> Array:
            """Return the part of the rate if nothing in it cancelled: a mean <= 1/sqrt(p)."""
            part: Array = sizes[0] / from_u1 + sizes[1] * mc / (
                from_u1 * np.sqrt(np.minimum(mc * from_u2 / from_u1, 1.0))
            )
            return part

        south = size_of_part(gaps.below_u1, gaps.below_u2)
        north = size_of_part(gaps.above_u1, gaps.above_u2)
        sure = _is_sure(noise * (south + north), fine.mean_precession_rate)
        sure &= _is_sure(noise * (south + north + abs(rough.r0)), fine.mean_spin_rate)
        return sure & _is_sure(
            _EPS * (abs(rough.r0) + abs(rough.state.psi_rate)), fine.spin_rate_start
        )


def _is_sure(error: Array, value: DoubleDouble | None) -> Mask:
    """Return where a value keeps the digits of a double."""
    assert value is not None
    sure: Mask = error < 8 * _GOOD * abs(value.high)
    return sure


class _LargestRoot:
    """Largest root of the cubic by Newton's method, and a bound of its relative error.

    `largest` is the solver that `gaps_from_start` asks for; it sets `error`.
    """

    def __init__(self, state: State[DoubleDouble]) -> None:
        self.error: Array = np.full_like(state.a.high, np.inf)

    def largest(self, ar: Any, c2: Any, c1: Any, c0: Any, bound: Any) -> DoubleDouble:
        """Return the root of x^3 + c2 x^2 + c1 x + c0; the first steps in doubles, from above."""
        b2, b1, b0, x = c2.high, c1.high, c0.high, bound.high
        for _ in range(_NEWTON_STEPS):
            step = (((x + b2) * x + b1) * x + b0) / ((3 * x + 2 * b2) * x + b1)
            x = np.where(step > 0, x - step, x)
            if not (step > 1e-9 * x).any():
                break
        root = DoubleDouble(x)
        for _ in range(4):
            value = ((root + c2) * root + c1) * root + c0
            slope = (3 * root.high + 2 * b2) * root.high + b1
            step = value.high / slope
            root = root - DoubleDouble(step)
        x = abs(root.high)
        terms = ((x + abs(b2)) * x + abs(b1)) * x + abs(b0)
        noise = _EPS * terms / abs(slope)
        self.error = (noise + abs(step) * (abs(step) > noise)) / x
        return root


class _ErrorBounds:
    """Bounds of the relative errors of the gaps.

    `worst` is the greatest of them per top, `small` says whether all gaps and the signs of
    beta - b u at u1 and u2 are sure, and `momenta` are the sizes of the terms of beta - b u there.
    """

    def __init__(self, state: State[DoubleDouble], gaps: Gaps[DoubleDouble], error: Array) -> None:
        start, doubles = _rounded(state), _rounded(gaps)
        a, b, above, below = start.a, start.b, start.above, start.below
        D, x1, x2 = doubles.a_u3_u, doubles.u1_u, doubles.u_u2
        around = start.psi_rate * start.sin
        momentum, energy = around * start.sin, start.theta_rate**2 + around**2
        c0 = (start.sin * start.theta_rate) ** 2
        c1_parts = abs(2 * b * momentum) + a * start.sin**2 + abs(2 * start.cos * energy)
        of_total = (_EPS * c1_parts + 2 * error * (c1_parts + a * c0 / D)) / D
        larger, smaller = np.maximum(x1, x2), np.minimum(x1, x2)
        of_larger = of_total + larger * (error + _EPS)
        of_smaller = smaller * (error + _EPS + of_larger / larger)
        of_x1 = np.where(x1 >= x2, of_larger, of_smaller)
        of_x2 = np.where(x1 >= x2, of_smaller, of_larger)
        of_D = error * D
        self.momenta = abs(momentum) + abs(b) * x1, abs(momentum) + abs(b) * x2
        self.worst: Array = np.maximum.reduce(
            [
                (of_x1 + of_x2) / doubles.u1_u2,
                (_EPS * above + of_x1) / doubles.above_u1,
                (_EPS * above + of_x2) / doubles.above_u2,
                (_EPS * below + of_x1) / doubles.below_u1,
                (_EPS * below + of_x2) / doubles.below_u2,
                (of_D + _EPS * D + a * of_x1) / doubles.a_u3_u1,
                (of_D + _EPS * D) / doubles.a_u3_above,
            ]
        )
        positive = np.minimum.reduce([getattr(doubles, name) for name in _POSITIVE]) > 0
        signs = [
            (_EPS * self.momenta[0] + abs(b) * of_x1) < _SURE * abs(doubles.momentum_u1),
            (_EPS * self.momenta[1] + abs(b) * of_x2) < _SURE * abs(doubles.momentum_u2),
        ]
        self.small: Mask = positive & (self.worst < _GOOD) & signs[0] & signs[1]


_POSITIVE = ("u1_u2", "above_u1", "above_u2", "below_u1", "below_u2", "a_u3_u1", "a_u3_above")


def _rounded(pairs: Any) -> Any:
    """Return a named tuple of pairs as one of doubles."""
    return type(pairs)(*(x.high for x in pairs))


def _state(tops: TopArrays) -> State[DoubleDouble]:
    m, A, C, s, g, r0, theta_rate, psi_rate = (
        DoubleDouble(x) for x in (*tops[:6], tops.thetadot0, tops.psidot0)
    )
    a, b = (m * g * s / A).scaled(2), C * r0 / A
    sine, cosine = _half_tilt(tops)
    return State(
        a=a,
        b=b,
        r0=r0,
        sleep=(b * b).scaled(0.5) - a,
        spin_drift=r0 - b.scaled(0.5),
        pole_drift=r0 - b,
        sin=(sine * cosine).scaled(2),
        cos=(cosine - sine) * (cosine + sine),
        sin_half=sine,
        cos_half=cosine,
        theta_rate=theta_rate,
        psi_rate=psi_rate,
    )


def _half_tilt(tops: TopArrays) -> tuple[DoubleDouble, DoubleDouble]:
    """Return sine and cosine of theta0/2, from the nearer pole."""
    nearer, down = tops.arc_from_pole()
    sine = _sine(nearer.scaled(0.5))
    cosine = (1.0 - sine * sine).sqrt()
    return DoubleDouble.choose(down, cosine, sine), DoubleDouble.choose(down, sine, cosine)


def _sine(x: DoubleDouble) -> DoubleDouble:
    """Return the sine by its Taylor series, for |x| <= pi/4."""
    square = x * x
    total = DoubleDouble(np.zeros_like(x.high))
    for n in range(29, 0, -2):
        high, low = pair(Fraction((-1) ** (n // 2), factorial(n)))
        total = total * square + DoubleDouble(np.full_like(x.high, high), np.full_like(x.high, low))
    return total * x
