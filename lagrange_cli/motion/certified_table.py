"""Proved columns of one motion over time: enclosures of the attitude, rounded to what is printed.

The numbers are those of `certified_sample`, rounded where both ends of a ball round alike.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from functools import cache, partial
from itertools import islice
from typing import TYPE_CHECKING, Any

from ..arithmetic.numbers import Number
from ..arithmetic.proved_rounding import Proved, about, proved
from ..arithmetic.text import NumberText, double_text
from .certified import Certified, rounding
from .certified_sample import BallSample, sample_at
from .columns import Part, chosen_columns, name_of
from .rational_columns import known_column
from .table import headings

if TYPE_CHECKING:
    from ..arithmetic.balls import Ball
    from ..arithmetic.points import Points

ROWS = 64
"""Rows that are handed on together."""


class CertifiedTable:
    """Columns of a motion over time, each number with its radius."""

    def __init__(
        self,
        motion: Certified,
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
        rates = (scene.b, scene.r0, scene.theta_rate, scene.psi_rate)
        self._speed = sum(map(abs, rates)) + scene.a + 1

    def row(self, time: Fraction) -> list[Proved[Any]]:
        """Return the numbers of the columns at a time, which is exact.

        Raises LagtopError where no precision tells one from 0 or a tie.
        """
        sample = cache(lambda bits: sample_at(self.motion, time, bits, wrap=self.wrap))
        return [self._number(part, time, sample) for part in self.chosen]

    def _number(
        self, part: Part, time: Fraction, sample: Callable[[int], BallSample]
    ) -> Proved[Any]:
        """Return a column at a time, at which `sample` gives the motion in so many bits."""
        what = f"{name_of(part)} at t = {float(time)}"
        to = rounding(what, self.digits)
        if part.method == "times":
            return about(to(time), time)
        scene, units = self.motion.exact, {"radians": self.radians, "wrap": self.wrap}
        number = proved(
            what,
            lambda bits: self._enclosure(part, sample(bits)),
            to,
            digits=self.digits or 0,
            more=self._bits_of(time),
            exactly=partial(known_column, scene, part.method, time, **units),
        )
        assert number is not None
        return number

    def _enclosure(self, part: Part, sample: BallSample) -> Ball:
        """Return a ball that holds a column, angles in the unit in use."""
        with sample.ar.working():
            value: Ball = getattr(sample, part.method)()
            in_degrees = part.heading.endswith("*") and not self.radians
            return value * 180 / sample.ar.pi if in_degrees else value

    def _bits_of(self, time: Fraction) -> int:
        """Return about how many bits whole turns take, in steps, so that precisions come again."""
        turns = abs(time) * self._speed
        return 64 * (math.ceil(turns).bit_length() // 32)


def certified_rows(
    table: CertifiedTable, times: Points, *, radii: bool
) -> tuple[list[str], Iterator[list[list[NumberText]]]]:
    """Return the header and lists of rows; with `radii` a column KEY_radius for each KEY follows.

    Times are the doubles that `lagtop table` computes at or, where digits are asked for, decimals.
    """
    header = [*table.header, *(f"{name}_radius" for name in table.header if radii)]

    def lists() -> Iterator[list[list[NumberText]]]:
        waiting: Iterator[Number] = times.decimals()
        if table.digits is None:
            waiting = (float(time) for time in waiting)
        while block := list(islice(waiting, ROWS)):
            yield [_texts(table.row(Fraction(time)), radii=radii) for time in block]

    return header, lists()


def _texts(row: Sequence[Proved[Any]], *, radii: bool) -> list[NumberText]:
    values = [
        NumberText(double_text(x.value)) if isinstance(x.value, float) else x.value for x in row
    ]
    return [*values, *(x.radius for x in row if radii)]
