"""solve(top): the constants of one motion, and from them its angles at any time."""

from __future__ import annotations

import math
from decimal import localcontext
from typing import TYPE_CHECKING, Any

from . import decimals
from .elliptic import Real
from .record import Record, Regime
from .released import released_record
from .top import LagtopError, Top

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .angles import Angles, Sampler
    from .columns import Constants

WORKING_DIGITS = 50
"""Digits of the constants behind the sampled angles; 34 would do, the rest is margin."""


class Motion(Record):
    """One motion, solved: the numbers of its record and its angles over time."""

    __slots__ = ()

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Tilt, spin and precession (radians) at the times t, in the shape of t.

        Spin and precession are unwrapped and 0 at t = 0; `wrap` brings them to (-pi, pi].
        Raises LagtopError for a time that is not finite or beyond 2^50 nutation periods.
        """
        return self.sampler().angles(t, wrap=wrap)

    def sampler(self) -> Sampler:
        """The series behind `angles`, to be kept where many blocks of times follow."""
        from .general import (
            analyse,
            many_digits,
            separatrix_swing,
            steady_rates,
            theta_constants,
        )
        from .samplers import separatrix_sampler, steady_sampler, theta_sampler

        ar = many_digits(WORKING_DIGITS)
        solution = analyse(ar, self.top)
        if solution.regime is Regime.SEPARATRIX:
            swing, begin = separatrix_swing(ar, solution), solution.start
            return separatrix_sampler(ar, swing, solution.speed, begin.r0, begin.b)
        if not solution.nutates:
            return steady_sampler(ar, self.top.tilt(ar), *steady_rates(solution))
        return theta_sampler(ar, theta_constants(ar, solution))

    def column_constants(self) -> Constants:
        """What the columns of `lagtop table` need besides the angles."""
        from .columns import column_constants
        from .general import analyse, many_digits

        return column_constants(self.top, analyse(many_digits(WORKING_DIGITS), self.top).start)


def solve(top: Top) -> Motion:
    """The constants of the motion of a top.

    Every number is the double nearest to its exact value.  Raises LagtopError for a start that
    describes no motion, and where a number leaves the range of doubles.
    """
    if top.is_released:
        with localcontext(decimals.context()):
            return _rounded(released_record(decimals, top))
    from .general import general_record, many_digits

    return _rounded(general_record(many_digits(WORKING_DIGITS), top))


def _rounded(exact: Record) -> Motion:
    rounded: dict[str, Any] = {key: _double(key, value) for key, value in exact.numbers().items()}
    return Motion(*exact._replace(**rounded))


def _double(name: str, value: Real | None) -> float | None:
    if value is None:
        return None
    nearest = float(value)
    if not math.isfinite(nearest):
        raise LagtopError(f"{name} must be within 1.8e308 in size, got {value}: change the units")
    return nearest
