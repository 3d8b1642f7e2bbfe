"""The modulus: in [0, 1] by any of its quantities, imaginary, or above 1; its constants.

A modulus of any kind is reduced to a modulus in [0, 1], whose argument is stretched by a factor:

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

from ..arithmetic.rounding import equal_digits
from ..errors import LagtopError
from ..top.ranges import ExactComplex
from .enclosures import Value, exact, record


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


class ModulusInput(NamedTuple):
    """A modulus in [0, 1], by one of its quantities.

    `name` is k, k_prime or nome; `radians` is the unit of the modular angle and of amplitudes.
    """

    name: str
    value: Fraction
    radians: bool = False

    def check(self) -> None:
        """Raise LagtopError unless the value is in its range."""
        name, value, is_high, end = self.name, self.value, self.value > 1, "1]"
        if name == "nome":
            is_high, end = value >= 1, "1)"
        if value < 0 or is_high:
            raise LagtopError(f"{name} must be in [0, {end}, got {float(value)}", name)
        if name == "nome" and 1 - value < _LEAST_BELOW_1:
            raise LagtopError("nome must be at most 1 - 1e-17: k' is too small beyond", name)

    @property
    def is_0(self) -> bool:
        """Whether k is 0."""
        return self.value == (1 if self.name == "k_prime" else 0)

    @property
    def is_1(self) -> bool:
        """Whether k is 1."""
        ends = {"k": 1, "k_prime": 0}
        return self.value == ends.get(self.name)

    def ball(self) -> Modulus:
        """Return k and k' in balls."""
        if self.is_0 or self.is_1:
            return Modulus(arb(int(self.is_1)), arb(int(self.is_0)))
        value = exact(self.value)
        if self.name == "nome":
            # the squares of theta2, theta4 over that of theta3, at tau = i T
            tau = acb(0, -value.log() / arb.pi())
            _, *thetas = acb.modular_theta(acb(0), tau)
            theta2, theta3, theta4 = (theta.real for theta in thetas)
            return Modulus((theta2 / theta3) ** 2, (theta4 / theta3) ** 2)
        other = exact(1 - self.value**2).sqrt()
        return Modulus(value, other) if self.name == "k" else Modulus(other, value)


_LEAST_BELOW_1 = Fraction("1e-17")
"""Least 1 - q: the exponent of k' is then within the limits of printed numbers."""

AnyModulus = ModulusInput | ExactComplex
"""A modulus in [0, 1] by one of its quantities, or a number that is imaginary or above 1."""


def check_modulus(given: AnyModulus) -> None:
    """Raise LagtopError unless the modulus is real and not negative, or i kbar with kbar > 0."""
    if isinstance(given, ModulusInput):
        given.check()
    elif given.real < 0 or given.imag < 0 or (given.real and given.imag):
        raise LagtopError(f"k must be 0 or more, or imaginary as 0.8i, got {given}", "k")


def numbers_of(given: AnyModulus) -> list[Fraction]:
    """Return the numbers of which a modulus consists."""
    return [given.value] if isinstance(given, ModulusInput) else [*given]


def reduced(given: AnyModulus) -> Modulus:
    """Return a modulus that is checked, reduced to [0, 1]."""
    if isinstance(given, ModulusInput):
        return given.ball()
    if given.imag:
        root = exact(1 + given.imag**2).sqrt()
        return Modulus(exact(given.imag) / root, 1 / root, Kind.IMAGINARY, root)
    if given.real > 1:
        k = exact(given.real)
        return Modulus(1 / k, exact(given.real**2 - 1).sqrt() / k, Kind.LARGE, k)
    return ModulusInput("k", given.real).ball()


def quarter_period(k_prime: arb) -> arb:
    """Return K = F(pi/2, k) from the complement k' in (0, 1] (DLMF 19.8.5)."""
    return arb.pi() / (2 * arb(1).agm(k_prime))


def second_kind(k_prime: arb) -> arb:
    """Return E = E(pi/2, k) from the complement k' in [0, 1] (DLMF 19.25.1)."""
    if k_prime == 0:
        return arb(1)
    square = acb(k_prime**2)
    return 2 * acb.elliptic_rg(acb(0), square, acb(1)).real


def nome(k: arb, k_prime: arb) -> arb:
    """Return q = exp(-pi K'/K), equation (2,4); 0 for k = 0, and 1 for k = 1."""
    if k == 0 or k_prime == 0:
        return arb(int(k_prime == 0))
    return (-arb.pi() * arb(1).agm(k_prime) / arb(1).agm(k)).exp()


def constants_record(given: AnyModulus, digits: int | None) -> dict[str, Any]:
    """Return the constants of a modulus, correctly rounded to doubles or to `digits` digits.

    Numbers that are not real are split into `_re` and `_im`; infinite constants are None.  Raises
    LagtopError for a modulus out of range.
    """
    check_modulus(given)

    def compute() -> dict[str, Value]:
        if isinstance(given, ModulusInput):
            return _unit_constants(given)
        return _other_constants(given)

    return record(compute, digits, equal_digits(numbers_of(given), digits or 0))


def _unit_constants(given: ModulusInput) -> dict[str, Value]:
    """Return the constants of a modulus in [0, 1]."""
    k, k_prime, *_ = given.ball()
    unit, factor = ("rad", 1) if given.radians else ("deg", 180 / arb.pi())
    return {
        "k": k,
        "k_prime": k_prime,
        f"modular_angle_{unit}": arb.atan2(k, k_prime) * factor,
        "nome": nome(k, k_prime),
        "nome_prime": nome(k_prime, k),
        "K": None if given.is_1 else quarter_period(k_prime),
        "K_prime": None if given.is_0 else quarter_period(k),
        "E": second_kind(k_prime),
        "E_prime": second_kind(k),
    }


def _other_constants(given: ExactComplex) -> dict[str, Value]:
    """Return the constants of a modulus that is imaginary or above 1.

    For k = i kbar, q is negative and K' = k'(K' - iK), with the constants of the reduced modulus on
    the right.  For k > 1, k' = i sqrt(k^2 - 1), and K, E and q are complex.
    """
    k, k_prime, kind, s = reduced(given)
    K, other = quarter_period(k_prime), quarter_period(k)
    E, e_other = second_kind(k_prime), second_kind(k)
    found: list[arb | acb]
    # E of the inverse of a modulus (DLMF 19.7.3)
    if kind is Kind.IMAGINARY:
        beyond = acb(e_other - k**2 * other, E - k_prime**2 * K) / k_prime
        found = [s, -nome(k, k_prime), K / s, acb(other, -K) / s, s * E, beyond]
    else:
        beyond = acb(E - k_prime**2 * K, e_other - k**2 * other) / k
        tau = acb(0, other / K)
        q = (tau / (1 - tau)).exp_pi_i()
        found = [acb(0, s * k_prime), q, acb(K, -other) / s, other / s, beyond, s * e_other]
    names = ("k_prime", "nome", "K", "K_prime", "E", "E_prime")
    parts: dict[str, Value] = {"k_re": given.real, "k_im": given.imag}
    return parts | split({name: acb(x) for name, x in zip(names, found, strict=True)})


def split(numbers: Mapping[str, acb | None]) -> dict[str, Value]:
    """Return the real and the imaginary parts of complex numbers."""
    parts: dict[str, Value] = {}
    for name, z in numbers.items():
        parts[f"{name}_re"], parts[f"{name}_im"] = (None, None) if z is None else (z.real, z.imag)
    return parts
