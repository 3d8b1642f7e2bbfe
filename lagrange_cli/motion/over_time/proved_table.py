"""Columns of one motion over time in balls, rounded if both ends of a ball agree.

The attitude is computed by `series_constants` in balls.  `theta_series` bounds the truncation error
of its series, so that whole turns are proved too.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import islice
from typing import TYPE_CHECKING, Any

from ...arithmetic.ball import Ball, balls
from ...arithmetic.numbers import Number
from ...arithmetic.rounding import Settled, equal_digits, rounding_of, settled
from ...arithmetic.text import NumberText, double_text
from ..kinds import Constant, Separatrix
from ..numbers import Numbers
from ..quantity import quantity
from .column_parts import ColumnConstants, ColumnParts, column_constants
from .columns import chosen_columns, headings
from .series_constants import Pose, pose_of

if TYPE_CHECKING:
    from ...arithmetic.points import Points

_ROWS_AT_ONCE = 64
"""Rows that are returned together."""
_EXTRA = 16
"""Step in digits by which the precision grows with time, so that one precision serves many rows."""


class BallSample(ColumnParts[Ball]):
    """A motion at one time in balls."""

    ar: Any

    def __init__(
        self,
        motion: Numbers,
        digits: int,
        top: ColumnConstants[Ball],
        t: Ball,
        at: Pose[Ball],
    ) -> None:
        self.motion, self.kind = motion, motion.kind(digits)
        self.top, self.t = top, t
        self.ar = balls(digits)
        self.tilting = at.tilting
        vars(self).update(x=at.x, y=at.y, within=at.phi, around=at.psi)

    @quantity
    def x2(self) -> Ball:
        """|X|^2."""
        return self.x * self.x

    @quantity
    def y2(self) -> Ball:
        """|Y|^2."""
        return self.y * self.y

    def over(self, value: Ball, divisor: Ball) -> Ball:
        """Return a quotient, and 0 if the value is exactly 0."""
        return value / divisor if value else value

    def wrapped(self, angle: Ball) -> Ball:
        """Return an angle in (-pi, pi]."""
        pi: Ball = self.ar.pi
        if self.kind.facts.plane:  # half turns: both ends belong to pi
            return pi * int(self.ar.nint(angle / pi) % 2)
        return angle - 2 * pi * int(self.ar.ceiling(angle / (2 * pi) - 0.5))

    @quantity
    def spin_wave(self) -> Ball:
        """The periodic part of the spin (6,4)."""
        return self._periodic(self.within, "mean_spin_rate", self.kind.state.spin_drift)

    @quantity
    def precession_wave(self) -> Ball:
        """The periodic part of the precession (7,4)."""
        return self._periodic(self.around, "mean_precession_rate", self.kind.b / 2)

    def _periodic(self, angle: Ball, name: str, limit: Ball) -> Ball:
        """Return an angle less its mean rate times t; on the separatrix the rate is its limit."""
        if isinstance(self.kind, Constant):
            return 0 * self.t
        if not isinstance(self.kind, Separatrix) and self.motion.is_zero(name):
            return angle
        rate = limit if isinstance(self.kind, Separatrix) else getattr(self.kind, name)
        return angle - rate * self.t

    @quantity
    def theta_square(self) -> Ball:
        """theta'^2 by the energy (4,2)."""
        return self.top.alpha - self.top.a * self.u - self.across * self.across

    @quantity
    def thetadot(self) -> Ball:
        """The nutation rate, with the sign of `tilting`; on the separatrix as a product."""
        if isinstance(self.kind, Separatrix) and self.t:
            along: Ball = self.ar.tanh(self.tilting) / self.x
            return 2 * self.kind.argument_rate * self.y * along
        if not self.tilting:
            return 0 * self.t
        speed: Ball = self.ar.sqrt(self.theta_square)
        return speed if self.tilting > 0 else -speed


class ProvedTable:
    """Columns of a motion over time, as doubles or with `digits` significant digits."""

    def __init__(
        self,
        motion: Numbers,
        columns: Sequence[str],
        digits: int | None = None,
        *,
        radians: bool = False,
        wrap: bool = False,
    ) -> None:
        """Raise LagtopError for an unknown column."""
        self.motion, self.digits, self.radians, self.wrap = motion, digits, radians, wrap
        self.chosen = chosen_columns(columns)
        self.header = headings(columns, radians=radians)
        scene = motion.exact
        psi_rate = Fraction(scene.top.psidot0) if scene.psi_rate is None else scene.psi_rate
        rates = (scene.b, scene.r0, scene.theta_rate, psi_rate)
        self._speed = sum(map(abs, rates)) + scene.a + 1
        self._pose = cache(lambda digits: pose_of(motion.kind(digits)))
        self._constants = cache(lambda digits: column_constants(motion.kind(digits), scene))

    def row(self, time: Fraction) -> list[Settled]:
        """Return the numbers of the columns at an exact time.

        Raises LagtopError if no precision distinguishes one from 0 or from a tie.
        """
        sample = cache(lambda digits: self.sample(time, digits))
        return [self._number(name, time, sample) for name in self.chosen]

    def sample(self, time: Fraction, digits: int) -> BallSample:
        """Return the motion at a time in balls of `digits` digits.

        Raises TooFewDigitsError if they do not separate the roots or the half periods.
        """
        t, state = balls(digits).convert(time), self.motion.kind(digits).state
        start = Pose(state.cos_half, state.sin_half, t, t, state.theta_rate)
        at = self._pose(digits)(t) if time else start
        return BallSample(self.motion, digits, self._constants(digits), t, at)

    def _number(self, name: str, time: Fraction, sample: Callable[[int], BallSample]) -> Settled:
        """Return a column at a time; `sample` returns the motion there in a number of digits."""
        what = f"{name} at t = {float(time)}"
        rounding = rounding_of(what, self.digits)
        if name == "t":
            return Settled(rounding(time), (time,))
        turns = len(str(int(abs(time) * self._speed)))  # digits of the whole turns
        number = settled(
            what,
            lambda digits: self._enclosure(name, sample(digits)),
            rounding,
            digits=self.digits or 0,
            more=turns // _EXTRA * _EXTRA,
            most=max(self.motion.exact.equal, equal_digits([time], self.digits or 0)),
        )
        assert number is not None
        return number

    def _enclosure(self, name: str, sample: BallSample) -> Ball:
        """Return a ball that contains a column, with angles in the unit in use."""
        value = sample.column(name)
        if self.wrap and name in {"phi", "psi"}:
            value = sample.wrapped(value)
        in_degrees = self.chosen[name].is_angle and not self.radians
        return value * 180 / sample.ar.pi if in_degrees else value

    def rows(
        self, times: Points, *, radii: bool = False
    ) -> tuple[list[str], Iterator[list[list[NumberText]]]]:
        """Return the header and lists of rows; with `radii` a KEY_radius follows for each KEY.

        Times are the doubles used by `lagtop table` or, if digits are requested, decimals.
        """
        header = [*self.header, *(f"{name}_radius" for name in self.header if radii)]
        return header, self._lists(times, radii=radii)

    def _lists(self, times: Points, *, radii: bool) -> Iterator[list[list[NumberText]]]:
        waiting: Iterator[Number] = times.decimals()
        if self.digits is None:
            waiting = (float(time) for time in waiting)
        while block := list(islice(waiting, _ROWS_AT_ONCE)):
            yield [_texts(self.row(Fraction(time)), radii=radii) for time in block]


def _texts(row: Sequence[Settled], *, radii: bool) -> list[NumberText]:
    values: list[Any] = [
        NumberText(double_text(x.value)) if isinstance(x.value, float) else x.value for x in row
    ]
    return [*values, *(x.radius for x in row if radii)]
