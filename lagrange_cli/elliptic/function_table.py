"""Tables of Jacobi's, theta, Zeta, Omega and Pi functions of one modulus."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

from flint import acb, arb

from ..arithmetic.enclosures import at_precision
from ..errors import LagtopError
from ..top.ranges import MAX_PERIODS, MAX_TIME, ListedPoints, check_reach
from ..top.units import DEGREES, Units
from .arguments import Arguments, ExactComplex
from .functions import THIRD, Functions, Point
from .legendre import Legendre
from .modulus import GivenModulus, Kind, angle, real_parts, split
from .tables import Cells, Rows, table_rows

QUOTIENTS = ("sn", "cn", "dn", "ns", "nc", "nd", "sc", "cs", "sd", "ds", "cd", "dc")
"""Jacobi's functions in Glaisher's notation: pq = pn/qn, nn = 1."""
INVERSES = tuple(f"arc{pq}" for pq in QUOTIENTS)
NEVILLE = ("theta_s", "theta_c", "theta_d", "theta_n")
THETAS = {"theta1": "11", "theta2": "10", "theta3": "00", "theta4": "01"}
"""The theta functions of z in radians, and the index of Theta(2Kz/pi)."""
_THIRD_KIND = ("omega", "pi")
FAMILIES = (
    *("am", *QUOTIENTS, "epsilon", *INVERSES),
    *("theta", "zeta", *THETAS, *NEVILLE, *_THIRD_KIND),
)
"""The functions of u; `am` stands for am, sn, cn and dn."""
_NEEDS_REAL_SQUARE = {"am", *INVERSES, *_THIRD_KIND}
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
    units: Units = DEGREES

    @property
    def has_real_u(self) -> bool:
        """Whether all arguments are real; K' is complex for an imaginary k, and K for k > 1."""
        u, kind = self.u, self.modulus.kind
        complex_units = {Kind.IMAGINARY: u[4:], Kind.LARGE: u[2:4], Kind.COMPLEX: u[2:]}
        return all(x is None for x in (*u[1::2], *complex_units.get(kind, ())))

    @property
    def has_imaginary_part(self) -> bool:
        """Whether the parameter is not real."""
        return any(self.parameter[1::2])

    @property
    def is_real(self) -> bool:
        """Whether each number has one column; the names of imaginary numbers end in `_imag`."""
        is_mixed = any(self.parameter[::2]) and self.has_imaginary_part
        return self.modulus.kind is Kind.UNIT and self.has_real_u and not is_mixed

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError for invalid inputs; see `function_rows`."""
        self.modulus.check()
        functions, asked, u = Functions(self.modulus.reduced()), set(self.families), self.u
        if "epsilon" in asked:
            self.modulus.check_principal()
        if functions.kind is Kind.COMPLEX and (wrong := sorted(asked & _NEEDS_REAL_SQUARE)):
            wanted = f"must not contain {wrong[0]} if k^2 is complex"
            raise LagtopError(f"functions {wanted}", "functions")
        if asked & {*INVERSES} and (u.has_quarters or not self.has_real_u):
            raise LagtopError("u must be real, without K, for inverse functions", "u")
        if asked & {*THETAS} and u.has_quarters:
            wanted = "must be z in radians, without K, for theta1 to theta4: theta takes u = 2Kz/pi"
            raise LagtopError(f"u {wanted}", "u")
        for name, x in (("u", u), ("param", self.parameter)):
            has_K, has_K_prime = x[2] or x[3], x[4] or x[5]
            if (functions.is_1 and has_K) or (functions.is_0 and has_K_prime):
                infinite = "K for k = 1" if functions.is_1 else "K' for k = 0"
                raise LagtopError(f"{name} must not contain {infinite}, where it is infinite", name)
        if functions.is_1 and {"theta", "zeta", "epsilon", *THETAS, *_THIRD_KIND} & asked:
            raise LagtopError("k must be below 1 for theta functions, got 1.0", "k")
        if doubles:
            self._check_reach(functions)

    def _check_reach(self, functions: Functions) -> None:
        """Raise LagtopError for arguments and parameters beyond 2^50 periods."""
        rates = [float(abs(rate).mid()) for rate in (functions.scale, functions.across)]
        if functions.kind is Kind.COMPLEX:
            rates = [max(rates)] * 2
        along, across = (min(MAX_PERIODS / rate, MAX_TIME) if rate else MAX_TIME for rate in rates)
        v = [ListedPoints([part]) for part in self.parameter]
        for name, parts in (("u", self.u), ("param", v)):
            limits = ((name, along), (f"the imaginary part of {name}", across))
            quarters = [(f"{name} in units of K", 2 * MAX_PERIODS)] * 4
            for points, (what, limit) in zip(parts, (*limits, *quarters), strict=True):
                if points is not None:
                    check_reach(what, points, limit)


def function_rows(request: FunctionRequest, digits: int | None = None) -> Rows:
    """Return a table of the functions of a request.

    Complex numbers have a column for each part; Jacobi's functions of real u are real.  Raises
    LagtopError for a modulus out of range, for multiples of an infinite K, for functions that do
    not exist for the modulus and, in doubles, for arguments and parameters beyond 2^50 periods.
    """
    modulus = request.modulus
    at_precision(_FIRST_DIGITS, lambda: request.check(doubles=digits is None))
    has_parameter = not {*_THIRD_KIND}.isdisjoint(request.families)
    has_integrals = not {"epsilon", *INVERSES}.isdisjoint(request.families)

    def constants() -> tuple[Functions, Legendre | None, Values]:
        functions = Functions(modulus.reduced())
        zetas = functions.zetas(functions.point(request.parameter)) if has_parameter else {}
        integrals = Legendre(modulus.reduced(), modulus.m) if has_integrals else None  # slow
        return functions, integrals, zetas

    def columns(x: ExactComplex, constants: tuple[Functions, Legendre | None, Values]) -> Cells:
        functions, legendre, zetas = constants
        u = functions.point(x)
        value = functions.value(u) if request.u.has_quarters else None
        real, imag = x[:2] if value is None else (value.real, value.imag)
        jacobi = _jacobi(request, functions, legendre, x)
        found = _thetas(request, functions, u)
        if has_parameter:
            found |= _third(request, functions.third(u, functions.point(request.parameter), zetas))
        if request.is_real:
            return {"u": real} | real_parts(jacobi | found)
        if not request.has_real_u:
            return {"u_re": real, "u_im": imag} | split(jacobi | found)
        is_complex = functions.kind is Kind.COMPLEX
        return {"u": real} | (split if is_complex else real_parts)(jacobi) | split(found)

    inputs = [*request.parameter, *modulus.value]
    return table_rows(request.u.numbers(digits), columns, constants, inputs, digits)


def _jacobi(
    request: FunctionRequest, functions: Functions, legendre: Legendre | None, x: ExactComplex
) -> Values:
    """Return the functions that are real for real u and k^2; am in the unit of the request."""
    families, u, found = request.families, functions.point(x), Values()
    has_am, is_real = "am" in families, functions.kind is not Kind.COMPLEX
    wanted = [pq for pq in QUOTIENTS if pq in families or (has_am and pq in QUOTIENTS[:3])]
    of = functions.neville(u) if wanted else {}
    if has_am:
        am = functions.amplitude(u, of["s"] / of["n"], of["c"] / of["n"])
        found |= angle("am", _on_axes(am, u, odd=True), request.units)
    for pq in wanted:
        quotient = None if pq[1] == "s" and u.is_0 else of[pq[0]] / of[pq[1]]
        found[pq] = _on_axes(quotient, u, odd="s" in pq, is_real=is_real)
    if legendre is None:
        return found
    if "epsilon" in families:  # E(am u, k) = Z_01(u) + u E/K
        zeta = functions.zetas(u)["01"] or acb(0)
        total = zeta + functions.value(u) * legendre.mean
        found["epsilon"] = _on_axes(total, u, odd=True, is_real=is_real)
    inverses = (name for name in INVERSES if name in families)
    return found | {name: legendre.inverse(name[3:], x.real) for name in inverses}


def _thetas(request: FunctionRequest, functions: Functions, u: Point) -> Values:
    """Return the theta functions of u and of z, Zeta, and Neville's functions."""
    families, value, found = request.families, functions.value(u), Values()
    is_imaginary, is_real = (functions.kind is kind for kind in (Kind.IMAGINARY, Kind.UNIT))
    thetas: list[tuple[str, str, acb]] = []
    if "theta" in families:
        at_u = functions.thetas(value * functions.rate)
        thetas += [(f"theta{ij}", ij, z) for ij, z in at_u.items()]
    if not {*THETAS}.isdisjoint(families):
        at_z = functions.thetas(value / arb.pi())
        thetas += [(name, ij, at_z[ij]) for name, ij in THETAS.items() if name in families]
    for name, ij, z in thetas:
        is_real_here = is_real or (is_imaginary and ij[0] == "0")
        found[name] = _on_axes(z, u, odd=ij == "11", is_real=is_real_here)
    is_real |= is_imaginary
    for ij, slope in functions.zetas(u).items() if "zeta" in families else ():
        found[f"zeta{ij}"] = _on_axes(slope, u, odd=True, is_real=is_real)
    if not {*NEVILLE}.isdisjoint(families):
        of, factor = functions.neville(u), (functions.exponent * value**2).exp()
        for name in NEVILLE:
            if name in families:
                z = of[name[-1]] * factor
                found[name] = _on_axes(z, u, odd=name == "theta_s", is_real=is_real)
    return found


def _third(request: FunctionRequest, values: Mapping[str, tuple[acb | None, acb | None]]) -> Values:
    """Return Omega and Pi, or their imaginary parts."""
    found, part = Values(), "_imag" if request.has_imaginary_part and request.is_real else ""
    for i, family in enumerate(("omega", "pi")):
        for ij in THIRD if family in request.families else ():
            z = values[ij][i]
            found[f"{family}{ij}{part}"] = acb(z.imag) if part and z is not None else z
    return found


def _on_axes(z: acb | None, u: Point, *, odd: bool, is_real: bool = True) -> acb | None:
    """Return an even or odd function of u, without parts that are 0 if it is real for real u."""
    if z is None or not is_real:
        return z
    if u.is_real:
        z = acb(z.real)
    if not any(u[::2]):
        z = acb(0, z.imag) if odd else acb(z.real)
    return z
