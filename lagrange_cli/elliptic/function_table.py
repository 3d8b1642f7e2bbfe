"""Tables of am, sn, cn, dn and of the theta, Zeta, Omega and Pi functions of one modulus."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import NamedTuple

from flint import acb, arb

from ..arithmetic.ball import balls
from ..arithmetic.rounding import FIRST_DIGITS
from ..errors import LagtopError
from ..top.ranges import MAX_PERIODS, MAX_TIME, ExactComplex, Points, check_reach
from .enclosures import Value, exact, rational
from .functions import INDICES, THIRD, Functions, Point
from .modulus import AnyModulus, Kind, check_modulus, numbers_of, reduced, split
from .tables import TableOfFunctions, nearest


class FunctionRequest(NamedTuple):
    """The functions to tabulate."""

    modulus: AnyModulus
    families: tuple[str, ...] = ("am",)
    """Some of am (with sn, cn and dn), theta, zeta, omega and pi."""
    parameter: ExactComplex = ExactComplex(Fraction(0))
    """The parameter of omega and pi."""
    imaginary: bool = False
    """Whether the parameter of real functions is imaginary (0i counts as imaginary)."""
    radians: bool = False
    in_quarters: bool = False
    """Whether the arguments are real multiples of K."""
    is_real: bool = True
    """Whether all numbers are real functions of a modulus in [0, 1], in one column each."""

    @property
    def am(self) -> str:
        """The name of the column of am, with its unit."""
        return "am_rad" if self.radians else "am_deg"

    @property
    def has_parameter(self) -> bool:
        """Whether Omega or Pi is among the families."""
        return bool({"omega", "pi"} & set(self.families))


class ComplexPoints(NamedTuple):
    """Complex arguments: their real parts and, unless all are real, their imaginary parts."""

    real: Points
    imag: Points | None = None

    def decimals(self) -> Iterator[ExactComplex]:
        """Yield every argument exactly."""
        if self.imag is None:
            return map(ExactComplex, self.real.decimals())
        return map(ExactComplex, self.real.decimals(), self.imag.decimals())


class FunctionTable(TableOfFunctions):
    """Tables of the functions of a request.

    Complex numbers have a column for each part.  am, sn, cn and dn of real arguments are real and
    have one.  For an imaginary parameter of real functions, Omega and Pi are given by their
    imaginary parts.

    Raises LagtopError for a modulus out of range, for multiples of an infinite K and for functions
    that need two periods.  In doubles it also refuses arguments and parameters beyond 2^50 periods,
    because doubles do not determine their place in a period.
    """

    def __init__(self, points: ComplexPoints, request: FunctionRequest) -> None:
        super().__init__()
        self.points, self.request, self.count = points, request, points.real.count
        self.parameter = point(request.parameter)

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError for invalid inputs; see the class."""
        request = self.request
        check_modulus(request.modulus)
        with balls(FIRST_DIGITS):
            functions = Functions(reduced(request.modulus))
        if functions.is_1 and request.in_quarters:
            message = "u must be a number, without K, for k = 1, where K is infinite"
            raise LagtopError(message, "u")
        if request.families != ("am",):
            self._check_periods(functions)
        if doubles:
            self._check_reach(functions)

    def _check_periods(self, functions: Functions) -> None:
        """Raise LagtopError for functions that need two periods."""
        request = self.request
        if request.is_real and functions.is_1:
            raise LagtopError("k must be below 1 for theta functions, got 1.0", "k")
        if not request.is_real and (functions.is_0 or functions.is_1):
            message = "k must not be 0 or 1 for theta functions of complex arguments"
            raise LagtopError(message, "k")
        if request.has_parameter and request.imaginary and request.is_real:
            height = exact(request.parameter.imag) * functions.across * 2
            if abs(height) >= 1:
                limit = (1 / (2 * functions.across)).mid()
                raise LagtopError(
                    f"param must be smaller than K' = {float(limit):.6g} in size "
                    f"if it is imaginary, got {request.parameter}",
                    "param",
                )

    def _check_reach(self, functions: Functions) -> None:
        """Raise LagtopError for arguments and parameters beyond 2^50 periods."""
        rates = [float(rate.mid()) for rate in (functions.scale, functions.across)]
        limits = [min(MAX_PERIODS / rate, MAX_TIME) if rate else MAX_TIME for rate in rates]
        real, imag = self.points
        if self.request.in_quarters:
            check_reach("u in units of K", real, 2 * MAX_PERIODS)
        else:
            check_reach("u", real, limits[0])
        if imag is not None:
            check_reach("the imaginary part of u", imag, limits[1])
        parameter = self.request.parameter
        for part, limit in zip(parameter, limits, strict=True):
            if abs(part) > limit:
                must = "be" if self.request.is_real else "have parts"
                raise LagtopError(
                    f"param must {must} within 2^50 periods = {limit:.3g} of 0, "
                    f"got {parameter} (or give --digits)",
                    "param",
                )

    def arguments(self, *, doubles: bool) -> Iterator[ExactComplex]:
        """Yield the arguments; for doubles, multiples of K are not rounded."""
        exact_points = self.points.decimals()
        if not doubles or self.request.in_quarters:
            return exact_points
        return (ExactComplex(*map(nearest, x)) for x in exact_points)

    def inputs(self, x: ExactComplex) -> Iterable[Fraction]:
        """Return the parts of the argument, the parameter and the modulus."""
        return [*x, *self.request.parameter, *numbers_of(self.request.modulus)]

    def constants(self) -> Functions:
        """Return the functions of the modulus."""
        return Functions(reduced(self.request.modulus))

    def columns(self, x: ExactComplex, constants: Functions) -> dict[str, Value]:
        """Return the argument and the functions."""
        request, u = self.request, point(x)
        if request.in_quarters:
            u = Point(u.real / (2 * constants.scale))
        found: dict[str, acb | None] = {}
        for family in request.families:
            if family == "am":
                found |= self._jacobi(constants, u)
            elif family in {"theta", "zeta"}:
                found |= _of_argument(constants, u, family)
        if request.has_parameter:
            found |= self._third(constants, u)
        argument = u.real if request.in_quarters else x.real
        if request.is_real:
            return {"u": argument} | _real_parts(found)
        jacobi = {name: found.pop(name) for name in (request.am, "sn", "cn", "dn") if name in found}
        if self.points.imag is not None:
            return {"u_re": x.real, "u_im": x.imag} | split(jacobi | found)
        return {"u": argument} | _real_parts(jacobi) | split(found)

    def _jacobi(self, functions: Functions, u: Point) -> dict[str, acb | None]:
        """Return am in the unit of the request, sn, cn and dn."""
        am, sn, cn, dn = functions.jacobi(u)
        if am is not None and not self.request.radians:
            am = am * 180 / arb.pi()
        axes, odd = u.axes, {self.request.am: am, "sn": sn}
        found = {name: _on_axes(z, axes, odd=True) for name, z in odd.items()}
        return found | {"cn": _on_axes(cn, axes), "dn": _on_axes(dn, axes)}

    def _third(self, functions: Functions, u: Point) -> dict[str, acb | None]:
        """Return Omega and Pi in the order of the families, or their imaginary parts."""
        request, values = self.request, functions.third(u, self.parameter)
        if request.is_real and self.parameter.is_0:
            values["11"] = acb(0), None  # also at u = 0, as on all of the real axis
        found: dict[str, acb | None] = {}
        for family in request.families:
            for ij in THIRD if family in {"omega", "pi"} else ():
                z = values[ij][family == "pi"]
                if request.imaginary and request.is_real:
                    found[f"{family}{ij}_imag"] = None if z is None else acb(z.imag)
                else:
                    found[f"{family}{ij}"] = z
        return found


def point(x: ExactComplex) -> Point:
    """Return an exact number as the functions take it."""
    return Point(*map(rational, x))


def _real_parts(numbers: dict[str, acb | None]) -> dict[str, Value]:
    return {name: None if z is None else z.real for name, z in numbers.items()}


def _of_argument(functions: Functions, u: Point, family: str) -> dict[str, acb | None]:
    """Return the theta or the Zeta functions of u."""
    kind, axes = functions.kind, u.axes
    values: Mapping[str, acb | None]
    if family == "zeta":
        values = functions.zetas(u)
        has_symmetry = dict.fromkeys(INDICES, kind is not Kind.LARGE)
    else:
        values = functions.thetas(u)
        has_symmetry = {
            ij: kind is Kind.UNIT or (kind is Kind.IMAGINARY and ij[0] == "0") for ij in INDICES
        }
    return {
        f"{family}{ij}": _on_axes(z, axes, odd=family == "zeta" or ij == "11")
        if has_symmetry[ij]
        else z
        for ij, z in values.items()
    }


def _on_axes(z: acb | None, axes: set[str], *, odd: bool = False) -> acb | None:
    """Return an even or odd function that is real on the real axis, without parts that are 0."""
    if z is None:
        return z
    if "real" in axes:
        z = acb(z.real)
    if "imag" in axes:
        z = acb(0, z.imag) if odd else acb(z.real)
    return z
