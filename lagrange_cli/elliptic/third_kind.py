"""The Omega and Pi functions of Chrapan's sections 2 and 3, which are integrals of the third kind.

    Omega_ij(eta, v) = log[Theta_ij(eta - v)/Theta_ij(eta + v)]/2,   Pi_ij = eta Z_ij(v) + Omega_ij

Two theta functions that nearly agree would leave nothing of their quotient, and eta Z nothing
beside Omega where the two cancel.  So what depends on the modulus and the parameter v alone is
computed once, in many digits, and what depends on eta is arranged so that nothing cancels:
Theta(eta -+ v) are taken apart as P +- Q, and the growth of Pi over a period is one constant.

A parameter of many digits and one rounded to doubles obey the same formulas, over mpf and arrays.
"""

from __future__ import annotations

import math
from typing import Any, Protocol

from ..arithmetic.doubles import DOUBLES
from ..arithmetic.formulas import in_arithmetic
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.points import MAX_PERIODS
from ..arithmetic.protocol import FunctionArithmetic, Value
from ..errors import LagtopError
from .complete import complete_k
from .modulus import Modulus
from .periods import Complex, Periods
from .theta import in_many_digits, in_periods, negligible, rounded, series_for, zeta_at
from .third_kind_imaginary import ImaginaryCircular, ImaginaryHyperbolic
from .third_kind_real import RealCircular, RealHyperbolic


class ThirdKind(Protocol):
    """Omega and Pi of one modulus and one parameter, at places in the periods of eta.

    Those of an imaginary parameter are imaginary, and given without the i.
    """

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Value:
        """Return Omega at x = eta/2K."""

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Value:
        """Return Pi at x = eta/2K; not a number where it has a pole for every eta."""

    def rounded(self) -> ThirdKind:
        """Return the parameter with its constants in doubles."""


class ZeroParameter:
    """The parameter 0, where Omega vanishes, and Pi but for the pole of Z_11."""

    def __init__(self, ij: str) -> None:
        self.ij = ij

    def omega(self, ar: FunctionArithmetic, x: Periods) -> Value:
        """Return 0."""
        return 0 * x.rest

    def pi(self, ar: FunctionArithmetic, x: Periods) -> Value:
        """Return 0 or, of the function 11, not a number."""
        return (math.nan if self.ij == "11" else 0) * x.rest

    def rounded(self) -> ZeroParameter:
        """Return the parameter itself."""
        return self


def check_parameter(ar: ManyDigits, v: Complex, modulus: Modulus) -> None:
    """Raise LagtopError unless v is real, or imaginary and smaller than K' in size.

    `ar` is an mpmath context.
    """
    height = abs(ar.im(v))
    if height and ar.re(v):
        raise LagtopError("param must be real or imaginary", "param")
    if height and modulus.k and height >= (limit := complete_k(ar, modulus.k)):
        size = ar.nstr(limit, 6)
        raise LagtopError(
            f"param must be smaller than K' = {size} in size where it is imaginary, "
            f"got {ar.nstr(ar.im(v), 6)}i",
            "param",
        )


def check_near(v: float, modulus: Modulus) -> None:
    """Raise LagtopError where a real parameter is more than 2^50 periods from 0."""
    limit = MAX_PERIODS * 2 * float(complete_k(DOUBLES, float(modulus.k_prime)))
    if abs(v) > limit:
        raise LagtopError(
            f"param must be within 2^50 periods = {limit:.3g} of 0, got {v} (or give --digits)",
            "param",
        )


def third_kind(ar: ManyDigits, ij: str, v: Complex, modulus: Modulus) -> ThirdKind:
    """Return Omega_ij and Pi_ij of a parameter, with constants in an mpmath context.

    Raises LagtopError as `check_parameter` does, and for k = 1.
    """
    check_parameter(ar, v, modulus)
    series = series_for(ar, modulus)
    if v == 0:
        return ZeroParameter(ij)
    terms = 3 + int(math.sqrt(negligible(ar) / math.pi))
    odd, imaginary = ij[0] == "1", bool(ar.im(v))
    if imaginary and series.circular:
        y = ar.im(v) * series.rate
        zeta = (
            ar.im(zeta_at(ar, ij, Periods(ar.convert(0), ar.mpc(0, abs(y))), series)) / series.rate
        )
        return ImaginaryCircular.at(ar, ij, y, zeta, series.q, terms=terms)
    if imaginary:
        y = ar.im(v) * series.rate
        return ImaginaryHyperbolic.at(ar, ij, y, series.steepness, terms)
    y = in_periods(ar, ar.re(v), series).rest
    if ij[1] == "0":
        y = Periods(ar.convert(0), y).half_further(ar).rest
    if series.circular:
        zeta = zeta_at(ar, f"{ij[0]}1", Periods(ar.convert(0), abs(y)), series) / series.rate
        return RealCircular.at(ar, odd, y, zeta, series.q, terms=terms)
    return RealHyperbolic.at(ar, odd, y, series.steepness, terms)


@in_arithmetic
def omega(ar: FunctionArithmetic, ij: str, eta: Value, v: Complex, modulus: Modulus) -> Complex:
    """Return Omega_ij(eta, v) of section 2, for real eta.

    Real v: the real part.  Imaginary v = i alpha, |alpha| < K': i times a phase continuous in eta,
    which for `ij` = 11 and alpha > 0 is -pi/2 at eta = 0, as in (2,5).  Arrays are evaluated a pair
    of modulus and parameter at a time.  Raises LagtopError for other v and for k = 1.
    """
    return _evaluate(ar, "omega", ij, (eta, v), modulus)


@in_arithmetic
def pi_function(
    ar: FunctionArithmetic, ij: str, eta: Value, v: Complex, modulus: Modulus
) -> Complex:
    """Return Pi_ij(eta, v) = eta Z_ij(v) + Omega_ij(eta, v), (3,1) and (3,2), as `omega` does."""
    return _evaluate(ar, "pi", ij, (eta, v), modulus)


def _evaluate(
    ar: Any, name: str, ij: str, place: tuple[Value, Complex], modulus: Modulus
) -> Complex:
    """Return Omega or Pi of numbers of a context, or of arrays that broadcast."""
    eta, v = place
    if not ar.is_array:
        v = ar.convert(v)
        series = series_for(ar, modulus)
        kind = third_kind(ar, ij, v, modulus)
        value = getattr(kind, name)(ar, in_periods(ar, ar.convert(eta), series))
        return ar.mpc(0, value) if ar.im(v) else value
    import numpy as np

    eta, v, *parts = np.broadcast_arrays(eta, v, *modulus)
    values = np.zeros(eta.shape, dtype=v.dtype if np.iscomplexobj(v) else float)
    many = ManyDigits()
    for pair in {tuple(pair) for pair in zip(*(x.ravel() for x in (v, *parts)), strict=True)}:
        same = np.all([x == y for x, y in zip((v, *parts), pair, strict=True)], axis=0)
        exact = in_many_digits(many, Modulus(*pair[1:]))
        kind = third_kind(many, ij, many.convert(complex(pair[0])), exact).rounded()
        x = in_periods(ar, eta[same], rounded(series_for(many, exact)))
        values[same] = getattr(kind, name)(ar, x) * (1j if pair[0].imag else 1)
    return values
