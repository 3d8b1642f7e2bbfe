"""The functions of one modulus, as balls of Arb: Jacobi's, theta, Zeta, Omega and Pi.

All functions reduce to a modulus k in [0, 1] (see `modulus`), with the argument z = u/2K in periods
and tau = iT, T = K'/K.  Jacobi's, theta and Zeta functions are quotients of Arb's theta functions.
Omega and Pi are differences of logarithms of theta functions.

Results have the precision of Arb in use.  Raises TooFewDigitsError if a branch needs more digits.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from flint import acb, arb, fmpq

from ..arithmetic.enclosures import TooFewDigitsError, nearest, sign
from .modulus import Kind, Modulus

THIRD = ("01", "00", "11")
"""The indices of Omega and Pi."""
_NUMBERS = {"01": 3, "00": 2, "11": 0, "10": 1}
"""The theta functions theta4, theta3, theta1 and theta2 of pi z: their places in Arb's tuple."""
_REDUCED = {Kind.UNIT: {}, Kind.IMAGINARY: {"01": "00", "00": "01"}, Kind.LARGE: {"00": "10"}}
"""The function of the reduced modulus that replaces each function, if the index differs."""


class Point(NamedTuple):
    """A complex number with exact parts, `fmpq`, or a ball for a multiple of K."""

    real: Any
    imag: Any = fmpq(0)

    @property
    def is_0(self) -> bool:
        """Whether the number is exactly 0."""
        return bool(self.real == 0 and self.imag == 0)


class Functions:
    """The functions of one modulus."""

    def __init__(self, modulus: Modulus) -> None:
        k, k_prime, self.kind, self.stretch = modulus
        self.is_0, self.is_1 = k.is_zero(), k_prime.is_zero()
        half_turn = self.stretch / arb.pi()
        self.scale = half_turn * (arb(0) if self.is_1 else arb(1).agm(k_prime))
        """Periods 2K of the reduced modulus in a unit of the argument."""
        self.across = half_turn * (arb(0) if self.is_0 else arb(1).agm(k))
        """Periods 2K' in a unit of the argument."""
        self.rate, self.tau = acb(self.scale), None
        """1/2K and iK'/K of the modulus itself."""
        if self.is_0 or self.is_1:
            return
        self.T = self.scale / self.across
        self.reduced_tau = reduced = acb(0, self.T)
        self.at_0 = acb.modular_theta(acb(0), reduced)
        self.tau = reduced
        if self.kind is Kind.IMAGINARY:
            self.tau = reduced + 1
        elif self.kind is Kind.LARGE:
            self.tau, self.rate = reduced / (1 - reduced), self.rate / (1 - reduced)

    def jacobi(self, u: Point) -> tuple[acb | None, acb, acb, acb]:
        """Return am, sn, cn and dn of u.

        am is continuous around the real axis.  It is None beyond its branch points, the poles of sn
        next to the axis.  For k > 1 its real part stays within a quarter of a turn.
        """
        sn, cn, dn = self._quotients(acb(*u))
        is_beyond = u.imag != 0 and sign(abs(u.imag) * self.across * 2 - 1) > 0
        return None if is_beyond else self._amplitude(u, sn, cn), sn, cn, dn

    def _quotients(self, u: acb) -> tuple[acb, acb, acb]:
        """Return sn, cn and dn."""
        if self.is_1:
            return u.tanh(), u.sech(), u.sech()
        if self.is_0:
            return *u.sin_cos(), acb(1)
        theta1, theta2, theta3, theta4 = acb.modular_theta(u * self.scale, self.reduced_tau)
        _, at2, at3, at4 = self.at_0
        sn, cn, dn = at3 * theta1 / (at2 * theta4), at4 * theta2, at4 * theta3
        cn, dn = cn / (at2 * theta4), dn / (at3 * theta4)
        if self.kind is Kind.IMAGINARY:
            return sn / (dn * self.stretch), cn / dn, 1 / dn
        return (sn / self.stretch, dn, cn) if self.kind is Kind.LARGE else (sn, cn, dn)

    def _amplitude(self, u: Point, sn: acb, cn: acb) -> acb:
        """Return the angle with a sine and a cosine, next to that of the real part of u."""
        if self.is_0:
            return acb(*u)
        periods = u.real * self.scale * (self.kind is not Kind.LARGE)
        if u.imag == 0:
            turns = nearest(arb(periods))
            half = -1 if turns % 2 else 1
            return acb(turns * arb.pi() + arb.atan2(half * sn.real, half * cn.real))
        angle = acb(0, -1) * (cn + acb(0, 1) * sn).log()
        if self.kind is Kind.LARGE:
            return angle
        return angle + 2 * arb.pi() * nearest((periods - angle.real / arb.pi()) / 2)

    def thetas(self, v: Point) -> dict[str, acb]:
        """Return Theta_ij(v)."""
        if self.tau is None:
            return {ij: acb(int(ij[0] == "0")) for ij in _NUMBERS}
        values = acb.modular_theta(acb(*v) * self.rate, self.tau)
        return {ij: values[_NUMBERS[ij]] for ij in _NUMBERS}

    def zetas(self, v: Point) -> dict[str, acb | None]:
        """Return Z_ij(v), the derivative of log Theta_ij(v); Z_11 has a pole at 0."""
        x, values = acb(*v), self.thetas(v)
        if self.tau is None:
            found = {"01": acb(0), "00": acb(0), "11": x.cot(), "10": -x.tan()}
        else:
            slopes = acb.modular_theta(x * self.rate, self.tau, 1)
            found = {ij: self.rate * slopes[n] / values[ij] for ij, n in _NUMBERS.items()}
        return {ij: None if ij == "11" and v.is_0 else found[ij] for ij in _NUMBERS}

    def third(
        self, u: Point, v: Point, zetas: dict[str, acb | None]
    ) -> dict[str, tuple[acb | None, acb | None]]:
        """Return Omega_ij(u, v) = log[Theta_ij(u - v)/Theta_ij(u + v)]/2 and Pi_ij(u, v) by index.

        Pi_ij = u Z_ij(v) + Omega_ij; `zetas` are the Z_ij(v).  The logarithms are those of
        `_logarithms`.  None stands for a pole.
        """
        less = Point(u.real - v.real, u.imag - v.imag)
        more = Point(u.real + v.real, u.imag + v.imag)
        added = acb(0)
        if self.kind is Kind.LARGE:  # by the transformation of tau
            added = acb(0, 2) * arb.pi() * self.scale**2 / (1 - self.reduced_tau)
            added *= acb(*u) * acb(*v)
        ends = self._logarithms(less), self._logarithms(more)
        found: dict[str, tuple[acb | None, acb | None]] = {}
        for ij in THIRD:
            inner, zeta = _REDUCED[self.kind].get(ij, ij), zetas[ij]
            if inner == "11" and (less.is_0 or more.is_0):
                found[ij] = None, None
            elif v.is_0:
                found[ij] = acb(0), None if zeta is None else acb(0)
            else:
                first, second = (end[inner] for end in ends)
                omega = (first - second) / 2 + added
                found[ij] = omega, None if zeta is None else omega + acb(*u) * zeta
        return found

    def _logarithms(self, at: Point) -> dict[str, acb]:
        """Return log theta_ij of the reduced modulus at a point, up to a constant.

        It is continuous between the lines on which theta_ij has its zeros, conjugate at conjugate
        points, and the mean of both sides on such a line.
        With z - n tau in the strip |Im z| <= T/2 around the real axis, n even or odd halves,

            log theta(z) = i pi (n^2 tau - 2 n z + n a) + log theta_0a(z - n tau),

        where a is the second index.  The last logarithm is the principal one: theta_0a is positive
        on the real axis, and on the edges of the strip its argument is within a quarter turn.  So
        it is in the whole strip, because the argument is a harmonic function.
        """
        if self.is_0:
            return {"01": acb(0), "00": acb(0), "11": _log_sine(at)}
        x, height, is_real = at.real * self.scale, at.imag * self.across, at.imag == 0
        within, found = x - nearest(arb(x)), {}
        for i, half in enumerate((fmpq(0), fmpq(1, 2))):
            n = half + (0 if is_real else _floor(height + fmpq(1, 2) - half))
            place = acb(within, (height - n) * self.T)
            for a, theta in enumerate(acb.modular_theta(place, self.reduced_tau)[2:]):
                value = theta.log() + arb.pi() * n * acb((2 * height - n) * self.T, a - 2 * x)
                found[f"{i}{a}"] = acb(value.real) if i and is_real else value
        return found


def _floor(x: arb) -> int:
    """Return the integer part of a number; raise TooFewDigitsError if it is not decided."""
    whole = arb(x).floor().unique_fmpz()
    if whole is None:
        raise TooFewDigitsError
    return int(whole)


def _log_sine(at: Point) -> acb:
    """Return log sin z up to a constant, continuous above and below the real axis."""
    z = acb(*at)
    if at.imag < 0:
        z = z.conjugate()
    value = (1 - (acb(0, 2) * z).exp()).log() + acb(0, 1) * (arb.pi() / 2 - z)
    if at.imag == 0:
        return acb(value.real)
    return value.conjugate() if at.imag < 0 else value
