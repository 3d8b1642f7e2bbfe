"""Tables of Jacobi's, theta, Zeta, Omega and Pi functions of one modulus."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

from flint import acb, fmpq

from ..arithmetic.enclosures import at_precision
from ..errors import LagtopError
from ..top.ranges import MAX_PERIODS, MAX_TIME, ListedPoints, check_reach
from ..top.units import DEGREES, Units
from .arguments import Arguments, ExactComplex
from .functions import THIRD, Functions, Point
from .modulus import GivenModulus, Kind, angle, real_parts, split
from .tables import Cells, Rows, table_rows

QUOTIENTS = ("sn", "cn", "dn", "ns", "nc", "nd", "sc", "cs", "sd", "ds", "cd", "dc")
"""Jacobi's functions in Glaisher's notation: pq = pn/qn, nn = 1."""
FAMILIES = ("am", *QUOTIENTS, "theta", "zeta", "omega", "pi")
"""The functions of u; `am` stands for am, sn, cn and dn."""
_FIRST_DIGITS = 32

Values = dict[str, acb | None]


class FunctionRequest(NamedTuple):
    """The functions to tabulate, and where."""

    u: Arguments
    modulus: GivenModulus
    families: tuple[str, ...] = ("am",)
    """Some of FAMILIES."""
    parameter: ExactComplex = ExactComplex(Fraction(0))
    """The parameter of omega and pi."""
    imaginary: bool = False
    """Whether the parameter of real functions is imaginary (0i counts as imaginary)."""
    units: Units = DEGREES

    @property
    def is_real(self) -> bool:
        """Whether each number has one column; the names of imaginary numbers end in `_imag`."""
        is_mixed = self.parameter.real and self.parameter.imag
        return self.modulus.kind is Kind.UNIT and self.u.imag is None and not is_mixed

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError for invalid inputs; see `function_rows`."""
        self.modulus.check()
        functions = Functions(self.modulus.reduced())
        if self.u.in_quarters and (functions.is_1 or functions.kind is Kind.LARGE):
            raise LagtopError(
                "u must not contain K for k >= 1, where K is infinite or complex", "u"
            )
        if functions.is_1 and {"theta", "zeta", "omega", "pi"} & set(self.families):
            raise LagtopError("k must be below 1 for theta functions, got 1.0", "k")
        if not doubles:
            return
        rates = [float(rate.mid()) for rate in (functions.scale, functions.across)]
        along, across = (min(MAX_PERIODS / rate, MAX_TIME) if rate else MAX_TIME for rate in rates)
        v, (name, most) = self.parameter, ("u", along)
        if self.u.in_quarters:
            name, most = "u in units of K", 2 * MAX_PERIODS
        for what, points, limit in (
            (name, self.u.real, most),
            ("the imaginary part of u", self.u.imag or ListedPoints([Fraction(0)]), across),
            ("param", ListedPoints([v.real]), along),
            ("the imaginary part of param", ListedPoints([v.imag]), across),
        ):
            check_reach(what, points, limit)


def function_rows(request: FunctionRequest, digits: int | None = None) -> Rows:
    """Return a table of the functions of a request.

    Complex numbers have a column for each part; Jacobi's functions of real u are real.  Raises
    LagtopError for a modulus out of range, for multiples of a K that is not real, for functions
    that do not exist for k = 1 and, in doubles, for arguments and parameters beyond 2^50 periods.
    """
    modulus, v = request.modulus, point(request.parameter)
    at_precision(_FIRST_DIGITS, lambda: request.check(doubles=digits is None))
    has_parameter = bool({"omega", "pi"} & set(request.families))

    def constants() -> tuple[Functions, Values]:
        functions = Functions(modulus.reduced())
        return functions, functions.zetas(v) if has_parameter else {}

    def columns(x: ExactComplex, constants: tuple[Functions, Values]) -> Cells:
        u, (functions, zetas) = point(x), constants
        if request.u.in_quarters:
            u = Point(u.real / (2 * functions.scale))
        jacobi, found = _jacobi(request, functions, u), _thetas(request, functions, u)
        if has_parameter:
            found |= _third(request, functions.third(u, v, zetas))
        argument = u.real if request.u.in_quarters else x.real
        if request.is_real:
            return {"u": argument} | real_parts(jacobi | found)
        if request.u.imag is not None:
            return {"u_re": x.real, "u_im": x.imag} | split(jacobi | found)
        return {"u": argument} | real_parts(jacobi) | split(found)

    inputs = [*request.parameter, *modulus.value]
    return table_rows(request.u.numbers(digits), columns, constants, inputs, digits)


def _jacobi(request: FunctionRequest, functions: Functions, u: Point) -> Values:
    """Return am in the unit of the request, and the quotients of sn, cn, dn and 1."""
    has_am, found = "am" in request.families, Values()
    wanted = {*request.families, *(("sn", "cn", "dn") if has_am else ())}
    if wanted.isdisjoint(QUOTIENTS):
        return found
    am, *values = functions.jacobi(u)
    of = dict(zip("scdn", (*values, acb(1)), strict=True))
    if has_am:
        found |= angle("am", _on_axes(am, u, odd=True), request.units)
    for name in QUOTIENTS:
        if name in wanted:
            p, q = (of[letter] for letter in name)
            quotient = None if name[1] == "s" and u.is_0 else p / q
            found[name] = _on_axes(quotient, u, odd="s" in name)
    return found


def _thetas(request: FunctionRequest, functions: Functions, u: Point) -> Values:
    families, kind, found = request.families, functions.kind, Values()
    for ij, z in functions.thetas(u).items() if "theta" in families else ():
        is_real = kind is Kind.UNIT or (kind is Kind.IMAGINARY and ij[0] == "0")
        found[f"theta{ij}"] = _on_axes(z, u, odd=ij == "11") if is_real else z
    for ij, slope in functions.zetas(u).items() if "zeta" in families else ():
        found[f"zeta{ij}"] = slope if kind is Kind.LARGE else _on_axes(slope, u, odd=True)
    return found


def _third(request: FunctionRequest, values: Mapping[str, tuple[acb | None, acb | None]]) -> Values:
    """Return Omega and Pi, or their imaginary parts."""
    found, part = Values(), "_imag" if request.imaginary and request.is_real else ""
    for i, family in enumerate(("omega", "pi")):
        for ij in THIRD if family in request.families else ():
            z = values[ij][i]
            found[f"{family}{ij}{part}"] = acb(z.imag) if part and z is not None else z
    return found


def point(x: ExactComplex) -> Point:
    """Return an exact number as the functions take it."""
    return Point(*(fmpq(part.numerator, part.denominator) for part in x))


def _on_axes(z: acb | None, u: Point, *, odd: bool) -> acb | None:
    """Return an even or odd function of u that is real for real u, without parts that are 0."""
    if z is not None and u.imag == 0:
        z = acb(z.real)
    if z is not None and u.real == 0:
        z = acb(0, z.imag) if odd else acb(z.real)
    return z
