"""What a table of functions of one modulus is asked for."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from .modulus_input import ModulusInput

THETA, THIRD = ("01", "00", "11", "10"), ("01", "00", "11")
"""The functions of one argument, and those of an argument and a parameter."""


class Request(NamedTuple):
    """What to evaluate: some families of functions, Omega and Pi with their parameter."""

    modulus: ModulusInput
    families: tuple[str, ...] = ("am",)
    """Some of am (with sn, cn and dn), theta, zeta, omega and pi."""
    parameter: Fraction = Fraction(0)
    imaginary: bool = False
    radians: bool = False
    in_quarters: bool = False
    """Whether the arguments are factors of K."""

    def in_doubles(self) -> Request:
        """Return the request with the parameter that its nearest double is."""
        return self._replace(parameter=Fraction(float(self.parameter)))

    @property
    def has_parameter(self) -> bool:
        """Whether Omega or Pi are among the families."""
        return bool({"omega", "pi"} & set(self.families))
