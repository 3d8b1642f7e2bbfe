"""A judge of the theta, Zeta, Omega and Pi functions in Arb's ball arithmetic.

It shares no formula with the program: theta functions and their derivatives by Arb itself, K from
Arb's arithmetic-geometric mean, and Omega and Pi from their definitions.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import Any, NamedTuple

from arb_balls import exact_arb
from flint import acb, arb, ctx

EPS = 2.0**-52
INDEX = {"11": 0, "10": 1, "00": 2, "01": 3}
"""The place of theta_ij among Arb's theta1 to theta4."""


class Exact(NamedTuple):
    """A value, and how much it changes with u (less whole periods) and v by their own sizes."""

    value: Any
    by_u: Any
    by_v: Any


class Judge:
    """The functions of one modulus, given by k or by k'."""

    def __init__(self, name: str, value: Fraction, bits: int = 700) -> None:
        ctx.prec = self.bits = bits
        x = exact_arb(value)
        other = (1 - x * x).sqrt()
        k, k_prime = (x, other) if name == "k" else (other, x)
        self.K, self.K_prime = arb.pi() / 2 / _agm(k_prime), arb.pi() / 2 / _agm(k)
        self.tau = acb(0, self.K_prime / self.K)

    def place(self, u: Any) -> tuple[Any, Any]:
        """Return whole periods in u and the rest, in periods."""
        x = u / (2 * self.K)
        turns = (x + exact_arb(Fraction(1, 2))).floor()
        return turns, x - turns

    def theta(self, ij: str, x: Any, order: int = 0) -> Any:
        """Return theta_ij, or a derivative of it, at x periods."""
        return acb(x).modular_theta(self.tau, order)[INDEX[ij]]

    def zeta(self, ij: str, x: Any) -> tuple[Any, Any]:
        """Return Z_ij at x periods, and its derivative by v."""
        value, slope, bend = (self.theta(ij, x, order) for order in range(3))
        ratio, scale = slope / value, 1 / (2 * self.K)
        return ratio * scale, (bend / value - ratio * ratio) * scale * scale

    def columns(self, u: float, v: float | None, imaginary: bool) -> Iterator[tuple[str, Exact]]:
        """Yield every column of `lagtop jacobi` but am, sn, cn, dn, with its exact value."""
        ctx.prec = self.bits
        exact_u = exact_arb(u)
        turns, x = self.place(exact_u)
        reach = 2 * self.K * x
        sign = 1 - 2 * (int(turns.unique_fmpz()) % 2)
        for ij in INDEX:
            value, slope = self.theta(ij, x), self.theta(ij, x, 1)
            by_u = x * slope.real
            yield f"theta{ij}", Exact(value.real * (sign if ij[0] == "1" else 1), by_u, arb(0))
            if ij != "11" or u:
                value, slope = self.zeta(ij, x)
                yield f"zeta{ij}", Exact(value.real, reach * slope.real, arb(0))
        if v is None:
            return
        w = acb(0, exact_arb(v)) if imaginary else acb(self.place(exact_arb(v))[1] * 2 * self.K)
        y = w / (2 * self.K)
        for ij in ("01", "00", "11"):
            if ij == "11" and (v == 0 or (not imaginary and abs(u) == abs(v))):
                continue  # poles
            omega = self._omega(ij, turns if v > 0 else -turns, x, y, imaginary)
            less, more = self.zeta(ij, acb(x) - y)[0], self.zeta(ij, acb(x) + y)[0]
            at_v, bend = self.zeta(ij, y)
            rates = (less - more) / 2, -(less + more) / 2
            growth = exact_u * at_v
            growth = growth.imag if imaginary else growth.real
            suffix = "_imag" if imaginary else ""
            by_v = abs(w * rates[1])
            yield f"omega{ij}{suffix}", Exact(omega, reach * abs(rates[0]), by_v)
            by_v = abs(w * (rates[1] + exact_u * bend))
            yield f"pi{ij}{suffix}", Exact(growth + omega, reach * abs(at_v + rates[0]), by_v)

    def _omega(self, ij: str, turns: Any, x: Any, y: Any, imaginary: bool) -> Any:
        """Return Omega, or the phase that it is i times of."""
        less = self.theta(ij, acb(x) - y)
        if not imaginary:
            return (abs(less) / abs(self.theta(ij, acb(x) + y))).log() / 2
        return less.arg() + (arb.pi() * turns if ij[0] == "1" else 0)


def _agm(x: Any) -> Any:
    return acb(1).agm(acb(x)).real


def units(computed: float, exact: Exact, *, with_v: bool) -> float:
    """Return an error in eps (max(1, |f|) + |u f'|), u less whole periods, and |v df/dv| too."""
    unit = max(1.0, abs(float(exact.value.mid()))) + abs(float(exact.by_u.mid()))
    if with_v:
        unit += abs(float(exact.by_v.mid()))
    error = abs(exact_arb(computed) - exact.value)
    assert float(error.rad()) < 1e-3 * EPS * unit, "the judge needs more bits"
    return float(error.mid()) / (EPS * unit)


class ComplexJudge:
    """The functions of complex numbers and of any modulus: real, imaginary or above 1.

    Theta functions are Arb's at the tau = iK'/K of the modulus itself, which is not brought into
    [0, 1], and sn, cn, dn are their quotients.
    """

    def __init__(self, k: complex, bits: int = 700) -> None:
        ctx.prec = self.bits = bits
        m = exact_arb(k.real) ** 2 - exact_arb(k.imag) ** 2
        complement = acb(1 - m).sqrt()
        self.K = acb(arb.pi()) / 2 / acb(1).agm(complement)
        self.K_prime = acb(arb.pi()) / 2 / acb(1).agm(acb(m).sqrt())
        if self.K_prime.imag > 0:  # on its cut, where both sides are as good
            self.K_prime = self.K_prime.conjugate()
        self.tau = acb(0, 1) * self.K_prime / self.K
        self.large = k.real > 1
        self.real_period = 2 * self.K if not self.large else acb(2 * self._inner(m)[0])
        self.imag_period = 2 * self._inner(m)[1]

    def _inner(self, m: Any) -> tuple[Any, Any]:
        """Return the half periods of all functions along the axes, by the squares of theta."""
        real = arb.pi() / 2 / _agm((1 - m).sqrt()) if m < 1 else self.K.real
        if m < 0:
            return real, self.K_prime.real
        return real, self.K_prime.real

    def theta(self, ij: str, z: Any, order: int = 0) -> Any:
        """Return Theta_ij or a derivative of it."""
        value = (z / (2 * self.K)).modular_theta(self.tau, order)[INDEX[ij]]
        return value / (2 * self.K) ** order

    def zeta(self, ij: str, z: Any) -> tuple[Any, Any]:
        """Return Z_ij, and its derivative."""
        value, slope, bend = (self.theta(ij, z, order) for order in range(3))
        ratio = slope / value
        return ratio, bend / value - ratio * ratio

    def rest(self, u: Any) -> Any:
        """Return a number less whole periods along both axes."""
        half, period = exact_arb(Fraction(1, 2)), self.real_period.real
        real = u.real - period * (u.real / period + half).floor()
        imag = u.imag - self.imag_period * (u.imag / self.imag_period + half).floor()
        return acb(real, imag)

    def jacobi(self, z: Any) -> tuple[Any, Any, Any]:
        """Return sn, cn, dn."""
        one, two, three, four = (z / (2 * self.K)).modular_theta(self.tau)
        zero: Any = acb(0)
        _, at_2, at_3, at_4 = zero.modular_theta(self.tau)
        return (
            at_3 * one / (at_2 * four),
            at_4 * two / (at_2 * four),
            at_4 * three / (at_3 * four),
        )

    def columns(self, u: complex, v: complex | None) -> Iterator[tuple[str, Exact]]:
        """Yield every function by its column; of logarithms there are several, i pi apart."""
        ctx.prec = self.bits
        z = acb(exact_arb(u.real), exact_arb(u.imag))
        size = abs(self.rest(z))
        sn, cn, dn = self.jacobi(z)
        m = (self.theta("10", acb(0)) / self.theta("00", acb(0))) ** 4
        yield "am", Exact(-acb(0, 1) * (cn + acb(0, 1) * sn).log(), size * abs(dn), arb(0))
        for name, value, slope in (
            ("sn", sn, cn * dn),
            ("cn", cn, sn * dn),
            ("dn", dn, m * sn * cn),
        ):
            yield name, Exact(value, size * abs(slope), arb(0))
        reach = abs(z) if self.large else abs(acb(self.rest(z).real, z.imag))
        for ij in INDEX:
            if u or ij != "11":
                value, slope = self.zeta(ij, z)
                far = reach if self.large else size
                yield f"zeta{ij}", Exact(value, far * abs(slope), arb(0))
            yield f"theta{ij}", Exact(self.theta(ij, z), reach * abs(self.theta(ij, z, 1)), arb(0))
        if v is None:
            return
        size = reach if self.large else size
        w = acb(exact_arb(v.real), exact_arb(v.imag))
        width = abs(w if self.large else self.rest(w))
        for ij in ("01", "00", "11"):
            on_line = abs(u.imag) == abs(v.imag) or not v
            if on_line and (ij == "11" or (self.large and ij == "00")):
                continue  # on a line of zeros, where the mean of two values is no logarithm
            quotient = self.theta(ij, z - w) / self.theta(ij, z + w)
            behind = quotient.real < 0  # away from the cut of the logarithm
            turned = (-quotient).log() + acb(0, arb.pi()) if behind else quotient.log()
            omega = turned / 2
            less, more = self.zeta(ij, z - w)[0], self.zeta(ij, z + w)[0]
            at_v, bend = self.zeta(ij, w)
            by_u, by_v = (less - more) / 2, -(less + more) / 2
            yield f"omega{ij}", Exact(omega, size * abs(by_u), width * abs(by_v))
            by_u, by_v = at_v + by_u, by_v + z * bend
            yield f"pi{ij}", Exact(z * at_v + omega, size * abs(by_u), width * abs(by_v))


STEPS = {"am": 2 * math.pi, "omega": 1j * math.pi, "pi": 1j * math.pi}
"""The number up to whose multiples a function is known, by its name without indices."""


def complex_units(name: str, computed: complex, exact: Exact) -> float:
    """Return the error of a complex number in eps (max(1, |f|) + |u f'| + |v df/dv|)."""
    error = acb(exact_arb(computed.real), exact_arb(computed.imag)) - exact.value
    step = STEPS.get(name.rstrip("01"))
    if step:
        exact_step = arb.pi() * (2 if name == "am" else 1)
        part = error.real if name == "am" else error.imag
        many = exact_step * (part / exact_step + exact_arb(Fraction(1, 2))).floor()
        error = error - (acb(many) if name == "am" else acb(0, many))
    size = abs(complex(computed))
    unit = max(1.0, size) + float(exact.by_u.mid()) + float(exact.by_v.mid())
    assert float(abs(error).rad()) < 1e-3 * EPS * unit, "the judge needs more bits"
    return float(abs(error).mid()) / (EPS * unit)
