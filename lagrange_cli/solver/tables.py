"""Tables over time: columns at arrays of times in doubles, and proved rows with any digits.

Proved rows come from balls, rounded if both ends of a ball agree.  Balls hold the truncation error
of the series too, so that whole turns are proved.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import ARRAYS, doubles_of
from ..arithmetic.ball import Ball, balls
from ..arithmetic.numbers import Number
from ..arithmetic.rounding import Rounded, equal_digits, rounding_of, settled
from ..arithmetic.text import NumberText, double_text
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..names import ANGLES
from ..top.ranges import EvenPoints, Points
from .columns import (
    DEFAULT_COLUMNS,
    ColumnConstants,
    Parts,
    chosen_columns,
    column_constants,
    headings,
)
from .kinds import Constant, Separatrix
from .quantity import quantity
from .record import Solution as Numbers
from .sampling import Attitude, near
from .series import ExactAttitude, exact_attitude

DEFAULT_ROWS = 101
_ROWS_AT_ONCE = 64
"""Proved rows that are returned together."""
_EXTRA = 16
"""Step in digits by which the precision grows with time, so that one precision serves many rows."""


class Sample(Parts[Array]):
    """The motion at a block of times."""

    ar: Any = ARRAYS

    def __init__(self, attitude: Attitude, top: ColumnConstants[Array], wrap: bool) -> None:
        self.attitude, self.top, self.wrap, self.t = attitude, top, wrap, attitude.t

    theta = property(lambda at: at.attitude.tilt)
    moduli = property(lambda at: at.attitude.moduli)
    sizes = quantity[Any](lambda at: [np.sqrt(square) for square in at.moduli])
    phi = property(lambda at: at.attitude.phi(wrap=at.wrap))
    psi = property(lambda at: at.attitude.psi(wrap=at.wrap))
    within = quantity[Any](lambda at: at.attitude.phi(wrap=True))
    around = quantity[Any](lambda at: at.attitude.psi(wrap=True))
    dphi = property(lambda at: at.attitude.waves()[0])
    dpsi = property(lambda at: at.attitude.waves()[1])

    @quantity
    def thetadot(self) -> Any:
        """The nutation rate (5,3); on a pole, where its sign changes, its size by (4,2)."""
        product = 2.0 * self.norm * self.sizes[0] * self.sizes[1]
        speed = np.sqrt(np.maximum(self.top.alpha - self.top.a * self.u, 0.0))
        return np.divide(self.attitude.rate, product, out=speed, where=product != 0.0)

    @quantity
    def quarters(self) -> Sequence[tuple[Array, Array]]:
        """(psi + phi)/2 and (psi - phi)/2, reduced by half turns, with the signs of X and Y."""
        halves = zip(self.attitude.sampler.halves, self.attitude.args, strict=True)
        return [half.within_a_quarter(arg.copy(), self.attitude) for half, arg in halves]

    args = property(lambda at: [arg for arg, _ in at.quarters])

    @quantity
    def unit(self) -> Any:
        """|X| and |Y|, each over sqrt(N), with the signs that make the quaternion continuous."""
        return [sign * x for (_, sign), x in zip(self.quarters, super().unit, strict=True)]

    def over(self, value: Array, divisor: Array) -> Array:
        """Return the quotient, and 0 for 0/0."""
        return np.divide(value, divisor, out=np.zeros_like(divisor), where=divisor != 0.0)


def columns_at(
    motion: Numbers, columns: Sequence[str], *, radians: bool, wrap: bool
) -> Callable[[Array], Iterator[tuple[slice, list[Array]]]]:
    """Return a function of times that yields blocks of columns; each overwrites the one before.

    Columns at t = 0 are correctly rounded.  Raises LagtopError for an unknown column.
    """
    chosen, kind = chosen_columns(columns), motion.sharp()
    constants = ColumnConstants(*(np.array(near(x)) for x in column_constants(kind, motion.exact)))

    @cache
    def start() -> list[float]:
        table = ProvedTable(motion, columns, radians=radians, wrap=wrap)
        return [number.value for number in table.row(Fraction(0))]

    def at(t: Array) -> Iterator[tuple[slice, list[Array]]]:
        for part, attitude in motion.sampler().attitudes(t):
            with ARRAYS.working():
                sample = Sample(attitude, constants, wrap)
                found = [np.broadcast_to(getattr(sample, x), sample.t.shape) for x in chosen]
            for i, column in enumerate(chosen.values()):
                if column.unit == "angle" and not radians:
                    found[i] = np.degrees(found[i])
            first = sample.t == 0
            if first.any():
                found = [np.where(first, x, y) for x, y in zip(start(), found, strict=True)]
            yield part, found

    return at


def rows(
    motion: Numbers,
    times: Points,
    columns: Sequence[str] = DEFAULT_COLUMNS,
    *,
    radians: bool = False,
    wrap: bool = False,
    stds: Callable[[Array], Array] | None = None,
) -> tuple[list[str], Iterator[Array]]:
    """Return the header and blocks of rows; angles in degrees or radians, wrapped or not.

    `stds` returns the uncertainties of the three angles at some times, shape (3, times).  They
    follow as last columns for each angle among the columns.  Raises LagtopError for an unknown
    column and, before the first block, for a time out of range.
    """
    header = headings(columns, radians=radians)
    ends = ("t_min", "t_max") if isinstance(times, EvenPoints) else ("t", "t")
    for name, end in zip(ends, times.bounds(), strict=False):  # empty if times are read later
        motion.sampler().check(end, name)
    angles = [i for i, name in enumerate(ANGLES) if stds is not None and name in columns]
    names = [f"{heading}_std" for i in angles for heading in headings([ANGLES[i]], radians=radians)]
    at = columns_at(motion, columns, radians=radians, wrap=wrap)

    def parts() -> Iterator[Array]:
        for t in times.blocks():
            for part, found in at(t):
                if stds is not None:
                    spread = stds(t[part])[angles]
                    found += [*six_digits(spread if radians else np.degrees(spread))]
                yield np.stack(found, axis=1)

    return [*header, *names], parts()


def six_digits(x: Array) -> Array:
    """Return numbers rounded to six significant digits."""
    with ARRAYS.working():
        places = 5 - np.floor(np.log10(x))
        finer, coarser = 10.0 ** np.maximum(places, 0), 10.0 ** np.maximum(-places, 0)
        return np.where(x > 0, np.rint(x * finer / coarser) / finer * coarser, x)


def table(
    motion: Numbers, t: ArrayLike, columns: Sequence[str], *, wrap: bool = False
) -> dict[str, Array]:
    """Return columns by name, each a float64 array in the shape of t; see `Motion.table`."""
    times, at = doubles_of("t", t), columns_at(motion, columns, radians=True, wrap=wrap)
    flat = np.ascontiguousarray(times).reshape(-1)
    found = {name: np.empty_like(flat) for name in chosen_columns(columns)}
    for part, block in at(flat):
        for values, column in zip(found.values(), block, strict=True):
            values[part] = column
    return {name: values.reshape(times.shape) for name, values in found.items()}


def grid(
    motion: Numbers,
    t_min: Fraction | None = None,
    t_max: Fraction | None = None,
    *,
    n: int | None = None,
    dt: Fraction | None = None,
) -> EvenPoints:
    """Return n times from t_min to t_max, or as many steps dt as fit, counted exactly.

    The default is 101 times over one nutation period from 0, or over a unit of time if the motion
    has no period.  Raises LagtopError unless the interval, n and dt give a grid of 1 to 1e9 rows.
    """
    t_min = Fraction(0) if t_min is None else t_min
    t_max = t_min + Fraction(motion.T_nutation or 1) if t_max is None else t_max
    if not t_max >= t_min:
        raise LagtopError(f"t_max must be >= t_min = {float(t_min)}, got {float(t_max)}", "t_max")
    if n is not None and n < 1:
        raise LagtopError(f"n must be >= 1, got {n}", "n")
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
        raise LagtopError(f"the grid of times {error}") from None


class BallSample(Parts[Ball]):
    """A motion at one time in balls."""

    ar: Any

    def __init__(
        self,
        motion: Numbers,
        digits: int,
        top: ColumnConstants[Ball],
        t: Ball,
        at: ExactAttitude[Ball],
    ) -> None:
        self.motion, self.kind, self.ar = motion, motion.kind(digits), balls(digits)
        self.top, self.t, self.tilting = top, t, at.tilting
        self.sizes, self.moduli = (at.x, at.y), (at.x * at.x, at.y * at.y)
        self.within, self.around = self.phi, self.psi = at.phi, at.psi

    theta = property(lambda at: 2 * at.ar.atan2(at.sizes[1], at.sizes[0]))

    def over(self, value: Ball, divisor: Ball) -> Ball:
        """Return a quotient, and 0 if the value is exactly 0."""
        return value / divisor if value else value

    def wrapped(self, angle: Ball) -> Any:
        """Return an angle in (-pi, pi]."""
        ar: Any = self.ar
        if self.kind.facts.plane:  # half turns: both ends belong to pi
            return ar.pi * int(ar.nint(angle / ar.pi) % 2)
        return angle - 2 * ar.pi * int(ar.ceiling(angle / (2 * ar.pi) - ar.convert(0.5)))

    dphi = property(lambda at: at.periodic(at.within, "mean_spin_rate"))
    dpsi = property(lambda at: at.periodic(at.around, "mean_precession_rate"))

    def periodic(self, angle: Ball, name: str) -> Any:
        """Return an angle less its mean rate times t; on the separatrix the rate is its limit."""
        if isinstance(self.kind, Constant):
            return 0 * self.t
        if isinstance(self.kind, Separatrix):
            half_b = self.kind.b / 2
            rate = half_b if name == "mean_precession_rate" else self.kind.state.spin_drift
            return angle - rate * self.t
        return angle if self.motion.is_zero(name) else angle - getattr(self.kind, name) * self.t

    @quantity
    def thetadot(self) -> Any:
        """The nutation rate by the energy (4,2), with the sign of `tilting`.

        On the separatrix it is a product, which keeps its digits at late times.
        """
        if isinstance(self.kind, Separatrix) and self.t:
            x, y = self.sizes
            return 2 * self.kind.argument_rate * y * self.ar.tanh(self.tilting) / x
        if not self.tilting:
            return 0 * self.t
        square = self.top.alpha - self.top.a * self.u - self.across * self.across
        speed = self.ar.sqrt(square)
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
        self._attitude = cache(lambda digits: exact_attitude(motion.kind(digits)))
        self._constants = cache(lambda digits: column_constants(motion.kind(digits), scene))

    def row(self, time: Fraction) -> list[Rounded]:
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
        start = ExactAttitude(state.cos_half, state.sin_half, t, t, state.theta_rate)
        at = self._attitude(digits)(t) if time else start
        return BallSample(self.motion, digits, self._constants(digits), t, at)

    def _number(self, name: str, time: Fraction, sample: Callable[[int], BallSample]) -> Rounded:
        """Return a column at a time; `sample` returns the motion there in a number of digits."""
        what = f"{name} at t = {float(time)}"
        rounding = rounding_of(what, self.digits)
        if name == "t":
            return Rounded(rounding(time), time)
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

    def _enclosure(self, name: str, sample: BallSample) -> Any:
        """Return a ball that contains a column, with angles in the unit in use."""
        value: Any = getattr(sample, name)
        if self.wrap and name in {"phi", "psi"}:
            value = sample.wrapped(value)
        in_degrees = self.chosen[name].unit == "angle" and not self.radians
        return value * 180 / sample.ar.pi if in_degrees else value

    def rows(
        self, times: Points, *, radii: bool = False
    ) -> tuple[list[str], Iterator[list[list[NumberText]]]]:
        """Return the header and lists of rows; with `radii` a KEY_radius follows for each KEY.

        Times are the doubles used by `lagtop table` or, if digits are requested, decimals.
        """

        def texts(time: Number) -> list[NumberText]:
            row = self.row(Fraction(time if self.digits else float(time)))
            values = [double_text(x.value) if self.digits is None else x.value for x in row]
            return [*map(NumberText, values), *(x.radius for x in row if radii)]

        def lists() -> Iterator[list[list[NumberText]]]:
            waiting = times.decimals()
            while block := list(islice(waiting, _ROWS_AT_ONCE)):
                yield [texts(time) for time in block]

        return [*self.header, *(f"{name}_radius" for name in self.header if radii)], lists()
