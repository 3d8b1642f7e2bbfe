"""What a table of functions of complex numbers is asked for: a modulus, families, and arguments."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from ..arithmetic.exact_complex import ExactComplex
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.points import Points
from ..arithmetic.protocol import Value
from .any_modulus import AnyModulus, Kind, any_modulus
from .modulus_input import ModulusInput


class ComplexRequest(NamedTuple):
    """A modulus of any kind, some families of functions, and a parameter."""

    modulus: ModulusInput | ExactComplex
    families: tuple[str, ...] = ("am",)
    parameter: ExactComplex = ExactComplex(Fraction(0))
    radians: bool = False

    def modulus_in(self, ar: ManyDigits) -> AnyModulus:
        """Return the modulus in a context.  Raises LagtopError where it is out of range."""
        if isinstance(self.modulus, ExactComplex):
            return any_modulus(ar, self.modulus)
        return AnyModulus(Kind.UNIT, self.modulus.in_digits(ar))


class ComplexPoints(NamedTuple):
    """Arguments by their real parts and, where some are not real, their imaginary parts."""

    real: Points
    imag: Points | None = None

    def blocks(self) -> Iterator[Value]:
        """Yield all of them as arrays."""
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
