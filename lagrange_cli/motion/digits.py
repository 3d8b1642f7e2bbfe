"""Any number of digits of the angles of a motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import ROUND_CEILING, Decimal
from functools import partial
from typing import cast

from ..arithmetic.correct_rounding import TooFewDigitsError, correctly_rounded, text_of
from ..arithmetic.decimals import Decimals
from ..arithmetic.numbers import Number
from ..arithmetic.text import NumberText
from ..inputs.names import ANGLES
from .regime import Regime
from .solve import Motion


def rows_in_digits(
    motion: Motion,
    times: Sequence[Number],
    digits: int,
    *,
    radians: bool = False,
    wrap: bool = False,
) -> list[list[NumberText]]:
    """Return rows of t, tilt, spin and precession to so many significant digits.

    Raises LagtopError where no precision tells an angle from 0.
    """
    table = DigitTable(motion, radians=radians, wrap=wrap)
    return [table.row(time, digits) for time in times]


class DigitTable:
    """Angles in digits; the attitude at each precision is made once."""

    def __init__(self, motion: Motion, *, radians: bool = False, wrap: bool = False) -> None:
        self.motion, self.radians, self.wrap = motion, radians, wrap
        self.ready: dict[int, Callable[[Number], list[Decimal]]] = {}

    def row(self, time: Number, digits: int) -> list[NumberText]:
        """Return the texts of t and the three angles."""
        computed: dict[int, list[Decimal]] = {}

        def angle(column: int, working: int) -> Decimal:
            if working not in computed:
                if working not in self.ready:
                    self.ready[working] = self._angles_with(working)
                computed[working] = self.ready[working](time)
            return computed[working][column]

        first = max(32, digits + 15)
        texts = [
            correctly_rounded(
                f"{name} at t = {float(time)}",
                partial(angle, column),
                partial(text_of, digits=digits),
                first=first,
                zero_is_proved=True,
            )
            for column, name in enumerate(ANGLES)
        ]
        return [
            text_of(Decimal(time) if isinstance(time, float) else time, digits),
            *filter(None, texts),
        ]

    def _angles_with(self, working: int) -> Callable[[Number], list[Decimal]]:
        """Return the angles at a time, computed with so many digits."""
        kind = self.motion.settled_kind(working)
        ar = cast(Decimals, kind.ar)
        spinor, (tilt_sin, tilt_cos) = kind.spinor(), (kind.state.sin_half, kind.state.cos_half)
        falls_to_0 = self.motion.regime is Regime.SEPARATRIX  # and keeps its digits, as 1/cosh does

        def angles(time: Number) -> list[Decimal]:
            with ar.working():
                t = ar.convert(time)
                if t:
                    at = spinor(t)
                    theta, phi, psi = 2 * ar.atan2(at.y, at.x), at.phi, at.psi
                    noise = at.size * ar.eps * 1000
                    doubtful = (phi, psi) if falls_to_0 else (theta, phi, psi)
                    if any(0 < abs(angle) < noise for angle in doubtful):
                        raise TooFewDigitsError
                else:
                    theta, phi, psi = 2 * ar.atan2(tilt_sin, tilt_cos), t, t
                if self.wrap:
                    phi, psi = wrapped(ar, phi), wrapped(ar, psi)
                unit = Decimal(1) if self.radians else 180 / ar.pi
                return [angle * unit for angle in (theta, phi, psi)]

        return angles


def wrapped(ar: Decimals, angle: Decimal) -> Decimal:
    """Return the angle in (-pi, pi] that differs by whole turns."""
    turns = (angle / (2 * ar.pi) - Decimal("0.5")).to_integral_value(ROUND_CEILING)
    return angle - 2 * ar.pi * turns
