"""Legendre's incomplete integrals of the first and second kind, over real amplitudes."""

from __future__ import annotations

from ..arithmetic.blocks import in_arithmetic
from ..arithmetic.double_double import two_product, two_sum
from ..arithmetic.protocol import FunctionArithmetic, Value
from .carlson import carlson_rd, carlson_rf
from .complete import complete_e, complete_k
from .modulus import Modulus

_PI = 3.141592653589793, 1.2246467991473532e-16


@in_arithmetic
def incomplete_f(ar: FunctionArithmetic, phi: Value, modulus: Modulus) -> Value:
    """Return F(phi, k), the integral of d phi/sqrt(1 - k^2 sin^2 phi) from 0 (3.1.2), for k' > 0.

    phi is any real amplitude in radians, of numpy or an mpmath context; |phi| <= pi/2 costs no
    digit, however close k is to 1.
    """
    half_turns, sine, cosine2, delta2 = _parts(ar, phi, modulus)
    within = sine * carlson_rf(ar, cosine2, delta2, 1 + 0 * sine)
    return half_turns * 2 * complete_k(ar, modulus.k_prime) + within


@in_arithmetic
def incomplete_e(ar: FunctionArithmetic, phi: Value, modulus: Modulus) -> Value:
    """Return E(phi, k), the integral of sqrt(1 - k^2 sin^2 phi) d phi from 0 to phi, for k' > 0.

    As a sum of positive terms (DLMF 19.25.10).
    """
    half_turns, sine, cosine2, delta2 = _parts(ar, phi, modulus)
    one, complement = 1 + 0 * sine, modulus.k_prime * modulus.k_prime
    first = carlson_rf(ar, cosine2, delta2, one)
    second = (modulus.k * sine) ** 2 * carlson_rd(ar, cosine2, one, delta2) / 3
    third = (1 - complement) * ar.sqrt(cosine2 / delta2)
    within = sine * (complement * (first + second) + third)
    return half_turns * 2 * complete_e(ar, modulus.k_prime) + within


def _parts(
    ar: FunctionArithmetic, phi: Value, modulus: Modulus
) -> tuple[Value, Value, Value, Value]:
    """Return half turns in phi and, of the rest, sin, cos^2, 1 - k^2 sin^2 as a sum of squares."""
    half_turns, rest, low = _reduced(ar, phi)
    sine, cosine = ar.sin(rest), ar.cos(rest)
    sine, cosine = sine + low * cosine, cosine - low * sine
    if ar.is_array:  # the rest may lie beyond a quarter turn by its rounding
        beyond = ar.where(cosine < 0, ar.sign(rest), 0.0)
        half_turns, sine = half_turns + beyond, ar.where(cosine < 0, -sine, sine)
    cosine2 = cosine * cosine
    return half_turns, sine, cosine2, cosine2 + modulus.k_prime * modulus.k_prime * (1 - cosine2)


def _reduced(ar: FunctionArithmetic, phi: Value) -> tuple[Value, Value, Value]:
    """Return half turns, the rest (phi up to a quarter turn) and what rounding took from it."""
    if not ar.is_array:
        half_turns = ar.nint(ar.re(phi) / ar.pi)
        return half_turns, phi - half_turns * ar.pi, 0 * phi
    half_turns = ar.nint(phi / ar.pi)
    product, error = two_product(half_turns, _PI[0])
    rest, low = two_sum(phi - product, -(error + half_turns * _PI[1]))
    return half_turns, rest, low
