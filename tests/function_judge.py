"""A judge of the theta, Zeta, Omega and Pi functions in Arb's ball arithmetic.

It shares no formula with the program: theta functions and their derivatives by Arb itself, K from
Arb's arithmetic-geometric mean, and Omega and Pi from their definitions.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any, NamedTuple

from flint import acb, arb, ctx, fmpq

EPS = 2.0**-52
INDEX = {"11": 0, "10": 1, "00": 2, "01": 3}
"""The place of theta_ij among Arb's theta1 to theta4."""


class Exact(NamedTuple):
    """A value, and how much it changes with u (less whole periods) and v by their own sizes."""

    value: Any
    by_u: Any
    by_v: Any


def ball(x: Fraction | float) -> Any:
    """Return a number as a ball."""
    exact = Fraction(x)
    return arb(fmpq(exact.numerator, exact.denominator))


class Judge:
    """The functions of one modulus, given by k or by k'."""

    def __init__(self, name: str, value: Fraction, bits: int = 700) -> None:
        ctx.prec = self.bits = bits
        x = ball(value)
        other = (1 - x * x).sqrt()
        k, k_prime = (x, other) if name == "k" else (other, x)
        self.K, self.K_prime = arb.pi() / 2 / _agm(k_prime), arb.pi() / 2 / _agm(k)
        self.tau = acb(0, self.K_prime / self.K)

    def place(self, u: Any) -> tuple[Any, Any]:
        """Return whole periods in u and the rest, in periods."""
        x = u / (2 * self.K)
        turns = (x + ball(Fraction(1, 2))).floor()
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
        exact_u = ball(u)
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
        w = acb(0, ball(v)) if imaginary else acb(self.place(ball(v))[1] * 2 * self.K)
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
    error = abs(ball(computed) - exact.value)
    assert float(error.rad()) < 1e-3 * EPS * unit, "the judge needs more bits"
    return float(error.mid()) / (EPS * unit)
