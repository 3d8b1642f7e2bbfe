"""Columns of one motion over time in balls, rounded if both ends of a ball agree.

The attitude is computed by `series_constants` in balls.  `theta_series` bounds the truncation error
of its series, so that whole turns are proved too.  Equation numbers are Chrapan's.

Some columns are fractions, which may be ties or exact zeros: at the start, in the constants of the
motion and in steady motions.  For some tops, such as a sphere or a disc, further columns are 0 or
constant at all times.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache, cached_property
from itertools import islice
from typing import TYPE_CHECKING, Any

from ...arithmetic.ball import Ball
from ...arithmetic.balls import Balls, balls
from ...arithmetic.exact_cosine import Cosine, U
from ...arithmetic.numbers import Number
from ...arithmetic.rounding import Settled, rounding_of, settled
from ...arithmetic.text import NumberText, double_text
from ..kinds import Constant, Separatrix
from ..numbers import Numbers
from ..rational_keys import known_fraction
from ..regime import Exact
from .column_formulas import ColumnConstants, ColumnFormulas, column_constants
from .columns import ScalarColumn, chosen_columns, headings
from .series_constants import Pose, pose_of

if TYPE_CHECKING:
    from ...arithmetic.points import Points

_ROWS_AT_ONCE = 64
"""Rows that are returned together."""
_EXTRA = 16
"""Step in digits by which the precision grows with time, so that one precision serves many rows."""


class BallSample(ColumnFormulas[Ball]):
    """A motion at one time in balls."""

    def __init__(
        self,
        motion: Numbers,
        digits: int,
        constants: ColumnConstants[Ball],
        t: Ball,
        at: Pose[Ball],
    ) -> None:
        self.exact, self.kind = motion.exact, motion.kind(digits)
        self.constants, self.t, self.ar = constants, t, t.ar
        self.x, self.y, self.within, self.around, self.tilting = at

    def over(self, value: Ball, divisor: Ball) -> Ball:
        """Return a quotient, and 0 if the value is exactly 0."""
        return value / divisor if value else value

    def wrapped(self, angle: Ball) -> Ball:
        """Return an angle in (-pi, pi]."""
        ar: Balls = self.t.ar
        if self.kind.facts.plane:  # half turns: both ends belong to pi
            return ar.pi * int(ar.nint(angle / ar.pi) % 2)
        return angle - 2 * ar.pi * int(ar.ceiling(angle / (2 * ar.pi) - ar.convert(0.5)))

    @property
    def dphi(self) -> Ball:
        """The periodic part of the spin (6,4)."""
        return self._periodic(self.within, "mean_spin_rate", self.kind.state.spin_drift)

    @property
    def dpsi(self) -> Ball:
        """The periodic part of the precession (7,4)."""
        return self._periodic(self.around, "mean_precession_rate", self.kind.b / 2)

    def _periodic(self, angle: Ball, name: str, limit: Ball) -> Ball:
        """Return an angle less its mean rate times t; on the separatrix the rate is its limit."""
        if isinstance(self.kind, Constant):
            return 0 * self.t
        if known_fraction(self.exact, name) == 0:
            return angle
        rate = limit if isinstance(self.kind, Separatrix) else getattr(self.kind, name)
        return angle - rate * self.t

    @cached_property
    def theta_square(self) -> Ball:
        """theta'^2 by the energy (4,2)."""
        return self.constants.alpha - self.constants.a * self.u - self.across * self.across

    @cached_property
    def thetadot(self) -> Ball:
        """The nutation rate, with the sign of `tilting`."""
        if not self.tilting:
            return 0 * self.t
        speed = self.ar.sqrt(self.theta_square)
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
        return [self._number(part, time, sample) for part in self.chosen]

    def sample(self, time: Fraction, digits: int) -> BallSample:
        """Return the motion at a time in balls of `digits` digits.

        Raises TooFewDigitsError if they do not separate the roots or the half periods.
        """
        t, state = balls(digits).convert(time), self.motion.kind(digits).state
        start = Pose(state.cos_half, state.sin_half, t, t, state.theta_rate)
        at = self._pose(digits)(t) if time else start
        return BallSample(self.motion, digits, self._constants(digits), t, at)

    def _number(
        self, part: ScalarColumn, time: Fraction, sample: Callable[[int], BallSample]
    ) -> Settled:
        """Return a column at a time; `sample` returns the motion there in a number of digits."""
        what = f"{part.name} at t = {float(time)}"
        rounding = rounding_of(what, self.digits)
        if part.name == "t":
            return Settled(rounding(time), (time,))
        number = settled(
            what,
            lambda digits: self._enclosure(part, sample(digits)),
            rounding,
            digits=self.digits or 0,
            more=self._digits_of(time),
            exactly=lambda: known_column(
                self.motion.exact, part.name, time, radians=self.radians, wrap=self.wrap
            ),
        )
        assert number is not None
        return number

    def _enclosure(self, part: ScalarColumn, sample: BallSample) -> Ball:
        """Return a ball that contains a column, with angles in the unit in use."""
        value: Ball = getattr(sample, part.name)
        if self.wrap and part.name in {"phi", "psi"}:
            value = sample.wrapped(value)
        in_degrees = part.heading.endswith("*") and not self.radians
        return value * 180 / sample.t.ar.pi if in_degrees else value

    def _digits_of(self, time: Fraction) -> int:
        """Return the approximate number of digits of the whole turns."""
        turns = len(str(int(abs(time) * self._speed)))
        return turns // _EXTRA * _EXTRA

    def rows(
        self, times: Points, *, radii: bool = False
    ) -> tuple[list[str], Iterator[list[list[NumberText]]]]:
        """Return the header and lists of rows; with `radii` a KEY_radius follows for each KEY.

        Times are the doubles used by `lagtop table` or, if digits are requested, decimals.
        """
        header = [*self.header, *(f"{name}_radius" for name in self.header if radii)]
        return header, self._lists(times, radii=radii)

    def _lists(self, times: Points, *, radii: bool) -> Iterator[list[list[NumberText]]]:
        exact = times.decimals()
        waiting: Iterator[Number] = map(float, exact) if self.digits is None else exact
        while block := list(islice(waiting, _ROWS_AT_ONCE)):
            yield [_texts(self.row(Fraction(time)), radii=radii) for time in block]


def _texts(row: Sequence[Settled], *, radii: bool) -> list[NumberText]:
    values: list[Any] = [
        NumberText(double_text(x.value)) if isinstance(x.value, float) else x.value for x in row
    ]
    return [*values, *(x.radius for x in row if radii)]


_RATES = {
    "phi": ("mean_spin_rate", "spin_rate_start"),
    "psi": ("mean_precession_rate", "precession_rate_start"),
}
"""The keys of the rates of both angles: the mean rate and the rate at the start."""


def known_column(
    exact: Exact, name: str, t: Fraction, *, radians: bool = False, wrap: bool = False
) -> Fraction | None:
    """Return a column at a time if it is known as a fraction, else None.

    Angles are in degrees or `radians`.
    """
    facts = exact.facts
    if name == "r":
        return exact.r0
    known = None if exact.psi_rate is None else _of_all_times(exact, name)
    if known is not None:
        return known
    if facts.steady and name in _RATES:
        rate = known_fraction(exact, _RATES[name][0])
        return rate * t if rate is not None and (not rate or (radians and not wrap)) else None
    if t and facts.free and facts.plane and not facts.steady:
        return _of_a_great_circle(exact, name, t, radians=radians)
    turns = exact.psi_rate != 0 and known_fraction(exact, "mean_spin_rate") != 0
    if t and (not facts.steady or (name in {"p", "q"} and turns)):
        return None
    return _at_start(exact, name, radians=radians)


def _of_all_times(exact: Exact, name: str) -> Fraction | None:
    """Return a constant of the motion, or a column that is constant for some tops.

    For example, p and q are constant for a sphere without torque.
    """
    facts, psi = exact.facts, exact.psi_rate
    if name in {"energy", "Lz"}:  # (4,2) and (4,3)
        A, C = Fraction(exact.top.A), Fraction(exact.top.C)
        energy = A / 2 * exact.alpha + C * exact.r0 * exact.r0 / 2
        return exact.cosine.fraction(energy if name == "energy" else A * exact.beta)
    if name == "axis_x":
        return Fraction(0) if facts.plane else None
    if name in {"quaternion_y", "quaternion_z"}:
        return Fraction(0) if _stands(exact, 1 if name == "quaternion_z" else -1) else None
    if name not in {"p", "q"}:
        return None
    if facts.free and exact.r0 == exact.b:  # the angular velocity is constant in the body
        return _at_start(exact, name, radians=False)
    # A disc, C = 2A, has p'' = -(r0^2 - a u/2) p, and q'' likewise: a rate that starts at 0
    # with the derivative 0 stays 0.  Without spin this holds for any top.
    balanced = not exact.theta_rate and 2 * exact.r0 * psi == exact.a
    at_rest = not psi and not exact.r0 * exact.theta_rate
    zero = exact.b == 2 * exact.r0 and (balanced if name == "p" else at_rest)
    return Fraction(0) if zero else None


def _stands(exact: Exact, sign: int) -> bool:
    """Return whether psi + sign phi leaps by whole turns only, at a pole, or not at all."""
    facts, psi = exact.facts, exact.psi_rate
    if facts.steady:
        return exact.cosine.vanishes(sign * exact.r0 + psi - sign * psi * U)
    passes = facts.over_bottom if sign > 0 else facts.over_top
    return passes and exact.r0 == exact.b


def _of_a_great_circle(exact: Exact, name: str, t: Fraction, *, radians: bool) -> Fraction | None:
    """Return a column of an axis that moves uniformly round a great circle through both poles."""
    rate = exact.theta_rate
    tilt = Fraction(0) if exact.facts.pole > 0 else exact.cosine.radians
    if tilt is None or abs(angle := tilt + rate * t) > 3:  # about half a turn, or beyond
        return None
    if name == "theta":
        return abs(angle) if radians else None
    return (rate if angle > 0 else -rate) if name == "thetadot" else None


def _at_start(exact: Exact, name: str, *, radians: bool) -> Fraction | None:
    """Return a column at t = 0."""
    cosine, facts = exact.cosine, exact.facts
    known = {
        "theta": cosine.radians if radians else cosine.degrees,
        "u": cosine.rational,
        "axis_z": cosine.rational,
        "thetadot": exact.theta_rate,
        "p": exact.theta_rate,
    }
    if name in {"q", "moment"}:
        factor = exact.psi_rate if name == "q" else Fraction(exact.top.A) * exact.a / 2
        sine = Fraction(0) if factor == 0 else _sine(cosine)
        return None if sine is None or factor is None else sine * factor
    if name not in {"phidot", "psidot"}:
        return known.get(name)
    if facts.pole and not facts.steady:  # the axis leaves the pole
        return exact.r0 - exact.b / 2 if name == "phidot" else facts.pole * exact.b / 2
    mean, start = _RATES[name.removesuffix("dot")]
    return known_fraction(exact, mean if facts.steady else start)


def _sine(cosine: Cosine) -> Fraction | None:
    """Return the sine of the tilt if it is rational, else None."""
    if cosine.degrees is None:
        return Fraction(0) if cosine.radians == 0 else None
    return Cosine(abs(90 - cosine.degrees), None).rational
