"""Legendre's incomplete integrals F and E of any real amplitude, for k in [0, 1]; their table."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.balls import Balls
from ..arithmetic.exact_cosine import below_quarters
from ..arithmetic.numbers import in_arithmetic
from ..arithmetic.points import MAX_PERIODS, Points, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from .carlson import carlson_rd, carlson_rf
from .complete import complete_e, complete_k
from .modulus import Modulus, ModulusInput
from .tables import TableOfFunctions

if TYPE_CHECKING:
    from .tables import Known


class Amplitude(NamedTuple):
    """An amplitude: whole half turns, and sine and cosine of the rest, up to a quarter turn."""

    half_turns: Numeric
    sine: Numeric
    cosine: Numeric
    """Never negative; exactly 0 at a quarter turn in degrees."""


def in_radians(ar: FunctionArithmetic, phi: Numeric) -> Amplitude:
    """Return an amplitude given in radians; arrays keep their digits up to 2^50 half turns."""
    if not ar.is_array:
        half_turns = ar.nint(ar.re(phi) / ar.pi)
        rest = phi - half_turns * ar.pi
        return Amplitude(half_turns, ar.sin(rest), ar.cos(rest))
    from ..arithmetic.double_double import PI, two_product, two_sum  # start-up

    half_turns = ar.nint(phi / ar.pi)
    product, error = two_product(half_turns, PI.high)
    second, second_error = two_product(half_turns, PI.middle)
    rest, low = two_sum(phi - product, -second)
    low -= error + (second_error + half_turns * PI.low)
    sine, cosine = ar.sin(rest), ar.cos(rest)
    sine, cosine = sine + low * cosine, cosine - low * sine
    beyond = ar.where(cosine < 0, ar.sign(rest), 0.0)  # rounded beyond a quarter turn
    return Amplitude(half_turns + beyond, ar.where(cosine < 0, -sine, sine), abs(cosine))


def in_degrees(ar: FunctionArithmetic, phi: Numeric) -> Amplitude:
    """Return an amplitude given in degrees; whole half turns are removed exactly."""
    if ar.is_array:
        import numpy as np

        rest = np.fmod(phi, 180.0)
        half_turns = ar.nint((phi - rest) / 180)
        beyond = ar.where(abs(rest) > 90, ar.sign(rest), 0.0)
        half_turns, rest = half_turns + beyond, rest - 180 * beyond
    else:
        half_turns = ar.nint(phi / 180)
        rest = phi - 180 * half_turns
    degree = ar.pi / 180
    return Amplitude(half_turns, ar.sin(degree * rest), ar.sin(degree * (90 - abs(rest))))


@in_arithmetic
def incomplete_f(ar: FunctionArithmetic, phi: Numeric, modulus: Modulus) -> Numeric:
    """Return F(phi, k), the integral of d phi/sqrt(1 - k^2 sin^2 phi) from 0 to phi (3.1.2).

    `phi` is any real amplitude in radians, of numpy or an mpmath context.  F(phi + n pi) is F(phi)
    + 2 n K.  For k = 1, F is infinite from a quarter turn on.
    """
    return f_of(ar, in_radians(ar, phi), modulus)


@in_arithmetic
def incomplete_e(ar: FunctionArithmetic, phi: Numeric, modulus: Modulus) -> Numeric:
    """Return E(phi, k), the integral of sqrt(1 - k^2 sin^2 phi) d phi from 0 to phi.

    `phi` is any real amplitude in radians, as in `incomplete_f`.  E(phi + n pi) is E(phi) + 2 n E.
    """
    return e_of(ar, in_radians(ar, phi), modulus)


@in_arithmetic
def f_of(ar: FunctionArithmetic, phi: Amplitude, modulus: Modulus) -> Numeric:
    """Return F of an amplitude: sin(phi) R_F(cos^2 phi, 1 - k^2 sin^2 phi, 1) within a turn."""
    cosine2, delta2 = _squares(ar, phi, modulus)
    within = phi.sine * carlson_rf(ar, cosine2, delta2, 1 + 0 * delta2)
    unbounded = (modulus.k_prime == 0) & ((phi.half_turns != 0) | (phi.cosine == 0))
    value = _quasi_periodic(ar, phi, within, complete_k, modulus)
    return ar.where(unbounded, ar.inf * ar.sign(phi.half_turns + phi.sine), value)


@in_arithmetic
def e_of(ar: FunctionArithmetic, phi: Amplitude, modulus: Modulus) -> Numeric:
    """Return E of an amplitude, as a sum of positive terms (DLMF 19.25.10)."""
    cosine2, delta2 = _squares(ar, phi, modulus)
    one, complement = 1 + 0 * delta2, modulus.k_prime * modulus.k_prime
    first = carlson_rf(ar, cosine2, delta2, one)
    second = (modulus.k * phi.sine) ** 2 * carlson_rd(ar, cosine2, one, delta2) / 3
    third = (1 - complement) * ar.sqrt(cosine2 / delta2)
    within = phi.sine * (complement * (first + second) + third)
    return _quasi_periodic(ar, phi, within, complete_e, modulus)


def _squares(ar: FunctionArithmetic, phi: Amplitude, modulus: Modulus) -> tuple[Numeric, Numeric]:
    """Return cos^2 phi and 1 - k^2 sin^2 phi as a sum of squares; both are 1 at a quarter turn."""
    cosine2 = phi.cosine * phi.cosine
    delta2 = cosine2 + modulus.k_prime * modulus.k_prime * (1 - cosine2)
    at_quarter = phi.cosine + 0 * delta2 == 0
    return ar.where(at_quarter, 1 + 0 * delta2, cosine2), ar.where(at_quarter, 1, delta2)


def _quasi_periodic(
    ar: FunctionArithmetic,
    phi: Amplitude,
    within: Numeric,
    complete: Callable[..., Any],
    modulus: Modulus,
) -> Numeric:
    """Return an integral from its part `within` a quarter turn and the complete integral.

    For arrays, the complete integral is a pair of doubles, so that a difference keeps its digits.
    """
    quarters = 2 * phi.half_turns + ar.where(phi.cosine == 0, ar.sign(phi.sine), 0)
    within = ar.where(phi.cosine == 0, 0, within)
    k_prime = ar.where(modulus.k_prime == 0, 1, modulus.k_prime)
    limit = 1 if complete is complete_e else 0  # E = 1 for k = 1, where F is infinite
    if not ar.is_array:
        quarter = complete(ar, k_prime) if quarters and modulus.k_prime else limit
        return quarters * quarter + within
    import numpy as np

    from ..arithmetic.arrays import PAIRS  # start-up
    from ..arithmetic.double_double import DoubleDouble, two_product  # start-up

    pair = complete(PAIRS, DoubleDouble(np.asarray(k_prime) + 0.0, np.asarray(modulus.rest) + 0.0))
    high = ar.where(modulus.k_prime == 0, limit, pair.high)
    low = ar.where(modulus.k_prime == 0, 0.0, pair.low)
    product, error = two_product(quarters + 0 * high, high)
    return product + (error + quarters * low + within)


class AmplitudeTable(TableOfFunctions):
    """Tables of F and E over amplitudes phi, in radians if the modulus is, else in degrees.

    For k = 1, F is infinite from a quarter turn on.  Raises LagtopError for a modulus out of range
    and, in doubles, for amplitudes beyond 2^50 half turns.
    """

    functions = 2

    def __init__(self, points: Points, modulus_input: ModulusInput) -> None:
        super().__init__(points, points.count)
        self.modulus, self.radians = modulus_input, modulus_input.radians

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError for a modulus out of range; see the class for doubles."""
        self.modulus.check()
        if doubles:
            check_reach("phi", self.points, MAX_PERIODS * (math.pi if self.radians else 180.0))
            self.modulus.in_doubles()

    def constants(self, ar: Balls) -> Modulus:
        """Return the modulus in balls."""
        return self.modulus.in_digits(ar)

    def rounded_constants(self) -> Modulus:
        """Return the modulus in doubles."""
        return self.modulus.in_doubles()

    def columns(
        self, ar: FunctionArithmetic, x: Numeric, constants: Modulus, known: Known
    ) -> dict[str, Numeric]:
        """Return the amplitudes, F and E."""
        name, reduced = ("phi_rad", in_radians) if self.radians else ("phi_deg", in_degrees)
        x = ar.convert(x)
        phi = reduced(ar, x)
        return {name: x, "F": f_of(ar, phi, constants), "E": e_of(ar, phi, constants)}

    def known(self, x: Fraction) -> Known:
        """Return the columns that are known exactly: 0 at phi = 0, phi for k = 0, an infinite F."""
        names = () if x else ("phi_rad", "phi_deg", "F", "E")
        known: dict[str, float | Fraction] = dict.fromkeys(names, 0)
        if "k" in self.modulus.zeros() and self.radians:
            known |= {"F": x, "E": x}
        beyond = below_quarters(1, abs(x)) < 0 if self.radians else abs(x) >= 90
        if "k_prime" in self.modulus.zeros() and beyond:
            known["F"] = math.inf
        return known

    def digits_lost(self, x: Fraction) -> int:
        """Return the number of digits taken by the half turns of an amplitude."""
        return len(str(int(abs(x))))
