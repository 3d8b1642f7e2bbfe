"""Tables of Legendre's F(phi, k) and E(phi, k) of one modulus, in doubles or any digits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.points import MAX_PERIODS, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Value
from .incomplete import e_of, f_of, in_degrees, in_radians
from .modulus import Modulus
from .modulus_input import ModulusInput
from .proved_digits import require_digits, settled_texts

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array


def header(modulus_input: ModulusInput) -> list[str]:
    """Return the names of the columns: the amplitude with its unit, F and E."""
    return ["phi_rad" if modulus_input.radians else "phi_deg", "F", "E"]


def rows(amplitudes: Points, modulus_input: ModulusInput) -> Iterator[Array]:
    """Return blocks of rows in doubles; what is infinite (F for k = 1) is not a number.

    Amplitudes are in degrees, or in radians where the modulus is.  Raises LagtopError before the
    first block for amplitudes beyond 2^50 half turns and for a modulus out of range.
    """
    import numpy as np

    half_turn = math.pi if modulus_input.radians else 180.0
    check_reach("phi", amplitudes, MAX_PERIODS * half_turn)
    modulus = modulus_input.in_doubles()

    def block(phi: Array) -> Array:
        together = np.stack([phi, *_integrals(ARRAYS, phi, modulus, modulus_input.radians)], axis=1)
        together[np.isinf(together)] = np.nan
        return together + 0.0  # no -0

    return (block(phi) for phi in amplitudes.blocks())


def digit_rows(
    amplitudes: Points, modulus_input: ModulusInput, digits: int
) -> Iterator[list[NumberText]]:
    """Return rows to so many significant digits; what is infinite is an empty text."""
    names = header(modulus_input)
    modulus_input.check()
    endless = {"F"} if "k_prime" in modulus_input.zeros() else set()

    def at(phi: Fraction) -> list[NumberText]:
        def compute(ar: ManyDigits) -> dict[str, Value]:
            require_digits(ar, digits, abs(ar.convert(phi)))
            modulus, exact = modulus_input.in_digits(ar), ar.convert(phi)
            integrals = _integrals(ar, exact, modulus, modulus_input.radians)
            return dict(zip(names, (exact, *integrals), strict=True))

        known = names if phi == 0 else endless
        return list(settled_texts(compute, digits, known).values())

    return (at(phi) for phi in amplitudes.decimals())


def _integrals(
    ar: FunctionArithmetic, phi: Value, modulus: Modulus, radians: bool
) -> tuple[Value, Value]:
    """Return F and E."""
    amplitude = (in_radians if radians else in_degrees)(ar, phi)
    return f_of(ar, amplitude, modulus), e_of(ar, amplitude, modulus)
