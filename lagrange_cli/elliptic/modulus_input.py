"""A modulus as the user names it, and the record of its constants."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.balls import balls
from ..arithmetic.exact_cosine import Cosine, below_quarters
from ..arithmetic.rounding import decided, pair
from ..errors import LagtopError
from .modulus import Modulus, constants, exact_modulus, modulus
from .proved_numbers import ProvedNumbers

if TYPE_CHECKING:
    from ..arithmetic.protocol import FunctionArithmetic, Value


class ModulusInput(NamedTuple):
    """A modulus as the user named it: k, k_prime, modular_angle (degrees, or radians) or nome."""

    name: str
    value: Fraction
    radians: bool = False

    def check(self) -> None:
        """Raise LagtopError unless the modulus is in its range."""
        most, end = {"modular_angle": (90.0, "90]"), "nome": (1.0, "1)")}.get(
            self.name, (1.0, "1]")
        )
        is_high = self.value > most or (self.name == "nome" and self.value == 1)
        if self.name == "modular_angle" and self.radians:
            is_high, end = below_quarters(1, self.value) < 0, "pi/2]"
        if self.value < 0 or is_high:
            value = float(self.value)
            raise LagtopError(f"{self.name} must be in [0, {end}, got {value}", self.name)

    def zeros(self) -> set[str]:
        """Return the constants that are exactly 0."""
        ends = {"k": 1, "k_prime": 1, "modular_angle": None if self.radians else 90, "nome": None}
        is_one = self.value == ends[self.name]  # pi/2 is irrational
        k_vanishes = is_one if self.name == "k_prime" else not self.value
        complement_vanishes = not self.value if self.name == "k_prime" else is_one
        zeros = {"k", "nome", "modular_angle_deg", "modular_angle_rad"} if k_vanishes else set()
        return zeros | ({"k_prime", "nome_prime"} if complement_vanishes else set())

    def in_digits(self, ar: FunctionArithmetic) -> Modulus:
        """Return the modulus in balls or an mpmath context, k and k' with all their digits.

        Raises LagtopError where it is out of range.
        """
        self.check()
        if self.name == "nome":
            return modulus(ar, q=ar.convert(self.value))
        if self.name == "modular_angle":
            angles = (None, self.value) if self.radians else (self.value, None)
            tilt = Cosine(*angles).tilt(ar)
            return Modulus(tilt.sin, tilt.cos)
        exact = exact_modulus(ar, self.value)
        return exact if self.name == "k" else Modulus(exact.k_prime, exact.k)

    def in_doubles(self) -> Modulus:
        """Return the modulus rounded once, k' as two doubles.

        Raises LagtopError where it is out of range, or k' is too small for a double.
        """

        def rounded(digits: int) -> Modulus:
            exact = self.in_digits(balls(digits))
            return Modulus(float(exact.k), *pair(exact.k_prime))

        found = decided(self.name, rounded)
        if not found.k_prime and "k_prime" not in self.zeros():
            raise LagtopError(
                f"{self.name}: k' is too small for doubles (give --digits)", self.name
            )
        return found


def constants_in(ar: FunctionArithmetic, modulus_input: ModulusInput) -> dict[str, Value]:
    """Return the record of a modulus in the digits of an arithmetic; None for what is infinite."""
    exact, zeros = modulus_input.in_digits(ar), modulus_input.zeros()
    K, K_prime, E, E_prime, q = constants(ar, exact)
    other = constants(ar, Modulus(exact.k_prime, exact.k)).q
    unit = "rad" if modulus_input.radians else "deg"
    angle = ar.atan2(exact.k, exact.k_prime) * (1 if modulus_input.radians else 180 / ar.pi)
    return {
        "k": exact.k,
        "k_prime": exact.k_prime,
        f"modular_angle_{unit}": angle,
        "nome": q,
        "nome_prime": other,
        "K": None if "k_prime" in zeros else K,
        "K_prime": None if "k" in zeros else K_prime,
        "E": E,
        "E_prime": E_prime,
    }


def constants_record(modulus_input: ModulusInput, digits: int | None) -> dict[str, Any]:
    """Return the record, each number the nearest double or to so many significant digits."""
    return ProvedNumbers(digits).of(
        lambda ar: constants_in(ar, modulus_input), dict.fromkeys(modulus_input.zeros(), 0)
    )
