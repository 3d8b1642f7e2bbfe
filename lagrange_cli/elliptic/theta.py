"""Theta functions and the Zeta, Omega and Pi functions made of them (Chrapan sections 1 to 3).

theta01, theta00, theta11, theta10 of x are theta4, theta3, theta1, theta2 of the angle pi x:
two functions, one even (0.) and one odd (1.), and the same shifted by half a period (.0).  Up to
k = k' they are summed as Fourier series in the nome, beyond as Gaussians (Jacobi's imaginary
transformation), so that a few terms are enough for every k < 1.

All functions take an mpmath context, or numpy with arguments and moduli that broadcast, and raise
LagtopError for k = 1, where there are no periods.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..arithmetic.double_double import reduce_phase
from ..arithmetic.generic import Arithmetic, Real, epsilon, everywhere, has_arrays, where
from ..errors import LagtopError
from .complete import complete_k, nome
from .modulus import Modulus, rate_of_half_periods

Complex = Real
"""A real or complex number, or array, of the arithmetic in use."""


class Place(NamedTuple):
    """An argument in periods: whole ones and the rest, its real part within half of one."""

    turns: Real
    rest: Complex


def theta(ar: Arithmetic, ij: str, x: Complex, given: Modulus) -> Complex:
    """theta_ij(x, iK'/K) of section 1, `ij` one of 01, 00, 11, 10."""
    _check(ij, given)
    return _size(ar, ij, given) * _with_slope(ar, ij, _place(ar, x), given)[0]


def theta_of(ar: Arithmetic, ij: str, v: Complex, given: Modulus) -> Complex:
    """Theta_ij(v) = theta_ij(v/2K), which keeps its digits at large real v."""
    _check(ij, given)
    return _size(ar, ij, given) * _with_slope(ar, ij, _in_periods(ar, v, given), given)[0]


def zeta(ar: Arithmetic, ij: str, v: Complex, given: Modulus) -> Complex:
    """Z_ij(v) = d log theta_ij(v/2K)/dv of section 1; Z_01 is Jacobi's Zeta function."""
    _check(ij, given)
    if not has_arrays(ar) and v == 0:  # to all digits
        return ar.inf if ij == "11" else 0 * v
    value, slope = _with_slope(ar, ij, _in_periods(ar, v, given), given)
    return slope / value / (2 * complete_k(ar, given.k_prime))


def omega(ar: Arithmetic, ij: str, eta: Real, v: Complex, given: Modulus) -> Complex:
    """Omega_ij(eta, v) = log[Theta_ij(eta - v)/Theta_ij(eta + v)]/2 of section 2, for real eta.

    Real v: the real part.  Imaginary v = i alpha, |alpha| < K': i times a phase continuous in eta,
    which for `ij` = 11 and alpha > 0 is -pi/2 at eta = 0, as in (2,5).  Raises LagtopError for
    other v.
    """
    _check(ij, given)
    x, alpha = _in_periods(ar, eta, given), _imag(ar, v)
    if not has_arrays(ar) and eta == 0 and not (ij == "11" and alpha):  # to all digits
        return 0 * v
    if everywhere(alpha == 0):
        y = _in_periods(ar, _real(ar, v), given)
        less = _with_slope(ar, ij, Place(x.turns - y.turns, x.rest - y.rest), given)[0]
        more = _with_slope(ar, ij, Place(x.turns + y.turns, x.rest + y.rest), given)[0]
        return (ar.log(abs(less)) - ar.log(abs(more))) / 2
    if not everywhere(_real(ar, v) == 0):
        raise LagtopError("the parameter must be real or imaginary")
    if not everywhere((given.k == 0) | (abs(alpha) < _quarter_period(ar, given.k))):
        raise LagtopError("an imaginary parameter must be smaller than K' in size")
    height = alpha / (2 * complete_k(ar, given.k_prime))
    turns, rest = _shifted(ar, ij, x)
    value, _ = _with_slope(ar, f"{ij[0]}1", Place(0 * turns, rest + _i(ar) * height), given)
    if ij[0] == "0":  # its real part is positive
        return -_i(ar) * ar.atan2(_imag(ar, value), _real(ar, value))
    side = ar.sign(alpha)
    turned = ar.atan2(-_real(ar, value), side * _imag(ar, value))  # from the phase at eta = 0
    return -_i(ar) * side * (turned + (ar.pi / 2 - turns * ar.pi))


def pi_function(ar: Arithmetic, ij: str, eta: Real, v: Complex, given: Modulus) -> Complex:
    """Pi_ij(eta, v) = eta Z_ij(v) + Omega_ij(eta, v), (3,1) and (3,2)."""
    return eta * zeta(ar, ij, v, given) + omega(ar, ij, eta, v, given)


def _check(ij: str, given: Modulus) -> None:
    if ij not in {"01", "00", "11", "10"}:
        raise LagtopError(f"the function must be 01, 00, 11 or 10, got {ij}")
    if not everywhere(given.k_prime > 0):
        raise LagtopError("k must be below 1 for theta functions, got 1.0")


def _quarter_period(ar: Arithmetic, k: Real) -> Real:
    """K', of k = 0 too."""
    return complete_k(ar, where(k > 0, k, 1 + 0 * k))


def _place(ar: Arithmetic, x: Complex) -> Place:
    real = _real(ar, x)
    turns = ar.rint(real) if has_arrays(ar) else ar.nint(real)
    return Place(turns, x - turns)


def _in_periods(ar: Arithmetic, v: Complex, given: Modulus) -> Place:
    """v/2K; real arrays keep their digits far away."""
    if has_arrays(ar) and ar.isrealobj(v):
        rate = rate_of_half_periods(ar, given.k_prime, given.rest)
        v, _ = ar.broadcast_arrays(ar.asarray(v, dtype=float), given.k_prime)
        return Place(*reduce_phase(v, rate))
    return _place(ar, v / (2 * complete_k(ar, given.k_prime)))


def _shifted(ar: Arithmetic, ij: str, x: Place) -> Place:
    """The place in the function i1 that is x in the function ij."""
    if ij[1] == "1":
        return x
    more = _place(ar, x.rest + 0.5)
    return Place(x.turns + more.turns, more.rest)


def _with_slope(ar: Arithmetic, ij: str, x: Place, given: Modulus) -> tuple[Complex, Complex]:
    """theta_ij(x) and its derivative, both over `_size`."""
    turns, rest = _shifted(ar, ij, x)
    odd = ij[0] == "1"
    circular = given.k <= given.k_prime
    if everywhere(circular):
        value, slope = _fourier(ar, odd, rest, given)
    elif not hasattr(circular, "any") or not circular.any():
        value, slope = _gaussians(ar, odd, rest, given)
    else:  # both, each with the other's moduli replaced by one that it can do
        middle = ar.sqrt(0.5)
        k, k_prime = given.k, given.k_prime
        low = Modulus(where(circular, k, middle), where(circular, k_prime, middle))
        high = Modulus(where(circular, middle, k), where(circular, middle, k_prime))
        pairs = zip(_fourier(ar, odd, rest, low), _gaussians(ar, odd, rest, high), strict=True)
        value, slope = (where(circular, one, other) for one, other in pairs)
    sign = 1 - 2 * (turns % 2) if odd else 1
    return sign * value, sign * slope


def _size(ar: Arithmetic, ij: str, given: Modulus) -> Real:
    """What all terms of a series have in common; it falls out of Zeta, Omega and Pi."""
    q = nome(ar, m=given.k * given.k, k_prime=given.k_prime)
    fourier = ar.sqrt(ar.sqrt(q)) if ij[0] == "1" else 1 + 0 * q
    gauss = ar.sqrt(complete_k(ar, given.k_prime) / _quarter_period(ar, given.k))
    return where(given.k <= given.k_prime, fourier, gauss)


def _fourier(ar: Arithmetic, odd: bool, x: Complex, given: Modulus) -> tuple[Complex, Complex]:
    """The series of section 1 in q, and its derivative, for q <= exp(-pi).

    1 + 2 sum (-1)^h q^(h^2) cos 2 pi h x, and over q^(1/4)
    2 sum (-1)^h q^(h(h+1)) sin 2 pi (h+1/2) x.
    """
    q = nome(ar, m=given.k * given.k, k_prime=given.k_prime)
    value, slope = (0 * x, 0 * x) if odd else (1 + 0 * x, 0 * x)
    for h in range(0 if odd else 1, _fourier_terms(ar, x, given)):
        weight = 2 * (-1) ** h * q ** (h * (h + 1) if odd else h * h)
        rate = (2 * h + odd) * ar.pi
        sine, cosine = ar.sin(rate * x), ar.cos(rate * x)
        value = value + weight * (sine if odd else cosine)
        slope = slope + weight * rate * (cosine if odd else -sine)
    return value, slope


def _gaussians(ar: Arithmetic, odd: bool, x: Complex, given: Modulus) -> tuple[Complex, Complex]:
    """The same for q >= exp(-pi), over sqrt(K/K'): sum (+-1)^n exp(-pi (x - n)^2 K/K').

    n are the half-integers.
    A Gaussian and its mirror image are taken together, so that nothing cancels near x = 0.
    """
    ratio = complete_k(ar, given.k_prime) / complete_k(ar, given.k)
    c = ar.pi * ratio
    left = _real(ar, x) < 0
    x = where(left, -x, x)
    value = slope = 0 * x
    for index in range(2 + int(math.sqrt(_digits(ar) / 3))):
        n, sign = index + 0.5, (-1) ** index if odd else 1
        bell, image = sign * ar.exp(-c * (x - n) ** 2), ar.expm1(-4 * c * n * x)
        total, difference = bell * (2 + image), -bell * image
        if odd:
            total, difference = difference, total
        value = value + total
        slope = slope - 2 * c * (x * total - n * difference)
    turn = where(left, -1, 1)
    return value * (turn if odd else 1), slope * (1 if odd else turn)


def _fourier_terms(ar: Arithmetic, x: Complex, given: Modulus) -> int:
    """Terms until q^(h^2) exp(2 pi h |Im x|) is negligible against the largest of them."""
    ratio = complete_k(ar, given.k_prime) / _quarter_period(ar, given.k)
    height = abs(_imag(ar, x)) * ratio
    peak = float(ar.max(height, initial=0.0) if has_arrays(ar) else height)
    return 2 + int(peak + math.sqrt(_digits(ar) / math.pi))


def _digits(ar: Arithmetic) -> float:
    """-log of the smallest number that matters beside 1."""
    return float(-ar.log(epsilon(ar))) + 2


def _i(ar: Arithmetic) -> Complex:
    return 1j if has_arrays(ar) else ar.mpc(0, 1)


def _real(ar: Arithmetic, x: Complex) -> Real:
    return ar.real(x) if has_arrays(ar) else ar.re(x)


def _imag(ar: Arithmetic, x: Complex) -> Real:
    return ar.imag(x) if has_arrays(ar) else ar.im(x)
