"""Arrays of tops that start with any rates: gaps in pairs of doubles, and which to trust.

The formulas are those of `motion.gaps`.  Beside each gap goes a bound of its error, found from the
sizes of the numbers that were subtracted; a top whose digits such a difference has used up is not
trusted, and solved by itself.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from fractions import Fraction
from functools import cached_property, reduce
from math import factorial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import ARRAYS, PAIRS
from ..arithmetic.double_double import DoubleDouble
from ..arithmetic.numbers import polynomial
from ..arithmetic.types import Array, Mask
from ..motion.any_start import gaps_from_start
from ..motion.gaps import Gaps, State
from ..motion.kinds import Nutating
from ..motion.regime import Facts, Regime
from .mean_rates import MeanRates
from .top_arrays import TopArrays

EPS = 2.0**-100
"""Relative error of a few operations on pairs."""
_SETTLED = 2.0**-90
"""Relative error at which the largest root is settled."""
_GOOD = 2.0**-54
"""Relative error at which a gap is trusted; a rate, whose bound is wider, at eight times it."""
_SURE = 2.0**-10
"""Relative error at which a sign is trusted."""
_FACTS = Facts(regime=Regime.REGULAR, at_rest=False, steady=False, free=False, spins=True)
_NEWTON_STEPS = 50
_STEPS_IN_PAIRS = 4
_MEANS = {
    "mean_spin_rate": "spin",
    "mean_precession_rate": "precession",
    "T_spin": "spin",
    "T_precession": "precession",
}
"""The keys of the mean rates, and which of them."""
_DIFFERENCES = frozenset("u1 u2 spin_rate_start spin_rate_half precession_rate_half".split())
"""Keys in which larger numbers may cancel, so that they are computed in pairs."""


class StartArrays:
    """Motions of many tops with a torque, off the poles."""

    def __init__(self, tops: TopArrays) -> None:
        with PAIRS.working():  # what overflows or divides by zero is not trusted
            state = pair_state(tops)
            root = _LargestRoot(state)
            gaps = gaps_from_start(PAIRS, state, _FACTS, root.largest)
            self.fine = Nutating(PAIRS, _FACTS, state, gaps)
            self.rough = Nutating(ARRAYS, _FACTS, _rounded(state), _rounded(gaps))
            self.errors = _ErrorBounds(state, gaps, root.error)

    @cached_property
    def means(self) -> MeanRates:
        """Mean rates of the tops."""
        return MeanRates(self.rough.r0, self.rough.k_prime, self.fine.gaps)

    def trusted(self, keys: Collection[str]) -> Mask:
        """Return which tops are sure, as far as some keys need it."""
        with PAIRS.working():
            if not {*_MEANS, "spin_rate_start"} & set(keys):
                return self.errors.small
            return self.errors.small & self._rates_are_sure()

    def number(self, key: str) -> Array | None:
        """Return the numbers of a key, an array over all tops; None where no top has one."""
        with PAIRS.working():
            if key in Nutating.lacks:
                return None
            if key in _MEANS:
                mean: Array = getattr(self.means, _MEANS[key])
                return 2 * np.pi / abs(mean) if key.startswith("T_") else mean
            if key in _DIFFERENCES:
                value: Any = getattr(self.fine, key)
                return None if value is None else value.high
            rough: Array | None = getattr(self.rough, key)
            return rough

    def paths(self) -> NDArray[np.object_]:
        """Return the paths of the axis."""
        b, gaps = np.sign(self.rough.b), self.rough.gaps
        looping = (b * gaps.momentum_u1 < 0) & (b * gaps.momentum_u2 > 0)
        names = np.array(["wavy", "looping"], dtype=object)
        paths: NDArray[np.object_] = names[looping.astype(np.intp)]
        return paths

    @property
    def noise(self) -> Array:
        """Bound of the relative errors of the gaps, and of what is made of them."""
        return self.errors.worst + EPS

    @cached_property
    def precession_size(self) -> Array:
        """Size of the mean precession rate if nothing in it cancelled."""
        rough, sizes = self.rough, self.errors.momenta
        mc, gaps = rough.k_prime * rough.k_prime, rough.gaps

        def size_of_part(from_u1: Array, from_u2: Array) -> Array:
            """Return the part of the rate if nothing in it cancelled: a mean <= 1/sqrt(p)."""
            part: Array = sizes[0] / from_u1 + sizes[1] * mc / (
                from_u1 * np.sqrt(np.minimum(mc * from_u2 / from_u1, 1.0))
            )
            return part

        south = size_of_part(gaps.below_u1, gaps.below_u2)
        north = size_of_part(gaps.above_u1, gaps.above_u2)
        return south + north

    def _rates_are_sure(self) -> Mask:
        """Return where the mean rates keep their digits, however their parts cancel."""
        rough, noise, size = self.rough, self.noise, self.precession_size
        sure = _is_sure(noise * size, self.means.precession)
        sure &= _is_sure(noise * (size + abs(rough.r0)), self.means.spin)
        at_start: Any = self.fine.spin_rate_start
        return sure & _is_sure(EPS * (abs(rough.r0) + abs(rough.state.psi_rate)), at_start.high)


def _is_sure(error: Array, value: Array) -> Mask:
    """Return where a value keeps the digits of a double."""
    sure: Mask = error < 8 * _GOOD * abs(value)
    return sure


class _LargestRoot:
    """Largest root of the cubic by Newton's method, and a bound of its relative error.

    `largest` is the solver that `gaps_from_start` asks for; it sets `error`.
    """

    def __init__(self, state: State[DoubleDouble]) -> None:
        self.error: Array = np.full_like(state.a.high, np.inf)

    def largest(self, ar: Any, c2: Any, c1: Any, c0: Any, bound: Any) -> DoubleDouble:
        """Return the root of x^3 + c2 x^2 + c1 x + c0: Viete's, and Newton's method from there."""
        b2, b1, b0 = c2.high, c1.high, c0.high
        x = np.fmin(bound.high, _vieta(b2, b1, b0))
        for _ in range(_NEWTON_STEPS):
            slope = (3 * x + 2 * b2) * x + b1
            step = (((x + b2) * x + b1) * x + b0) / slope
            x = np.where(slope > 0, x - step, x)
            if not (abs(step) > 1e-9 * x).any():
                break
        root = DoubleDouble(x)
        for _ in range(_STEPS_IN_PAIRS):
            value = ((root + c2) * root + c1) * root + c0
            slope = (3 * x + 2 * b2) * x + b1
            step = value.high / slope
            root = root - DoubleDouble(step)
            x = root.high
            left = self._left(abs(step), abs(slope), (abs(b2), abs(b1), abs(b0)), x)
            self.error = left / x
            if not (self.error > _SETTLED).any():
                break
        return root

    @staticmethod
    def _left(step: Array, slope: Array, sizes: tuple[Array, Array, Array], x: Array) -> Array:
        """Return a bound of the error after a step: its noise, the slope's, and the curvature."""
        b2, b1, b0 = sizes
        noise = EPS * (((x + b2) * x + b1) * x + b0)
        steep = 2.0**-49 * ((3 * x + 2 * b2) * x + b1)
        bound: Array = (noise + step * (steep + step * (3 * x + b2))) / slope
        return bound


def _vieta(b2: Array, b1: Array, b0: Array) -> Array:
    """Return the largest root of x^3 + b2 x^2 + b1 x + b0, whose roots are real, roughly."""
    square = (b2 * b2 - 3 * b1) / 9
    radius = np.sqrt(square)
    cosine = ((9 * b1 - 2 * b2 * b2) * b2 - 27 * b0) / (54 * square * radius)
    root: Array = 2 * radius * np.cos(np.arccos(np.clip(cosine, -1, 1)) / 3) - b2 / 3
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
        momentum, energy = start.momentum, start.energy
        c0 = (start.sin * start.theta_rate) ** 2
        c1_parts = abs(2 * b * momentum) + a * start.sin**2 + abs(2 * start.cos * energy)
        of_total = (EPS * c1_parts + 2 * error * (c1_parts + a * c0 / D)) / D
        larger, smaller = np.maximum(x1, x2), np.minimum(x1, x2)
        of_larger = of_total + larger * (error + EPS)
        of_smaller = smaller * (error + EPS + of_larger / larger)
        of_x1 = np.where(x1 >= x2, of_larger, of_smaller)
        of_x2 = np.where(x1 >= x2, of_smaller, of_larger)
        of_D = error * D
        self.momenta = abs(momentum) + abs(b) * x1, abs(momentum) + abs(b) * x2

        def bounds() -> Iterator[Array]:
            yield (of_x1 + of_x2) / doubles.u1_u2
            yield (EPS * above + of_x1) / doubles.above_u1
            yield (EPS * above + of_x2) / doubles.above_u2
            yield (EPS * below + of_x1) / doubles.below_u1
            yield (EPS * below + of_x2) / doubles.below_u2
            yield (of_D + EPS * D + a * of_x1) / doubles.a_u3_u1
            yield (of_D + EPS * D) / doubles.a_u3_above

        self.worst: Array = reduce(np.maximum, bounds())
        positive = reduce(np.minimum, (getattr(doubles, name) for name in _POSITIVE)) > 0
        signs = [
            (EPS * self.momenta[0] + abs(b) * of_x1) < _SURE * abs(doubles.momentum_u1),
            (EPS * self.momenta[1] + abs(b) * of_x2) < _SURE * abs(doubles.momentum_u2),
        ]
        self.small: Mask = positive & (self.worst < _GOOD) & signs[0] & signs[1]


_POSITIVE = ("u1_u2", "above_u1", "above_u2", "below_u1", "below_u2", "a_u3_u1", "a_u3_above")


def _rounded(pairs: Any) -> Any:
    """Return a named tuple of pairs as one of doubles."""
    return type(pairs)(*(x.high for x in pairs))


def pair_state(tops: TopArrays) -> State[DoubleDouble]:
    """Return constants and start of tops in pairs of doubles, as the cubic of any start needs them.

    The differences from r0 and from b^2/2 are NaN.
    """
    m, A, C, s, g, r0, theta_rate, psi_rate = (
        DoubleDouble(x) for x in (*tops[:6], tops.thetadot0, tops.psidot0)
    )
    a, b = (m * g * s / A).scaled(2), C * r0 / A
    sine, cosine = _half_tilt(tops)
    unused = DoubleDouble(np.broadcast_to(np.nan, r0.high.shape))  # by these formulas
    return State(
        a=a,
        b=b,
        r0=r0,
        sleep=unused,
        spin_drift=unused,
        pole_drift=unused,
        sin=(sine * cosine).scaled(2),
        cos=(cosine - sine) * (cosine + sine),
        sin_half=sine,
        cos_half=cosine,
        below=(cosine * cosine).scaled(2),
        above=(sine * sine).scaled(2),
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
    """Return the sine by its Taylor series, for |x| <= pi/4; small terms need doubles only."""
    square = x * x
    total = DoubleDouble(polynomial([x.high for x in _SINE_TAIL], square.high))
    for coefficient in reversed(_SINE):
        total = total * square + coefficient
    return total * x


_TERMS = [PAIRS.convert(Fraction((-1) ** n, factorial(2 * n + 1))) for n in range(15)]
_SINE, _SINE_TAIL = _TERMS[:8], _TERMS[8:]
"""Coefficients of the sine; from x^17 on they are below eps of the first."""
