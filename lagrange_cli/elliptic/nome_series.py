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


def sn_sums(ar: FunctionArithmetic, u: Numeric, modulus: Modulus) -> Iterator[Numeric]:
    """Yield sums of sn u = 2 pi/(k K) sum q^(n-1/2)/(1 - q^(2n-1)) sin (2n-1) pi u/2K  (3.1.4)."""
    return _odd_sums(ar, u, modulus, -1, ar.sin)


def cn_sums(ar: FunctionArithmetic, u: Numeric, modulus: Modulus) -> Iterator[Numeric]:
    """Yield sums of cn u = 2 pi/(k K) sum q^(n-1/2)/(1 + q^(2n-1)) cos (2n-1) pi u/2K  (3.1.5)."""
    return _odd_sums(ar, u, modulus, 1, ar.cos)


def _odd_sums(
    ar: FunctionArithmetic,
    u: Numeric,
    modulus: Modulus,
    sign: int,
    wave: Callable[[Numeric], Numeric],
) -> Iterator[Numeric]:
    """Yield the partial sums of the waves of odd order, with `sign` before q^(2n-1)."""
    q, angle, scale = _parts(ar, u, modulus)
    root = ar.sqrt(q)
    return accumulate(scale * root**n / (1 + sign * q**n) * wave(n * angle) for n in count(1, 2))


def am_sums(ar: FunctionArithmetic, u: Numeric, modulus: Modulus) -> Iterator[Numeric]:
    """Yield the sums of am u = pi u/2K + sum (2/n) q^n/(1 + q^2n) sin 2n pi u/2K  (3.1.7)."""
    q, angle, _ = _parts(ar, u, modulus)
    terms = (2 * q**n / (n * (1 + q ** (2 * n))) * ar.sin(2 * n * angle) for n in count(1))
    return accumulate(terms, initial=angle)


def k_sums(ar: FunctionArithmetic, modulus: Modulus) -> Iterator[Numeric]:
    """Yield the sums of K = pi/2 {1 + (1/2)^2 k^2 + (1 3/2 4)^2 k^4 + ...}  (3.1.8)."""
    m = modulus.k * modulus.k
    factors = (((2 * n - 1) / ar.convert(2 * n)) ** 2 * m for n in count(1))
    terms = accumulate(factors, lambda term, factor: term * factor, initial=ar.pi / 2)
    return accumulate(terms)


def sn_bound(ar: FunctionArithmetic, modulus: Modulus) -> ErrorBound:
    """Return the bound 2 pi/(k K) q^(n+1/2)/((1 - q)(1 - q^(2n+1))) on the error of (3.1.4).

    Beyond the n-th term, 1/(1 - q^(2j-1)) <= 1/(1 - q^(2n+1)).  The sum of q^(j-1/2) over j > n is
    q^(n+1/2)/(1 - q).
    """
    q, _, scale = _parts(ar, ar.convert(0), modulus)
    first = scale * ar.sqrt(q) / (1 - q)
    power = _falling(ar, ar.log(q))
    return lambda n: first * power(n) / (1 - power(2 * n + 1))


def cn_bound(ar: FunctionArithmetic, modulus: Modulus) -> ErrorBound:
    """Return the bound 2 pi/(k K) q^(n+1/2)/(1 - q) on the error of n terms of (3.1.5).

    Here 1/(1 + q^(2j-1)) < 1, and the sum is the same as in `sn_bound`.
    """
    q, _, scale = _parts(ar, ar.convert(0), modulus)
    first, power = scale * ar.sqrt(q) / (1 - q), _falling(ar, ar.log(q))
    return lambda n: first * power(n)


def am_bound(ar: FunctionArithmetic, modulus: Modulus) -> ErrorBound:
    """Return the bound 2 q^(n+1)/((n+1)(1 - q)) on the error of n terms of (3.1.7) in radians.

    For j > n, 1/(j (1 + q^2j)) < 1/(n+1), and the sum of q^j is q^(n+1)/(1 - q).
    """
    q, _, _ = _parts(ar, ar.convert(0), modulus)
    first, power = 2 * q / (1 - q), _falling(ar, ar.log(q))
    return lambda n: first * power(n) / (n + 1)


def k_bound(ar: FunctionArithmetic, modulus: Modulus) -> ErrorBound:
    """Return the bound k^2n/((2n + 1/2) k'^2), or K if that is less, on the error of (3.1.8).

    Let c_j = 1 3 ... (2j-1)/(2 4 ... 2j).  From each j to the next, c_j^2 (j + 1/4) grows by the
    factor

        (16j^3 + 36j^2 + 24j + 5)/(16j^3 + 36j^2 + 24j + 4)

    and tends to 1/pi (Wallis's product).  So for j >= n the terms pi/2 c_j^2 k^2j are below
    k^2j/(2n + 1/2), and the sum of k^2j is k^2n/k'^2.
    """
    complement = modulus.k_prime * modulus.k_prime
    half, power = ar.convert(0.5), _falling(ar, ar.log1p(-complement))
    K = complete_k(ar, modulus.k_prime)
    return lambda n: min(power(n) / ((2 * n + half) * complement), K)


def _falling(ar: FunctionArithmetic, fall: Numeric) -> ErrorBound:
    """Return exp(n fall) as a function of n, but at least exp(-10^6), which is quicker."""
    return lambda n: ar.exp(max(n * fall, -(10**6)))


def _parts(
    ar: FunctionArithmetic, u: Numeric, modulus: Modulus
) -> tuple[Numeric, Numeric, Numeric]:
    """Return the nome (3.1.6), pi u/2K and 2 pi/(k K)."""
    K = complete_k(ar, modulus.k_prime)
    q = nome(ar, m=modulus.k * modulus.k, k_prime=modulus.k_prime)
    return q, ar.pi * u / (2 * K), 2 * ar.pi / (modulus.k * K)


TOLERANCE = "1e-16"
"""Tolerance of `SeriesTable.needed`, in the unit of the column."""

_DIGITS = 400
"""Digits enough for every error that a double can hold."""


class _Series(NamedTuple):
    """The partial sums of a series, their limit, and a bound on the error after n terms."""

    sums: Iterator[Numeric]
    exact: Numeric
    bound: ErrorBound


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
        K = complete_k(ar, modulus.k_prime)
        self.series = {"K": _Series(k_sums(ar, modulus), K, k_bound(ar, modulus))}
        if u is not None:
            argument = ar.convert(u) * (K if in_quarters else 1)
            limit = MAX_PERIODS * 2 * K
            if abs(argument) > limit:
                reach, got = ar.nstr(limit, 3), float(argument)
                raise LagtopError(f"u must be within 2^50 periods = {reach} of 0, got {got}", "u")
            self.series |= _at(ar, argument, modulus, radians=modulus_input.radians)
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


def _at(ar: ManyDigits, u: Numeric, modulus: Modulus, *, radians: bool) -> dict[str, _Series]:
    """Return the series at u."""
    am, sn, cn, _ = jacobi(ar, u, modulus)
    unit, bound = 1 if radians else 180 / ar.pi, am_bound(ar, modulus)
    from_first_term = (unit * part for part in islice(am_sums(ar, u, modulus), 1, None))
    return {
        "am_rad" if radians else "am_deg": _Series(
            from_first_term, unit * am, lambda n: unit * bound(n)
        ),
        "sn": _Series(sn_sums(ar, u, modulus), sn, sn_bound(ar, modulus)),
        "cn": _Series(cn_sums(ar, u, modulus), cn, cn_bound(ar, modulus)),
    }


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
