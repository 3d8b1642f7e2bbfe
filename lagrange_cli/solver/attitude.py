"""The attitude of a top at one time, in balls of Arb, by Jacobi's theta functions.

The attitude is a pair of complex numbers, the Cayley-Klein parameters:

    X = cos(theta/2) exp(i (psi + phi)/2),    Y = sin(theta/2) exp(i (psi - phi)/2)

Let z be the number of nutation periods since a passage of u1.  Apart from a uniform rotation and a
common positive factor, X is theta2 and Y is theta1 of the angle pi (z - i s y), with a sign s and a
place y of its own.  (After release from rest, (psi + phi)/2 and (psi - phi)/2 contain Pi_00 and
Pi_11 of (4,29) and (4,34).)  The phase is counted from the nearer turning point: X or Y then has a
positive real part, and its argument cannot jump.  Equation numbers are Chrapan's.

A course has the constants of one motion in one precision.  Among them are `spin` and `precession`,
the mean rates, `unit`, a unit of time, and `start`, arg X and arg Y at t = 0 without their mean
growth.  Its methods raise TooFewDigitsError if the precision does not suffice.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any, NamedTuple

from flint import acb, arb

from ..arithmetic.enclosures import nearest, root, sign
from .facts import Facts

Names = Mapping[str, Any]
"""The numbers of a motion by name, as `numbers.Numbers` has them."""


class Attitude(NamedTuple):
    """The attitude at one time."""

    x: arb
    """cos(theta/2), up to a positive factor common with y."""
    y: arb
    """sin(theta/2), up to that factor."""
    dphi: arb
    """Spin, unwrapped from 0 at t = 0, less its mean rate times t."""
    dpsi: arb
    """Precession, unwrapped from 0 at t = 0, less its mean rate times t."""
    tilting: arb
    """A number with the sign of the nutation rate; on the separatrix the argument -h."""


class Swing(NamedTuple):
    """The motion of the tilt on the separatrix: u = u2 + (1 - u2) tanh^2(rate (t - lowest))."""

    rate: float
    """Rate of the argument, in radians per unit of time."""
    lowest: float
    """Time at which the axis is lowest."""


class Side(NamedTuple):
    """The constants of X or of Y in a motion that nutates."""

    sign: int
    """s, the direction in which the argument of X or Y turns: by half a turn per period."""
    place: arb
    """F/2K or, if the motion is `hyperbolic`, F/2K', with the integral F of `_sides`.

    It is exactly 0 if the axis passes over the pole where X or Y is 0.
    """
    size: arb
    """|X| at u1, or |Y| at u2, where |X|^2 + |Y|^2 is 1 at u1 and k' at u2."""


class Nutation:
    """The constants of a motion that nutates."""

    def __init__(self, facts: Facts, of: Names) -> None:
        self.spin, self.precession = of["mean_spin_rate"], of["mean_precession_rate"]
        self.period = self.unit = of["T_nutation"]
        self.direction = _start_direction(facts)
        self.since = _since_u1(facts, of)
        """Periods from a passage of u1 to t = 0."""
        self.ratio: arb | None = None if of["m_k"].is_zero() else of["K_prime"] / of["K"]
        """K'/K, or None if k = 0."""
        self.hyperbolic = self.ratio is not None and float(self.ratio.mid()) < 1
        """Whether K > K': the theta functions are then series in the nome of k' (see `series`)."""
        self.acceleration = of["height"] * of["narrow"] / 2
        """-u'' at u1, that is, -f'(u1)/2 (4,9)."""
        self.sides = _sides(facts, of, of["K_prime"] if self.hyperbolic else of["K"])
        """The constants of X and of Y."""

    @cached_property
    def start(self) -> tuple[arb, arb]:
        """arg X and arg Y at t = 0, without their mean growth."""
        return self.waves(self.since)

    def at(self, t: arb) -> Attitude:
        """Return the attitude at a time."""
        z = self.since + t / self.period
        n, rest, values = self._values(z)
        x, y = (
            last - first
            for first, last in zip(self.start, self._waves(n, rest, values), strict=True)
        )
        return Attitude(abs(values[0]), abs(values[1]), x - y, x + y, rest * (-1) ** n)

    def growth(self, first: arb, last: arb) -> tuple[arb, arb]:
        """Return the growth of spin and precession between two phases z."""
        t = (last - first) * self.period
        x, y = (end - start for start, end in zip(self.waves(first), self.waves(last), strict=True))
        return self.spin * t + x - y, self.precession * t + x + y

    def waves(self, z: arb) -> tuple[arb, arb]:
        """Return arg X and arg Y at a phase z, without their mean growth."""
        return self._waves(*self._values(z))

    def _waves(self, n: int, rest: arb, values: list[acb]) -> tuple[arb, arb]:
        """Return arg X and arg Y without their mean growth.

        Of the two limits at a passage over a pole it is the one on the side of t = 0.
        """
        found = []
        for pole, side, value in zip((1, -1), self.sides, values, strict=True):
            if side.place.is_zero():  # it only turns at the passages
                own = (n % 2 == 0) == (pole > 0)
                turns = arb(0 if own else side.sign * (sign(rest) or -pole * self.direction)) / 2
            else:
                turns = arb.atan2(value.imag, value.real) / arb.pi()
            found.append((turns - side.sign * rest) * arb.pi())
        return found[0], found[1]

    def _values(self, z: arb) -> tuple[int, arb, list[acb]]:
        """Return the number of the nearest turning point, the periods since it, X and Y.

        X and Y have the same positive factor, and arguments counted from this turning point.
        """
        n = nearest(2 * z)
        rest, found = z - arb(n) / 2, []
        for odd, side, (y, unit) in zip((0, 1), self.sides, self._units, strict=True):
            theta1, theta2 = self._thetas(acb(rest, -side.sign * y))
            found.append(unit * (theta2 if n % 2 == odd else acb(0, side.sign) * theta1))
        return n, rest, found

    @cached_property
    def _units(self) -> list[tuple[arb, arb]]:
        """The places of X and Y over 2K, and their factors."""
        scale = self.ratio if self.hyperbolic and self.ratio is not None else arb(1)
        places = [side.place * scale for side in self.sides]
        own = [self._thetas(acb(0, y))[1].real for y in places]
        return [(y, x.size / theta) for y, x, theta in zip(places, self.sides, own, strict=True)]

    def _thetas(self, z: acb) -> tuple[acb, acb]:
        """Return theta1 and theta2 of pi z, divided by 2 q^(1/4) if k is 0."""
        if self.ratio is None:
            return z.sin_pi(), z.cos_pi()
        theta1, theta2, *_ = acb.modular_theta(z, acb(0, self.ratio))
        return theta1, theta2


class SingleSwing:
    """The constants of a motion on the separatrix: 1 - u = (1 - u2)/cosh^2 h, h = h0 + rate t.

    A constant tilt is a swing at the rate 0.
    """

    def __init__(self, facts: Facts, of: Names) -> None:
        u0, u2 = of["u0"], of["u2"]
        self.rate = self.h0 = arb(0)
        """h0 is exactly 0 if the axis is lowest at t = 0."""
        self.direction = 0 if facts.steady else _start_direction(facts)
        if facts.steady:
            self.precession = arb(0) if facts.vertical else of["psidot0"]
            self.spin = of["r0"] - self.precession * u0
            self.x, self.y, *_ = start_of(facts, of)
        else:
            self.precession = of["b"] / 2
            self.spin = of["r0"] - self.precession
            self.x = arb(0) if facts.over_bottom else root((1 + u2) / 2)
            """cos(theta_max/2)."""
            self.y = root((1 - u2) / 2) * (-1 if facts.spin < 0 else 1)
            """sin(theta_max/2), with the sign of b."""
            self.rate = root(of["wide"]) / 2
            if not facts.turning:
                self.h0 = -self.direction * root((u0 - u2) / (1 - u0)).asinh()
        self.unit = _time_of_a_radian(self.spin, self.precession, self.rate)
        self.start = self.turn(self.h0), arb(0)

    def at(self, t: arb) -> Attitude:
        """Return the attitude at a time."""
        h = self.h0 + self.rate * t
        turned = self.turn(h) - self.start[0]
        x = abs(acb(self.x, self.y * h.tanh()))
        return Attitude(x, abs(self.y) * h.sech(), turned, turned, -h)

    def turn(self, h: arb) -> arb:
        """Return arg X without its mean growth; on the lower pole, the limit at t = 0."""
        side = arb(-self.direction) if h.is_zero() and self.x.is_zero() else h.tanh()
        return arb.atan2(self.y * side, self.x)


Course = Nutation | SingleSwing
"""The constants from which the attitude of any motion follows."""


def course_of(facts: Facts, of: Names) -> Course:
    """Return the constants of a motion, from its facts and its numbers in the precision in use."""
    return Nutation(facts, of) if facts.nutates else SingleSwing(facts, of)


def _start_direction(facts: Facts) -> int:
    """Return -1 if the nutation rate is negative at the start, else 1."""
    return -1 if facts.inputs["thetadot0"] < 0 else 1


def _time_of_a_radian(*rates: arb) -> arb:
    """Return the inverse of about the largest rate, or 1 if all rates are 0."""
    fastest = max(rates, key=lambda rate: abs(float(rate.mid())))
    return arb(1) if fastest.contains(0) else abs(1 / fastest.mid())


def start_of(facts: Facts, of: Names) -> Attitude:
    """Return the attitude at t = 0 from the inputs of a motion; it has no periodic parts."""
    pole, half = facts.pole, arb.atan2(*of["theta0"]) / 2
    x, y = (arb(pole > 0), arb(pole < 0)) if pole else (half.cos(), half.sin())
    return Attitude(x, y, arb(0), arb(0), of["thetadot0"])


def _sides(facts: Facts, of: Names, unit: arb) -> tuple[Side, Side]:
    """Return the constants of X and Y, with places in units of K or K'.

    A place is an integral F of modulus k'.  For X, sn^2 F = (1 + u2)/(1 + u1).  For Y, sn^2 F =
    (1 - u1)(u3 - u2)/((u3 - u1)(1 - u2)).  After release from rest, F is K' - alpha for X and alpha
    for Y (4,31)-(4,33).
    """
    height, wide, above_u2 = of["height"], of["wide"], of["above_u2"]
    found, a_above_u3 = [], wide - of["a"] * above_u2
    for over_pole, sign_of_momentum, sine2, cosine2, size2 in (
        (facts.over_bottom, facts.plus, of["below_u2"], height, of["below_u1"]),
        (
            *(facts.over_top, facts.minus),
            *(of["above_u1"] * wide, height * a_above_u3, above_u2 * of["k_prime"]),
        ),
    ):
        amplitude = arb.atan2(root(sine2), root(cosine2))
        F = acb.elliptic_f(acb(amplitude), acb(of["m_k_prime"])).real
        if not (sign_of_momentum or over_pole):  # u3 = 1
            F = of["K_prime"]
        place = arb(0) if over_pole else arb(0.5) if F is unit else F / unit / 2
        found.append(Side(sign_of_momentum or 1, place, root(size2 / 2)))
    return found[0], found[1]


def _since_u1(facts: Facts, of: Names) -> arb:
    """Return the periods from the nearest passage of u1 to t = 0, by (4,23) and (4,24)."""
    if facts.turning:
        return arb(1 - facts.turning) / 4
    sine2, cosine2 = of["rise"] * of["wide"], of["fall"] * of["narrow"]
    amplitude = arb.atan2(root(sine2), root(cosine2))
    periods: arb = acb.elliptic_f(acb(amplitude), acb(of["m_k"])).real / (2 * of["K"])
    return _start_direction(facts) * periods
