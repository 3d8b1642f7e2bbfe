"""How the nome series of Aksenov converge, a row per number of terms."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.points import MAX_PERIODS
from ..arithmetic.protocol import Value
from ..arithmetic.text import double_text
from ..errors import LagtopError
from .complete import complete_k
from .jacobi import jacobi
from .many_digits import ManyDigits
from .modulus import Modulus
from .modulus_input import ModulusInput
from .nome_series import (
    ErrorBound,
    am_bound,
    am_sums,
    cn_bound,
    cn_sums,
    k_bound,
    k_sums,
    sn_bound,
    sn_sums,
)
from .tables import TableOfFunctions

if TYPE_CHECKING:
    from .tables import Rows

TOLERANCE = "1e-16"
"""The error, in the unit of the column, that the needed terms are counted for."""

_DIGITS = 400
"""Enough for every error that a double can hold."""


class _Series(NamedTuple):
    """The partial sums of a series, what they tend to, and a bound of the error after n terms."""

    sums: Iterator[Value]
    exact: Value
    bound: ErrorBound


class SeriesTable(TableOfFunctions):
    """Partial sums 1 to `terms`, each with its error and a bound of the error that is proved.

    They are of (3.1.8) for K and, at u (a factor of K if `in_quarters`), of (3.1.7), (3.1.4),
    (3.1.5) for am, sn, cn.
    """

    def __init__(
        self,
        modulus_input: ModulusInput,
        u: Fraction | None,
        terms: int,
        *,
        in_quarters: bool = False,
    ) -> None:
        """Raise LagtopError for k = 0 and k = 1, where the series are limits, and for a distant u.

        That is one beyond 2^50 periods.
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

    def needed(self) -> dict[str, int]:
        """Return how many terms make the bound of each column at most 1e-16."""
        return {name: terms_needed(x.bound, self.tolerance) for name, x in self.series.items()}

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


def _at(ar: ManyDigits, u: Value, modulus: Modulus, *, radians: bool) -> dict[str, _Series]:
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


def terms_needed(bound: ErrorBound, tolerance: Value) -> int:
    """Return the least number of terms from which a falling bound is at most the tolerance."""
    enough = 1  # Python's integers have no end, and k may be as close to 1 as it likes
    while bound(enough) > tolerance:
        enough *= 2
    few = enough // 2
    while enough - few > 1:
        middle = (few + enough) // 2
        few, enough = (middle, enough) if bound(middle) > tolerance else (few, middle)
    return enough
