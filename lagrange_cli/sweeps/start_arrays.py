"""Roots of the cubic for arrays of tops that start with any rates, in pairs of doubles.

In x = u - u0 the cubic (4,9) is a x^3 + c2 x^2 + c1 x + (sin(theta0) thetadot0)^2.  Its largest
root x3 comes from Newton's method, x1 >= 0 >= x2 from a quadratic equation whose discriminant is a
sum of positive terms; so the gaps between them have the digits of a double unless the top is close
to a steady precession, the separatrix or a pole.  `clear` says which are not.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import cached_property
from math import factorial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic import double_double as twofold
from ..arithmetic.double_double import Twofold
from ..arithmetic.types import Array, Mask
from ..elliptic import complete_k
from ..motion.cubic import Place, Start
from ..motion.general import Solution
from ..motion.general_record import GeneralNutation, half_rates, mean_rates
from ..motion.regime import Regime
from ..motion.released import complement, modulus, phase_rate
from ..motion.roots import Roots
from .top_arrays import Tops

_CLEAR = 2.0**-40
"""Of its parts at least, so that a difference of pairs has the digits of a double."""
_NEWTON_STEPS = 80


class State(NamedTuple):
    """The state at t = 0 and constants of the motion, to about 100 bits."""

    a: Twofold
    b: Twofold
    r0: Twofold
    below: Twofold
    """1 + cos(theta0)."""
    above: Twofold
    """1 - cos(theta0)."""
    sin: Twofold
    theta_rate: Twofold
    psi_rate: Twofold

    @property
    def u(self) -> Twofold:
        """cos(theta0)."""
        return (self.below - self.above).scaled(0.5)

    @property
    def around(self) -> Twofold:
        """psidot0 sin(theta0)."""
        return self.psi_rate * self.sin

    def start(self) -> Start:
        """It in doubles."""
        momentum = self.around * self.sin
        energy = self.theta_rate * self.theta_rate + self.around * self.around
        return Start(
            a=self.a.high,
            b=self.b.high,
            r0=self.r0.high,
            psi_rate=self.psi_rate.high,
            theta_rate=self.theta_rate.high,
            u=self.u.high,
            alpha=(energy + self.a * self.u).high,
            beta=(momentum + self.b * self.u).high,
            beta_plus_b=(momentum + self.b * self.below).high,
            beta_minus_b=(momentum - self.b * self.above).high,
            drift=(self.r0 - self.b).high,
        )


class Starts(NamedTuple):
    """An array of tops, and where what is said of them is to be trusted."""

    state: State
    roots: Roots
    place: Place
    path: NDArray[np.object_]
    clear: Mask

    def nutation(self) -> GeneralNutation:
        """The numbers of the clear ones."""
        state, roots, place = (_part(x, self.clear) for x in (self.state, self.roots, self.place))
        return PairedNutation(state, roots, place, self.path[self.clear])


class PairedNutation(GeneralNutation):
    """Numbers in doubles, from pairs; the rates, whose parts may cancel, in pairs to the end."""

    def __init__(self, state: State, roots: Roots, place: Place, path: Any) -> None:
        self.pairs = state, roots, place
        rounded, where = Roots(*_rounded(roots)), Place(*_rounded(place))
        k, k_prime = modulus(np, rounded), complement(np, rounded)
        speed = phase_rate(np, state.a.high, rounded)
        period = 2 * complete_k(np, k_prime) / speed
        solution = Solution(
            Regime.REGULAR, state.start(), rounded, where, k, k_prime, speed, period
        )
        super().__init__(np, solution, path)

    @cached_property
    def spin_rate_start(self) -> Array:
        """As given."""
        state, _, _ = self.pairs
        return (state.r0 - state.psi_rate * state.u).high

    @cached_property
    def _mean_rates(self) -> tuple[Array, Array]:
        state, roots, place = self.pairs
        k_prime = twofold.sqrt(roots.u3_u1 / roots.u3_u2)
        spin, precession = mean_rates(twofold, state.r0, roots, place, k_prime)
        return spin.high, precession.high

    @cached_property
    def _half_rates(self) -> tuple[Array, Array]:
        state, roots, place = self.pairs
        spin, precession = half_rates(state.r0, state.b, roots, place)
        assert spin is not None
        assert precession is not None
        return spin.high, precession.high


def _rounded(pairs: Iterable[Any]) -> list[Array]:
    return [x.high for x in pairs]


def _part(values: Any, rows: Mask) -> Any:
    """Some of the rows of a named tuple of pairs."""
    return type(values)(*(Twofold(x.high[rows], x.low[rows]) for x in values))


def starts(tops: Tops) -> Starts:
    """Roots, constants and paths of tops with a torque, off the poles, of usual sizes."""
    state = _state(tops)
    with np.errstate(all="ignore"):  # what overflows or divides by zero is not clear
        return _solved(state)


def _state(tops: Tops) -> State:
    m, A, C, s, g, r0, theta_rate, psi_rate = (
        Twofold(x) for x in (*tops[:6], tops.thetadot0, tops.psidot0)
    )
    sine, cosine = _half_tilt(tops)
    return State(
        a=(m * g * s / A).scaled(2),
        b=C * r0 / A,
        r0=r0,
        below=(cosine * cosine).scaled(2),
        above=(sine * sine).scaled(2),
        sin=(sine * cosine).scaled(2),
        theta_rate=theta_rate,
        psi_rate=psi_rate,
    )


def _half_tilt(tops: Tops) -> tuple[Twofold, Twofold]:
    """Sine and cosine of theta0/2, from the nearer pole."""
    nearer, down = tops.arc_from_pole()
    sine = _sine(nearer.scaled(0.5))
    cosine = twofold.sqrt(1.0 - sine * sine)
    return _either(down, cosine, sine), _either(down, sine, cosine)


def _either(condition: Mask, yes: Twofold, no: Twofold) -> Twofold:
    return Twofold(np.where(condition, yes.high, no.high), np.where(condition, yes.low, no.low))


def _sine(x: Twofold) -> Twofold:
    """The Taylor series, for |x| <= pi/4."""
    square = x * x
    total = Twofold(np.zeros_like(x.high))
    for n in range(29, 0, -2):
        term = Fraction((-1) ** (n // 2), factorial(n))
        high = float(term)
        total = total * square + Twofold(
            np.full_like(x.high, high), np.full_like(x.high, float(term - Fraction(high)))
        )
    return total * x


def _solved(state: State) -> Starts:
    a, b, u, sin, around = state.a, state.b, state.u, state.sin, state.around
    energy = state.theta_rate * state.theta_rate + around * around
    c0 = (sin * state.theta_rate) * (sin * state.theta_rate)
    parts = (b * around * sin).scaled(2), -(a * sin * sin), -(u * energy).scaled(2)
    c1 = parts[0] + parts[1] + parts[2]
    c2 = (a * u).scaled(2) - energy - b * b
    x3 = _largest_root(a, c2, c1, c0)
    product = -(c0 / (a * x3))
    total = (c1 / a - product) / x3
    spread = twofold.sqrt(total * total - product.scaled(4))
    larger = (abs(total) + spread).scaled(0.5)
    smaller = product / larger
    up = total.high >= 0  # the two have opposite signs
    x1, x2 = _either(up, larger, -smaller), _either(up, smaller, -larger)
    gaps = {
        "u3_u1": (x3, x1),
        "below_u1": (state.below, -x1),
        "below_u2": (state.below, -x2),
        "above_u1": (state.above, x1),
        "above_u2": (state.above, x2),
        "u3_above": (x3, state.above),
    }
    differences = {name: more - less for name, (more, less) in gaps.items()}
    clear = np.isfinite(x3.high) & (x3.high - x1.high > 2.0**-20 * x3.high)
    for name, (more, less) in gaps.items():
        clear &= differences[name].high > _CLEAR * np.maximum(abs(more.high), abs(less.high))
    noise = sum(abs(part.high) for part in parts)
    clear &= a.high * x3.high * spread.high > 64 * _CLEAR * noise
    roots = Roots(
        u1=u + x1,
        u2=u + x2,
        u3=u + x3,
        u1_u2=spread,
        u3_u2=x3 - x2,
        below_u3=state.below + x3,
        **differences,
    )
    momentum = around * sin
    place = Place(x1, -x2, x3, momentum - b * x1, momentum - b * x2)
    still = momentum / b - x1  # from u1 to where the precession would stand still
    clear &= (b.high == 0) | (abs(still.high) > 1e-6 * spread.high)
    looping = (b.high != 0) & (still.high < 0) & (still.high > -spread.high)
    return Starts(state, roots, place, np.where(looping, "looping", "wavy").astype(object), clear)


def _largest_root(a: Twofold, c2: Twofold, c1: Twofold, c0: Twofold) -> Twofold:
    """By Newton's method from above, where it is monotonic; the last steps in pairs."""
    b2, b1, b0 = c2.high / a.high, c1.high / a.high, c0.high / a.high
    x = 2 * np.maximum(abs(b2), np.maximum(np.sqrt(abs(b1)), np.cbrt(abs(b0))))
    for _ in range(_NEWTON_STEPS):
        step = (((x + b2) * x + b1) * x + b0) / ((3 * x + 2 * b2) * x + b1)
        x = x - step
        if not (abs(step) > 1e-9 * x).any():
            break
    root = Twofold(x)
    for _ in range(3):
        value = ((a * root + c2) * root + c1) * root + c0
        slope = (3 * a.high * root.high + 2 * c2.high) * root.high + c1.high
        root = root - Twofold(value.high / slope)
    return root
