"""The constants of a modulus: nome and complete integrals."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from flint import acb, arb

from .legendre import Legendre
from .modulus import GivenModulus, Kind, Modulus, degrees, real_parts, split
from .tables import Row, numbers

CONSTANTS = """
m | m | parameter k² | |
k | k | modulus | |
k_prime | k' | complementary modulus | |
modular_angle_deg | arcsin k | modular angle | deg |
modular_angle_rad | arcsin k | modular angle | rad |
nome | q | nome | | (3.1.6)
nome_prime | q' | nome of k' | | (3.1.6)
Complete integrals
K | K | first kind, k | | (3.1.2)
K_prime | K' | first kind, k' | | (3.1.2)
E | E | second kind, k | |
E_prime | E' | second kind, k' | |
Pi | Π(n) | third kind, k | |
"""
"""Key, symbol, meaning, unit and equation of each constant; a line without `|` begins a group."""


def constants_record(
    given: GivenModulus, digits: int | None, *, n: Fraction | None = None, radians: bool = False
) -> dict[str, Any]:
    """Return the constants of a modulus, correctly rounded to doubles or to `digits` digits.

    With n, Pi(n | k) is one of them.  Unless k is in [0, 1], numbers are split into `_re` and
    `_im`.  Infinite constants are None.  Raises LagtopError for a modulus out of range.
    """
    given.check()

    def compute(_: int) -> Row:
        found = constants_of(given.reduced(), radians=radians)
        if n is not None:
            found["Pi"] = Legendre(given.reduced(), given.m, n).complete.Pi
        row = real_parts(found) if given.kind is Kind.UNIT else split(found)
        if given.name == "m":
            return {"m": given.value.real} | row
        return row | ({given.name: given.value.real} if given.name in row else {})

    return numbers(compute, [*given.value, n or Fraction(0)], digits)


def constants_of(modulus: Modulus, *, radians: bool = False) -> dict[str, acb | None]:
    """Return the moduli, the nomes q = exp(-pi K'/K) (3.1.6), and the integrals of k and k'."""
    complement = modulus.complement
    K, E, _ = Legendre(modulus).complete
    K_prime, E_prime, _ = Legendre(complement).complete
    found = {"k": modulus.ball, "k_prime": complement.ball}
    if modulus.kind is Kind.UNIT:
        angle = acb(arb.atan2(modulus.k, modulus.k_prime))
        found |= {"modular_angle_rad": angle} if radians else {"modular_angle_deg": degrees(angle)}
    found["nome"] = _nome(K, K_prime)
    if modulus.kind is Kind.UNIT:
        found["nome_prime"] = _nome(K_prime, K)
    return {**found, "K": K, "K_prime": K_prime, "E": E, "E_prime": E_prime}


def _nome(K: acb | None, K_prime: acb | None) -> acb:
    """Return exp(-pi K'/K) in its limits, too; None stands for infinity."""
    if K is None or K_prime is None:
        return acb(int(K is None))
    return (-arb.pi() * K_prime / K).exp()
