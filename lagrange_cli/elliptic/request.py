"""What a table of functions of one modulus is asked for: modulus, families, and arguments."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.points import ExactComplex
from .modulus_input import ModulusInput

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..arithmetic.protocol import Value

THETA, THIRD = ("01", "00", "11", "10"), ("01", "00", "11")
"""The functions of one argument, and those of an argument and a parameter."""


class FunctionRequest(NamedTuple):
    """What to evaluate: some families of functions, Omega and Pi with their parameter."""

    modulus: ModulusInput | ExactComplex
    """A modulus in [0, 1] by one of its names, or one that is imaginary or above 1."""
    families: tuple[str, ...] = ("am",)
    """Some of am (with sn, cn and dn), theta, zeta, omega and pi."""
    parameter: ExactComplex = ExactComplex(Fraction(0))
    imaginary: bool = False
    """Whether a table of real functions has an imaginary parameter, of which 0i is one."""
    radians: bool = False
    in_quarters: bool = False
    """Whether the arguments, which are real, are factors of K."""

    @property
    def am(self) -> str:
        """The name of the column of am, with its unit."""
        return "am_rad" if self.radians else "am_deg"

    @property
    def real_modulus(self) -> ModulusInput:
        """The modulus of a table of real functions."""
        assert isinstance(self.modulus, ModulusInput)
        return self.modulus

    @property
    def size(self) -> Fraction:
        """The parameter of a table of real functions or, of an imaginary one, the parameter/i."""
        return self.parameter.imag if self.imaginary else self.parameter.real

    @property
    def has_parameter(self) -> bool:
        """Whether Omega or Pi are among the families."""
        return bool({"omega", "pi"} & set(self.families))

    def in_doubles(self) -> FunctionRequest:
        """Return the request with the parameter that its nearest double is."""
        return self._replace(parameter=self.parameter.nearest())


class Arguments(NamedTuple):
    """Arguments by their real parts and, if some are not real, their imaginary parts."""

    real: Points
    imag: Points | None = None

    def blocks(self) -> Iterator[Value]:
        """Yield all of them as complex arrays."""
        if self.imag is None:
            yield from (block + 0j for block in self.real.blocks())
        else:
            pairs = zip(self.real.blocks(), self.imag.blocks(), strict=True)
            yield from (real + 1j * imag for real, imag in pairs)

    def exactly(self) -> Iterator[ExactComplex]:
        """Yield every one exactly."""
        if self.imag is None:
            yield from map(ExactComplex, self.real.decimals())
        else:
            yield from map(ExactComplex, self.real.decimals(), self.imag.decimals())
