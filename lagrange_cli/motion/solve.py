"""solve(top): the constants of one motion, and from them its angles at any time."""

from __future__ import annotations

import math
from decimal import localcontext
from typing import TYPE_CHECKING, Any

from ..arithmetic import decimals
from ..arithmetic.generic import Real, many_digits
from ..errors import LagtopError
from ..inputs.top import Top
from .record import Record
from .released import released_record

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .samplers import Angles, Sampler


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
        """The series behind `angles`."""
        from .make_sampler import sampler_of

        return sampler_of(self.top)


def solve(top: Top) -> Motion:
    """The constants of the motion of a top.

    Every number is the double nearest to its exact value.  Raises LagtopError for a start that
    describes no motion, and where a number leaves the range of doubles.
    """
    if top.is_released:
        with localcontext(decimals.context()):
            return _rounded(released_record(decimals, top))
    from .general import digits_for_record
    from .general_record import general_record

    return _rounded(general_record(many_digits(digits_for_record(top)), top))


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
