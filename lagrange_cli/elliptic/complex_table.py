"""Tables of functions of complex numbers and of any modulus."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from fractions import Fraction
from functools import cache, partial
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.complex_balls import ComplexBalls, complex_balls
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, ExactComplex, check_reach
from ..arithmetic.protocol import ComplexArithmetic, Numeric
from ..arithmetic.rounding import decided
from ..errors import LagtopError
from .any_modulus import AnyModulus, ModulusKind, any_constants, any_modulus, reduced_modulus
from .complex_theta import theta_at_place, zeta_at_place
from .complex_third_kind import Parameter, omega_at, parameter, pi_at
from .jacobi import complex_jacobi
from .modulus import ModulusInput
from .periods import INDICES, Lattice, Place, lattice, place_of
from .request import THIRD, ComplexPoints, FunctionRequest, Known, known_parts
from .tables import ProvedNumbers, TableOfFunctions

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

    def rounded(self, ar: ComplexArithmetic) -> _ComplexConstants:
        """Return the constants in doubles, for arrays."""
        third = {ij: kind.rounded(ar) for ij, kind in self.third.items()}
        periods = self.periods and self.periods.rounded(ar)
        return _ComplexConstants(self.modulus.rounded(), periods, third)


class ComplexTable(TableOfFunctions):
    """Tables of real and imaginary parts; u, am, sn, cn, dn of real arguments have one column.

    Raises LagtopError for a modulus out of range.  In doubles it also refuses a tiny modulus, and
    arguments or a parameter beyond 2^50 periods.
    """

    def __init__(self, arguments: ComplexPoints, request: FunctionRequest) -> None:
        self.arguments, self.request, self.count = arguments, request, arguments.real.count

    def modulus_in(self, ar: ComplexBalls) -> AnyModulus:
        """Return the modulus in balls; raise LagtopError if it is out of range."""
        modulus = self.request.modulus
        if isinstance(modulus, ModulusInput):
            return reduced_modulus(ar, ModulusKind.UNIT, modulus.in_digits(ar))
        return any_modulus(ar, modulus)

    def digit_rows(self, digits: int | None = None, *, short: bool = False) -> DigitRows:
        """Yield rows of proved numbers; see `TableOfFunctions`."""
        numbers = ProvedNumbers(digits, short=short, arithmetic=complex_balls)
        constants, modulus_in = cache(self._constants), cache(self.modulus_in)
        request, k = self.request, self.request.modulus
        stretch = Fraction(1) if isinstance(k, ModulusInput) else 1 + k.real + k.imag

        def row(u: ExactComplex) -> dict[str, NumberText]:
            def known_in(digits: int) -> Known:
                given = modulus_in(ar := complex_balls(digits))
                beyond = bool(abs(ar.im(u)) * given.across > 0.5)
                return known_parts(u, request, given, beyond=beyond)

            known = decided("the branch points of am", known_in)

            def compute(ar: ComplexBalls) -> dict[str, Numeric]:
                return known.settled(ar, self._parts(ar, u, constants(ar), known.poles))

            far = max(abs(part) for part in (*u, *request.parameter)) * stretch
            return numbers.texts(compute, known.values(), len(str(int(far))))

        return map(row, self.arguments.exactly())

    def array_columns(self) -> ArrayColumns:
        """Return the columns of a block of arguments in doubles, and the blocks."""
        from ..arithmetic.arrays import ARRAYS  # start-up

        def rounded(digits: int) -> _ComplexConstants:
            exact = self._constants(complex_balls(digits))
            self._check_doubles(exact)
            return exact.rounded(ARRAYS)

        ready = decided("the constants of these functions", rounded)
        return lambda u: self._parts(ARRAYS, u, ready), self.arguments.blocks()

    def _constants(self, ar: ComplexBalls) -> _ComplexConstants:
        """Return the constants in balls."""
        request, given = self.request, self.modulus_in(ar)
        periods = lattice(ar, given) if request.families != ("am",) else None
        third: dict[str, Parameter] = {}
        if periods and request.has_parameter:
            third = {ij: parameter(ar, ij, request.parameter, periods) for ij in THIRD}
        return _ComplexConstants(given, periods, third)

    def _check_doubles(self, functions: _ComplexConstants) -> None:
        """Raise LagtopError for moduli beyond the range of doubles, and for distant arguments."""
        given = functions.modulus
        k, k_prime, _ = given.modulus
        if given.kind is ModulusKind.LARGE and given.stretch > _MOST:
            raise LagtopError(f"k must be at most {_MOST:g} (or give --digits)", "k")
        if 0 < k < _LEAST or 0 < k_prime < _LEAST:
            raise LagtopError(
                f"k must be 0 or at least {_LEAST:g} in size, and so must k' (or give --digits)",
                "k",
            )
        limits = MAX_TIME, MAX_TIME
        if k and k_prime:
            limits = float(MAX_PERIODS / given.scale), float(MAX_PERIODS / given.across)
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

    def compute(ar: ComplexBalls) -> dict[str, Numeric]:
        return _both(ar, any_constants(ar, modulus))

    return ProvedNumbers(digits, arithmetic=complex_balls).of(compute)


def _both(ar: ComplexArithmetic, columns: dict[str, Numeric]) -> dict[str, Numeric]:
    """Return the real and the imaginary part of every column."""
    return {
        f"{name}{suffix}": part(z)
        for name, z in columns.items()
        for suffix, part in (("_re", ar.re), ("_im", ar.im))
    }
