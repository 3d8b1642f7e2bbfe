"""Proved columns of one motion over time: enclosures of the attitude, rounded to what is printed.

The numbers are those of `certified_sample`, rounded where both ends of a ball round alike.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import partial
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
"""Rows that settle together."""


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
        samples: dict[int, BallSample] = {}

        def enclosure(part: Part, bits: int) -> Ball:
            if bits not in samples:
                samples[bits] = sample_at(self.motion, time, bits, wrap=self.wrap)
            with samples[bits].ar.working():
                value: Ball = getattr(samples[bits], part.method)()
                in_degrees = part.heading.endswith("*") and not self.radians
                return value * 180 / samples[bits].ar.pi if in_degrees else value

        found = []
        for part in self.chosen:
            what = f"{name_of(part)} at t = {float(time)}"
            if part.method == "times":
                found.append(about(rounding(what, self.digits)(time), time))
                continue
            number = proved(
                what,
                partial(enclosure, part),
                rounding(what, self.digits),
                digits=self.digits or 0,
                more=self._bits_of(time),
                exactly=partial(
                    known_column,
                    self.motion.exact,
                    part.method,
                    time,
                    radians=self.radians,
                    wrap=self.wrap,
                ),
            )
            assert number is not None
            found.append(number)
        return found

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
