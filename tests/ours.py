"""Our elliptic functions in numbers of mpmath, for the equations of the sources."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import Any

from flint import acb, arb
from mpmath.ctx_mp import MPContext

from lagrange_cli.arithmetic.enclosures import at_precision
from lagrange_cli.elliptic.arguments import ExactComplex
from lagrange_cli.elliptic.functions import Functions
from lagrange_cli.elliptic.legendre import Legendre, constants_of
from lagrange_cli.elliptic.modulus import GivenModulus
from lagrange_cli.top.units import RADIANS


class ManyDigits(MPContext):  # type: ignore[misc]
    """A context of mpmath of its own, which leaves other precisions alone."""

    def __init__(self, digits: int) -> None:
        super().__init__()
        self.dps = digits


def fraction(x: Any) -> Fraction:
    """Return the exact value of a real number of mpmath."""
    sign, mantissa, exponent, _ = x._mpf_
    found: Fraction = (-1) ** sign * Fraction(int(mantissa)) * Fraction(2) ** exponent
    return found


class Ours:
    """Our functions in the numbers of a context, and with its digits.

    A modulus k is a number: in [0, 1], imaginary or above 1.
    """

    def __init__(self, ar: ManyDigits) -> None:
        self.ar = ar

    def exact(self, z: Any) -> ExactComplex:
        """Return the exact value of a number."""
        return ExactComplex(*(fraction(self.ar.mpf(x)) for x in (self.ar.re(z), self.ar.im(z))))

    def modulus(self, k: Any) -> GivenModulus:
        """Return a modulus."""
        return GivenModulus("k", self.exact(k))

    def number(self, ball: arb | acb | None) -> Any:
        """Return the middle of a ball, real if its imaginary part is 0."""
        if ball is None:
            return None
        if isinstance(ball, acb):
            real, imag = self.number(ball.real), self.number(ball.imag)
            return self.ar.mpc(real, imag) if imag else real
        mantissa, exponent = ball.mid().man_exp()
        return self.ar.ldexp(self.ar.mpf(int(mantissa)), int(exponent))

    def evaluated(self, compute: Callable[[], Any]) -> Any:
        """Return what a function computes in balls, as numbers."""
        found = at_precision(self.ar.dps + 30, compute)
        return tuple(map(self.number, found)) if isinstance(found, tuple) else self.number(found)

    def _functions(self, k: Any) -> Functions:
        return Functions(self.modulus(k).reduced())

    def _point(self, z: Any, k: Any) -> Any:
        return self._functions(k).point(self.exact(z))

    def jacobi(self, u: Any, k: Any) -> Any:
        """Return am, sn, cn, dn."""
        return self.evaluated(lambda: self._functions(k).jacobi(self._point(u, k)))

    def zeta(self, ij: str, v: Any, k: Any) -> Any:
        """Return Z_ij(v)."""
        return self.evaluated(lambda: self._functions(k).zetas(self._point(v, k))[ij])

    def omega(self, ij: str, eta: Any, v: Any, k: Any) -> Any:
        """Return Omega_ij(eta, v)."""
        return self._third(ij, eta, v, k, 0)

    def pi_function(self, ij: str, eta: Any, v: Any, k: Any) -> Any:
        """Return Pi_ij(eta, v)."""
        return self._third(ij, eta, v, k, 1)

    def _third(self, ij: str, eta: Any, v: Any, k: Any, which: int) -> Any:

        def values() -> Any:
            functions = self._functions(k)
            first, second = (functions.point(self.exact(x)) for x in (eta, v))
            return functions.third(first, second, functions.zetas(second))

        return self.evaluated(lambda: values()[ij][which])

    def constant(self, name: str, k: Any) -> Any:
        """Return K, E or the nome."""
        return self.evaluated(lambda: constants_of(self.modulus(k).reduced())[name])

    def integral(self, which: int, phi: Any, k: Any) -> Any:
        """Return F(phi, k), or E(phi, k) for `which` = 1, of an amplitude in radians."""
        given = self.modulus(k)

        def compute() -> Any:
            legendre = Legendre(given.reduced(), given.m, None)
            return tuple(legendre.at(self.exact(phi), RADIANS))

        return self.evaluated(compute)[which]


ours = Ours(ManyDigits(60))
ar = ours.ar
jacobi, zeta, omega, pi_function = ours.jacobi, ours.zeta, ours.omega, ours.pi_function
quarter_period, second_kind, nome = (partial(ours.constant, x) for x in ("K", "E", "nome"))
incomplete_f, incomplete_e = partial(ours.integral, 0), partial(ours.integral, 1)
