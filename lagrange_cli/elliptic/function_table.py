"""Tables of the functions of one modulus, in doubles or to any number of digits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import cache, partial
from itertools import chain
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.ball_functions import BallFunctions, ball_functions
from ..arithmetic.doubles import DOUBLES
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Value
from ..arithmetic.rounding import decided
from ..arithmetic.sums_of_doubles import pair
from ..errors import LagtopError
from .complete import complete_k
from .jacobi import Jacobi, jacobi, jacobi_at
from .known_values import known_values, put_exact_values
from .modulus import Modulus
from .periods import Periods, of_quarters
from .proved_numbers import ProvedNumbers, small_or_large
from .request import THETA, THIRD, Request
from .theta import ThetaSeries, in_periods, rounded, series_for, theta_at, zeta_at
from .third_kind import ThirdKind, check_near, third_kind

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array


class Functions(NamedTuple):
    """The modulus of a request and all that follows from it and the parameter alone."""

    modulus: Modulus
    series: ThetaSeries | None
    """None for k = 1, where there are no periods."""
    third: dict[str, ThirdKind]
    K: Value
    """The quarter period; a pair in doubles, None for k = 1."""

    def rounded(self, modulus: Modulus) -> Functions:
        """Return them in doubles, beside the modulus in doubles."""
        series = self.series and rounded(self.series)
        third = {ij: kind.rounded() for ij, kind in self.third.items()}
        return Functions(modulus, series, third, self.K and pair(self.K))


def functions_in(ar: BallFunctions, request: Request) -> Functions:
    """Return the constants of a request in balls.

    Raises LagtopError for a modulus or a parameter out of range.
    """
    exact = request.modulus.in_digits(ar)
    endless = "k_prime" in request.modulus.zeros() and request.families == ("am",)
    series = None if endless else series_for(ar, exact)
    third: dict[str, ThirdKind] = {}
    if request.has_parameter:
        size, imaginary = ar.convert(request.parameter), request.imaginary
        third = {ij: third_kind(ar, ij, size, exact, imaginary=imaginary) for ij in THIRD}
    return Functions(exact, series, third, None if endless else complete_k(ar, exact.k_prime))


def values(
    ar: FunctionArithmetic,
    u: Value,
    functions: Functions,
    request: Request,
    known: Mapping[str, float] = MappingProxyType({}),
) -> dict[str, Value]:
    """Return the columns at u, of arrays or in balls; those `known` are not computed.

    u is a factor of K where the request says so.  Omega and Pi of an imaginary parameter are given
    by their imaginary parts.
    """
    series = functions.series
    if not series:
        found = jacobi(ar, u, functions.modulus)
        columns = {"u": u} | dict(_named(ar, found, request))
        return columns | {name: known[name] for name in known.keys() & columns.keys()}
    if request.in_quarters:
        x = of_quarters(ar, u)
        u = times_quarter(ar, u, functions.K)
    else:
        x = in_periods(ar, u, series)
    columns = {"u": u}
    for name, compute in _families(ar, x, functions, series, request):
        columns[name] = known[name] if name in known else compute()
    return columns


def _named(ar: FunctionArithmetic, found: Jacobi, request: Request) -> Iterator[tuple[str, Value]]:
    """Yield am, in the unit of the request, sn, cn and dn by the names of their columns."""
    unit, size = ("rad", 1) if request.radians else ("deg", 180 / ar.pi)
    yield f"am_{unit}", found.am * size
    yield from zip(("sn", "cn", "dn"), found[1:], strict=True)


def times_quarter(ar: FunctionArithmetic, factor: Value, K: Value) -> Value:
    """Return a multiple of K, which is a pair for arrays."""
    if not ar.is_array:
        return factor * K
    from ..arithmetic.double_double import two_product

    product, error = two_product(factor, K.high)
    return product + (error + factor * K.low)


def _families(
    ar: FunctionArithmetic, x: Periods, functions: Functions, series: ThetaSeries, request: Request
) -> Iterator[tuple[str, Callable[[], Value]]]:
    """Yield the columns of the families by name, and how to compute each."""
    suffix = "_imag" if request.imaginary else ""
    for family in request.families:
        if family == "am":
            for name, value in _named(ar, jacobi_at(ar, x, functions.modulus, series), request):
                yield name, partial(ar.convert, value)
        elif family in {"theta", "zeta"}:
            at = theta_at if family == "theta" else zeta_at
            for ij in THETA:
                yield f"{family}{ij}", partial(at, ar, ij, x, series)
        else:
            for ij, kind in functions.third.items():
                yield f"{family}{ij}{suffix}", partial(getattr(kind, family), ar, x)


def check_domain(arguments: Points, request: Request) -> Modulus:
    """Return the modulus in doubles.

    Raises LagtopError, before any arithmetic, for arguments or a parameter out of the range in
    which doubles name a place in the periods.
    """
    modulus = request.modulus.in_doubles()
    has_periods = modulus.k_prime > 0
    if request.in_quarters:
        check_quarters(request)
        check_reach("u in units of K", arguments, 2 * MAX_PERIODS)
    else:
        limit = MAX_PERIODS * 2 * complete_k(DOUBLES, modulus.k_prime) if has_periods else MAX_TIME
        check_reach("u", arguments, min(limit, MAX_TIME))
    if request.has_parameter and has_periods and not request.imaginary:
        check_near(float(request.parameter), modulus)
    return modulus


def rows(arguments: Points, request: Request) -> tuple[list[str], Iterator[Array]]:
    """Return the header, and blocks of rows in doubles; a pole is not a number.

    Raises LagtopError before the first block, as `check_domain` does.
    """
    import numpy as np

    from ..arithmetic.arrays import ARRAYS

    request, parameter = request.in_doubles(), float(request.parameter)
    modulus = check_domain(arguments, request)
    functions = decided(
        "the constants of these functions",
        lambda digits: functions_in(ball_functions(digits), request).rounded(modulus),
    )

    def columns(u: Array) -> dict[str, Array]:
        with np.errstate(all="ignore"):  # poles, and what leaves the doubles, end as empty cells
            table = values(ARRAYS, u, functions, request)
        put_exact_values(table, u, request)
        poles = abs(table["u"]) == abs(parameter)
        if request.has_parameter and parameter and not request.imaginary:
            for name in {"omega11", "pi11"} & set(table):
                table[name] = np.where(poles, np.nan, table[name])
        return table

    def block(u: Array) -> Array:
        together = np.stack(list(columns(u).values()), axis=1)
        together[np.isinf(together)] = np.nan
        return together + 0.0  # no -0

    header = list(columns(np.array(arguments.bounds())))
    return header, (block(u) for u in arguments.blocks())


def blocks(
    arguments: Points, request: Request
) -> tuple[list[str], Iterator[Array | list[list[NumberText]]]]:
    """Return what `rows` does, as texts without NumPy where the table is small."""
    header: list[str] = []

    def small() -> list[list[NumberText]]:
        header[:], lines = digit_rows(arguments, request, short=True)
        return list(lines)

    def large() -> Iterator[Array]:
        header[:], arrays = rows(arguments, request)
        return arrays

    return header, small_or_large(4 * len(request.families) * arguments.count, small, large)


def digit_rows(
    arguments: Points, request: Request, digits: int | None = None, *, short: bool = False
) -> tuple[list[str], Iterator[list[NumberText]]]:
    """Return the header, and rows to so many significant digits; a pole is an empty text.

    Without `digits` the arguments and the parameter are rounded to doubles, and each number is the
    nearest double: what `rows` does, without NumPy; a `short` search raises TooFewDigitsError
    where that is sooner.  Raises LagtopError before any row, for a
    parameter out of range and, without `digits`, as `check_domain` does.
    """
    if digits is None:
        request = request.in_doubles()
        check_domain(arguments, request)
    elif request.in_quarters:
        check_quarters(request)
    places = arguments.decimals()
    if digits is None and not request.in_quarters:
        places = (Fraction(float(u)) for u in places)
    numbers = ProvedNumbers(digits, short=short)

    @cache
    def constants(ar: BallFunctions) -> Functions:
        return functions_in(ar, request)

    def at(u: Fraction) -> dict[str, NumberText]:
        known = known_values(u, request)
        more = len(str(int(max(abs(u), abs(request.parameter)))))
        return numbers.texts(
            lambda ar: values(ar, ar.convert(u), constants(ar), request, known), known, more
        )

    first = at(next(places))
    return list(first), (list(row.values()) for row in chain([first], map(at, places)))


def check_quarters(request: Request) -> None:
    """Raise LagtopError where K is infinite, so that no argument is a multiple of it."""
    request.modulus.check()
    if "k_prime" in request.modulus.zeros():
        raise LagtopError("u must be a number, without K, for k = 1, where K is infinite", "u")
