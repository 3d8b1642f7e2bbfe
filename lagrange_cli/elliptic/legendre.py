"""Legendre's integrals F, E and Pi of an amplitude, for every modulus; constants of a modulus.

With Delta^2 = 1 - k^2 sin^2 t they are integrals from 0 to phi:

    F(phi, k) of 1/Delta,    E(phi, k) of Delta,    Pi(n; phi | k) of 1/((1 - n sin^2 t) Delta).

The path follows the real axis to Re phi, then a parallel to the imaginary axis.  If k sin t > 1 on
the real axis, Delta is +i |Delta|, as for k^2 with a small negative imaginary part.  Pi is a Cauchy
principal value if its path crosses a pole.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from fractions import Fraction
from typing import Any, NamedTuple

from flint import acb, arb

from ..arithmetic.enclosures import at_precision, exact, nearest, sign
from ..errors import LagtopError
from ..top.ranges import MAX_PERIODS, check_reach
from ..top.units import DEGREES, Units
from .arguments import Arguments, ExactComplex
from .modulus import GivenModulus, Kind, Modulus, angle, real_parts, split
from .tables import Cells, Rows, numbers, table_rows

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
INTEGRALS = ("F", "E", "Pi", "zeta")
"""The functions of an amplitude; zeta is Jacobi's."""
_SQUARED_SINES: dict[Fraction, Fraction | arb] = {
    Fraction(x): Fraction(y, 4) for x, y in ((0, 0), (30, 1), (45, 2), (60, 3), (90, 4))
}
"""The rational squares of sines of angles in degrees."""


class Integrals(NamedTuple):
    """F, E and Pi.

    None stands for a pole, for a number beyond a pole without a principal value, for a number on a
    cut, and for a Pi that is not requested.
    """

    F: acb | None
    E: acb | None
    Pi: acb | None = None


class Legendre:
    """The integrals of a modulus and, if it is given, of n, in balls."""

    def __init__(
        self, modulus: Modulus, m: Fraction | None = None, n: Fraction | None = None
    ) -> None:
        """Take a modulus in balls, and the parameter m = k^2 if it is real and known exactly."""
        self.n, self.is_1 = n, modulus.k_prime.is_zero()
        squares = [x.ball**2 for x in (modulus, modulus.complement)]
        is_complex = modulus.kind is Kind.COMPLEX
        self.m: Any
        self.complement: Any
        self.m, self.complement = squares if is_complex else (x.real for x in squares)
        self.known_m: Any = self.m if m is None else m
        self.above_1 = self.known_m if modulus.kind is Kind.LARGE else None
        """The parameter m if it is above 1."""
        self.complete = self._within(arb(1), arb(0), arb(0), Fraction(1))
        """The complete integrals, to pi/2."""
        K, E, _ = self.complete
        self.mean = acb(0) if K is None or E is None else E / K
        """E/K, the mean of dn^2; 0, its limit, for k = 1."""

    def at(self, phi: ExactComplex, units: Units = DEGREES) -> Integrals:
        """Return the integrals of an amplitude in `units`, degrees or radians.

        They follow from those of the first quarter by f(phi + pi) = f(phi) + 2 f(pi/2).
        """
        square: Fraction | arb
        if units.radians and phi.real:
            half_turns = nearest(exact(phi.real) / arb.pi())
            rest = exact(phi.real) - half_turns * arb.pi()
            side = sign(rest)
            sine, cosine = abs(rest).sin_cos()
            sign(cosine)  # otherwise the ball goes beyond the quarter turn
            square = sine**2
        else:
            half_turns = math.ceil(phi.real / 180 - Fraction(1, 2))
            within = phi.real - 180 * half_turns
            side = -1 if within < 0 else 1
            sine, cosine = exact(abs(within) / 180).sin_cos_pi()
            square = _SQUARED_SINES.get(abs(within), sine**2)
        height = side * exact(phi.imag) * (1 if units.radians else arb.pi() / 180)
        found = self._within(sine, cosine, height, square)
        if not half_turns:
            return _each(lambda x: side * x, found)
        return _each(lambda x, whole: side * x + 2 * half_turns * whole, found, self.complete)

    def zeta(self, found: Integrals) -> acb | None:
        """Return Jacobi's zeta function E(phi, k) - F(phi, k) E/K of an amplitude."""
        if found.F is None or found.E is None:
            return None
        return found.E - found.F * self.mean

    def inverse(self, pq: str, x: Fraction) -> acb | None:
        """Return the real u with pq(u) = x, a value of Glaisher's function, or None if none exists.

        It is F of an amplitude phi (DLMF 22.15).  With p^2 = p0 + p1 sin^2 phi, and q^2 alike,
        sin^2 phi = (x^2 q0 - p0)/(p1 - x^2 q1).  u is in [-K, K] if pq is odd there, else in
        [0, 2K]; for k > 1, with the real part of K.
        """
        m = self.known_m
        square = x**2 if isinstance(m, Fraction) else exact(x**2)
        parts = {"s": (0, 1), "c": (1, -1), "d": (1, -m), "n": (1, 0)}
        (p0, p1), (q0, q1) = (parts[letter] for letter in pq)
        above, below = square * q0 - p0, p1 - square * q1
        turning = "c" if self.above_1 is None else "d"  # it changes its sign after a quarter
        if not _sign(below) or (_sign(x) < 0 and {"s", turning}.isdisjoint(pq)):
            return None
        t = above / below
        if _sign(t) < 0 or _sign(1 - t) < 0 or _sign(1 - m * t) < 0:
            return None
        u = self._first_quarter(t)
        if _sign(x) >= 0:
            return u
        if pq[0] == "s" or (pq[1] == "s" and pq[0] != turning):
            return -u
        return 2 * self._first_quarter(square * 0 + 1 if self.above_1 is None else 1 / m) - u

    def _first_quarter(self, square: Fraction | arb) -> acb:
        """Return F of an amplitude in the first quarter, from its squared sine."""
        t, d = _ball(square), _ball(1 - self.known_m * square)
        return acb(t.sqrt()) * acb.elliptic_rf(acb(1 - t), acb(d), acb(1))

    def _within(self, sine: arb, cosine: arb, height: arb, square: Fraction | arb) -> Integrals:
        """Return the integrals of x + iy, 0 <= x <= pi/2.

        `sine` and `cosine` are those of x, and `square` is sin^2 x, as a fraction if it is known.
        Below the real axis Carlson's integrals have the branch of the path.  Above it their values
        are conjugate, and for k sin x > 1 the values of the path are reflected at Re f(pi/2).
        """
        inside = 1 if self.above_1 is None else _side(self.above_1, square)
        s = acb(sine * height.cosh(), -cosine * abs(height).sinh())
        c2 = acb(cosine * height.cosh(), sine * abs(height).sinh()) ** 2
        d = c2 + self.complement * s**2
        if height.is_zero():
            return self._real(s, c2, d, square)
        is_upper = sign(height) > 0
        at_quarter = isinstance(square, Fraction) and square in {0, 1}
        if (at_quarter and inside > 0 and sign(d.real) <= 0) or (is_upper and not inside):
            return Integrals(None, None)
        found = self._carlson(s, c2, d)
        if is_upper and inside > 0:
            return _each(acb.conjugate, found)
        if is_upper:
            return _each(lambda x, whole: 2 * whole.real - x.conjugate(), found, self.complete)
        return found

    def _carlson(self, s: acb, c2: acb, d: acb) -> Integrals:
        """Return F and E from sin phi, cos^2 phi and Delta^2 (DLMF 19.25.5, 19.25.9)."""
        F, third = s * acb.elliptic_rf(c2, d, acb(1)), self.m * s**3 / 3
        return Integrals(F, s if self.is_1 else F - third * acb.elliptic_rd(c2, d, acb(1)))

    def _real(self, s: acb, c2: acb, d: acb, square: Fraction | arb) -> Integrals:
        """Return the integrals of a real amplitude; they are real up to the branch point of F."""
        if self.is_1 and square == 1:
            return Integrals(None, s)
        F, E, _ = self._carlson(s, c2, d)
        n = self.n
        past = 0 if n is None else _side(n, square)
        if n is None or F is None or not past or (past < 0 and n == self.above_1):
            return Integrals(F, E)
        p = c2 + exact(1 - n) * s**2
        Pi = F + exact(n) * s**3 * acb.elliptic_rj(c2, d, acb(1), p) / 3  # DLMF 19.25.14
        if past < 0:  # half a residue, because R_J passes the pole on one side
            root = acb(1 - self.m / exact(n)).sqrt()
            Pi += acb(0, arb.pi()) / (2 * exact(n - 1).sqrt() * root)
        return Integrals(F, E, acb(Pi.real) if self.above_1 is None else Pi)


def _each(function: Callable[..., acb], *integrals: Integrals) -> Integrals:
    """Apply a function to F, E and Pi; None stays None."""
    parts = zip(*integrals, strict=True)
    return Integrals(*(None if any(x is None for x in part) else function(*part) for part in parts))


def _ball(x: Fraction | arb) -> arb:
    """Return a number in a ball."""
    return x if isinstance(x, arb) else exact(x)


def _sign(x: Fraction | arb) -> int:
    """Return the sign of a number."""
    return sign(_ball(x))


def _side(q: Fraction | arb, square: Fraction | arb) -> int:
    """Return the sign of 1 - q sin^2 phi, from sin^2 phi; exactly if both numbers are fractions."""
    if isinstance(q, Fraction) and isinstance(square, Fraction):
        return _sign(1 - q * square)
    return sign(1 - _ball(q) * _ball(square))


def amplitude_rows(
    phi: Arguments,
    given: GivenModulus,
    n: Fraction | None = None,
    names: Collection[str] = INTEGRALS[:3],
    *,
    units: Units = DEGREES,
    digits: int | None = None,
) -> Rows:
    """Return a table of F, E, zeta and, with n, Pi over amplitudes, if they are among `names`.

    Complex numbers have a column for each part.  F is infinite from a quarter turn on if k = 1.
    Raises LagtopError for a modulus out of range, for complex amplitudes with n or with a complex
    k^2 and, in doubles, for amplitudes beyond 2^50 half turns.
    """
    given.check()
    _check_third(given, n)
    if phi.has_quarters:
        raise LagtopError("phi must be an angle, without K", "phi")
    if phi.imag is not None and (n is not None or given.kind is Kind.COMPLEX):
        raise LagtopError("phi must be real if n is given, or if k^2 is complex", "phi")
    for points in filter(None, (phi.real, phi.imag)) if digits is None else ():
        check_reach("phi", points, MAX_PERIODS * math.pi * units.radian)
    shown = {*names} - ({"Pi"} if n is None else set())
    heading, is_complex = f"phi_{units.angle}", given.kind in {Kind.LARGE, Kind.COMPLEX}

    def columns(x: ExactComplex, legendre: Legendre) -> Cells:
        values = legendre.at(x, units)
        every = (*values, legendre.zeta(values))
        found = {name: y for name, y in zip(INTEGRALS, every, strict=True) if name in shown}
        if phi.imag is not None:
            return {f"{heading}_re": x.real, f"{heading}_im": x.imag} | split(found)
        return {heading: x.real} | (split if is_complex else real_parts)(found)

    inputs = [*given.value, n or Fraction(0)]
    at = phi.numbers(digits)
    return table_rows(at, columns, lambda: Legendre(given.reduced(), given.m, n), inputs, digits)


def constants_record(
    given: GivenModulus, digits: int | None, *, n: Fraction | None = None, units: Units = DEGREES
) -> dict[str, Any]:
    """Return `CONSTANTS` of a modulus, correctly rounded to doubles or to `digits` digits.

    With n, Pi(n | k) is one of them.  Unless k is in [0, 1], numbers are split into `_re` and
    `_im`.  Infinite constants are None.  Raises LagtopError for a modulus out of range.
    """
    given.check()
    at_precision(32, given.check_principal)
    _check_third(given, n)

    def compute(_: int) -> Cells:
        found = constants_of(given.reduced(), units)
        if n is not None:
            found["Pi"] = Legendre(given.reduced(), given.m, n).complete.Pi
        row = real_parts(found) if given.kind is Kind.UNIT else split(found)
        if given.name == "m":
            real, imag = given.value[:2]
            return ({"m_re": real, "m_im": imag} if imag else {"m": real}) | row
        return row

    return numbers(compute, [*given.value, n or Fraction(0)], digits)


def _check_third(given: GivenModulus, n: Fraction | None) -> None:
    """Raise LagtopError for Pi of a modulus with a complex square."""
    if n is not None and given.kind is Kind.COMPLEX:
        raise LagtopError("n needs a real k^2: Pi is not computed for complex k^2", "n")


def constants_of(modulus: Modulus, units: Units = DEGREES) -> dict[str, acb | None]:
    """Return the moduli, the nomes q = exp(-pi K'/K) (3.1.6), and the integrals of k and k'."""
    complement = modulus.complement
    K, E, _ = Legendre(modulus).complete
    K_prime, E_prime, _ = Legendre(complement).complete
    found = {"k": modulus.ball, "k_prime": complement.ball}
    nomes = {"nome": _nome(K, K_prime)}
    if modulus.kind is Kind.UNIT:
        modular = acb(arb.atan2(modulus.k, modulus.k_prime))
        found |= angle("modular_angle", modular, units)
        nomes["nome_prime"] = _nome(K_prime, K)
    return {**found, **nomes, "K": K, "K_prime": K_prime, "E": E, "E_prime": E_prime}


def _nome(K: acb | None, K_prime: acb | None) -> acb:
    """Return exp(-pi K'/K) in its limits, too; None stands for infinity."""
    if K is None or K_prime is None:
        return acb(int(K is None))
    return (-arb.pi() * K_prime / K).exp()
