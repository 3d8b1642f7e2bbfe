"""Moduli of any kind, reduced to [0, 1]: imaginary k = i kbar, and k above 1.

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
from typing import NamedTuple

from ..arithmetic.points import ExactComplex
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..arithmetic.rounding import triple
from ..errors import LagtopError
from .complete import complete_k, period_mean
from .modulus import Modulus, ModulusInput, constants, exact_modulus


class ModulusKind(Enum):
    """The kind of a modulus: in [0, 1], imaginary, or above 1."""

    UNIT = "in [0, 1]"
    IMAGINARY = "imaginary"
    LARGE = "above 1"


class AnyModulus(NamedTuple):
    """The modulus in [0, 1] to which a modulus of any kind is reduced, and the reduction."""

    kind: ModulusKind
    modulus: Modulus
    stretch: Numeric
    """Factor of the argument."""
    scale: Numeric
    """Half periods along 2K per unit of the argument, stretch/(2K); a `Triple` in doubles."""
    across: Numeric
    """Half periods along 2iK' per unit of the argument, stretch/(2K'); 0 if K' is infinite."""

    def rounded(self) -> AnyModulus:
        """Return the modulus in doubles, for arrays."""
        scale, across = (triple(rate) if rate else 0.0 for rate in (self.scale, self.across))
        modulus = Modulus(*map(float, self.modulus))
        return AnyModulus(self.kind, modulus, float(self.stretch), scale, across)


def reduced_modulus(
    ar: FunctionArithmetic, kind: ModulusKind, modulus: Modulus, stretch: Numeric = 1
) -> AnyModulus:
    """Return a modulus from the modulus in [0, 1] to which it is reduced."""
    scale, across = (
        stretch / (2 * complete_k(ar, other)) if other else 0 * other
        for other in (modulus.k_prime, modulus.k)
    )
    return AnyModulus(kind, modulus, stretch, scale, across)


def any_modulus(ar: FunctionArithmetic, k: ModulusInput | ExactComplex | complex) -> AnyModulus:
    """Reduce a modulus k >= 0, or i kbar with kbar > 0, to a modulus in [0, 1].

    `ar` is the arithmetic of complex balls or an mpmath context.  Raises LagtopError for other
    numbers.
    """
    if isinstance(k, ModulusInput):
        return reduced_modulus(ar, ModulusKind.UNIT, k.in_digits(ar))
    if not (k.real >= 0 and k.imag >= 0 and not (k.real and k.imag) and k.real + k.imag < math.inf):
        raise LagtopError(f"k must be 0 or more, or imaginary as 0.8i, got {k}", "k")
    real, imag = ar.convert(k.real), ar.convert(k.imag)
    if k.imag:
        root = ar.sqrt(1 + imag * imag)
        return reduced_modulus(ar, ModulusKind.IMAGINARY, Modulus(imag / root, 1 / root), root)
    if k.real > 1:
        complement = ar.sqrt(ar.convert(Fraction(k.real) ** 2 - 1)) / real
        return reduced_modulus(ar, ModulusKind.LARGE, Modulus(1 / real, complement), real)
    return reduced_modulus(ar, ModulusKind.UNIT, exact_modulus(ar, Fraction(k.real)))


def any_constants(ar: FunctionArithmetic, modulus: ExactComplex | complex) -> dict[str, Numeric]:
    """Return the record of a modulus that is imaginary or above 1, in balls or an mpmath context.

    For imaginary k, q is negative and K' = k'(K' - iK), with the constants of the modulus in [0, 1]
    on the right.  For k > 1, k' = i sqrt(k^2 - 1), and K, E and q are complex.
    """
    kind, (k, k_prime, _), s, *_ = given = any_modulus(ar, modulus)
    assert kind is not ModulusKind.UNIT
    K, K_prime, E, E_prime, q = constants(ar, given.modulus)
    if kind is ModulusKind.IMAGINARY:
        found = s, -q, K / s, ar.mpc(K_prime, -K) / s, s * E, _e_beyond(ar, k_prime, k)
    else:
        growth = -ar.pi * K_prime / (K * K + K_prime * K_prime)  # log q is growth (K + iK')
        q = ar.mpc(ar.cos(growth * K_prime), ar.sin(growth * K_prime)) * ar.exp(growth * K)
        K, K_prime, complement = ar.mpc(K, -K_prime) / s, K_prime / s, ar.mpc(0, s * k_prime)
        found = complement, q, K, K_prime, _e_beyond(ar, k, k_prime), s * E_prime
    k = ar.mpc(ar.convert(modulus.real), ar.convert(modulus.imag))
    names = ("k", "k_prime", "nome", "K", "K_prime", "E", "E_prime")
    return dict(zip(names, (k, *found), strict=True))


def _e_beyond(ar: FunctionArithmetic, k: Numeric, k_prime: Numeric) -> Numeric:
    """Return E of the modulus 1/k > 1, {E - k'^2 K + i (E' - k^2 K')}/k (DLMF 19.7.3).

    The difference E - k'^2 K is computed as k^2 K times the mean of cn^2 over a period, so that
    nothing cancels.
    """
    here = complete_k(ar, k_prime) * period_mean(ar, k_prime, 1, 1, 0 * k)
    there = complete_k(ar, k) * period_mean(ar, k, 1, 1, 0 * k)
    return ar.mpc(k * here, k_prime**2 / k * there)
