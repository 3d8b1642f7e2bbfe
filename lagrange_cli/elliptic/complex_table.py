"""Tables of functions of complex numbers and of any modulus, in doubles or to so many digits."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import cache, partial
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.exact_complex import ExactComplex
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, check_reach
from ..arithmetic.protocol import ComplexArithmetic, Value
from ..errors import LagtopError
from .agreeing_digits import Settled, settled_or_rounded
from .any_modulus import AnyModulus, Kind, any_constants, any_modulus
from .complex_jacobi import complex_jacobi
from .complex_known import known_parts
from .complex_request import ComplexPoints, ComplexRequest
from .complex_theta import theta_at_place, zeta_at_place
from .complex_third_kind import Parameter, omega_at, parameter, pi_at
from .lattice import Lattice, Place, lattice, place
from .request import THETA, THIRD

if TYPE_CHECKING:
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array

_LEAST = 1e-150
"""Least k and k' in doubles, of the modulus that another one is reduced to."""
_MOST = 1e20
"""Greatest k above 1 in doubles."""


class _Functions(NamedTuple):
    """What follows from the modulus and the parameter alone."""

    modulus: AnyModulus
    periods: Lattice | None
    """None where am, sn, cn, dn alone are asked for."""
    third: dict[str, Parameter]

    def rounded(self) -> _Functions:
        """Return them for arrays."""
        third = {ij: kind.rounded(ARRAYS) for ij, kind in self.third.items()}
        return _Functions(self.modulus, self.periods and self.periods.rounded(ARRAYS), third)


def complex_rows(
    arguments: ComplexPoints, request: ComplexRequest
) -> tuple[list[str], Iterator[Array]]:
    """Return the header, and blocks of rows in doubles; a pole is not a number.

    Raises LagtopError, before any row, for a modulus, arguments or a parameter out of range.
    """
    import numpy as np

    request = request._replace(parameter=request.parameter.nearest())
    functions = _functions(ManyDigits(), request)
    _check_doubles(functions, arguments, request)
    ready, real = functions.rounded(), arguments.imag is None

    def parts(u: Value) -> dict[str, Value]:
        with np.errstate(all="ignore"):  # poles, and what leaves the doubles, end as empty cells
            return _parts(ARRAYS, _columns(ARRAYS, u, ready, request), real=real)

    def block(u: Value) -> Array:
        found = parts(u)
        table = np.stack(list(found.values()), axis=1)
        for i, name in enumerate(found):
            if name.endswith("_re"):
                pair = table[:, i : i + 2]
                pair[~np.isfinite(pair).all(axis=1)] = np.nan
        return np.where(np.isfinite(table), table, np.nan) + 0.0  # no -0

    return list(parts(next(arguments.blocks())[:1])), map(block, arguments.blocks())


def complex_digit_rows(
    arguments: ComplexPoints, request: ComplexRequest, digits: int
) -> tuple[list[str], Iterator[list[NumberText]]]:
    """Return the header, and rows to so many significant digits; a pole is an empty text.

    Raises LagtopError for a modulus out of range, before any row.
    """
    kind, _, stretch = request.modulus_in(ManyDigits())
    settled = Settled(digits)

    @cache
    def constants(ar: ManyDigits) -> _Functions:
        return _functions(ar, request)

    def at(u: ExactComplex) -> dict[str, NumberText]:
        known = known_parts(u, request, kind)

        def compute(ar: ManyDigits) -> dict[str, Value]:
            for far in (*u, *request.parameter):
                settled.require(ar, abs(ar.convert(far)) * stretch)
            z = ar.mpc(ar.convert(u.real), ar.convert(u.imag))
            columns = _columns(ar, z, constants(ar), request, known.poles)
            return known.cleared(ar, _parts(ar, columns, real=arguments.imag is None))

        return settled.texts(compute, known.names())

    header = list(at(next(arguments.exactly())))
    return header, (list(at(u).values()) for u in arguments.exactly())


def any_constants_record(modulus: ExactComplex, digits: int | None = None) -> dict[str, Value]:
    """Return the constants of a modulus that is imaginary or above 1, by their two parts."""

    def compute(ar: ManyDigits) -> dict[str, Value]:
        given = any_modulus(ar, modulus)
        k_prime, K, K_prime, E, E_prime, q = any_constants(ar, given)
        k = ar.mpc(ar.convert(modulus.real), ar.convert(modulus.imag))
        columns = {"k": k, "k_prime": k_prime, "nome": q, "K": K, "K_prime": K_prime}
        return _both(ar, columns | {"E": E, "E_prime": E_prime})

    real = "k_re k_prime_im nome_im K_im E_im" if modulus.imag else "k_im k_prime_re"
    return settled_or_rounded(
        compute, digits, f"{real} {'' if modulus.imag else 'K_prime_im E_prime_im'}".split()
    )


def _functions(ar: ManyDigits, request: ComplexRequest) -> _Functions:
    """Return the constants of a request in an mpmath context."""
    given = request.modulus_in(ar)
    periods = lattice(ar, given) if request.families != ("am",) else None
    third: dict[str, Parameter] = {}
    if periods and {"omega", "pi"} & set(request.families):
        v = ar.mpc(ar.convert(request.parameter.real), ar.convert(request.parameter.imag))
        third = {ij: parameter(ar, ij, v, periods) for ij in THIRD}
    return _Functions(given, periods, third)


def _check_doubles(
    functions: _Functions, arguments: ComplexPoints, request: ComplexRequest
) -> None:
    """Raise LagtopError for what doubles cannot name: tiny moduli, and arguments too far away."""
    k, k_prime, _ = functions.modulus.modulus
    if functions.modulus.kind is Kind.LARGE and functions.modulus.stretch > _MOST:
        raise LagtopError(f"k must be at most {_MOST:g} (or give --digits)", "k")
    if 0 < k < _LEAST or 0 < k_prime < _LEAST:
        raise LagtopError(
            f"k must be farther than {_LEAST:g} from 0 and so that k' is not smaller "
            "(or give --digits)",
            "k",
        )
    periods = functions.periods
    if periods is None and not (k and k_prime):
        limits = MAX_TIME, MAX_TIME
    else:
        periods = periods or lattice(ManyDigits(), functions.modulus)
        limits = float(MAX_PERIODS / periods.scale), float(MAX_PERIODS / periods.across)
    check_reach("u", arguments.real, limits[0])
    if arguments.imag is not None:
        check_reach("the imaginary part of u", arguments.imag, limits[1])
    for part, limit in zip(request.parameter, limits, strict=True):
        if abs(part) > limit:
            raise LagtopError(
                f"param must have parts within 2^50 periods = {limit:.3g} of 0, "
                f"got {request.parameter} (or give --digits)",
                "param",
            )


def _columns(
    ar: ComplexArithmetic,
    u: Value,
    functions: _Functions,
    request: ComplexRequest,
    without: Collection[str] = (),
) -> dict[str, Value]:
    """Return the functions at u by their names; those `without` a value are not numbers."""
    columns, periods = {"u": u}, functions.periods
    if "am" in request.families:
        unit, turn = ("rad", 1) if request.radians else ("deg", 180 / ar.pi)
        am, sn, cn, dn = complex_jacobi(ar, u, functions.modulus)
        columns |= {f"am_{unit}": am * turn, "sn": sn, "cn": cn, "dn": dn}
    if periods is None:
        return columns
    for name, compute in _families(ar, place(ar, u, periods), functions, periods, request):
        columns[name] = ar.mpc(ar.nan, ar.nan) if name in without else compute()
    return columns


def _families(
    ar: ComplexArithmetic,
    at: Place,
    functions: _Functions,
    periods: Lattice,
    request: ComplexRequest,
) -> Iterator[tuple[str, Callable[[], Value]]]:
    """Yield the columns of the families by name, and how to compute each."""
    for family in request.families:
        if family == "am":
            continue
        if family in {"theta", "zeta"}:
            function = theta_at_place if family == "theta" else zeta_at_place
            for ij in THETA:
                yield f"{family}{ij}", partial(function, ar, ij, at, periods)
        else:
            for ij, kind in functions.third.items():
                yield (
                    f"{family}{ij}",
                    partial(omega_at if family == "omega" else pi_at, ar, at, kind),
                )


def _parts(ar: ComplexArithmetic, columns: dict[str, Value], *, real: bool) -> dict[str, Value]:
    """Return the parts of the columns; u, am, sn, cn, dn are real at real arguments."""
    single = columns.keys() & {"u", "am_deg", "am_rad", "sn", "cn", "dn"} if real else set()
    parts = {name: ar.re(z) for name, z in columns.items() if name in single}
    return parts | _both(ar, {name: z for name, z in columns.items() if name not in parts})


def _both(ar: ComplexArithmetic, columns: dict[str, Value]) -> dict[str, Value]:
    """Return the real and the imaginary part of every column."""
    return {
        f"{name}{suffix}": part(z)
        for name, z in columns.items()
        for suffix, part in (("_re", ar.re), ("_im", ar.im))
    }
