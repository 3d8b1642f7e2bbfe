"""Keys on request of the elementary theory: stability, steady precession, fast tops.

The keys depend only on a = 2mgs/A (4,4), b = C r0/A (4,5), the tilt and A/C. They need no solution
of the motion.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ...arithmetic.exact_cosine import U
from ...arithmetic.numbers import R, absolute
from ...arithmetic.values import Over
from ...inputs.steady_rate import FAST, SLOW, SteadyRates, rational_root
from ..gaps import State
from ..quantity import key, keys_of
from ..regime import Exact

if TYPE_CHECKING:
    from ...arithmetic.protocol import Arithmetic

elementary_key = partial(key, "Steady precession and elementary theory")
rate_key = partial(elementary_key, unit="rad/time")


class Textbook(Over[R]):
    """Numbers of the elementary theory for any start; None if a number does not exist."""

    def __init__(self, ar: Arithmetic[R], exact: Exact, start: State[R]) -> None:
        self.ar, self.exact, self.steady = ar, exact, SteadyRates(exact.a, exact.b, exact.cosine)
        self.a, self.b, self.cos = start.a, start.b, start.cos
        with ar.working():
            self.ratio = ar.convert(ratio_of(exact))

    @elementary_key(
        "λ", "stability factor C²r0²/(4Amgs)", "b²/2a", "b**2/(2*a)", absent="without torque"
    )
    def stability_factor(self) -> R | None:
        """The stability factor lambda = C^2 r0^2/(4 A mgs) = b^2/2a; None without torque."""
        return self.b * self.b / (2 * self.a) if self.exact.a else None

    @rate_key("r0 sleeping", "least r0 of a stable upright top", "2√(Amgs)/C", "2*sqrt(A*m*g*s)/C")
    def r0_sleeping(self) -> R:
        """The least total spin rate 2 sqrt(A mgs)/C of a stable upright top."""
        return self.ratio * self.ar.sqrt(2 * self.a)

    @rate_key(
        "Ω slow",
        "slow steady precession",
        "ϑ'' = 0",
        "m*g*s = C*r0*steady_rate_slow - A*cos(theta0)*steady_rate_slow**2",
        absent="if |r0| < r0_steady_min, or if r0 = 0 at 90 degrees",
    )
    def steady_rate_slow(self) -> R | None:
        """The root of smaller size of A cos(theta) Omega^2 - C r0 Omega + mgs = 0."""
        return self._steady(SLOW)

    @rate_key(
        "Ω fast",
        "fast steady precession",
        "ϑ'' = 0",
        "m*g*s = C*r0*steady_rate_fast - A*cos(theta0)*steady_rate_fast**2",
        absent="if |r0| < r0_steady_min, or at 90 degrees",
    )
    def steady_rate_fast(self) -> R | None:
        """The root of larger size of this equation; None at 90 degrees, where it is infinite."""
        return self._steady(FAST)

    def _steady(self, word: str) -> R | None:
        if not self.steady.exists(word):
            return None
        return self.steady.rate(self.ar, self.a, self.b, self.cos, word)

    @rate_key(
        "r0 steady",
        "least r0 of steady precession",
        "2√(Amgs u0)/C",
        "2*sqrt(A*m*g*s*max(cos(theta0), 0))/C",
    )
    def r0_steady_min(self) -> R:
        """The least total spin rate 2 sqrt(A mgs cos(theta))/C of a steady precession at the tilt.

        The rate is 0 from 90 degrees on.
        """
        if self.exact.cosine.sign(U) < 0:
            return 0 * self.a
        return self.ratio * self.ar.sqrt(2 * self.a * self.cos)

    @rate_key(
        "ψ' elementary",
        "precession of a fast top",
        "mgs/(C r0)",
        "m*g*s/(C*r0)",
        absent="if r0 = 0",
    )
    def precession_rate_elementary(self) -> R | None:
        """The precession rate mgs/(C r0) of a fast top; None if r0 = 0."""
        return self.a / (2 * self.b) if self.exact.b else None

    @elementary_key(
        "T elementary",
        "nutation of a fast top",
        "2πA/(C r0)",
        "2*pi*A/(C*abs(r0))",
        unit="time",
        absent="if r0 = 0",
    )
    def T_nutation_elementary(self) -> R | None:
        """The nutation period 2 pi A/(C |r0|) of a fast top; None if r0 = 0."""
        return 2 * self.ar.pi / absolute(self.b) if self.exact.b else None


TEXTBOOK = keys_of(Textbook)
"""The keys of this module and their declarations."""


STEADY_KEYS = frozenset({"steady_rate_slow", "steady_rate_fast"})
WITH_RATIO = frozenset({"r0_sleeping", "r0_steady_min"})
"""The keys that have the factor A/C."""


def ratio_of(exact: Exact) -> Fraction:
    """Return A/C."""
    return Fraction(exact.top.A) / Fraction(exact.top.C)


def textbook_fractions(exact: Exact) -> dict[str, Fraction]:
    """Return the keys of this module whose values are known as fractions."""
    a, b, u, ratio = exact.a, exact.b, exact.cosine.rational, ratio_of(exact)
    steady, side = SteadyRates(a, b, exact.cosine), exact.cosine.sign(U)
    sleeping = rational_root(2 * a)
    least = Fraction(0) if side <= 0 or not a else None if u is None else rational_root(2 * a * u)
    known = {
        "stability_factor": b * b / (2 * a) if a else None,
        "r0_sleeping": None if sleeping is None else ratio * sleeping,
        "steady_rate_slow": steady.fraction(SLOW),
        "steady_rate_fast": steady.fraction(FAST),
        "r0_steady_min": None if least is None else ratio * least,
        "precession_rate_elementary": a / (2 * b) if b else None,
    }
    return {name: value for name, value in known.items() if value is not None}
