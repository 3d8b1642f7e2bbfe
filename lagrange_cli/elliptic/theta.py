"""Theta functions and their logarithmic derivatives, the Zeta functions (Chrapan section 1).

As functions of x, theta01, theta00, theta11, theta10 are theta4, theta3, theta1, theta2 of the
angle pi x.  They are one even (0.) and one odd (1.) function, and both shifted by half a period
(.0).  Up to k = k' they are summed as Fourier series in the nome.  For larger k they are sums of
Gaussians (Jacobi's imaginary transformation), so that a few terms are enough for every k < 1.

`theta` and `zeta` take an mpmath context or numpy, and real or complex arguments.  Arrays of
arguments and moduli broadcast, and each modulus is evaluated alone.  Both raise LagtopError for k =
1, which has no periods.  Complex arguments use `complex_theta`.  See README.md in this folder for
errors.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arithmetic.ball import TooFewDigitsError
from ..arithmetic.balls import balls
from ..arithmetic.numbers import in_arithmetic
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..arithmetic.rounding import Triple, decided, triple
from ..errors import LagtopError
from .complete import complete_k, nome
from .modulus import Modulus, in_many_digits
from .periods import (
    Complex,
    Periods,
    check_index,
    each_alone,
    is_complex,
    negligible,
    reduced,
    whole_and_rest,
)


class ThetaSeries(NamedTuple):
    """The constants of the series of one modulus."""

    circular: bool
    """Whether the Fourier series are in use, rather than the Gaussians."""
    q: Numeric
    """The nome, at most exp(-pi)."""
    steepness: Numeric
    """pi K/K' of the Gaussians, at least pi."""
    even_size: Numeric
    """Common factor of all terms of the even function."""
    odd_size: Numeric
    rate: Numeric
    """1/(2K)."""
    exact_rate: Triple | None = None
    """1/(2K) for reducing arrays of arguments; None for numbers."""


def series_for(ar: FunctionArithmetic, modulus: Modulus) -> ThetaSeries:
    """Return the constants of one modulus; for arrays, rounded from balls.

    Raises LagtopError for k = 1.
    """
    if not modulus.k_prime > 0:
        raise LagtopError("k must be below 1 for theta functions, got 1.0", "k")
    if not ar.is_array:
        return series_constants(ar, modulus)

    def rounded(digits: int) -> ThetaSeries:
        exact = balls(digits)
        return series_in_doubles(series_constants(exact, in_many_digits(exact, modulus)))

    return decided("the constants of the modulus", rounded)


def series_constants(ar: FunctionArithmetic, modulus: Modulus) -> ThetaSeries:
    """Return the constants in balls or an mpmath context."""
    k, k_prime = modulus.k, modulus.k_prime
    circular = ar.either(k <= k_prime)
    quarter, other = complete_k(ar, k_prime), complete_k(ar, ar.where(k > 0, k, 1 + 0 * k))
    q = ar.where(circular, nome(ar, m=k * k, k_prime=k_prime), ar.exp(-ar.pi))
    gauss = ar.sqrt(quarter / other)
    steepness = ar.where(circular, ar.pi, ar.pi * quarter / other)
    if not steepness > 3:
        raise TooFewDigitsError  # the bounds on the truncation errors assume it
    even_size = ar.where(circular, 1 + 0 * q, gauss)
    odd_size = ar.where(circular, ar.sqrt(ar.sqrt(q)), gauss)
    return ThetaSeries(circular, q, steepness, even_size, odd_size, 1 / (2 * quarter))


def series_in_doubles(series: ThetaSeries) -> ThetaSeries:
    """Return constants of many digits as doubles.

    Raises TooFewDigitsError if the balls are too wide.
    """
    q, steepness, even_size, odd_size, rate = map(float, series[1:-1])
    exact = triple(series.rate)
    return ThetaSeries(series.circular, q, steepness, even_size, odd_size, rate, exact)


@in_arithmetic
def theta(ar: FunctionArithmetic, ij: str, x: Complex, modulus: Modulus) -> Complex:
    """Return theta_ij(x, iK'/K) of section 1; `ij` is 01, 00, 11 or 10."""
    check_index(ij)

    def function(x: Complex, *parts: Numeric) -> Complex:
        if is_complex(ar, x):
            from .complex_theta import theta_of_modulus  # start-up

            return theta_of_modulus(ar, ij, x, Modulus(*parts))
        return theta_at(ar, ij, whole_and_rest(ar, ar.re(x)), series_for(ar, Modulus(*parts)))

    return each_alone(ar, function, x, *modulus)


@in_arithmetic
def zeta(ar: FunctionArithmetic, ij: str, v: Complex, modulus: Modulus) -> Complex:
    """Return Z_ij(v) = d log theta_ij(v/2K)/dv of section 1; Z_01 is Jacobi's Zeta function.

    Poles are infinite in arrays, and at v = 0 also in many digits.
    """
    check_index(ij)

    def function(v: Complex, *parts: Numeric) -> Complex:
        if is_complex(ar, v):
            from .complex_theta import zeta_of_modulus  # start-up

            return zeta_of_modulus(ar, ij, v, Modulus(*parts))
        series = series_for(ar, Modulus(*parts))
        if not ar.is_array and v == 0:  # exactly
            return ar.inf if ij == "11" else 0 * v
        return zeta_at(ar, ij, in_periods(ar, ar.re(v), series), series)

    return each_alone(ar, function, v, *modulus)


def theta_at(ar: FunctionArithmetic, ij: str, x: Periods, series: ThetaSeries) -> Numeric:
    """Return theta_ij at a place in its periods."""
    size = series.odd_size if ij[0] == "1" else series.even_size
    return size * _bell(ar, ij, x.rest, series) * _value(ar, ij, x, series)


def zeta_at(ar: FunctionArithmetic, ij: str, x: Periods, series: ThetaSeries) -> Numeric:
    """Return Z_ij at a place in its periods."""
    value, slope = _sums(ar, ij, x, series)
    if ij == "10":
        value = _value(ar, ij, x, series)
    return slope / value * series.rate


def in_periods(ar: FunctionArithmetic, v: Numeric, series: ThetaSeries) -> Periods:
    """Return v/2K; arrays keep their digits far away and next to whole periods."""
    if series.exact_rate:
        return reduced(v, series.exact_rate)
    return whole_and_rest(ar, v * series.rate)


def _value(ar: FunctionArithmetic, ij: str, x: Periods, series: ThetaSeries) -> Numeric:
    """Return theta_ij(x) divided by the size of the function and its `_bell`.

    To be accurate next to its zero, theta10 is evaluated as theta11 half a period away.  The
    derivative of theta10 is accurate next to 0, and is not evaluated there.
    """
    if ij == "10":
        ij, x = "11", x.half_further(ar)
    return _sums(ar, ij, x, series, slopes=False)[0]


def _sums(
    ar: FunctionArithmetic, ij: str, x: Periods, series: ThetaSeries, *, slopes: bool = True
) -> tuple[Numeric, Numeric]:
    """Return the sum of a series and, if `slopes` is set, of its derivative."""
    if series.circular:
        value, slope = _fourier(ar, ij, x.rest, series.q, slopes=slopes)
    else:
        value, slope = _gaussians(ar, ij, x.rest, series.steepness, slopes=slopes)
    sign = 1 - 2 * (x.turns % 2) if ij[0] == "1" else 1
    return sign * value, sign * slope


def _fourier(
    ar: FunctionArithmetic, ij: str, x: Numeric, q: Numeric, *, slopes: bool
) -> tuple[Numeric, Numeric]:
    """Return the series of section 1 in q <= exp(-pi), and its derivative.

    - 01 and 00: 1 + 2 sum (-+1)^h q^(h^2) cos 2 pi h x.
    - 11, over q^(1/4): 2 sum (-1)^h q^(h(h+1)) sin 2 pi (h+1/2) x.
    - 10, over q^(1/4): the same with cosines, without the sign.
    """
    odd, sines = ij[0] == "1", ij == "11"
    wave, other = (ar.sin, ar.cos) if sines else (ar.cos, ar.sin)
    value, slope = (0 * x, 0 * x) if odd else (1 + 0 * x, 0 * x)
    terms = 2 + int(math.sqrt(negligible(ar) / math.pi))
    for h in range(0 if odd else 1, terms):
        weight = 2 * (-1) ** (h * int(ij[1])) * q ** (h * (h + 1) if odd else h * h)
        rate = (2 * h + odd) * ar.pi
        value = value + weight * wave(rate * x)
        if slopes:
            slope = slope + weight * (rate if sines else -rate) * other(rate * x)
    # from N = terms on, terms are at most 2 q^(N^2), each less than half of the one before
    left_out = q ** (terms * terms)
    return widened_by(ar, value, 4 * left_out), widened_by(ar, slope, 26 * terms * left_out)


def _bell(ar: FunctionArithmetic, ij: str, x: Numeric, series: ThetaSeries) -> Numeric:
    """Return the greatest Gaussian, by which sums are divided; 1 for Fourier series."""
    if series.circular:
        return 1
    distance = ar.where(x < 0, 0.5 + x, 0.5 - x) if ij[1] == "1" else x
    return ar.exp(-series.steepness * distance * distance)


def _gaussians(
    ar: FunctionArithmetic, ij: str, x: Numeric, c: Numeric, *, slopes: bool
) -> tuple[Numeric, Numeric]:
    """Return sum (+-1)^n exp(-c (x - n)^2) and its derivative, over the greatest Gaussian.

    c is the steepness.  For 01 and 11, n runs over the half-integers; for 00 and 10, over the
    integers.  A Gaussian and its mirror image are taken together, so that nothing cancels near x =
    0.
    """
    half, subtracted = ij[1] == "1", ij == "11"
    left = x < 0
    x = ar.where(left, -x, x)
    value = slope = 0 * x
    if not half:
        value, slope = 1 + 0 * x, -2 * c * x
    terms = 2 + int(math.sqrt(negligible(ar) / 3))
    for index in range(terms):
        n = index + 0.5 if half else index + 1.0
        sign = (-1) ** int(n) if ij[0] == "1" else 1
        lower = index * (index + 1 - 2 * x) if half else n * (n - 2 * x)
        bell, image = sign * ar.exp(-c * lower), ar.expm1(-4 * c * n * x)
        total, difference = bell * (2 + image), -bell * image
        if subtracted:
            total, difference = difference, total
        value = value + total
        if slopes:
            slope = slope - 2 * c * (x * total - n * difference)
    # from N = terms on, each pair is at most 2 exp(-c N^2) and less than half of the one before
    bell = ar.exp(-c * (terms * terms))
    value = widened_by(ar, value, 4 * bell)
    slope = widened_by(ar, slope, 8 * c * (terms + 2) * bell)
    turn = ar.where(left, -1, 1)
    return value * (turn if subtracted else 1), slope * (1 if subtracted else turn)


def widened_by(ar: FunctionArithmetic, value: Numeric, left_out: Numeric) -> Numeric:
    """Return a ball with `left_out` added to its radius; other numbers are left as they are."""
    return ar.widened(value, lambda: (left_out,), lambda x: x, values_only=True)
