"""The modulus, given by the quantity that keeps its digits; its constants and their record."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.balls import Balls, balls
from ..arithmetic.exact_cosine import Cosine, below_quarters
from ..arithmetic.numbers import in_arithmetic
from ..arithmetic.rounding import decided, pair
from ..errors import LagtopError
from .complete import complete_e, complete_k, nome
from .tables import ProvedNumbers

if TYPE_CHECKING:  # NumPy is loaded for arrays only
    from ..arithmetic.protocol import FunctionArithmetic, Numeric
    from ..arithmetic.types import Array


class Modulus(NamedTuple):
    """k and its complement k', scalars or arrays, each good to an ulp."""

    k: Numeric
    k_prime: Numeric
    rest: Numeric = 0.0
    """The part of k' lost to rounding (arrays only); the period needs it far away from 0."""


class Constants(NamedTuple):
    """K, E and the nome q of k; K' and E' of the complement; for k = 1, K is inf and q = 1."""

    K: Numeric
    K_prime: Numeric
    E: Numeric
    E_prime: Numeric
    q: Numeric


@in_arithmetic
def modulus(
    ar: FunctionArithmetic,
    *,
    k: Numeric = None,
    k_prime: Numeric = None,
    m: Numeric = None,
    angle: Numeric = None,
    q: Numeric = None,
) -> Modulus:
    """Return the modulus from exactly one of k, k', m = k^2, the modular angle, the nome q.

    The angle arcsin k is in radians.  Pass the complement k' if k is close to 1.

    `ar` is numpy or an mpmath context.  Raises LagtopError for a value outside [0, 1] (the angle:
    [0, pi/2]; the nome: [0, 1)), and unless exactly one value is given.
    """
    names = {"k": k, "k_prime": k_prime, "m": m, "angle": angle, "q": q}
    named = [(name, value) for name, value in names.items() if value is not None]
    if len(named) != 1:
        raise LagtopError(f"exactly one of {', '.join(names)} must be given, got {len(named)}")
    name, value = named[0]
    if ar.is_array:
        import numpy as np

        value = np.asarray(value, dtype=float)
    else:
        value = ar.convert(value)
    most = ar.pi / 2 if name == "angle" else 1
    inside = value >= 0
    if ar.everywhere(inside):  # an open comparison of balls asks for more digits
        inside = value < 1 if name == "q" else value <= most
    if not ar.everywhere(inside):
        end = {"angle": "pi/2]", "q": "1)"}.get(name, "1]")
        wrong = value[~inside].flat[0] if ar.is_array and value.ndim else value
        raise LagtopError(f"{name} must be in [0, {end}, got {float(wrong)}", name)
    return _FROM[name](ar, value)


@in_arithmetic
def constants(ar: FunctionArithmetic, modulus: Modulus) -> Constants:
    """Return the complete integrals and the nome (2,4), each to a few eps."""
    k, k_prime = modulus.k, modulus.k_prime
    ordinary, other = ar.where(k_prime > 0, k_prime, 1 + 0 * k), ar.where(k > 0, k, 1 + 0 * k)
    infinite = ar.inf
    return Constants(
        K=ar.where(k_prime > 0, complete_k(ar, ordinary), infinite),
        K_prime=ar.where(k > 0, complete_k(ar, other), infinite),
        E=ar.where(k_prime > 0, complete_e(ar, ordinary), 1 + 0 * k),
        E_prime=ar.where(k > 0, complete_e(ar, other), 1 + 0 * k),
        q=ar.where(k_prime > 0, nome(ar, m=k * k, k_prime=ordinary), 1 + 0 * k),
    )


def exact_modulus(ar: FunctionArithmetic, k: Fraction) -> Modulus:
    """Return a modulus in [0, 1] whose complement keeps its digits however close k is to 1."""
    return Modulus(ar.convert(k), ar.sqrt(ar.convert(1 - k * k)))


def in_many_digits(ar: FunctionArithmetic, modulus: Modulus) -> Modulus:
    """Convert a modulus in doubles to balls or to an mpmath context."""
    k, k_prime, rest = map(float, modulus)
    return Modulus(ar.convert(k), ar.convert(k_prime) + ar.convert(rest))


def _from_k(ar: FunctionArithmetic, k: Numeric) -> Modulus:
    """Return k and k' = sqrt(1 - k^2), with the part of k' lost to rounding."""
    if not ar.is_array:
        return Modulus(k, ar.sqrt((1 - k) * (1 + k)))
    from ..arithmetic.double_double import two_product  # start-up

    return Modulus(k, *_complement(*two_product(k, k)))


def _from_m(ar: FunctionArithmetic, m: Numeric) -> Modulus:
    if not ar.is_array:
        return Modulus(ar.sqrt(m), ar.sqrt(1 - m))
    return Modulus(ar.sqrt(m), *_complement(m, 0.0))


def _complement(square: Array, rest: Array | float) -> tuple[Array, Array]:
    """Return the square root of 1 - square - rest, and the part of it lost to rounding."""
    from ..arithmetic.double_double import sqrt_pair, two_sum  # start-up

    difference, error = two_sum(1.0, -square)
    return sqrt_pair(*two_sum(difference, error - rest))


def _from_q(ar: FunctionArithmetic, q: Numeric) -> Modulus:
    """Return theta2^2/theta3^2 and theta4^2/theta3^2, in the smaller of the nomes of k and k'."""
    limit = ar.exp(-ar.pi)
    large = ar.either(q > limit)
    root = ar.where(large, ar.exp(ar.pi**2 / (2 * ar.log(ar.where(large, q, limit)))), ar.sqrt(q))
    small = root * root
    n, power, theta2, theta3, theta4 = 0, small**0, small * 0, small**0, small**0
    while not ar.everywhere(power <= ar.eps / 4):
        theta2 = theta2 + 2 * small ** (n * (n + 1))
        n += 1
        power = small ** (n * n)
        theta3, theta4 = theta3 + 2 * power, theta4 + 2 * (-1) ** n * power
    if ar.is_array and (root == 0)[large].any():
        raise LagtopError("q must be at most 0.9934 in doubles: k' underflows beyond")
    # each term is less than half of the one before: the truncation error is below 4 small^(n^2)
    theta2, theta3, theta4 = (
        ar.widened(x, lambda: (power,), lambda power: 4 * power, values_only=True)
        for x in (theta2, theta3, theta4)
    )
    one, other = root * (theta2 / theta3) ** 2, (theta4 / theta3) ** 2
    return Modulus(ar.where(large, other, one), ar.where(large, one, other), 0 * q)


_FROM: dict[str, Callable[[FunctionArithmetic, Numeric], Modulus]] = {
    "k": _from_k,
    "k_prime": lambda ar, other: Modulus(_from_k(ar, other).k_prime, other, 0 * other),
    "m": _from_m,
    "angle": lambda ar, angle: Modulus(ar.sin(angle), ar.cos(angle), 0 * angle),
    "q": _from_q,
}


_LEAST_BELOW_1 = Fraction("1e-17")
"""Least 1 - q for which exp(pi^2/log q) is within the exponents of decimals."""


class ModulusInput(NamedTuple):
    """A modulus as given: k, k_prime, modular_angle (degrees, or radians) or nome."""

    name: str
    value: Fraction
    radians: bool = False

    def check(self) -> None:
        """Raise LagtopError unless the modulus is in its range."""
        most, end = {"modular_angle": (90.0, "90]"), "nome": (1.0, "1)")}.get(
            self.name, (1.0, "1]")
        )
        is_high = self.value > most or (self.name == "nome" and self.value == 1)
        if self.name == "modular_angle" and self.radians:
            is_high, end = below_quarters(1, self.value) < 0, "pi/2]"
        if self.value < 0 or is_high:
            value = float(self.value)
            raise LagtopError(f"{self.name} must be in [0, {end}, got {value}", self.name)

    def zeros(self) -> set[str]:
        """Return the constants that are exactly 0."""
        ends = {"k": 1, "k_prime": 1, "modular_angle": None if self.radians else 90, "nome": None}
        is_one = self.value == ends[self.name]  # pi/2 is irrational
        k_vanishes = is_one if self.name == "k_prime" else not self.value
        complement_vanishes = not self.value if self.name == "k_prime" else is_one
        zeros = {"k", "nome", "modular_angle_deg", "modular_angle_rad"} if k_vanishes else set()
        return zeros | ({"k_prime", "nome_prime"} if complement_vanishes else set())

    def in_digits(self, ar: FunctionArithmetic) -> Modulus:
        """Return the modulus in balls or an mpmath context, with all digits of k and k'.

        Raises LagtopError if it is out of range.
        """
        self.check()
        if self.name == "nome":
            if isinstance(ar, Balls) and 1 - self.value < _LEAST_BELOW_1:
                raise LagtopError("nome must be at most 1 - 1e-17: k' is too small beyond", "nome")
            return modulus(ar, q=ar.convert(self.value))
        if self.name == "modular_angle":
            angles = (None, self.value) if self.radians else (self.value, None)
            tilt = Cosine(*angles).tilt(ar)
            return Modulus(tilt.sin, tilt.cos)
        exact = exact_modulus(ar, self.value)
        return exact if self.name == "k" else Modulus(exact.k_prime, exact.k)

    def in_doubles(self) -> Modulus:
        """Return the modulus rounded once, with k' as two doubles.

        Raises LagtopError if it is out of range, or if k' is too small for a double.
        """

        def rounded(digits: int) -> Modulus:
            exact = self.in_digits(balls(digits))
            return Modulus(float(exact.k), *pair(exact.k_prime))

        found = decided(self.name, rounded)
        if not found.k_prime and "k_prime" not in self.zeros():
            raise LagtopError(
                f"{self.name}: k' is too small for doubles (give --digits)", self.name
            )
        return found


def constants_in(ar: FunctionArithmetic, modulus_input: ModulusInput) -> dict[str, Numeric]:
    """Return the record of a modulus in some arithmetic; None for infinite constants."""
    exact, zeros = modulus_input.in_digits(ar), modulus_input.zeros()
    K, K_prime, E, E_prime, q = constants(ar, exact)
    other = constants(ar, Modulus(exact.k_prime, exact.k)).q
    unit = "rad" if modulus_input.radians else "deg"
    angle = ar.atan2(exact.k, exact.k_prime) * (1 if modulus_input.radians else 180 / ar.pi)
    return {
        "k": exact.k,
        "k_prime": exact.k_prime,
        f"modular_angle_{unit}": angle,
        "nome": q,
        "nome_prime": other,
        "K": None if "k_prime" in zeros else K,
        "K_prime": None if "k" in zeros else K_prime,
        "E": E,
        "E_prime": E_prime,
    }


def constants_record(modulus_input: ModulusInput, digits: int | None) -> dict[str, Any]:
    """Return the record of a modulus, correctly rounded to doubles or to `digits` digits."""
    return ProvedNumbers(digits).of(
        lambda ar: constants_in(ar, modulus_input), dict.fromkeys(modulus_input.zeros(), 0)
    )
