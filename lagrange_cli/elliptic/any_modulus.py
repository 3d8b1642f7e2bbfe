"""Moduli beyond [0, 1]: imaginary k = i kbar, and k above 1.

The functions of such a modulus are functions of a modulus in [0, 1] at an argument that is
stretched by a real factor.

- k = i kbar: the modulus is kbar/sqrt(1 + kbar^2), and the factor is sqrt(1 + kbar^2).  One unit is
  added to tau = iK'/K (Chrapan (1,1), (2,2) and (3,4)).
- k > 1: the modulus is 1/k, the factor k, and tau/(1 - tau) replaces tau (DLMF 22.17).  K is
  complex, on the side of its branch cut on which k^2 has a small negative imaginary part, as in
  mpmath.
"""

from __future__ import annotations

import math
from enum import Enum
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.points import ExactComplex
from ..arithmetic.protocol import Numeric
from ..errors import LagtopError
from .complete import complete_k, period_mean
from .modulus import Modulus, constants, exact_modulus

if TYPE_CHECKING:  # mpmath is loaded for complex numbers only
    from .many_digits import ManyDigits


class ModulusKind(Enum):
    """The kind of a modulus: in [0, 1], imaginary, or above 1."""

    UNIT = "in [0, 1]"
    IMAGINARY = "imaginary"
    LARGE = "above 1"


class AnyModulus(NamedTuple):
    """The modulus in [0, 1] to which a modulus of any kind is reduced, and the reduction."""

    kind: ModulusKind
    modulus: Modulus
    stretch: Numeric = 1
    """Factor of the argument."""


def any_modulus(ar: ManyDigits, k: ExactComplex | complex) -> AnyModulus:
    """Reduce a modulus k >= 0, or i kbar with kbar > 0, to a modulus in [0, 1].

    `ar` is an mpmath context.  Raises LagtopError for other numbers.
    """
    real, imag = ar.convert(k.real), ar.convert(k.imag)
    if not (real >= 0 and imag >= 0 and not (real and imag) and max(real, imag) < math.inf):
        raise LagtopError(f"k must be 0 or more, or imaginary as 0.8i, got {k}", "k")
    if imag:
        root = ar.sqrt(1 + imag * imag)
        return AnyModulus(ModulusKind.IMAGINARY, Modulus(imag / root, 1 / root), root)
    if real > 1:
        complement = ar.sqrt(ar.convert(Fraction(k.real) ** 2 - 1)) / real
        return AnyModulus(ModulusKind.LARGE, Modulus(1 / real, complement), real)
    return AnyModulus(ModulusKind.UNIT, exact_modulus(ar, Fraction(k.real)))


def any_constants(ar: ManyDigits, modulus: ExactComplex | complex) -> dict[str, Numeric]:
    """Return the record of a modulus that is imaginary or above 1, in an mpmath context.

    For imaginary k, q is negative and K' = k'(K' - iK), with the constants of the modulus in [0, 1]
    on the right.  For k > 1, k' = i sqrt(k^2 - 1), and K, E and q are complex.
    """
    kind, (k, k_prime, _), s = given = any_modulus(ar, modulus)
    assert kind is not ModulusKind.UNIT
    K, K_prime, E, E_prime, q = constants(ar, given.modulus)
    if kind is ModulusKind.IMAGINARY:
        found = s, -q, K / s, ar.mpc(K_prime, -K) / s, s * E, _e_beyond(ar, k_prime, k)
    else:
        K, K_prime, complement = ar.mpc(K, -K_prime) / s, K_prime / s, ar.mpc(0, s * k_prime)
        q = ar.exp(-ar.pi * K_prime / K)
        found = complement, q, K, K_prime, _e_beyond(ar, k, k_prime), s * E_prime
    k = ar.mpc(ar.convert(modulus.real), ar.convert(modulus.imag))
    names = ("k", "k_prime", "nome", "K", "K_prime", "E", "E_prime")
    return dict(zip(names, (k, *found), strict=True))


def _e_beyond(ar: ManyDigits, k: Numeric, k_prime: Numeric) -> Numeric:
    """Return E of the modulus 1/k > 1, {E - k'^2 K + i (E' - k^2 K')}/k (DLMF 19.7.3).

    The difference E - k'^2 K is computed as k^2 K times the mean of cn^2 over a period, so that
    nothing cancels.
    """
    here = complete_k(ar, k_prime) * period_mean(ar, k_prime, 1, 1, 0 * k)
    there = complete_k(ar, k) * period_mean(ar, k, 1, 1, 0 * k)
    return ar.mpc(k * here, k_prime**2 / k * there)
