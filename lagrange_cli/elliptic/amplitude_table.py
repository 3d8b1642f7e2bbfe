"""Tables of Legendre's F(phi, k) and E(phi, k) of one modulus, in doubles or any digits."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING

from ..arithmetic.ball_functions import BallFunctions
from ..arithmetic.points import MAX_PERIODS, check_reach
from ..arithmetic.protocol import FunctionArithmetic, Value
from .incomplete import e_of, f_of, in_degrees, in_radians
from .modulus import Modulus
from .modulus_input import ModulusInput
from .proved_numbers import ProvedNumbers, small_or_large

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..arithmetic.text import NumberText
    from ..arithmetic.types import Array


def header(modulus_input: ModulusInput) -> list[str]:
    """Return the names of the columns: the amplitude with its unit, F and E."""
    return ["phi_rad" if modulus_input.radians else "phi_deg", "F", "E"]


def check_domain(amplitudes: Points, modulus_input: ModulusInput) -> Modulus:
    """Return the modulus in doubles.

    Raises LagtopError for amplitudes beyond 2^50 half turns and for a modulus out of range.
    """
    half_turn = math.pi if modulus_input.radians else 180.0
    check_reach("phi", amplitudes, MAX_PERIODS * half_turn)
    return modulus_input.in_doubles()


def rows(amplitudes: Points, modulus_input: ModulusInput) -> Iterator[Array]:
    """Return blocks of rows in doubles; what is infinite (F for k = 1) is not a number.

    Amplitudes are in degrees, or in radians where the modulus is.  Raises LagtopError before the
    first block as `check_domain` does.
    """
    import numpy as np

    from ..arithmetic.arrays import ARRAYS

    modulus = check_domain(amplitudes, modulus_input)

    def block(phi: Array) -> Array:
        together = np.stack([phi, *_integrals(ARRAYS, phi, modulus, modulus_input.radians)], axis=1)
        together[np.isinf(together)] = np.nan
        return together + 0.0  # no -0

    return (block(phi) for phi in amplitudes.blocks())


def blocks(
    amplitudes: Points, modulus_input: ModulusInput
) -> Iterator[Array | list[list[NumberText]]]:
    """Return what `rows` does, as texts without NumPy where the table is small."""
    return small_or_large(
        2 * amplitudes.count,
        lambda: list(digit_rows(amplitudes, modulus_input, short=True)),
        lambda: rows(amplitudes, modulus_input),
    )


def digit_rows(
    amplitudes: Points,
    modulus_input: ModulusInput,
    digits: int | None = None,
    *,
    short: bool = False,
) -> Iterator[list[NumberText]]:
    """Return rows to so many significant digits; what is infinite is an empty text.

    Without `digits` amplitudes are rounded to doubles, and each number is the nearest double: what
    `rows` does, without NumPy; a `short` search raises TooFewDigitsError where that is sooner.
    Raises LagtopError for a modulus out of range and, without
    `digits`, as `check_domain` does.
    """
    names, numbers = header(modulus_input), ProvedNumbers(digits, short=short)
    modulus_input.check()
    if digits is None:
        check_domain(amplitudes, modulus_input)
    endless = "k_prime" in modulus_input.zeros()
    modulus_in = cache(modulus_input.in_digits)
    quarter = math.pi / 2 if modulus_input.radians else 90

    def at(phi: Fraction) -> list[NumberText]:
        def compute(ar: BallFunctions) -> dict[str, Value]:
            exact = ar.convert(phi)
            integrals = _integrals(ar, exact, modulus_in(ar), modulus_input.radians)
            return dict(zip(names, (exact, *integrals), strict=True))

        known: dict[str, float] = dict.fromkeys(names, 0) if phi == 0 else {}
        if endless and abs(phi) >= quarter:
            known["F"] = math.inf
        return list(numbers.texts(compute, known, len(str(int(abs(phi))))).values())

    places = amplitudes.decimals()
    return (at(phi if digits else Fraction(float(phi))) for phi in places)


def _integrals(
    ar: FunctionArithmetic, phi: Value, modulus: Modulus, radians: bool
) -> tuple[Value, Value]:
    """Return F and E."""
    amplitude = (in_radians if radians else in_degrees)(ar, phi)
    return f_of(ar, amplitude, modulus), e_of(ar, amplitude, modulus)
