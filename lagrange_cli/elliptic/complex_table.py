"""Tables of functions of complex numbers and of any modulus."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.complex_balls import ComplexBalls, complex_balls
from ..arithmetic.points import MAX_PERIODS, MAX_TIME, ExactComplex, check_reach
from ..arithmetic.protocol import ComplexArithmetic, Numeric
from ..arithmetic.rounding import decided
from ..errors import LagtopError
from .any_modulus import AnyModulus, ModulusKind, any_constants, any_modulus
from .complex_theta import theta_at_place, zeta_at_place
from .complex_third_kind import Parameter, omega_at, parameter, pi_at
from .jacobi import complex_jacobi
from .modulus import ModulusInput
from .periods import INDICES, Lattice, Place, lattice, place_of
from .request import THIRD, ComplexPoints, FunctionRequest, known_parts, whole_quarters
from .tables import ProvedNumbers, TableOfFunctions

if TYPE_CHECKING:
    from .tables import Known

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
        third = {ij: kind.rounded() for ij, kind in self.third.items()}
        periods = self.periods and self.periods.rounded()
        return _ComplexConstants(self.modulus.rounded(), periods, third)


class ComplexTable(TableOfFunctions):
    """Tables of real and imaginary parts; u, am, sn, cn, dn of real arguments have one column.

    Raises LagtopError for a modulus out of range.  In doubles it also refuses a tiny modulus, and
    arguments or a parameter beyond 2^50 periods.
    """

    arithmetic = staticmethod(complex_balls)

    def __init__(self, arguments: ComplexPoints, request: FunctionRequest) -> None:
        super().__init__(arguments, arguments.real.count)
        self.request = request
        self.modulus_in = cache(lambda digits: any_modulus(complex_balls(digits), request.modulus))

    def known(self, x: ExactComplex) -> Known:
        """Return the parts that are known exactly at a point; a pole is NaN."""

        def known_in(digits: int) -> Known:
            given, height = self.modulus_in(digits), complex_balls(digits).convert(abs(x.imag))
            beyond = bool(height * given.across > 0.5)
            return known_parts(x, self.request, given, beyond=beyond)

        return decided("the branch points of am", known_in)

    def digits_lost(self, x: ExactComplex) -> int:
        """Return the number of digits taken by the whole periods of u and of the parameter."""
        k = self.request.modulus
        stretch = 1 if isinstance(k, ModulusInput) else 1 + k.real + k.imag
        return len(str(int(stretch * max(abs(part) for part in (*x, *self.request.parameter)))))

    def rounded_constants(self) -> _ComplexConstants:
        """Return the constants in doubles."""
        return decided(
            "the constants of these functions",
            lambda digits: self.constants(complex_balls(digits)).rounded(),
        )

    def constants(self, ar: ComplexBalls) -> _ComplexConstants:
        """Return the constants in balls."""
        request, given = self.request, self.modulus_in(ar.digits)
        periods = lattice(ar, given) if request.families != ("am",) else None
        third: dict[str, Parameter] = {}
        if periods and request.has_parameter:
            v = ar.convert(request.parameter)
            third = {ij: parameter(ar, ij, v, periods) for ij in THIRD}
        return _ComplexConstants(given, periods, third)

    def check(self, *, doubles: bool) -> None:
        """Raise LagtopError for a modulus out of range; see the class."""
        in_range = self._check_doubles if doubles else lambda _: None
        decided("the modulus", lambda digits: in_range(self.modulus_in(digits)))

    def _check_doubles(self, given: AnyModulus) -> None:
        """Raise LagtopError for moduli beyond the range of doubles, and for distant arguments."""
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
        check_reach("u", self.points.real, limits[0])
        if self.points.imag is not None:
            check_reach("the imaginary part of u", self.points.imag, limits[1])
        for part, limit in zip(self.request.parameter, limits, strict=True):
            if abs(part) > limit:
                raise LagtopError(
                    f"param must have parts within 2^50 periods = {limit:.3g} of 0, "
                    f"got {self.request.parameter} (or give --digits)",
                    "param",
                )

    def columns(
        self, ar: ComplexArithmetic, x: Numeric, constants: _ComplexConstants, known: Known
    ) -> dict[str, Numeric]:
        """Return the parts of the columns, without functions of which both parts are known."""
        u, parts, both = ar.convert(x), {}, {}
        if "am" in self.request.families:
            am, sn, cn, dn = complex_jacobi(ar, u, constants.modulus)
            am = am * (1 if self.request.radians else 180 / ar.pi)
            parts = {self.request.am: am, "sn": sn, "cn": cn, "dn": dn}
        parts = {"u": u} | parts
        if self.points.imag is None:
            parts = {name: ar.re(z) for name, z in parts.items()}
        else:
            parts, both = {}, parts
        if constants.periods is not None:
            at = place_of(ar, u, constants.periods)
            for name, compute in self._families(ar, at, constants, constants.periods):
                is_known = {f"{name}_re", f"{name}_im"} <= known.keys()
                both[name] = ar.mpc(ar.nan, ar.nan) if is_known else compute()
        parts |= _both(ar, both)
        if not ar.is_array:
            quarters = whole_quarters(x, self.request, constants.modulus.kind) & parts.keys()
            for name in quarters - known.keys():
                parts[name] = ar.nint(2 * parts[name] / ar.pi) * ar.pi / 2
        return parts

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
