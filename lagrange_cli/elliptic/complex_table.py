"""Tables of functions of complex numbers and of any modulus."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from functools import cache, partial
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, ExactComplex, check_reach
from ..arithmetic.protocol import ComplexArithmetic, Numeric
from ..errors import LagtopError
from .any_modulus import AnyModulus, ModulusKind, any_constants, any_modulus
from .complex_theta import theta_at_place, zeta_at_place
from .complex_third_kind import Parameter, omega_at, parameter, pi_at
from .jacobi import complex_jacobi
from .many_digits import AgreeingNumbers, ManyDigits
from .modulus import ModulusInput
from .periods import INDICES, Lattice, Place, lattice, place_of
from .request import THIRD, ComplexPoints, FunctionRequest, known_parts
from .tables import TableOfFunctions

if TYPE_CHECKING:
    from ..arithmetic.text import NumberText
    from .tables import ArrayColumns, DigitRows

_LEAST = 1e-150
"""Least k and k' of the reduced modulus in doubles."""
_MOST = 1e20
"""Greatest k in doubles."""


class _ComplexConstants(NamedTuple):
    """Constants that depend only on the modulus and the parameter."""

    modulus: AnyModulus
    periods: Lattice | None
    """None if only am, sn, cn and dn are requested."""
    third: dict[str, Parameter]

    def rounded(self) -> _ComplexConstants:
        """Return the constants in doubles, for arrays."""
        third = {ij: kind.rounded(ARRAYS) for ij, kind in self.third.items()}
        return _ComplexConstants(self.modulus, self.periods and self.periods.rounded(ARRAYS), third)


class ComplexTable(TableOfFunctions):
    """Tables of real and imaginary parts; u, am, sn, cn, dn of real arguments have one column.

    Raises LagtopError for a modulus out of range.  In doubles it also refuses a tiny modulus, and
    arguments or a parameter beyond 2^50 periods.
    """

    def __init__(self, arguments: ComplexPoints, request: FunctionRequest) -> None:
        self.arguments, self.request, self.count = arguments, request, arguments.real.count

    def modulus_in(self, ar: ManyDigits) -> AnyModulus:
        """Return the modulus in a context; raise LagtopError if it is out of range."""
        modulus = self.request.modulus
        if isinstance(modulus, ModulusInput):
            return AnyModulus(ModulusKind.UNIT, modulus.in_digits(ar))
        return any_modulus(ar, modulus)

    def digit_rows(self, digits: int | None = None, *, short: bool = False) -> DigitRows:
        """Yield rows of numbers with N digits, on which two precisions agree."""
        assert digits is not None
        given, settled = self.modulus_in(ManyDigits()), AgreeingNumbers(digits)
        constants = cache(self._constants)

        def row(u: ExactComplex) -> dict[str, NumberText]:
            known = known_parts(u, self.request, given)

            def compute(ar: ManyDigits) -> dict[str, Numeric]:
                for far in (*u, *self.request.parameter):
                    settled.require(ar, abs(ar.convert(far)) * given.stretch)
                z = ar.mpc(ar.convert(u.real), ar.convert(u.imag))
                return known.cleared(ar, self._parts(ar, z, constants(ar), known.poles))

            return settled.texts(compute, known.names())

        return map(row, self.arguments.exactly())

    def array_columns(self) -> ArrayColumns:
        """Return the columns of a block of arguments in doubles, and the blocks."""
        exact = self._constants(ManyDigits())
        self._check_doubles(exact)
        ready = exact.rounded()
        return lambda u: self._parts(ARRAYS, u, ready), self.arguments.blocks()

    def _constants(self, ar: ManyDigits) -> _ComplexConstants:
        """Return the constants in an mpmath context."""
        request, given = self.request, self.modulus_in(ar)
        periods = lattice(ar, given) if request.families != ("am",) else None
        third: dict[str, Parameter] = {}
        if periods and request.has_parameter:
            v = ar.mpc(ar.convert(request.parameter.real), ar.convert(request.parameter.imag))
            third = {ij: parameter(ar, ij, v, periods) for ij in THIRD}
        return _ComplexConstants(given, periods, third)

    def _check_doubles(self, functions: _ComplexConstants) -> None:
        """Raise LagtopError for moduli beyond the range of doubles, and for distant arguments."""
        k, k_prime, _ = functions.modulus.modulus
        if functions.modulus.kind is ModulusKind.LARGE and functions.modulus.stretch > _MOST:
            raise LagtopError(f"k must be at most {_MOST:g} (or give --digits)", "k")
        if 0 < k < _LEAST or 0 < k_prime < _LEAST:
            raise LagtopError(
                f"k must be 0 or at least {_LEAST:g} in size, and so must k' (or give --digits)",
                "k",
            )
        periods = functions.periods
        if periods is None and not (k and k_prime):
            limits = MAX_TIME, MAX_TIME
        else:
            periods = periods or lattice(ManyDigits(), functions.modulus)
            limits = float(MAX_PERIODS / periods.scale), float(MAX_PERIODS / periods.across)
        check_reach("u", self.arguments.real, limits[0])
        if self.arguments.imag is not None:
            check_reach("the imaginary part of u", self.arguments.imag, limits[1])
        for part, limit in zip(self.request.parameter, limits, strict=True):
            if abs(part) > limit:
                raise LagtopError(
                    f"param must have parts within 2^50 periods = {limit:.3g} of 0, "
                    f"got {self.request.parameter} (or give --digits)",
                    "param",
                )

    def _parts(
        self,
        ar: ComplexArithmetic,
        u: Numeric,
        constants: _ComplexConstants,
        poles: Collection[str] = (),
    ) -> dict[str, Numeric]:
        """Return the parts of the functions at u by name; `poles` are NaN."""
        parts, both = {"u": u}, {}
        if "am" in self.request.families:
            am, sn, cn, dn = complex_jacobi(ar, u, constants.modulus)
            am = am * (1 if self.request.radians else 180 / ar.pi)
            parts |= {self.request.am: am, "sn": sn, "cn": cn, "dn": dn}
        if self.arguments.imag is None:
            parts = {name: ar.re(z) for name, z in parts.items()}
        else:
            parts, both = {}, parts
        if constants.periods is not None:
            at = place_of(ar, u, constants.periods)
            for name, compute in self._families(ar, at, constants, constants.periods):
                both[name] = ar.mpc(ar.nan, ar.nan) if name in poles else compute()
        return parts | _both(ar, both)

    def _families(
        self, ar: ComplexArithmetic, at: Place, functions: _ComplexConstants, periods: Lattice
    ) -> Iterator[tuple[str, Callable[[], Numeric]]]:
        """Yield the columns of the families by name, each with the function that computes it."""
        functions_of_u = {"theta": theta_at_place, "zeta": zeta_at_place}
        functions_of_both = {"omega": omega_at, "pi": pi_at}
        for family in self.request.families:
            if function := functions_of_u.get(family):
                yield from (
                    (f"{family}{ij}", partial(function, ar, ij, at, periods)) for ij in INDICES
                )
            elif third := functions_of_both.get(family):
                for ij, kind in functions.third.items():
                    yield f"{family}{ij}", partial(third, ar, at, kind)


def any_constants_record(modulus: ExactComplex, digits: int | None) -> dict[str, Numeric]:
    """Return constants of a modulus that is imaginary or above 1, in real and imaginary parts."""

    def compute(ar: ManyDigits) -> dict[str, Numeric]:
        return _both(ar, any_constants(ar, modulus))

    if digits is None:
        return {name: float(x) for name, x in compute(ManyDigits()).items()}
    zeros = "k_re k_prime_im nome_im K_im E_im"
    if not modulus.imag:
        zeros = "k_im k_prime_re K_prime_im E_prime_im"
    return AgreeingNumbers(digits).texts(compute, zeros.split())


def _both(ar: ComplexArithmetic, columns: dict[str, Numeric]) -> dict[str, Numeric]:
    """Return the real and the imaginary part of every column."""
    return {
        f"{name}{suffix}": part(z)
        for name, z in columns.items()
        for suffix, part in (("_re", ar.re), ("_im", ar.im))
    }
