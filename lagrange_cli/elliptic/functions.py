"""The functions of one modulus, as balls of Arb: Jacobi's, theta, Zeta, Omega and Pi.

One class serves every modulus: in [0, 1], imaginary and above 1.  All functions reduce to a modulus
k in [0, 1] (see `modulus`), with the argument z = u/2K in periods and tau = iT, T = K'/K.  Results
have the precision of Arb in use.  If it does not decide a branch, TooFewDigitsError is raised, and
the caller repeats the evaluation with more digits.

Jacobi's, theta and Zeta functions are quotients of Arb's theta functions.  Omega and Pi are
differences of logarithms of theta functions, in the frame zeta = z, T_0 = T or, if T < 1, zeta =
z/tau, T_0 = 1/T (Jacobi's imaginary transformation).  There, with p = exp(-pi T_0),

    log theta = constant - pi n^2 T_0/4 - pi i n zeta + log(1 + s(zeta - i n T_0/2)),
    s(r) = 2 sum over m >= 1 of (+-1)^m p^(m^2) cos 2 pi m r.

The integer n, even or odd by the function, is twice the number of the strip of zeta, so that the
imaginary part of r is within T_0/2.  The polynomials are subtracted in exact fractions.  So a
difference keeps its digits, even if it is as small as p = 10^(-10^13).
"""

from __future__ import annotations

from math import isqrt
from typing import Any, NamedTuple

from flint import acb, arb, ctx, fmpq

from ..arithmetic.ball import TooFewDigitsError
from .modulus import Kind, Modulus

INDICES = ("01", "00", "11", "10")
"""The theta functions theta4, theta3, theta1 and theta2 of the angle pi z."""
THIRD = ("01", "00", "11")
"""The indices of Omega and Pi."""
_NUMBERS = {"11": 0, "10": 1, "00": 2, "01": 3}
"""The positions of the theta functions in Arb's tuple."""
_REDUCED = {
    Kind.UNIT: {},
    Kind.IMAGINARY: {"01": "00", "00": "01"},
    Kind.LARGE: {"10": "00", "00": "10"},
}
"""The function of the reduced modulus that replaces each function, if the index differs."""


Waves = list[tuple[acb, acb]]
"""Terms of the series s(r), each as exp(2 pi i m r) and exp(-2 pi i m r) times a factor."""


class Point(NamedTuple):
    """A complex number with exact parts, `fmpq`, or balls for multiples of K."""

    real: Any
    imag: Any = fmpq(0)

    @property
    def axes(self) -> set[str]:
        """The axes on which the point lies: `real`, `imag`, both or none."""
        names = {"real"} if self.imag == 0 else set()
        return names | {"imag"} if self.real == 0 else names

    @property
    def is_0(self) -> bool:
        """Whether the number is exactly 0."""
        return bool(self.real == 0 and self.imag == 0)

    def ball(self) -> acb:
        """Return the number as a ball."""
        return acb(self.real, self.imag)


class Jacobi(NamedTuple):
    """am u, its sine sn u, its cosine cn u, and dn u, the derivative of am u."""

    am: acb | None
    """None beyond the branch points of am."""
    sn: acb
    cn: acb
    dn: acb


class Functions:
    """The functions of one modulus."""

    def __init__(self, modulus: Modulus) -> None:
        k, k_prime, self.kind, self.stretch = modulus
        self.is_0, self.is_1 = k == 0, k_prime == 0
        half_turn = self.stretch / arb.pi()
        self.scale = arb(0) if self.is_1 else half_turn * arb(1).agm(k_prime)
        """Periods 2K of the reduced modulus in a unit of the argument."""
        self.across = arb(0) if self.is_0 else half_turn * arb(1).agm(k)
        """Periods 2K' in a unit of the argument."""
        self._slopes: dict[str, tuple[Point, int, acb]] = {}
        self._thetas: tuple[Point | None, dict[str, acb]] = None, {}
        self.rate, self.tau = acb(self.scale), None
        """1/2K and iK'/K of the modulus itself."""
        if self.is_0 or self.is_1:
            self.direct, self.T0, self.step = True, arb(0), self.scale
            self._half_turns = arb.pi() * self.step / 2
            return
        ratio = self.scale / self.across
        reduced = acb(0, ratio)
        self.at_0 = acb.modular_theta(acb(0), reduced)
        self.direct = bool(ratio.mid() >= 1)
        self.T0 = ratio if self.direct else 1 / ratio
        self.step = self.scale if self.direct else self.across
        self._half_turns = arb.pi() * self.step / 2
        self._p = (-arb.pi() * self.T0).exp()
        self._p2, self._bits = self._p**2, 4.5 * float(self.T0.mid())
        self._reduced, self.tau = reduced, reduced
        if self.kind is Kind.IMAGINARY:
            self.tau = reduced + 1
        elif self.kind is Kind.LARGE:
            self.tau = reduced / (1 - reduced)
            self.rate = self.rate / (1 - reduced)

    def jacobi(self, u: Point) -> Jacobi:
        """Return am, sn, cn and dn of u.

        am is continuous around the real axis and ends at its branch points, the poles of sn next to
        the axis.  For k > 1 its real part stays within a quarter of a turn.
        """
        sn, cn, dn = self._quotients(u.ball())
        above = abs(u.imag) * self.across * 2
        if above > 1:
            return Jacobi(None, sn, cn, dn)
        if not above < 1:
            raise TooFewDigitsError
        return Jacobi(self._amplitude(u, sn, cn), sn, cn, dn)

    def _quotients(self, u: acb) -> tuple[acb, acb, acb]:
        """Return sn, cn and dn."""
        if self.is_1:
            return u.tanh(), u.sech(), u.sech()
        if self.is_0:
            return *u.sin_cos(), acb(1)
        theta1, theta2, theta3, theta4 = acb.modular_theta(u * self.scale, self._reduced)
        _, at2, at3, at4 = self.at_0
        sn, cn, dn = at3 * theta1 / (at2 * theta4), at4 * theta2, at4 * theta3
        cn, dn = cn / (at2 * theta4), dn / (at3 * theta4)
        if self.kind is Kind.IMAGINARY:
            return sn / (dn * self.stretch), cn / dn, 1 / dn
        return (sn / self.stretch, dn, cn) if self.kind is Kind.LARGE else (sn, cn, dn)

    def _amplitude(self, u: Point, sn: acb, cn: acb) -> acb:
        """Return the angle with a sine and a cosine, next to that of the real part of u."""
        if self.is_0:
            return u.ball()
        periods = u.real * self.scale * (self.kind is not Kind.LARGE)
        if u.imag == 0:
            turns = nearest(periods)
            sign = -1 if turns % 2 else 1
            return acb(turns * arb.pi() + arb.atan2(sign * sn.real, sign * cn.real))
        angle = acb(0, -1) * (cn + acb(0, 1) * sn).log()
        if self.kind is Kind.LARGE:
            return angle
        return angle + 2 * arb.pi() * nearest((periods - angle.real / arb.pi()) / 2)

    def thetas(self, v: Point) -> dict[str, acb]:
        """Return Theta_ij(v)."""
        if self.tau is None:
            return {ij: acb(int(ij[0] == "0")) for ij in INDICES}
        if self._thetas[0] is not v:  # the Zeta functions of the same row need them again
            values = acb.modular_theta(v.ball() * self.rate, self.tau)
            self._thetas = v, {ij: values[_NUMBERS[ij]] for ij in INDICES}
        return self._thetas[1]

    def zetas(self, v: Point) -> dict[str, acb | None]:
        """Return Z_ij(v), the derivative of log Theta_ij(v); Z_11 has a pole at 0."""
        x = v.ball()
        if self.tau is None:
            found = {"01": acb(0), "00": acb(0), "11": x.cot(), "10": -x.tan()}
        else:
            values, slopes = self.thetas(v), acb.modular_theta(x * self.rate, self.tau, 1)
            found = {ij: self.rate * slopes[n] / values[ij] for ij, n in _NUMBERS.items()}
        return {ij: None if ij == "11" and v.is_0 else found[ij] for ij in INDICES}

    def third(self, u: Point, v: Point) -> dict[str, tuple[acb | None, acb | None]]:
        """Return Omega_ij(u, v) = log[Theta_ij(u - v)/Theta_ij(u + v)]/2 and Pi_ij(u, v) by index.

        Pi_ij = u Z_ij(v) + Omega_ij.  log Theta_ij(z) is continuous between the lines on which
        Theta_ij has its zeros: Im z = 2nK' for 11, and (2n + 1)K' for 01 and 00.  On the imaginary
        axis it changes by half a turn at a zero.  Its values at conjugate z are conjugate.  On a
        line of zeros it is the mean of both sides.  For imaginary k, Re K' replaces K'.  For k > 1
        the lines of the modulus 1/k apply.  None stands for a pole.
        """
        less, more = (
            Point(u.real - v.real, u.imag - v.imag),
            Point(u.real + v.real, u.imag + v.imag),
        )
        bend = self._bend() * (u.ball() * v.ball())
        return {ij: self._third(ij, (u, v), (less, more), bend) for ij in THIRD}

    def _third(
        self, ij: str, of: tuple[Point, Point], ends: tuple[Point, Point], bend: acb
    ) -> tuple[acb | None, acb | None]:
        """Return Omega and Pi of (u, v) from u - v and u + v; the transformations add `bend`."""
        inner, (u, v), (less, more) = _REDUCED[self.kind].get(ij, ij), of, ends
        if inner == "11" and (less.is_0 or more.is_0):
            return None, None
        if v.is_0:
            return acb(0), None if inner == "11" else acb(0)
        if u.is_0:
            strip = 0 if v.imag == 0 else self._strip(v, inner)
            value = acb(0, -arb.pi() * int(inner[1]) * strip / 2)
            return value, value
        a = self._logarithm(inner, less)
        is_conjugate = less.real == more.real and less.imag == -more.imag
        b = a.conjugate(direct=self.direct) if is_conjugate else self._logarithm(inner, more)
        n, slope = self._slope(inner, v)
        p, q = (u.real, u.imag) if self.direct else (u.imag, -u.real)
        along, across = a.n * a.p - b.n * b.p, a.n * a.q - b.n * b.q
        turns = arb.pi() * (a.quarters - b.quarters) / 4
        base = (a.rest - b.rest) / 2 + acb(arb.pi() * self.T0 * (b.n**2 - a.n**2) / 8, turns)
        omega = base + acb(across, -along) * self._half_turns + bend
        pi = base + acb(across + 2 * n * q, -along - 2 * n * p) * self._half_turns
        pi += acb(p, q) * slope
        if u.axes & v.axes:
            pi = acb(pi.real, turns)
        elif u.axes and v.axes:
            pi = acb(0, pi.imag)
            omega = omega if self.kind is Kind.LARGE else acb(0, omega.imag)
        return omega, pi

    def _bend(self) -> acb:
        """Return the factor of uv that the transformations of the modulus add to Omega."""
        bend = acb(0)
        if not self.direct:
            bend += 2 * arb.pi() * self.scale * self.across
        if self.kind is Kind.LARGE:
            bend += acb(0, 2 * arb.pi()) * self.scale**2 / (1 - self._reduced)
        return bend

    def _slope(self, inner: str, v: Point) -> tuple[int, acb]:
        """Return n and c times the derivative of log(1 + s) at v."""
        at, n, slope = self._slopes.get(inner, (None, 0, acb(0)))
        if at != v:
            cell = self._cell(inner, v)
            n, slope = cell.n, cell.slope() * self.step
            self._slopes[inner] = v, n, slope
        return n, slope

    def _strip(self, at: Point, inner: str) -> int:
        """Return twice the number of the strip between lines of zeros; it must be determined."""
        if self.is_0:
            return int(inner[0]) * (-1 if at.imag < 0 else 1)
        height = at.imag * self.across
        whole = (height if inner[0] == "1" else height + 0.5).floor().unique_fmpz()
        if whole is None:
            raise TooFewDigitsError
        return 2 * int(whole) + int(inner[0])

    def _cell(self, inner: str, at: Point) -> _Cell:
        """Return the place of a point in the frame of the series, and the series there."""
        real_axis = at.imag == 0
        strip = 0 if real_axis else self._strip(at, inner)
        p, q = (at.real, at.imag) if self.direct else (at.imag, -at.real)
        zeta = acb(p, q) * self.step
        if self.is_0:
            n = int(inner[0]) * (-1 if q < 0 else 1)
            wave = -(zeta * (2 * n)).exp_pi_i() * int(inner[0])
            return _Cell(strip, n, p, q, [(wave, acb(0)) if n > 0 else (acb(0), wave)])
        index = inner if self.direct else inner[::-1]
        odd, sign = int(index[0]), -1 if index[1] == "1" else 1
        n = strip or odd
        if not self.direct:
            n = 2 * nearest(q * self.scale - odd / 2) + odd
        rest = zeta - acb(0, self.T0) * n / 2
        return _Cell(strip, n, p, q, self._waves(rest, sign))

    def _logarithm(self, inner: str, at: Point) -> _Logarithm:
        """Return log theta at a point; its imaginary part is known on the axes."""
        cell, alternating = self._cell(inner, at), int(inner[1])
        rest = cell.small().log1p()
        if at.axes:
            quarters = 0 if at.imag == 0 else cell.strip * alternating
            return _Logarithm(cell.n, fmpq(0), cell.q, acb(rest.real), quarters)
        quarters = cell.n * alternating if self.direct else cell.strip * (cell.n + alternating)
        return _Logarithm(cell.n, cell.p, cell.q, rest, quarters)

    def _waves(self, r: acb, sign: int) -> Waves:
        """Return the two parts of each term of s(r), for |Im r| <= T_0/2.

        The last pair is an error: twice the first term that is left out.  From each such term to
        the next, the size falls by a factor below exp(-2 pi).
        """
        p, wave = self._p, sign * (2 * r).exp_pi_i()
        up, down = p * wave, p / wave
        more_up, more_down = up * self._p2, down * self._p2
        waves = []
        for _ in range(1 + isqrt(int(ctx.prec / self._bits))):
            waves.append((up, down))
            up, down = up * more_up, down * more_down
            more_up, more_down = more_up * self._p2, more_down * self._p2
        part = arb(0, 2 * (up.abs_upper() + down.abs_upper()))
        return [*waves, (acb(part, part), acb(0))]


class _Cell(NamedTuple):
    """A place in the frame of the series."""

    strip: int
    n: int
    p: Any
    q: Any
    waves: Waves

    def small(self) -> acb:
        """Return s(r)."""
        return sum((up + down for up, down in self.waves), acb(0))

    def slope(self) -> acb:
        """Return the derivative of log(1 + s(r)) by zeta."""
        slope = sum((m * (up - down) for m, (up, down) in enumerate(self.waves, 1)), acb(0))
        return acb(0, 2) * arb.pi() * slope / (1 + self.small())


class _Logarithm(NamedTuple):
    """log theta = constant - pi n^2 T_0/4 - pi i n c (p + iq) + rest + pi i quarters/2."""

    n: int
    p: Any
    q: Any
    rest: acb
    quarters: int

    def conjugate(self, *, direct: bool) -> _Logarithm:
        """Return the logarithm at the conjugate point of the plane of u."""
        n, p, q = (-self.n, self.p, -self.q) if direct else (self.n, -self.p, self.q)
        return _Logarithm(n, p, q, self.rest.conjugate(), -self.quarters)


def nearest(x: arb) -> int:
    """Return an integer within 3/4 of all numbers in x; raise TooFewDigitsError for a wide ball."""
    whole = (x.mid() + 0.5).mid().floor().unique_fmpz() if x.rad() <= 0.25 else None
    if whole is None:
        raise TooFewDigitsError
    return int(whole)
