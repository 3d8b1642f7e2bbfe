"""Tables of Legendre's F(phi, k) and E(phi, k) of one modulus."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from ..arithmetic.balls import Balls
from ..arithmetic.exact_cosine import below_quarters
from ..arithmetic.points import MAX_PERIODS, Points, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Value
from .incomplete import e_of, f_of, in_degrees, in_radians
from .modulus import Modulus
from .modulus_input import ModulusInput
from .tables import RealTable

if TYPE_CHECKING:
    from .tables import Known


class AmplitudeTable(RealTable):
    """F and E of amplitudes phi, which are in radians if the modulus is, else in degrees.

    F is infinite for k = 1 from a quarter turn on.  Raises LagtopError for a modulus out of range
    and, in doubles, for amplitudes beyond 2^50 half turns.
    """

    functions = 2

    def __init__(self, points: Points, modulus_input: ModulusInput) -> None:
        super().__init__(points)
        self.modulus, self.radians = modulus_input, modulus_input.radians

    def in_doubles(self) -> AmplitudeTable:
        """Return the table itself."""
        self.check()
        check_reach("phi", self.points, MAX_PERIODS * (math.pi if self.radians else 180.0))
        self.modulus.in_doubles()
        return self

    def check(self) -> None:
        """Raise LagtopError for a modulus out of range."""
        self.modulus.check()

    def constants(self, ar: Balls) -> Modulus:
        """Return the modulus in balls."""
        return self.modulus.in_digits(ar)

    def rounded_constants(self) -> Modulus:
        """Return the modulus in doubles."""
        return self.modulus.in_doubles()

    def columns(
        self, ar: FunctionArithmetic, x: Value, constants: Modulus, known: Known
    ) -> dict[str, Value]:
        """Return the amplitudes, F and E."""
        name, reduced = ("phi_rad", in_radians) if self.radians else ("phi_deg", in_degrees)
        phi = reduced(ar, x)
        return {name: x, "F": f_of(ar, phi, constants), "E": e_of(ar, phi, constants)}

    def known(self, x: Fraction) -> dict[str, float]:
        """Return 0 at 0, and where F is infinite."""
        names = () if x else ("phi_rad", "phi_deg", "F", "E")
        known: dict[str, float] = dict.fromkeys(names, 0)
        beyond = below_quarters(1, abs(x)) < 0 if self.radians else abs(x) >= 90
        if "k_prime" in self.modulus.zeros() and beyond:
            known["F"] = math.inf
        return known

    def digits_lost(self, x: Fraction) -> int:
        """Return how many digits the half turns of an amplitude take."""
        return len(str(int(abs(x))))
