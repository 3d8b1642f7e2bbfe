"""The columns of `lagtop table` at arrays of times, and blocks of rows for the writer."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cache, reduce
from operator import or_
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...arithmetic.arrays import ARRAYS, BLOCK, blocks, doubles_of, workspace
from ...arithmetic.points import EvenPoints, Points
from ...arithmetic.types import Array
from ...inputs.names import ANGLES
from ..numbers import Numbers
from ..quantity import quantity
from .attitude import Attitude, needed
from .column_parts import ColumnConstants, ColumnParts, column_constants
from .columns import DEFAULT_COLUMNS, Column, chosen_columns, headings
from .proved_table import ProvedTable
from .samplers import near
from .series_constants import direction


class Sample(ColumnParts[Array]):
    """The motion at a block of times."""

    ar: Any = ARRAYS

    def __init__(
        self, attitude: Attitude, top: ColumnConstants[Array], rises: int, wrap: bool
    ) -> None:
        self.attitude = attitude
        self.growths, self.times = attitude.growths, attitude.times
        self.t, self.top, self.rises, self.wrap = self.times.t, top, rises, wrap

    @property
    def tilt(self) -> Array:
        """The angle theta."""
        return self.attitude.theta()

    @property
    def spin(self) -> Array:
        """The angle phi."""
        return self.attitude.phi(wrap=self.wrap)

    @property
    def precession(self) -> Array:
        """The angle psi."""
        return self.attitude.psi(wrap=self.wrap)

    @quantity
    def spin_wave(self) -> Array:
        """The periodic part of the spin (6,4)."""
        return self.growths.phi.since_start(np.subtract(*self.attitude.args), self.times)

    @quantity
    def precession_wave(self) -> Array:
        """The periodic part of the precession (7,4)."""
        return self.growths.psi.since_start(np.add(*self.attitude.args), self.times)

    @quantity
    def x2(self) -> Array:
        """|X|^2."""
        return needed(self.attitude.x2)

    @quantity
    def y2(self) -> Array:
        """|Y|^2."""
        return needed(self.attitude.y2)

    @quantity
    def x(self) -> Array:
        """|X|."""
        return np.sqrt(self.x2)

    @quantity
    def y(self) -> Array:
        """|Y|."""
        return np.sqrt(self.y2)

    @quantity
    def thetadot(self) -> Array:
        """The nutation rate (5,3); on a pole by the energy (4,2), with the sign of the start."""
        product = 2.0 * self.norm * self.x * self.y
        speed = np.sqrt(np.maximum(self.top.alpha - self.top.a * self.u, 0.0))
        speed *= self.rises
        return np.divide(needed(self.attitude.rate), product, out=speed, where=product != 0.0)

    @quantity
    def within(self) -> Array:
        """The spin, up to whole turns."""
        return self.attitude.phi(wrap=True)

    @quantity
    def around(self) -> Array:
        """The precession, up to whole turns; the line of nodes lies along x at psi = 0."""
        return self.attitude.psi(wrap=True)

    @quantity
    def quarters(self) -> Sequence[tuple[Array, Array]]:
        """(psi + phi)/2 and (psi - phi)/2, reduced by half turns, with the signs of X and Y."""
        assert self.growths.halves is not None
        halves = zip(self.growths.halves(), self.attitude.args, strict=True)
        return [half.within_a_quarter(arg.copy(), self.times) for half, arg in halves]

    @quantity
    def args(self) -> tuple[Array, Array]:
        """(psi + phi)/2 and (psi - phi)/2, reduced by half turns."""
        (arg_x, _), (arg_y, _) = self.quarters
        return arg_x, arg_y

    @quantity
    def unit(self) -> tuple[Array, Array]:
        """|X| and |Y|, each over sqrt(N), with the signs that make the quaternion continuous."""
        (_, sign_x), (_, sign_y) = self.quarters
        x, y = super().unit
        return sign_x * x, sign_y * y

    def over(self, value: Array, divisor: Array) -> Array:
        """Return the quotient, and 0 for 0/0."""
        return np.divide(value, divisor, out=np.zeros_like(divisor), where=divisor != 0.0)


def samples(
    motion: Numbers, t: Array, chosen: Mapping[str, Column], *, wrap: bool
) -> Iterator[tuple[slice, Sample]]:
    """Yield the motion at the times t, block by block, with the parts that some columns need.

    The next sample overwrites the one before.
    """
    sampler, kind = motion.sampler(), motion.sharp()
    needs = reduce(or_, (column.needs for column in chosen.values()))
    constants = ColumnConstants(*(np.array(near(x)) for x in column_constants(kind, motion.exact)))
    farthest = sampler.check(t)
    with workspace(min(t.size, BLOCK)) as space:
        for part in blocks(t.size):
            with ARRAYS.working():
                attitude = sampler.attitude(t[part], needs, farthest, space)
            yield part, Sample(attitude, constants, direction(kind), wrap)


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
    chosen, header = chosen_columns(columns), headings(columns, radians=radians)
    ends = ("t_min", "t_max") if isinstance(times, EvenPoints) else ("t", "t")
    for name, end in zip(ends, times.bounds(), strict=False):  # empty if times are read later
        motion.sampler().check(end, name)
    angles = [i for i, name in enumerate(ANGLES) if stds is not None and name in columns]
    names = [f"{heading}_std" for i in angles for heading in headings([ANGLES[i]], radians=radians)]

    write = _writer(motion, columns, radians=radians, wrap=wrap)

    def blocks() -> Iterator[Array]:
        for t in times.blocks():
            for _, sample in samples(motion, t, chosen, wrap=wrap):
                block = np.empty((sample.t.size, len(chosen) + len(angles)))
                write(sample, block.T)
                if stds is not None:
                    spread = stds(sample.t)[angles]
                    block.T[len(chosen) :] = six_digits(spread if radians else np.degrees(spread))
                yield block

    return [*header, *names], blocks()


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
    chosen, times = chosen_columns(columns), doubles_of("t", t)
    motion.sampler().check(times)
    flat = np.ascontiguousarray(times).reshape(-1)
    found = {name: np.empty_like(flat) for name in chosen}
    write = _writer(motion, columns, radians=True, wrap=wrap)
    with ARRAYS.working():
        for part, sample in samples(motion, flat, chosen, wrap=wrap):
            write(sample, [values[part] for values in found.values()])
    return {name: values.reshape(times.shape) for name, values in found.items()}


def _writer(
    motion: Numbers, columns: Sequence[str], *, radians: bool, wrap: bool
) -> Callable[[Sample, Iterable[Array]], None]:
    """Return a function that writes the columns of a sample into arrays, one for each column."""
    chosen = chosen_columns(columns)

    @cache
    def start() -> list[float]:
        """Return the correctly rounded columns at t = 0."""
        table = ProvedTable(motion, columns, radians=radians, wrap=wrap)
        return [number.value for number in table.row(Fraction(0))]

    def write(sample: Sample, targets: Iterable[Array]) -> None:
        first = sample.t == 0
        at_start = bool(first.any())
        for i, (name, target) in enumerate(zip(chosen, targets, strict=False)):
            target[:] = sample.column(name)
            if chosen[name].is_angle and not radians:
                np.degrees(target, out=target)
            if at_start:
                target[first] = start()[i]

    return write
