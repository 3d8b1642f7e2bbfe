"""Tables of the functions of one modulus, in doubles or to any number of digits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import cache, partial
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.correct_rounding import TooFewDigitsError
from ..arithmetic.double_double import two_product
from ..arithmetic.doubles import DOUBLES
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Value
from ..arithmetic.sums_of_doubles import pair
from ..errors import LagtopError
from .complete import complete_k
from .jacobi import jacobi, jacobi_at
from .known_values import known_values, put_exact_values
from .modulus import Modulus
from .modulus_input import ModulusInput
from .periods import Complex, Periods, of_quarters
from .proved_digits import require_digits, settled_texts
from .theta import ThetaSeries, in_periods, rounded, series_for, theta_at, zeta_at
from .third_kind import ThirdKind, check_near, check_parameter, third_kind

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array

THETA, THIRD = ("01", "00", "11", "10"), ("01", "00", "11")
"""The functions of one argument, and those of an argument and a parameter."""


class Request(NamedTuple):
    """What to evaluate: am, sn, cn, dn and these families, Omega and Pi with their parameter."""

    modulus: ModulusInput
    families: tuple[str, ...] = ()
    parameter: Fraction = Fraction(0)
    imaginary: bool = False
    radians: bool = False
    in_quarters: bool = False
    """Whether the arguments are factors of K."""

    def parameter_in(self, ar: FunctionArithmetic) -> Complex:
        """Return the parameter in an mpmath context, rounded once."""
        value = ar.convert(self.parameter)
        return ar.mpc(0, value) if self.imaginary else ar.mpc(value, 0)

    def in_doubles(self) -> Request:
        """Return the request with the parameter that its nearest double is."""
        return self._replace(parameter=Fraction(float(self.parameter)))

    @property
    def has_parameter(self) -> bool:
        """Whether Omega or Pi are among the families."""
        return bool({"omega", "pi"} & set(self.families))


class Functions(NamedTuple):
    """The modulus of a request and all that follows from it and the parameter alone."""

    modulus: Modulus
    series: ThetaSeries | None
    """None where no family but am, sn, cn, dn is asked for."""
    third: dict[str, ThirdKind]
    K: Value
    """The quarter period; a pair in doubles."""

    def rounded(self, modulus: Modulus) -> Functions:
        """Return them in doubles, beside the modulus in doubles."""
        series = self.series and rounded(self.series)
        third = {ij: kind.rounded() for ij, kind in self.third.items()}
        return Functions(modulus, series, third, pair(self.K))


def functions_in(ar: ManyDigits, request: Request) -> Functions:
    """Return the constants of a request in an mpmath context.

    Raises LagtopError for a modulus or a parameter out of range.
    """
    exact = request.modulus.in_digits(ar)
    series = series_for(ar, exact) if request.families else None
    third: dict[str, ThirdKind] = {}
    if request.has_parameter:
        v = request.parameter_in(ar)
        check_parameter(ar, v, exact)
        third = {ij: third_kind(ar, ij, v, exact) for ij in THIRD}
    return Functions(
        exact, series, third, complete_k(ar, exact.k_prime) if exact.k_prime else ar.inf
    )


def values(
    ar: FunctionArithmetic,
    u: Value,
    functions: Functions,
    request: Request,
    known: Mapping[str, float] = MappingProxyType({}),
) -> dict[str, Value]:
    """Return the columns at u, in numpy or an mpmath context; those `known` are not computed.

    u is a factor of K where the request says so.  Omega and Pi of an imaginary parameter are given
    by their imaginary parts.
    """
    unit = ("rad", 1) if request.radians else ("deg", 180 / ar.pi)
    if request.in_quarters:
        x = of_quarters(ar, u)
        am, sn, cn, dn = jacobi_at(ar, x, functions.modulus)
        u = times_quarter(ar, u, functions.K)
    else:
        am, sn, cn, dn = jacobi(ar, u, functions.modulus)
    columns = {"u": u, f"am_{unit[0]}": am * unit[1], "sn": sn, "cn": cn, "dn": dn}
    columns |= {name: ar.convert(known[name]) for name in columns if name in known}
    if not functions.series:
        return columns
    if not request.in_quarters:
        x = in_periods(ar, u, functions.series)
        if not ar.is_array and u and not x.rest:
            raise TooFewDigitsError
    for name, compute in _families(ar, x, functions, functions.series, request):
        columns[name] = ar.convert(known[name]) if name in known else compute()
    return columns


def times_quarter(ar: FunctionArithmetic, factor: Value, K: Value) -> Value:
    """Return a multiple of K, which is a pair for arrays."""
    if not ar.is_array:
        return factor * K
    product, error = two_product(factor, K.high)
    return product + (error + factor * K.low)


def _families(
    ar: FunctionArithmetic, x: Periods, functions: Functions, series: ThetaSeries, request: Request
) -> Iterator[tuple[str, Callable[[], Value]]]:
    """Yield the columns of the families by name, and how to compute each."""
    suffix = "_imag" if request.imaginary else ""
    for family in request.families:
        if family in {"theta", "zeta"}:
            at = theta_at if family == "theta" else zeta_at
            for ij in THETA:
                yield f"{family}{ij}", partial(at, ar, ij, x, series)
        else:
            for ij, kind in functions.third.items():
                yield f"{family}{ij}{suffix}", partial(getattr(kind, family), ar, x)


def rows(arguments: Points, request: Request) -> tuple[list[str], Iterator[Array]]:
    """Return the header, and blocks of rows in doubles; a pole is not a number.

    Raises LagtopError before the first block, and before any arithmetic, for arguments or a
    parameter out of range.
    """
    import numpy as np

    request = request.in_doubles()
    in_doubles = request.modulus.in_doubles()
    has_periods = in_doubles.k_prime > 0
    if request.in_quarters:
        check_quarters(request)
        check_reach("u in units of K", arguments, 2 * MAX_PERIODS)
    else:
        limit = (
            MAX_PERIODS * 2 * complete_k(DOUBLES, in_doubles.k_prime) if has_periods else MAX_TIME
        )
        check_reach("u", arguments, min(limit, MAX_TIME))
    parameter = float(request.parameter)
    if request.has_parameter and has_periods and not request.imaginary:
        check_near(parameter, in_doubles)
    functions = functions_in(ManyDigits(), request).rounded(in_doubles)

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


def digit_rows(
    arguments: Points, request: Request, digits: int
) -> tuple[list[str], Iterator[list[NumberText]]]:
    """Return the header, and rows to so many significant digits; a pole is an empty text.

    Raises LagtopError for a parameter out of range, before any row.
    """
    if request.in_quarters:
        check_quarters(request)

    @cache
    def at_precision(dps: int) -> tuple[ManyDigits, Functions]:
        ar = ManyDigits(dps)
        return ar, functions_in(ar, request)

    def at(u: Fraction) -> dict[str, NumberText]:
        known = known_values(u, request)

        def compute(context: ManyDigits) -> dict[str, Value]:
            for far in (u, request.parameter if not request.imaginary else 0):
                require_digits(context, digits, abs(context.convert(far)))
            ar, functions = at_precision(context.dps)
            return values(ar, ar.convert(u), functions, request, known)

        return settled_texts(compute, digits, known)

    header = list(at(next(arguments.decimals())))
    return header, (list(at(u).values()) for u in arguments.decimals())


def check_quarters(request: Request) -> None:
    """Raise LagtopError where K is infinite, so that no argument is a multiple of it."""
    request.modulus.check()
    if "k_prime" in request.modulus.zeros():
        raise LagtopError("u must be a number, without K, for k = 1, where K is infinite", "u")
