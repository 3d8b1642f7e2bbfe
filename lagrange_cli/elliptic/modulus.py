"""The modulus by any of its quantities.

Every modulus is reduced to a modulus in [0, 1], whose argument is stretched by a factor:

- k = i kbar has the modulus kbar/sqrt(1 + kbar^2) and the factor sqrt(1 + kbar^2).  tau = iK'/K
  increases by 1 (Chrapan (1,1), (2,2) and (3,4)).
- k > 1 has the modulus 1/k and the factor k, and tau/(1 - tau) replaces tau (DLMF 22.17).  K is the
  limit for k^2 with a small negative imaginary part, as in mpmath.

If k^2 is not real, k and k' are the roots with positive real parts, and nothing is reduced.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import Enum
from fractions import Fraction
from typing import Any, NamedTuple

from flint import acb, arb

from ..arithmetic.enclosures import exact, sign
from ..errors import LagtopError
from ..top.units import DEGREES, Units
from .arguments import ExactComplex
from .tables import Cell

_LEAST_BELOW_1 = Fraction("1e-17")
"""Least 1 - |q|: the exponent of k' is then within the limits of printed numbers."""


class Kind(Enum):
    """The kind of a modulus."""

    UNIT = "in [0, 1]"
    IMAGINARY = "imaginary"
    LARGE = "above 1"
    COMPLEX = "complex, with a complex square"


class Modulus(NamedTuple):
    """A modulus reduced to [0, 1], in balls; its complement keeps its digits next to k = 1.

    If the kind is COMPLEX, both are complex and not reduced.
    """

    k: Any
    k_prime: Any
    kind: Kind = Kind.UNIT
    stretch: arb = arb(1)
    """Factor of the argument."""
    rates: tuple[acb, acb] | None = None
    """1/2K and 1/2K' of a complex nome, whose K may not be the principal value K(k)."""

    @property
    def ball(self) -> acb:
        """The given modulus itself."""
        if self.kind in {Kind.UNIT, Kind.COMPLEX}:
            return acb(self.k)
        return acb(0, self.stretch * self.k) if self.kind is Kind.IMAGINARY else acb(self.stretch)

    @property
    def complement(self) -> Modulus:
        """The modulus k'; it is above 1 if k is imaginary, and imaginary if k is above 1."""
        kind = {Kind.IMAGINARY: Kind.LARGE, Kind.LARGE: Kind.IMAGINARY}.get(self.kind, self.kind)
        return self._replace(k=self.k_prime, k_prime=self.k, kind=kind)


class GivenModulus(NamedTuple):
    """A modulus by one of its quantities: k, k_prime, m = k^2, nome or modular_angle."""

    name: str
    value: ExactComplex
    units: Units = DEGREES
    """The unit of a modular angle."""

    def check(self) -> None:
        """Raise LagtopError for a modular angle or a nome out of range."""
        name, (real, imag, *_) = self.name, self.value
        size, right = real**2 + imag**2, math.pi / 2 if self.units.radians else 90
        if name == "modular_angle" and (imag or not 0 <= real <= right):
            raise LagtopError(f"{name} must be between 0 and {right}, got {self.value}", name)
        if name != "nome":
            return
        if size >= 1:
            raise LagtopError(f"nome must be below 1 in magnitude, got {self.value}", name)
        if size > (1 - _LEAST_BELOW_1) ** 2:
            raise LagtopError(
                "nome must be at most 1 - 1e-17 in magnitude: beyond that, k' is too small", name
            )

    def check_principal(self) -> None:
        """Raise LagtopError for a complex nome whose K is not the principal value K(k)."""
        if self.name != "nome" or not self.value.imag:
            return
        tau = self._tau()
        if min(sign(abs(2 * tau + x) - 1) for x in (-1, 1)) < 0:
            wanted = "must be exp(i pi tau) with |2 tau - 1| and |2 tau + 1| >= 1 for K and E"
            raise LagtopError(f"nome {wanted}, got {self.value}", "nome")

    @property
    def square(self) -> ExactComplex | None:
        """The parameter k^2, exactly; None if only a nome or a modular angle is known."""
        name, (x, y, *_) = self.name, self.value
        if name in {"nome", "modular_angle"}:
            return None if x or y else ExactComplex(Fraction(0))
        if name == "m":
            return self.value
        square = ExactComplex(x**2 - y**2, 2 * x * y)
        return square if name == "k" else ExactComplex(1 - square.real, -square.imag)

    @property
    def m(self) -> Fraction | None:
        """The parameter k^2 if it is real and known exactly."""
        return self.square.real if self.square and not self.square.imag else None

    @property
    def kind(self) -> Kind:
        """The kind of the modulus."""
        square = self.square or self.value
        if square.imag:
            return Kind.COMPLEX
        if square.real < 0:
            return Kind.IMAGINARY
        is_above_1 = square.real > 1 and self.name != "modular_angle"
        return Kind.LARGE if is_above_1 else Kind.UNIT

    def _tau(self) -> acb:
        """Return tau = iK'/K of a nome, or of -q if it is real and negative."""
        q = acb(exact(self.value.real), exact(self.value.imag))
        return (q if self.value.imag else acb(abs(q.real))).log() / acb(0, arb.pi())

    def reduced(self) -> Modulus:
        """Return the modulus in balls, reduced to [0, 1] unless its kind is COMPLEX."""
        kind, square, stretch = self.kind, self.square, arb(1)
        if square is None and self.name == "modular_angle":
            angle = exact(self.value.real)
            return Modulus(*(angle.sin_cos() if self.units.radians else (angle / 180).sin_cos_pi()))
        if square is None:  # the squares of theta2 and theta4 over that of theta3
            tau = self._tau()
            _, theta2, theta3, theta4 = acb.modular_theta(acb(0), tau)
            k, k_prime = (theta2 / theta3) ** 2, (theta4 / theta3) ** 2
            if kind is Kind.COMPLEX:
                rate = 1 / (arb.pi() * theta3**2)
                return Modulus(k, k_prime, kind, rates=(rate, rate * acb(0, 1) / tau))
            stretch = 1 / k_prime.real if kind is Kind.IMAGINARY else stretch
            return Modulus(k.real, k_prime.real, kind, stretch)
        m = square.real
        if kind is Kind.COMPLEX:
            ball = acb(exact(m), exact(square.imag))
            return Modulus(ball.sqrt(), acb(exact(1 - m), -ball.imag).sqrt(), kind)
        if kind is Kind.IMAGINARY:
            m, stretch = m / (m - 1), exact(1 - m).sqrt()
        elif kind is Kind.LARGE:
            m, stretch = 1 / m, exact(m).sqrt()
        return Modulus(exact(m).sqrt(), exact(1 - m).sqrt(), kind, stretch)


def split(numbers: Mapping[str, acb | None]) -> dict[str, Cell]:
    """Return the real and the imaginary parts of complex numbers."""
    parts: dict[str, Cell] = {}
    for name, z in numbers.items():
        parts[f"{name}_re"], parts[f"{name}_im"] = (None, None) if z is None else (z.real, z.imag)
    return parts


def real_parts(numbers: Mapping[str, acb | None]) -> dict[str, Cell]:
    """Return the real parts of complex numbers."""
    return {name: None if z is None else z.real for name, z in numbers.items()}


def angle(name: str, radians: Any, units: Units) -> dict[str, Any]:
    """Return the column of an angle, `name_deg` or `name_rad`; None stays None."""
    is_turned = radians is not None and not units.radians
    return {f"{name}_{units.angle}": radians * 180 / arb.pi() if is_turned else radians}
