"""Tables of the functions of one modulus in [0, 1], for real arguments."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.balls import Balls, balls
from ..arithmetic.numbers import DOUBLES
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, ListedPoints, Points, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Numeric
from ..arithmetic.rounding import decided, pair
from ..errors import LagtopError
from .complete import complete_k
from .jacobi import Jacobi, jacobi, jacobi_at
from .modulus import Modulus
from .periods import INDICES, Periods, whole_and_rest
from .request import THIRD, FunctionRequest, known_values, put_exact_values
from .tables import TableOfFunctions
from .theta import ThetaSeries, in_periods, series_for, series_in_doubles, theta_at, zeta_at
from .third_kind import third_kind
from .third_kind_series import ThirdKind

if TYPE_CHECKING:
    from ..arithmetic.types import Array
    from .tables import Known


class FunctionConstants(NamedTuple):
    """The modulus of a request, and the constants that depend only on it and the parameter."""

    modulus: Modulus
    series: ThetaSeries | None
    """None for k = 1, which has no periods."""
    third: dict[str, ThirdKind]
    K: Numeric
    """The quarter period; a pair of doubles in a table of doubles, None for k = 1."""

    def rounded(self, modulus: Modulus) -> FunctionConstants:
        """Return the constants in doubles, with the given modulus in doubles."""
        series = self.series and series_in_doubles(self.series)
        third = {ij: kind.rounded() for ij, kind in self.third.items()}
        return FunctionConstants(modulus, series, third, self.K and pair(self.K))


class FunctionTable(TableOfFunctions):
    """Tables of am, sn, cn, dn and the theta, Zeta, Omega and Pi functions of arguments u.

    The arguments are in units of K if the request says so.  For an imaginary parameter, Omega and
    Pi are given by their imaginary parts.

    Raises LagtopError for a modulus or a parameter out of range.  In doubles it also refuses
    arguments and parameters so large that doubles do not determine their place in a period.
    """

    def __init__(self, points: Points, request: FunctionRequest) -> None:
        super().__init__(points, points.count)
        self.request, self.modulus = request, request.real_modulus
        self.functions, self.rounds = 4 * len(request.families), not request.in_quarters

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError if arguments are multiples of an infinite K; see the class."""
        request, endless = self.request, "k_prime" in self.modulus.zeros()
        if doubles or request.in_quarters:
            self.modulus.check()
        if request.in_quarters and endless:
            message = "u must be a number, without K, for k = 1, where K is infinite"
            raise LagtopError(message, "u")
        if not doubles:
            return
        k_prime = self.modulus.in_doubles().k_prime
        reach = MAX_TIME if endless else MAX_PERIODS * 2 * complete_k(DOUBLES, k_prime)
        if request.in_quarters:
            check_reach("u in units of K", self.points, 2 * MAX_PERIODS)
        else:
            check_reach("u", self.points, min(reach, MAX_TIME))
        if request.has_parameter and not (endless or request.imaginary):
            check_reach("param", ListedPoints([request.size]), reach)

    def constants(self, ar: Balls) -> FunctionConstants:
        """Return the constants of the modulus and the parameter."""
        request, exact = self.request, self.modulus.in_digits(ar)
        endless = "k_prime" in self.modulus.zeros() and request.families == ("am",)
        series = None if endless else series_for(ar, exact)
        third: dict[str, ThirdKind] = {}
        if request.has_parameter:
            size, imaginary = ar.convert(request.size), request.imaginary
            third = {ij: third_kind(ar, ij, size, exact, imaginary=imaginary) for ij in THIRD}
        return FunctionConstants(
            exact, series, third, None if endless else complete_k(ar, exact.k_prime)
        )

    def rounded_constants(self) -> FunctionConstants:
        """Return the constants in doubles."""
        modulus = self.modulus.in_doubles()
        return decided(
            "the constants of these functions",
            lambda digits: self.constants(balls(digits)).rounded(modulus),
        )

    def columns(
        self, ar: FunctionArithmetic, x: Numeric, constants: FunctionConstants, known: Known
    ) -> dict[str, Numeric]:
        """Return the columns at arguments x, without those that are `known`."""
        u, series = ar.convert(x), constants.series
        if not series:
            columns = {"u": u} | dict(self._named(ar, jacobi(ar, u, constants.modulus)))
            return columns | {name: known[name] for name in known.keys() & columns.keys()}
        if self.request.in_quarters:
            place = whole_and_rest(ar, u / 2)  # exact up to 2^52 K
            u = times_quarter(ar, u, constants.K)
        else:
            place = in_periods(ar, u, series)
        columns = {"u": u}
        for name, compute in self._families(ar, place, constants, series):
            columns[name] = known[name] if name in known else compute()
        return columns

    def _named(self, ar: FunctionArithmetic, found: Jacobi) -> Iterator[tuple[str, Numeric]]:
        """Yield am (in the unit of the request), sn, cn and dn with the names of their columns."""
        yield self.request.am, found.am * (1 if self.request.radians else 180 / ar.pi)
        yield from zip(("sn", "cn", "dn"), found[1:], strict=True)

    def _families(
        self, ar: FunctionArithmetic, at: Periods, functions: FunctionConstants, series: ThetaSeries
    ) -> Iterator[tuple[str, Callable[[], Numeric]]]:
        """Yield the columns of the families by name, each with the function that computes it."""
        suffix = "_imag" if self.request.imaginary else ""
        for family in self.request.families:
            if family == "am":
                for name, value in self._named(ar, jacobi_at(ar, at, functions.modulus, series)):
                    yield name, partial(ar.convert, value)
            elif family in {"theta", "zeta"}:
                function = theta_at if family == "theta" else zeta_at
                for ij in INDICES:
                    yield f"{family}{ij}", partial(function, ar, ij, at, series)
            else:
                for ij, kind in functions.third.items():
                    yield f"{family}{ij}{suffix}", partial(getattr(kind, family), ar, at)

    def known(self, x: Fraction) -> Known:
        """Return the zeros, poles and other exact values at u; am is u if k = 0."""
        request = self.request
        is_u = "k" in request.real_modulus.zeros() and request.radians and not request.in_quarters
        return known_values(x, request) | ({request.am: x} if is_u else {})

    def put_known(self, columns: dict[str, Array], x: Array) -> None:
        """Put zeros, poles and other exact values into columns of doubles."""
        put_exact_values(columns, x, self.request)

    def digits_lost(self, x: Fraction) -> int:
        """Return the number of digits taken by the whole periods of u and of the parameter."""
        return len(str(int(max(abs(x), abs(self.request.size)))))


def times_quarter(ar: FunctionArithmetic, factor: Numeric, K: Numeric) -> Numeric:
    """Return `factor` times K, which is a pair of doubles for arrays."""
    if not ar.is_array:
        return factor * K
    from ..arithmetic.double_double import two_product  # start-up

    product, error = two_product(factor, K.high)
    return product + (error + factor * K.low)
