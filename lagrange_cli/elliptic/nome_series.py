"""Aksenov's nome series (3.1.4) to (3.1.8) as endless partial sums, and their table.

They hold for 0 < k < 1 and real u, or complex u with |Im u| < K'; `ar` is an mpmath context.  Use
them to study convergence, and `jacobi` and `complete_k` to compute.

The error bounds hold for real u.  The terms beyond the n-th are bounded in size by a geometric
series, whose sum is the bound.  This holds because |sin| and |cos| are at most 1 and each weight is
at most q or k^2 times the one before.  Any further factor decreases, or is replaced by its greatest
value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from itertools import accumulate, count, islice
from operator import mul
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.points import MAX_PERIODS
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..arithmetic.text import double_text
from ..errors import LagtopError
from .complete import complete_k, nome
from .jacobi import jacobi
from .many_digits import ManyDigits
from .modulus import Modulus, ModulusInput
from .tables import TableOfFunctions

if TYPE_CHECKING:
    from .tables import Rows

ErrorBound = Callable[[Numeric], Numeric]
"""A bound on the error after n terms, as a function of n."""


class NomeSeries(NamedTuple):
    """The partial sums of a series, their limit, and a bound on the error after n terms."""

    sums: Iterator[Numeric]
    exact: Numeric
    bound: ErrorBound


def nome_series(
    ar: FunctionArithmetic, u: Numeric, modulus: Modulus, unit: Numeric = 1
) -> dict[str, NomeSeries]:
    """Return the series of am (in a `unit`, a multiple of radians), sn and cn of u.

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
    K, (am, sn, cn, _) = complete_k(ar, modulus.k_prime), jacobi(ar, u, modulus)
    q = nome(ar, m=modulus.k * modulus.k, k_prime=modulus.k_prime)
    x, scale, root = ar.pi * u / (2 * K), 2 * ar.pi / (modulus.k * K), ar.sqrt(q)
    power, first = _falling(ar, ar.log(q)), scale * root / (1 - q)

    def odd(sign: int, wave: Callable[[Numeric], Numeric]) -> Iterator[Numeric]:
        """Return the partial sums of the waves of odd order, with `sign` before q^(2n-1)."""
        orders = count(1, 2)
        return accumulate(scale * root**n / (1 + sign * q**n) * wave(n * x) for n in orders)

    even = (2 * q**n / (n * (1 + q ** (2 * n))) * ar.sin(2 * n * x) for n in count(1))
    from_first_term = (unit * part for part in islice(accumulate(even, initial=x), 1, None))
    return {
        "am": NomeSeries(
            from_first_term, unit * am, lambda n: unit * 2 * q / (1 - q) * power(n) / (n + 1)
        ),
        "sn": NomeSeries(odd(-1, ar.sin), sn, lambda n: first * power(n) / (1 - power(2 * n + 1))),
        "cn": NomeSeries(odd(1, ar.cos), cn, lambda n: first * power(n)),
    }


def k_series(ar: FunctionArithmetic, modulus: Modulus) -> NomeSeries:
    """Return the series of K = pi/2 {1 + (1/2)^2 k^2 + (1 3/2 4)^2 k^4 + ...}  (3.1.8).

    The bound is k^2n/((2n + 1/2) k'^2), or K if that is less.  Let c_j = 1 3 ... (2j-1)/(2 4 ...
    2j).  From each j to the next, c_j^2 (j + 1/4) grows by the factor

        (16j^3 + 36j^2 + 24j + 5)/(16j^3 + 36j^2 + 24j + 4)

    and tends to 1/pi (Wallis's product).  So for j >= n the terms pi/2 c_j^2 k^2j are below
    k^2j/(2n + 1/2), and the sum of k^2j is k^2n/k'^2.
    """
    m, complement = modulus.k * modulus.k, modulus.k_prime * modulus.k_prime
    factors = (((2 * n - 1) / ar.convert(2 * n)) ** 2 * m for n in count(1))
    sums = accumulate(accumulate(factors, mul, initial=ar.pi / 2))
    half, power = ar.convert(0.5), _falling(ar, ar.log1p(-complement))
    K = complete_k(ar, modulus.k_prime)
    return NomeSeries(sums, K, lambda n: min(power(n) / ((2 * n + half) * complement), K))


def _falling(ar: FunctionArithmetic, fall: Numeric) -> ErrorBound:
    """Return exp(n fall) as a function of n, but at least exp(-10^6), which is quicker."""
    return lambda n: ar.exp(max(n * fall, -(10**6)))


TOLERANCE = "1e-16"
"""Tolerance of `SeriesTable.needed`, in the unit of the column."""

_DIGITS = 400
"""Digits enough for every error that a double can hold."""


class SeriesTable(TableOfFunctions):
    """Partial sums 1 to `terms`, each with its error and a proved bound on the error.

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
        ar = ManyDigits(_DIGITS)
        modulus = modulus_input.in_digits(ar)
        if not (modulus.k and modulus.k_prime):
            raise LagtopError(f"the nome series need 0 < k < 1, got k = {float(modulus.k)}")
        self.series = {"K": k_series(ar, modulus)}
        if u is not None:
            K, (name, unit) = self.series["K"].exact, ("am_deg", 180 / ar.pi)
            if modulus_input.radians:
                name, unit = "am_rad", 1
            argument, limit = ar.convert(u) * (K if in_quarters else 1), MAX_PERIODS * 2 * K
            if abs(argument) > limit:
                reach, got = ar.nstr(limit, 3), float(argument)
                raise LagtopError(f"u must be within 2^50 periods = {reach} of 0, got {got}", "u")
            found = nome_series(ar, argument, modulus, unit)
            self.series |= {name: found.pop("am"), **found}
        self.count, self.tolerance = terms, ar.mpf(TOLERANCE)

    def needed(self) -> str:
        """Return, as text, how many terms bring the bound of each column down to 1e-16."""
        counts = {name: terms_needed(x.bound, self.tolerance) for name, x in self.series.items()}
        return ", ".join(
            f"{name} {int(n) if n < 10**9 else n.context.nstr(n, 3)}" for name, n in counts.items()
        )

    def rows(self, digits: int | None = None) -> Rows:
        """Return the header, and each row as a block of texts."""
        names = (f"{name}{part}" for name in self.series for part in ("", "_error", "_bound"))
        return ["terms", *names], ([row] for row in self._texts())

    def _texts(self) -> Iterator[list[str]]:
        """Yield the rows as texts."""
        series = list(self.series.values())
        sums = zip(*(islice(x.sums, self.count) for x in series), strict=True)
        for n, parts in enumerate(sums, 1):
            cells = (
                x
                for part, of in zip(parts, series, strict=True)
                for x in (part, abs(part - of.exact), of.bound(n))
            )
            yield [str(n), *(double_text(float(x) + 0.0) for x in cells)]


def terms_needed(bound: ErrorBound, tolerance: Numeric) -> Numeric:
    """Return the least number of terms for which a falling bound is at most the tolerance.

    The result is a number of the context, correct to 300 bits, since k may be arbitrarily close to
    1.
    """
    ar = tolerance.context

    def bisected(few: Numeric, enough: Numeric, terms: Callable[[Numeric], Numeric]) -> Numeric:
        """Return the least number that is enough, by bisection."""
        while enough - few > max(1, ar.ldexp(enough, -min(300, ar.prec - 10))):
            middle = (few + enough) // 2
            few, enough = (middle, enough) if bound(terms(middle)) > tolerance else (few, middle)
        return enough

    if bound(1) <= tolerance:
        return ar.convert(1)
    bits = 1
    while bound(ar.ldexp(1, bits)) > tolerance:
        bits *= 2
    most = ar.ldexp(
        1, int(bisected(ar.convert(0), ar.convert(bits), lambda i: ar.ldexp(1, int(i))))
    )
    return bisected(most / 2, most, lambda n: n)
