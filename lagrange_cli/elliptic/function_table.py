"""What `lagtop jacobi` shows: the constants of a modulus, its functions, the nome series."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.correct_digits import require_digits, settle, settled_or_rounded
from ..arithmetic.double_double import pair
from ..arithmetic.generic import Arithmetic, Real, many_digits, number
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, check_reach
from ..arithmetic.text import double_text
from ..errors import LagtopError
from . import complete_k
from .jacobi import jacobi
from .modulus import Modulus, constants, modulus
from .nome_series import am_sums, cn_sums, k_sums, sn_sums
from .theta import Complex, omega, pi_function, theta_of, zeta

if TYPE_CHECKING:
    from ..arithmetic.correct_digits import NumberText
    from ..arithmetic.points import Points
    from ..arithmetic.types import Array

ONE_ARGUMENT = {"theta": theta_of, "zeta": zeta}
TWO_ARGUMENTS = {"omega": omega, "pi": pi_function}


class Given(NamedTuple):
    """A modulus as it was given: k, k_prime, angle (degrees, or radians) or q, and its value."""

    name: str
    value: Fraction
    radians: bool = False

    def modulus(self, ar: Arithmetic) -> Modulus:
        """It in an mpmath context.  Raises LagtopError where it is out of range."""
        if self.name != "angle" or self.radians:
            return modulus(ar, **{self.name: number(ar, self.value)})
        if not 0 <= self.value <= 90:
            raise LagtopError(f"modular_angle_deg must be in [0, 90], got {float(self.value)}")
        if self.value == 90:
            return modulus(ar, k_prime=0)
        return modulus(ar, angle=ar.pi * number(ar, self.value) / 180)


class Request(NamedTuple):
    """What to evaluate: am, sn, cn, dn and these families, Omega and Pi with their parameter."""

    given: Given
    families: tuple[str, ...] = ()
    parameter: Fraction = Fraction(0)
    imaginary: bool = False
    radians: bool = False


def constants_in(ar: Arithmetic, given: Given) -> dict[str, Real]:
    """The record of a modulus in an mpmath context; None for what is infinite."""
    of = given.modulus(ar)
    K, K_prime, E, E_prime, q = constants(ar, of)
    other = constants(ar, Modulus(of.k_prime, of.k)).q
    unit = "rad" if given.radians else "deg"
    angle = ar.atan2(of.k, of.k_prime) * (1 if given.radians else 180 / ar.pi)
    return {
        "k": of.k,
        "k_prime": of.k_prime,
        f"modular_angle_{unit}": angle,
        "nome": q,
        "nome_prime": other,
        "K": None if ar.isinf(K) else K,
        "K_prime": None if ar.isinf(K_prime) else K_prime,
        "E": E,
        "E_prime": E_prime,
    }


def constants_record(given: Given, digits: int | None = None) -> dict[str, Any]:
    """The record, each number the nearest double or to so many significant digits."""
    return settled_or_rounded(lambda ar: constants_in(ar, given), digits)


def values(ar: Arithmetic, u: Real, of: Modulus, request: Request) -> dict[str, Real]:
    """The columns at u, in either arithmetic; what is imaginary by its imaginary part."""
    unit = ("rad", 1) if request.radians else ("deg", 180 / ar.pi)
    am, sn, cn, dn = jacobi(ar, u, of)
    columns = {"u": u, f"am_{unit[0]}": am * unit[1], "sn": sn, "cn": cn, "dn": dn}
    for family in request.families:
        if family in ONE_ARGUMENT:
            for ij in "01 00 11 10".split():
                columns[f"{family}{ij}"] = ONE_ARGUMENT[family](ar, ij, u, of)
        else:
            for ij in "01 00 11".split():
                value = TWO_ARGUMENTS[family](ar, ij, u, _parameter(ar, request), of)
                columns |= _real_column(ar, f"{family}{ij}", value, request.imaginary)
    return columns


def _parameter(ar: Arithmetic, request: Request) -> Complex:
    value = number(ar, request.parameter)
    if not request.imaginary:
        return value
    return ar.mpc(0, value) if hasattr(ar, "mpc") else 1j * value


def _real_column(ar: Arithmetic, name: str, value: Complex, imaginary: bool) -> dict[str, Real]:
    if not imaginary:
        return {name: value}
    return {f"{name}_imag": ar.im(value) if hasattr(ar, "im") else ar.imag(value)}


def rows(arguments: Points, request: Request) -> tuple[list[str], Iterator[Array]]:
    """The header, and blocks of rows in doubles.  Raises LagtopError before the first block."""
    import numpy as np

    exact = request.given.modulus(many_digits())
    of = Modulus(float(exact.k), *pair(exact.k_prime))
    if exact.k_prime > 0 and not of.k_prime:
        raise LagtopError("k' is too small for doubles: give --digits")
    limit = MAX_PERIODS * 2 * float(complete_k(np, of.k_prime)) if of.k_prime else MAX_TIME
    check_reach("u", arguments, min(limit, MAX_TIME))

    def columns(u: Array) -> dict[str, Array]:
        with np.errstate(divide="ignore", invalid="ignore"):
            return values(np, u, of, request)

    header = list(columns(np.array(arguments.bounds())))

    def block(u: Array) -> Array:
        together = np.stack(list(columns(u).values()), axis=1)
        together[np.isinf(together)] = np.nan  # the poles of Zeta, Omega and Pi: no number
        return together

    return header, (block(u) for u in arguments.blocks())


def digit_rows(
    arguments: Points, request: Request, digits: int
) -> tuple[list[str], Iterator[list[NumberText]]]:
    """The header, and rows to so many significant digits."""

    def at(u: Fraction) -> dict[str, NumberText]:
        def compute(ar: Arithmetic) -> dict[str, Real]:
            require_digits(ar, digits, abs(number(ar, u)))
            return values(ar, number(ar, u), request.given.modulus(ar), request)

        return settle(compute, digits)

    header = list(at(next(arguments.decimals())))
    return header, (list(at(u).values()) for u in arguments.decimals())


def series_rows(given: Given, u: Fraction | None, terms: int) -> tuple[list[str], list[list[str]]]:
    """Partial sums 1 to `terms` of (3.1.8) for K and, at u, of (3.1.7), (3.1.4), (3.1.5) for am,
    sn, cn, each with its error.

    Raises LagtopError for k = 0 and k = 1, where the series are limits.
    """
    ar = many_digits()
    of = given.modulus(ar)
    if not (of.k and of.k_prime):
        raise LagtopError(f"the nome series need 0 < k < 1, got k = {float(of.k)}")
    sums: dict[str, tuple[Iterator[Real], Real]] = {
        "K": (k_sums(ar, of), complete_k(ar, of.k_prime))
    }
    if u is not None:
        x, unit = number(ar, u), 1 if given.radians else 180 / ar.pi
        am, sn, cn, _ = jacobi(ar, x, of)
        from_first_term = islice(am_sums(ar, x, of), 1, None)
        sums["am_rad" if given.radians else "am_deg"] = (
            (unit * part for part in from_first_term),
            unit * am,
        )
        sums |= {"sn": (sn_sums(ar, x, of), sn), "cn": (cn_sums(ar, x, of), cn)}
    header = ["terms", *(name for key in sums for name in (key, f"{key}_error"))]
    exact = [value for _, value in sums.values()]
    table = []
    for n, row in enumerate(zip(*(parts for parts, _ in sums.values()), strict=False), 1):
        pairs = zip(row, exact, strict=True)
        cells = (x for part, true in pairs for x in (part, abs(part - true)))
        table.append([str(n), *(double_text(float(x)) for x in cells)])
        if n == terms:
            break
    return header, table
