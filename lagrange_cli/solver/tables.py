"""Tables over time: columns at arrays of times in doubles, and proved rows with any digits.

Both evaluate the formulas of `columns`: arrays in doubles, from the series of `sampling`, and
proved rows in balls, from theta functions (`attitude`).  A proved row is rounded if both ends of
its balls agree.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache, partial
from itertools import islice

import numpy as np
from flint import arb

from ..arithmetic.enclosures import (
    Rounded,
    TooFewDigitsError,
    decided,
    decimal_text,
    equal_digits,
    exact,
    kept,
    nearest,
    root,
    settled,
    sign,
)
from ..arithmetic.numbers import Real
from ..arithmetic.text import NumberText, double_text
from ..arithmetic.types import Array
from ..errors import LagtopError, OutOfRangeError, arg
from ..names import RADIUS
from ..top.ranges import EvenPoints, Points
from ..top.units import DEGREES, Units
from .attitude import Course, start_of
from .columns import (
    DEFAULT_COLUMNS,
    FORMULAS,
    REDUCED,
    WITHIN_A_TURN,
    Columns,
    chosen_columns,
    column_constants,
    headings,
)
from .numbers import square
from .record import Solution
from .sampling import is_ordinary
from .series import near

DEFAULT_ROWS = 101
_MORE_THAN_A_DOUBLE = 40
"""Digits of proved rows that are rounded to doubles: no tie of two doubles is met by chance."""
_ROWS_AT_ONCE = 64
"""Proved rows that are returned together."""
_BALLS = {
    **{"cos": arb.cos, "sin": arb.sin, "tanh": arb.tanh, "atan2": arb.atan2, "sqrt": root},
    **{"square": square, "sign": sign, "ratio": lambda x, y: x if x.is_zero() else x / y},
}
_BALL_FORMULAS = FORMULAS | {
    "XX": "square(X)",
    "YY": "square(Y)",
    "tilt": "2*atan2(Y, X)",
    "spin_turn": "spin",
    "precession_turn": "precession",
    "angle_X": "(precession + spin)/2",
    "angle_Y": "(precession - spin)/2",
    "signed_X": "X",
    "signed_Y": "Y",
    # by the energy (4,2)
    "nutation_rate": (
        "tilting if tilting.is_zero()"
        " else sign(tilting)*sqrt(energy_constant - a*u - square(across))"
    ),
}
_SWING = {"nutation_rate": "2*swing_rate*Y*tanh(tilting)/X"}
"""On the separatrix a product, which keeps its digits at late times."""


def columns_at(
    motion: Solution, columns: Sequence[str], units: Units, *, wrap: bool
) -> Callable[[Array], Array]:
    """Return a function of times that returns columns, of shape (columns, times).

    Columns at t = 0 are correctly rounded.  Constants near the ends of the doubles need proved rows
    (about 2 ms each).  Raises LagtopError for an unknown column.
    """
    chosen, sampler = chosen_columns(columns), motion.sampler()

    def doubles(digits: int) -> dict[str, float] | None:
        found = column_constants(motion.balls(digits))
        if not (sampler.is_ordinary and is_ordinary(*found.values())):
            return None
        alpha = float(found.pop("energy_constant").mid())  # 0 may be known to no digit
        return {name: near(x) for name, x in found.items()} | {"energy_constant": alpha}

    @cache
    def start() -> Array:
        return _proved(motion, np.zeros(1), columns, units, wrap=wrap)

    constants = decided(doubles, motion.facts.equal)

    def found_at(t: Array) -> Array:
        if not constants:
            sampler.check(t, wrap=wrap or not WITHIN_A_TURN.isdisjoint(chosen))
            return _proved(motion, t, columns, units, wrap=wrap)
        found = sampler.evaluate(t, [*chosen], wrap=wrap, **constants)
        for row, column in zip(found, chosen.values(), strict=True):
            if column.unit == "angle" and not units.radians:
                np.degrees(row, out=row)
        if (first := np.flatnonzero(t == 0)).size:
            found[:, first] = start()
        found += 0.0  # no -0
        return found

    return found_at


def _proved(
    motion: Solution, t: Array, columns: Sequence[str], units: Units, *, wrap: bool
) -> Array:
    """Return columns of proved rows, rounded to doubles, of shape (columns, times).

    Numbers below all doubles are 0.  Raises OutOfRangeError for a number beyond the doubles.
    """
    table = ProvedTable(motion, columns, _MORE_THAN_A_DOUBLE, units=units, wrap=wrap)
    found = np.empty((len(table.chosen), t.size))
    for i, time in enumerate(t.tolist()):
        found[:, i] = [float(x.value) for x in table.row(Fraction(time))]
    beyond = np.argwhere(np.isinf(found))
    if beyond.size:
        name, time = [*table.chosen][beyond[0, 0]], t[beyond[0, 1]]
        raise OutOfRangeError(f"{name} at t = {time} must be within 1.8e308 in magnitude")
    return found


def rows(
    motion: Solution,
    times: Points,
    columns: Sequence[str] = DEFAULT_COLUMNS,
    *,
    units: Units = DEGREES,
    wrap: bool = False,
    stds: Callable[[Array], Array] | None = None,
) -> tuple[list[str], Iterator[Array]]:
    """Return the header and blocks of rows; angles in degrees or radians, wrapped or not.

    `stds` returns the uncertainties of all columns but the time, in radians, which follow as last
    columns.  Raises LagtopError for an unknown column and, before the first block, for a time out
    of range.
    """
    chosen = chosen_columns(columns)
    within = wrap or not WITHIN_A_TURN.isdisjoint(chosen)
    ends = ("t_min", "t_max") if isinstance(times, EvenPoints) else ("t", "t")
    for name, end in zip(ends, times.bounds(), strict=False):  # empty if times are read later
        motion.sampler().check(end, name, wrap=within)
    header = headings(chosen, units)
    uncertain = [name for name in chosen if name != "t"] if stds else []
    are_angles = [chosen[name].unit == "angle" for name in uncertain]
    at = columns_at(motion, columns, units, wrap=wrap)

    def parts() -> Iterator[Array]:
        for t in times.blocks():
            found = at(t)
            if stds and uncertain:
                spread = stds(t)
                spread[are_angles] *= units.radian
                found = np.concatenate([found, six_digits(spread)])
            yield found.T

    return [*header, *(f"{x}_std" for x in headings(uncertain, units))], parts()


def six_digits(x: Array) -> Array:
    """Return numbers rounded to six significant digits."""
    with np.errstate(all="ignore"):
        places = 5 - np.floor(np.log10(x))
        finer, coarser = 10.0 ** np.maximum(places, 0), 10.0 ** np.maximum(-places, 0)
        return np.where(x > 0, np.rint(x * finer / coarser) / finer * coarser, x)


def grid(
    motion: Solution,
    t_min: Fraction | None = None,
    t_max: Fraction | None = None,
    *,
    n: int | None = None,
    dt: Fraction | None = None,
    exact: bool = False,
) -> EvenPoints:
    """Return n times from t_min to t_max, or as many steps dt as fit, counted exactly.

    The default is 101 times over one nutation period from 0, or over a unit of time if the motion
    has no period.  If times are `exact`, the period is the decimal that `solve` prints.  Raises
    LagtopError unless the interval, n and dt give a grid of 1 to 1e9 rows.
    """
    t_min = Fraction(0) if t_min is None else t_min
    if t_max is None:
        period = motion.T_nutation or 1.0
        t_max = t_min + Fraction(double_text(period) if exact else period)
    if not t_max >= t_min:
        least = f"{arg('t_min')} = {float(t_min)}"
        raise LagtopError(f"t_max must be >= {least}, got {float(t_max)}", "t_max")
    if dt is not None:
        if not dt > 0:
            raise LagtopError(f"dt must be > 0, got {float(dt)}", "dt")
        count, step = int((t_max - t_min) / dt) + 1, dt
    else:
        count = n or (DEFAULT_ROWS if t_max > t_min else 1)
        step = (t_max - t_min) / (count - 1) if count > 1 else Fraction(0)
    try:
        return EvenPoints(t_min, step, count)
    except LagtopError as error:
        raise LagtopError(f"the grid of times {error.marked}") from None


def within_a_turn(angle: arb, *, plane: bool) -> arb:
    """Return an angle in (-pi, pi]; in a `plane` it is a multiple of pi."""
    if plane:
        return arb.pi() * (nearest(angle / arb.pi()) % 2)
    turns = (angle / (2 * arb.pi()) - arb(0.5)).ceil()
    if not turns.is_exact():
        raise TooFewDigitsError
    return angle - 2 * arb.pi() * turns


class ProvedTable:
    """Columns of a motion over time, as doubles or with `digits` significant digits."""

    def __init__(
        self,
        motion: Solution,
        columns: Sequence[str],
        digits: int | None = None,
        *,
        units: Units = DEGREES,
        wrap: bool = False,
    ) -> None:
        """Raise LagtopError for an unknown column."""
        self.motion, self.digits, self.units, self.wrap = motion, digits, units, wrap
        self.chosen = chosen_columns(columns)
        self.header = headings(self.chosen, units)
        self._constants = kept(lambda digits: column_constants(motion.balls(digits)))

    def row(self, time: Fraction) -> list[Rounded]:
        """Return the numbers of the columns at an exact time.

        Raises LagtopError if no precision distinguishes one from 0 or from a tie.
        """
        facts, columns = self.motion.facts, kept(partial(self._columns, time))
        most = max(facts.equal, equal_digits([time], self.digits or 0))

        def ball(name: str, digits: int) -> arb:
            value: arb = columns(digits)[name]
            if self.wrap and name in REDUCED:
                value = within_a_turn(value, plane=facts.plane)
            in_degrees = self.chosen[name].unit == "angle" and not self.units.radians
            return value * 180 / arb.pi() if in_degrees else value

        def number(name: str) -> Rounded:
            found = settled(f"{name} at t = {float(time)}", partial(ball, name), self.digits, most)
            assert found is not None
            return found

        return [number(name) for name in self.chosen]

    def _columns(self, time: Fraction, digits: int) -> Columns:
        """Return all columns at one time, in balls of the precision in use.

        Raises TooFewDigitsError if the digits do not separate the roots or the half periods.
        """
        facts, of, t = self.motion.facts, self.motion.balls(digits), exact(time)
        course: Course = of["course"]
        at = course.at(t) if time else start_of(facts, of)
        spin, precession = course.spin * t + at.dphi, course.precession * t + at.dpsi
        if facts.plane:  # these angles change only at the poles, by half turns
            spin, precession = (arb.pi() * nearest(x / arb.pi()) for x in (spin, precession))
        items = {"t": t, "X": at.x, "Y": at.y, "spin": spin, "precession": precession}
        items |= {"spin_wave": at.dphi, "precession_wave": at.dpsi, "tilting": at.tilting}
        formulas = _BALL_FORMULAS
        if facts.separatrix and time:
            formulas, items["swing_rate"] = formulas | _SWING, of["swing_rate"]
        return Columns(formulas, _BALLS | self._constants(digits) | items)

    def rows(
        self, times: Points, *, radii: bool = False
    ) -> tuple[list[str], Iterator[list[list[NumberText]]]]:
        """Return the header and lists of rows; with `radii` KEY_radius follows for each KEY but t.

        Times are the doubles used by `lagtop table` or, if digits are requested, decimals.  They
        are exact, and have all of their digits.
        """
        bounded = [name for name in self.header if radii and name != "t"]

        def texts(time: Real) -> list[NumberText]:
            t = NumberText(double_text(float(time)))
            if self.digits is not None:
                t = decimal_text(Fraction(time), max(self.digits, sys.float_info.dig))
            row = dict(zip(self.header, self.row(Fraction(t)), strict=True))
            values = [
                double_text(x.value) if self.digits is None else x.value for x in row.values()
            ]
            shown = [
                t if name == "t" else NumberText(x) for name, x in zip(row, values, strict=True)
            ]
            return [*shown, *(row[name].radius for name in bounded)]

        def lists() -> Iterator[list[list[NumberText]]]:
            waiting = times.decimals()
            while block := list(islice(waiting, _ROWS_AT_ONCE)):
                yield [texts(time) for time in block]

        return [*self.header, *(f"{name}{RADIUS}" for name in bounded)], lists()
