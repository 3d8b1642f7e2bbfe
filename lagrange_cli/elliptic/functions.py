"""The functions of one modulus, as balls of Arb: Jacobi's, theta, Zeta, Omega and Pi.

All functions reduce to a modulus k in [0, 1] (see `modulus`), with the argument z = u/2K in periods
and tau = i K'/K.  Jacobi's, theta and Zeta functions are quotients of Arb's theta functions.
Omega and Pi are those of Chrapan, whose equation numbers are cited: differences of logarithms of
theta functions.

Results have the precision of Arb in use.  Raises TooFewDigitsError if a branch needs more digits.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from flint import acb, arb, fmpq

from ..arithmetic.enclosures import TooFewDigitsError, nearest, sign
from .arguments import ExactComplex
from .modulus import Kind, Modulus

THIRD = ("01", "00", "11")
"""The indices of Omega and Pi."""
_NUMBERS = {"01": 3, "00": 2, "11": 0, "10": 1}
"""The theta functions theta4, theta3, theta1 and theta2 of pi z: their places in Arb's tuple."""
_REDUCED = {Kind.IMAGINARY: {"01": "00", "00": "01"}, Kind.LARGE: {"00": "10"}}
"""The function of the reduced modulus that replaces each function, if the index differs.

For an imaginary modulus by (2,2) and (2,3).
"""
_LETTERS = {Kind.IMAGINARY: "scnd", Kind.LARGE: "sdcn"}
"""The letters of Neville's functions of the reduced modulus that replace s, c, d and n."""


class Point(NamedTuple):
    """A complex number plus multiples of K/stretch and K'/stretch of the reduced modulus.

    Parts are `fmpq`.  The first may be a ball.
    """

    real: Any
    imag: Any = fmpq(0)
    K: Any = fmpq(0)
    iK: Any = fmpq(0)
    K_prime: Any = fmpq(0)
    iK_prime: Any = fmpq(0)

    @property
    def is_0(self) -> bool:
        """Whether the number is exactly 0."""
        return not any(self)

    @property
    def is_real(self) -> bool:
        """Whether the number is real for a modulus with a real square."""
        return not any(self[1::2])

    def plus(self, other: Point, factor: int) -> Point:
        """Return this number plus a multiple of another one."""
        return Point(*(x + factor * y for x, y in zip(self, other, strict=True)))


class Functions:
    """The functions of one modulus."""

    def __init__(self, modulus: Modulus) -> None:
        k, k_prime, self.kind, self.stretch, rates = modulus
        self.is_0, self.is_1 = k.is_zero(), k_prime.is_zero()
        half_turn = self.stretch / arb.pi()
        self.scale: Any = half_turn * (arb(0) if self.is_1 else k_prime.agm(1))
        """stretch/2K of the reduced modulus: periods in a unit of the argument."""
        self.across: Any = half_turn * (arb(0) if self.is_0 else k.agm(1))
        """stretch/2K' of the reduced modulus."""
        if rates:
            self.scale, self.across = rates
        self.rate, self.tau, self.exponent = acb(self.scale), None, acb(0)
        """1/2K and iK'/K of the modulus itself, and the exponent of its theta functions.

        They are those of the reduced modulus times exp(exponent u^2).
        """
        self.ratio = self.scale / self.across
        """K'/K of the reduced modulus."""
        if self.is_0 or self.is_1:
            return
        self.tau = self.reduced_tau = reduced = acb(0, 1) * self.ratio
        self.at_0 = acb.modular_theta(acb(0), reduced)
        if self.kind is Kind.IMAGINARY:
            self.tau = reduced + 1
        elif self.kind is Kind.LARGE:
            self.tau, self.rate = reduced / (1 - reduced), self.rate / (1 - reduced)
            self.exponent = acb(0, -1) * arb.pi() * self.scale**2 / (1 - reduced)

    def point(self, x: ExactComplex) -> Point:
        """Return an exact number, with multiples of the modulus' own K and K', as a point.

        K' is K' - iK of the reduced modulus if k is imaginary, and K is K - iK' if k > 1.
        """
        real, imag, K, iK, K_prime, iK_prime = (fmpq(y.numerator, y.denominator) for y in x)
        if self.kind is Kind.IMAGINARY:
            K, iK = K + iK_prime, iK - K_prime
        elif self.kind is Kind.LARGE:
            K_prime, iK_prime = K_prime + iK, iK_prime - K
        return Point(real, imag, K, iK, K_prime, iK_prime)

    def value(self, at: Point) -> acb:
        """Return a point as a complex number."""
        u = acb(*at[:2])
        for (real, imag), rate in ((at[2:4], self.scale), (at[4:], self.across)):
            if real or imag:  # otherwise the quarter period may be infinite
                u += acb(real, imag) / (2 * rate)
        return u

    def _periods(self, at: Point) -> Any:
        """Return the real part in units of 2K, exactly if it is a multiple of K."""
        return at.real * self.scale + at.K / 2 + (at.K_prime and at.K_prime * self.ratio / 2)

    def _height(self, at: Point) -> Any:
        """Return the imaginary part in units of 2K', exactly if it is a multiple of K'."""
        return at.imag * self.across + at.iK_prime / 2 + (at.iK and at.iK / (2 * self.ratio))

    def neville(self, u: Point) -> dict[str, acb]:
        """Return Neville's functions theta_s to theta_n, without exp(exponent u^2), by letter.

        Every quotient pq of Glaisher is theta_p/theta_q.
        """
        x = self.value(u)
        if self.is_1:
            return {"s": x.sinh(), "c": acb(1), "d": acb(1), "n": x.cosh()}
        if self.is_0:
            return {"s": x.sin(), "c": x.cos(), "d": acb(1), "n": acb(1)}
        theta1, theta2, theta3, theta4 = acb.modular_theta(x * self.scale, self.reduced_tau)
        _, at2, at3, at4 = self.at_0
        sine = at3 * theta1 / (at2 * at4 * self.stretch)
        found = {"s": sine, "c": theta2 / at2, "d": theta3 / at3, "n": theta4 / at4}
        letters = _LETTERS.get(self.kind, "scdn")
        return {p: found[q] for p, q in zip("scdn", letters, strict=True)}

    def jacobi(self, u: Point) -> tuple[acb | None, acb, acb, acb]:
        """Return am, sn, cn and dn of u."""
        s, c, d, n = self.neville(u).values()
        sn, cn = s / n, c / n
        return self.amplitude(u, sn, cn), sn, cn, d / n

    def amplitude(self, u: Point, sn: acb, cn: acb) -> acb | None:
        """Return am(u), the angle with that sine and cosine, continuous around the real axis.

        It is None from its branch points on, the poles of sn next to the axis.  For k > 1 its real
        part stays within a quarter of a turn.
        """
        if self.is_0:
            return self.value(u)
        if not u.is_real and sign(abs(arb(2 * self._height(u))) - 1) >= 0:
            return None
        periods = 0 if self.kind is Kind.LARGE else arb(self._periods(u))
        if u.is_real:
            turns = nearest(arb(periods))
            half = -1 if turns % 2 else 1
            return acb(turns * arb.pi() + arb.atan2(half * sn.real, half * cn.real))
        angle = acb(0, -1) * (cn + acb(0, 1) * sn).log()
        if self.kind is Kind.LARGE:
            return angle
        return angle + 2 * arb.pi() * nearest((periods - angle.real / arb.pi()) / 2)

    def thetas(self, turns: acb) -> dict[str, acb]:
        """Return Theta_ij(2K turns): theta4, theta3, theta1 and theta2 of pi times the argument."""
        if self.tau is None:
            return {ij: acb(int(ij[0] == "0")) for ij in _NUMBERS}
        values = acb.modular_theta(turns, self.tau)
        return {ij: values[n] for ij, n in _NUMBERS.items()}

    def zetas(self, v: Point) -> dict[str, acb | None]:
        """Return Z_ij(v) of section 1, the derivative of log Theta_ij(v); Z_11 has a pole at 0."""
        x = self.value(v)
        values = self.thetas(x * self.rate)
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

        Pi_ij = u Z_ij(v) + Omega_ij (3,1), (3,2); `zetas` are the Z_ij(v).  The logarithms are
        those of `_logarithms`.  None stands for a pole.
        """
        less, more = u.plus(v, -1), u.plus(v, 1)
        ends, argument = (self._logarithms(less), self._logarithms(more)), self.value(u)
        added = -2 * self.exponent * argument * self.value(v)
        found: dict[str, tuple[acb | None, acb | None]] = {}
        for ij in THIRD:
            inner, zeta = _REDUCED.get(self.kind, {}).get(ij, ij), zetas[ij]
            if inner == "11" and (less.is_0 or more.is_0):
                found[ij] = None, None
            elif v.is_0:
                found[ij] = acb(0), None if zeta is None else acb(0)
            else:
                first, second = (end[inner] for end in ends)
                omega = (first - second) / 2 + added
                found[ij] = omega, None if zeta is None else omega + argument * zeta
        return found

    def _logarithms(self, at: Point) -> dict[str, acb]:
        """Return log theta_ij of the reduced modulus at a point, up to a constant.

        It is continuous between the lines on which theta_ij has its zeros, conjugate at conjugate
        points, and the mean of both sides on such a line.
        With z - n tau in the strip of height Im tau around the real axis, n even or odd halves,

            log theta(z) = i pi (n^2 tau - 2 n z + n a) + log theta_0a(z - n tau),

        where a is the second index.  The last logarithm is the principal one: theta_0a is positive
        on the real axis, and on the edges of the strip its argument is within a quarter turn.  So
        it is in the whole strip, because the argument is a harmonic function.
        """
        if self.is_0:
            log_sine = _log_sine(self.value(at), at.is_real)
            return {"01": acb(0), "00": acb(0), "11": log_sine}
        x, height, found = self._periods(at), self._height(at), {}
        within = x - nearest(arb(x))
        for i, half in enumerate((fmpq(0), fmpq(1, 2))):
            above = _floor(height + fmpq(1, 2) - half)
            below = -_floor(half - fmpq(1, 2) - height) - 1
            numbers = [half + n for n in ({above} if at.is_real else {above, below})]
            sides = [self._in_strip(x, within, height, n) for n in numbers]
            for a in (0, 1):
                mean = sum((side[a] for side in sides), acb(0)) / len(sides)
                found[f"{i}{a}"] = acb(mean.real) if at.is_real else mean
        return found

    def _in_strip(self, x: Any, within: Any, height: Any, n: fmpq) -> list[acb]:
        """Return log theta_ij of `_logarithms` with the number n, for the second index 0 and 1.

        The point has the real part x, in units of 2K, and the imaginary part `height`, in units of
        2K'; `within` is x less the nearest integer.
        """
        thetas = acb.modular_theta(acb(within, (height - n) * self.ratio), self.reduced_tau)[2:]
        return [
            theta.log() + arb.pi() * n * acb((2 * height - n) * self.ratio, a - 2 * x)
            for a, theta in enumerate(thetas)
        ]


def _floor(x: Any) -> int:
    """Return the integer part of a number; raise TooFewDigitsError if it is not decided."""
    whole = arb(x).floor().unique_fmpz()
    if whole is None:
        raise TooFewDigitsError
    return int(whole)


def _log_sine(z: acb, is_real: bool) -> acb:
    """Return log sin z up to a constant, continuous above and below the real axis."""
    is_below = not is_real and sign(z.imag) < 0
    if is_below:
        z = z.conjugate()
    value = (1 - (acb(0, 2) * z).exp()).log() + acb(0, 1) * (arb.pi() / 2 - z)
    if is_real:
        return acb(value.real)
    return value.conjugate() if is_below else value
