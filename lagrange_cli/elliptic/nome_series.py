"""Aksenov's nome series (3.1.4) to (3.1.8) as partial sums, and their table.

They hold for 0 < k < 1 and real u.  Use them to study convergence, and `jacobi` to compute.

The terms beyond the n-th are bounded in size by a geometric series, whose sum is the error bound.
This holds because |sin| and |cos| are at most 1 and each weight is at most q or k^2 times the one
before.  Any further factor decreases, or is replaced by its greatest value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import accumulate, count, islice
from operator import mul
from typing import NamedTuple

from flint import arb

from ..arithmetic.ball import balls
from ..arithmetic.text import NumberText
from ..errors import LagtopError
from ..top.ranges import MAX_PERIODS
from .enclosures import cell, exact
from .functions import Functions, Point
from .modulus import Modulus, ModulusInput, nome, quarter_period
from .tables import Rows


class NomeSeries(NamedTuple):
    """The partial sums of a series, their limit, and a bound on the error after n terms."""

    sums: Iterator[arb]
    exact: arb
    bound: Callable[[int], arb]


def nome_series(u: arb, modulus: Modulus) -> dict[str, NomeSeries]:
    """Return the series of am, sn and cn of u in balls.

    With x = pi u/2K, the terms, and the bounds times 1 - q, are

        am u = x + sum (2/n) q^n/(1 + q^2n) sin 2n x  (3.1.7),
                   2 q^(n+1)/(n+1),
        sn u = 2 pi/(k K) sum q^(n-1/2)/(1 - q^(2n-1)) sin (2n-1) x  (3.1.4),
                   2 pi/(k K) q^(n+1/2)/(1 - q^(2n+1)),
        cn u = 2 pi/(k K) sum q^(n-1/2)/(1 + q^(2n-1)) cos (2n-1) x  (3.1.5),
                   2 pi/(k K) q^(n+1/2).

    The sum of q^j over j > n is q^(n+1)/(1 - q).  For j > n, 1/(j (1 + q^2j)) < 1/(n+1), and
    1/(1 - q^(2j-1)) <= 1/(1 - q^(2n+1)).
    """
    K, q = quarter_period(modulus.k_prime), nome(modulus.k, modulus.k_prime)
    am, sn, cn = (z.real for z in Functions(modulus).jacobi(Point(u))[:3] if z is not None)
    x, scale, root = arb.pi() * u / (2 * K), 2 * arb.pi() / (modulus.k * K), q.sqrt()
    first = scale * root / (1 - q)

    def odd(sign: int, wave: Callable[[arb], arb]) -> Iterator[arb]:
        """Return the partial sums of the waves of odd order, with `sign` before q^(2n-1)."""
        orders = count(1, 2)
        return accumulate(scale * root**n / (1 + sign * q**n) * wave(n * x) for n in orders)

    even = (2 * q**n / (n * (1 + q ** (2 * n))) * (2 * n * x).sin() for n in count(1))
    return {
        "am": NomeSeries(
            islice(accumulate(even, initial=x), 1, None),
            am,
            lambda n: 2 * q ** (n + 1) / ((1 - q) * (n + 1)),
        ),
        "sn": NomeSeries(odd(-1, arb.sin), sn, lambda n: first * q**n / (1 - q ** (2 * n + 1))),
        "cn": NomeSeries(odd(1, arb.cos), cn, lambda n: first * q**n),
    }


def k_series(modulus: Modulus) -> NomeSeries:
    """Return the series of K = pi/2 {1 + (1/2)^2 k^2 + (1 3/2 4)^2 k^4 + ...}  (3.1.8).

    The bound is k^2n/((2n + 1/2) k'^2), or K if that is less.  Let c_j = 1 3 ... (2j-1)/(2 4 ...
    2j).  From each j to the next, c_j^2 (j + 1/4) grows by the factor

        (16j^3 + 36j^2 + 24j + 5)/(16j^3 + 36j^2 + 24j + 4)

    and tends to 1/pi (Wallis's product).  So for j >= n the terms pi/2 c_j^2 k^2j are below
    k^2j/(2n + 1/2), and the sum of k^2j is k^2n/k'^2.
    """
    m, complement = modulus.k**2, modulus.k_prime**2
    factors = ((arb(2 * n - 1) / (2 * n)) ** 2 * m for n in count(1))
    sums = accumulate(accumulate(factors, mul, initial=arb.pi() / 2))
    K = quarter_period(modulus.k_prime)
    return NomeSeries(sums, K, lambda n: K.min(m**n / ((2 * n + arb(0.5)) * complement)))


_DIGITS = 400
"""Digits enough for every error that a double can hold."""


class SeriesTable:
    """Partial sums 1 to `count`, each with its error and a proved bound on the error.

    The series are (3.1.8) for K and, at u, (3.1.7), (3.1.4) and (3.1.5) for am, sn and cn.  With
    `in_quarters`, u is in units of K.
    """

    def __init__(
        self,
        modulus_input: ModulusInput,
        u: Fraction | None,
        terms: int,
        *,
        in_quarters: bool = False,
    ) -> None:
        """Raise LagtopError unless 0 < k < 1 and u is within 2^50 periods of 0.

        At k = 0 and k = 1 the series exist as limits only.
        """
        modulus_input.check()
        if modulus_input.is_0 or modulus_input.is_1:
            k = float(modulus_input.is_1)
            raise LagtopError(f"the nome series need 0 < k < 1, got k = {k}")
        self.modulus_input, self.u, self.count, self.in_quarters = (
            modulus_input,
            u,
            terms,
            in_quarters,
        )

    def rows(self, digits: int | None = None) -> Rows:
        """Return the header, and a block with all rows as text."""
        with balls(_DIGITS):
            series = self._series()
            names = [f"{name}{part}" for name in series for part in ("", "_error", "_bound")]
            sums = zip(*(islice(x.sums, self.count) for x in series.values()), strict=True)
            rows = []
            for n, parts in enumerate(sums, 1):
                cells = (
                    x
                    for part, of in zip(parts, series.values(), strict=True)
                    for x in (part, abs(part - of.exact), of.bound(n))
                )
                rows.append([NumberText(n), *(cell(float(x.mid()) + 0.0) for x in cells)])
        return ["terms", *names], iter([rows])

    def _series(self) -> dict[str, NomeSeries]:
        """Return the series by the names of their columns."""
        modulus = self.modulus_input.ball()
        found = {"K": k_series(modulus)}
        if self.u is None:
            return found
        K, u = found["K"].exact, exact(self.u)
        u = u * K if self.in_quarters else u
        if abs(u) > MAX_PERIODS * 2 * K:
            reach, got = float((MAX_PERIODS * 2 * K).mid()), float(u.mid())
            raise LagtopError(f"u must be within 2^50 periods = {reach:.3g} of 0, got {got}", "u")
        others = nome_series(u, modulus)
        am, unit = others.pop("am"), arb(1) if self.modulus_input.radians else 180 / arb.pi()
        scaled = NomeSeries(
            (unit * part for part in am.sums), unit * am.exact, lambda n: unit * am.bound(n)
        )
        return found | {f"am_{'rad' if self.modulus_input.radians else 'deg'}": scaled} | others
