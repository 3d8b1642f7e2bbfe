"""The Omega and Pi functions of Chrapan's sections 2 and 3, which are integrals of the third kind.

    Omega_ij(eta, v) = log[Theta_ij(eta - v)/Theta_ij(eta + v)]/2,   Pi_ij = eta Z_ij(v) + Omega_ij

Two theta functions that nearly agree would leave nothing of their quotient, and eta Z nothing
beside Omega where the two cancel.  So what depends on the modulus and the parameter v alone is
computed once, in many digits, and what depends on eta is arranged so that nothing cancels:
Theta(eta -+ v) are taken apart as P +- Q, and the growth of Pi over a period is one constant.

A parameter of many digits and one rounded to doubles obey the same formulas, over balls and arrays.
"""

from __future__ import annotations

import math
from functools import partial
from typing import Any

from ..arithmetic.balls import balls
from ..arithmetic.numbers import DOUBLES, in_arithmetic
from ..arithmetic.points import MAX_PERIODS
from ..arithmetic.protocol import ComplexArithmetic, FunctionArithmetic, Value
from ..arithmetic.rounding import decided
from ..errors import LagtopError
from .complete import complete_k
from .modulus import Modulus, in_many_digits
from .periods import Complex, Periods, each_alone, negligible
from .theta import (
    in_periods,
    series_for,
    zeta_at,
)
from .third_kind_imaginary import ImaginaryCircular, ImaginaryHyperbolic
from .third_kind_real import RealCircular, RealHyperbolic, ThirdKind, ZeroParameter


def check_parameter(
    ar: FunctionArithmetic, size: Value, modulus: Modulus, *, imaginary: bool
) -> None:
    """Raise LagtopError for an imaginary parameter whose size is K' or more."""
    if imaginary and modulus.k and abs(size) >= (limit := complete_k(ar, modulus.k)):
        raise LagtopError(
            f"param must be smaller than K' = {_shown(limit)} in size where it is imaginary, "
            f"got {_shown(size)}i",
            "param",
        )


def _shown(x: Value) -> str:
    middle: Value = getattr(x, "middle", x)
    return f"{float(middle):.6g}"


def check_near(v: float, modulus: Modulus) -> None:
    """Raise LagtopError where a real parameter is more than 2^50 periods from 0."""
    limit = MAX_PERIODS * 2 * float(complete_k(DOUBLES, float(modulus.k_prime)))
    if abs(v) > limit:
        raise LagtopError(
            f"param must be within 2^50 periods = {limit:.3g} of 0, got {v} (or give --digits)",
            "param",
        )


def third_kind(
    ar: FunctionArithmetic, ij: str, size: Value, modulus: Modulus, *, imaginary: bool
) -> ThirdKind:
    """Return Omega_ij and Pi_ij of a parameter, with constants in balls or an mpmath context.

    The parameter is `size`, or i times it if `imaginary`.  Raises LagtopError as `check_parameter`
    does, and for k = 1.
    """
    check_parameter(ar, size, modulus, imaginary=imaginary)
    series = series_for(ar, modulus)
    if not size:
        return ZeroParameter(ij)
    terms = 3 + int(math.sqrt(negligible(ar) / math.pi))
    odd = ij[0] == "1"
    if imaginary:
        y = size * series.rate
        if series.circular:
            return ImaginaryCircular.at(ar, ij, y, series.q, terms)
        return ImaginaryHyperbolic.at(ar, ij, y, series.steepness, terms)
    y = in_periods(ar, size, series).rest
    if ij[1] == "0":
        y = Periods(0, y).half_further(ar).rest
    if series.circular:
        zeta = zeta_at(ar, f"{ij[0]}1", Periods(0, abs(y)), series) / series.rate
        return RealCircular.at(ar, odd, y, zeta, series.q, terms=terms)
    return RealHyperbolic.at(ar, odd, y, series.steepness, terms)


@in_arithmetic
def omega(ar: ComplexArithmetic, ij: str, eta: Value, v: Complex, modulus: Modulus) -> Complex:
    """Return Omega_ij(eta, v) of section 2, for real eta.

    Real v: the real part.  Imaginary v = i alpha, |alpha| < K': i times a phase continuous in eta,
    which for `ij` = 11 and alpha > 0 is -pi/2 at eta = 0, as in (2,5).  Arrays are evaluated a pair
    of modulus and parameter at a time.  Raises LagtopError for other v and for k = 1.
    """
    return _evaluate(ar, "omega", ij, (eta, v), modulus)


@in_arithmetic
def pi_function(
    ar: ComplexArithmetic, ij: str, eta: Value, v: Complex, modulus: Modulus
) -> Complex:
    """Return Pi_ij(eta, v) = eta Z_ij(v) + Omega_ij(eta, v), (3,1) and (3,2), as `omega` does."""
    return _evaluate(ar, "pi", ij, (eta, v), modulus)


def _evaluate(
    ar: Any, name: str, ij: str, place: tuple[Value, Complex], modulus: Modulus
) -> Complex:
    """Return Omega or Pi of numbers of a context, or of arrays that broadcast."""

    def function(eta: Value, v: Complex, *parts: Value) -> Complex:
        given = Modulus(*parts)
        size, imaginary = parameter_of(ar, v)
        make = rounded_kind if ar.is_array else partial(third_kind, ar)
        kind = make(ij, size, given, imaginary=imaginary)
        value = getattr(kind, name)(ar, in_periods(ar, eta, series_for(ar, given)))
        return ar.mpc(0 * value, value) if imaginary else value

    eta, v = place
    if not ar.is_array:
        eta, v = ar.convert(eta), ar.convert(v)
    return each_alone(ar, function, eta, v, *modulus)


def parameter_of(ar: FunctionArithmetic, v: Complex) -> tuple[Value, bool]:
    """Return the size of a parameter, with its sign, and whether it is imaginary.

    Raises LagtopError unless it is real or imaginary.
    """
    real, imag = ar.re(v), ar.im(v)
    if imag and real:
        raise LagtopError("param must be real or imaginary", "param")
    return (imag, True) if imag else (real, False)


def rounded_kind(ij: str, size: float, modulus: Modulus, *, imaginary: bool) -> ThirdKind:
    """Return Omega_ij and Pi_ij of a parameter and a modulus in doubles, rounded from balls."""

    def kind(digits: int) -> ThirdKind:
        ar = balls(digits)
        exact = in_many_digits(ar, modulus)
        return third_kind(ar, ij, ar.convert(float(size)), exact, imaginary=imaginary).rounded()

    return decided("the constants of the parameter", kind)
