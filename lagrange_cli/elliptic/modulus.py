"""The modulus by any of its quantities.

Every modulus is reduced to a modulus in [0, 1], whose argument is stretched by a factor:

- k = i kbar has the modulus kbar/sqrt(1 + kbar^2) and the factor sqrt(1 + kbar^2).  tau = iK'/K
  increases by 1 (Chrapan (1,1), (2,2) and (3,4)).
- k > 1 has the modulus 1/k and the factor k, and tau/(1 - tau) replaces tau (DLMF 22.17).  K is the
  limit for k^2 with a small negative imaginary part, as in mpmath.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from fractions import Fraction
from typing import Any, NamedTuple

from flint import acb, arb

from ..arithmetic.enclosures import exact
from ..errors import LagtopError
from ..top.units import Units
from .arguments import ExactComplex
from .tables import Cell

_LEAST_BELOW_1 = Fraction("1e-17")
"""Least 1 - |q|: the exponent of k' is then within the limits of printed numbers."""


class Kind(Enum):
    """The kind of a modulus."""

    UNIT = "in [0, 1]"
    IMAGINARY = "imaginary"
    LARGE = "above 1"


class Modulus(NamedTuple):
    """A modulus reduced to [0, 1], in balls; its complement keeps its digits next to k = 1."""

    k: arb
    k_prime: arb
    kind: Kind = Kind.UNIT
    stretch: arb = arb(1)
    """Factor of the argument."""

    @property
    def ball(self) -> acb:
        """The given modulus itself."""
        if self.kind is Kind.UNIT:
            return acb(self.k)
        return acb(0, self.stretch * self.k) if self.kind is Kind.IMAGINARY else acb(self.stretch)

    @property
    def complement(self) -> Modulus:
        """The modulus k'; it is above 1 if k is imaginary, and imaginary if k is above 1."""
        kind = {Kind.IMAGINARY: Kind.LARGE, Kind.LARGE: Kind.IMAGINARY}.get(self.kind, Kind.UNIT)
        return self._replace(k=self.k_prime, k_prime=self.k, kind=kind)


class GivenModulus(NamedTuple):
    """A modulus by one of its quantities: k, k_prime, m = k^2 or nome."""

    name: str
    value: ExactComplex

    def check(self) -> None:
        """Raise LagtopError unless k^2 is real and k is 0 or more, or imaginary."""
        name, (real, imag) = self.name, self.value
        if name in {"k", "k_prime"}:
            if real < 0 or imag < 0 or (real and imag):
                form = f"{name} must be 0 or more, or imaginary (0.8i)"
                raise LagtopError(f"{form}, got {self.value}", name)
        elif imag:
            raise LagtopError(f"{name} must be real, got {self.value}", name)
        elif name == "nome" and abs(real) >= 1:
            raise LagtopError(f"nome must be in (-1, 1), got {float(real)}", name)
        elif name == "nome" and 1 - abs(real) < _LEAST_BELOW_1:
            raise LagtopError(
                "nome must be at most 1 - 1e-17 in size: k' is too small beyond", name
            )

    @property
    def m(self) -> Fraction | None:
        """The parameter k^2, exactly; None if the nome is given."""
        name, (real, imag) = self.name, self.value
        if name == "nome":
            return None if real else Fraction(0)
        square = real**2 - imag**2
        return {"k": square, "k_prime": 1 - square, "m": real}[name]

    @property
    def kind(self) -> Kind:
        """The kind of the modulus."""
        m = self.value.real if self.m is None else self.m
        return Kind.IMAGINARY if m < 0 else Kind.LARGE if m > 1 else Kind.UNIT

    def reduced(self) -> Modulus:
        """Return the modulus in balls, reduced to [0, 1]."""
        kind, m = self.kind, self.m
        if m is None:  # the squares of theta2 and theta4 over that of theta3, at tau = iT
            tau = acb(0, -exact(abs(self.value.real)).log() / arb.pi())
            _, *thetas = acb.modular_theta(acb(0), tau)
            theta2, theta3, theta4 = (theta.real for theta in thetas)
            k, k_prime = (theta2 / theta3) ** 2, (theta4 / theta3) ** 2
            return Modulus(k, k_prime, kind, arb(1) if kind is Kind.UNIT else 1 / k_prime)
        square, stretch = m, arb(1)
        if kind is Kind.IMAGINARY:
            square, stretch = m / (m - 1), exact(1 - m).sqrt()
        elif kind is Kind.LARGE:
            square, stretch = 1 / m, exact(m).sqrt()
        return Modulus(exact(square).sqrt(), exact(1 - square).sqrt(), kind, stretch)


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
