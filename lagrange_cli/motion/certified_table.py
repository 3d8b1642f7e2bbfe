"""Proved columns of one motion over time: enclosures of the attitude, rounded to what is printed.

The attitude is that of the theta series in balls (`series_constants`), whose remainders are proved
in `theta_series`, so that the unwrapped turns are proved with it.  A column here has the name of a
method of `sample.Sample`, of which it is the exact value.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cached_property, partial
from itertools import islice
from typing import TYPE_CHECKING, Any, cast

from ..arithmetic.balls import Ball
from ..arithmetic.numbers import Number
from ..arithmetic.proved_rounding import Proved, about, proved
from ..arithmetic.text import NumberText, double_text
from ..errors import LagtopError
from .certified import Certified, rounding
from .columns import COLUMNS, Part, chosen_columns, name_of
from .kinds import Constant, Kind, Separatrix
from .rational_keys import known_fraction
from .series_constants import Attitude, Spinor
from .table import headings

if TYPE_CHECKING:
    from ..arithmetic.balls import Balls
    from ..arithmetic.points import Points

ROWS = 64
"""Rows that settle together."""


class BallSample:
    """A motion at one time in balls; a quantity is computed when it is asked for."""

    def __init__(self, kind: Kind[Ball], t: Ball, at: Attitude[Ball], *, wrap: bool) -> None:
        self.kind, self.t, self.at, self.wrap = kind, t, at, wrap
        self.ar = cast("Balls", kind.ar)

    def theta(self) -> Ball:
        """Return the tilt."""
        return 2 * self.ar.atan2(self.at.y, self.at.x)

    def phi(self) -> Ball:
        """Return the spin."""
        return self._angle(self.at.phi)

    def psi(self) -> Ball:
        """Return the precession."""
        return self._angle(self.at.psi)

    def _angle(self, angle: Ball) -> Ball:
        """Return an angle as it stands, or in (-pi, pi]."""
        if not self.wrap:
            return angle
        ar, pi = self.ar, self.ar.pi
        if self.kind.facts.plane:  # half turns, where both ends belong to pi
            return pi * (ar.nint(angle / pi) % 2)
        return angle - 2 * pi * ar.ceiling(angle / (2 * pi) - 1 / ar.convert(2))

    @cached_property
    def growths(self) -> tuple[Ball, Ball]:
        """Mean growth of spin and precession, on the separatrix in infinite time."""
        kind = self.kind
        if isinstance(kind, Separatrix):
            return kind.state.spin_drift * self.t, kind.b / 2 * self.t
        return kind.mean_spin_rate * self.t, kind.mean_precession_rate * self.t

    def phi_remainder(self) -> Ball:
        """Return the spin less its mean growth (6,4)."""
        constant = isinstance(self.kind, Constant)
        return 0 * self.t if constant else self.at.phi - self.growths[0]

    def psi_remainder(self) -> Ball:
        """Return the precession less its mean growth (7,4)."""
        constant = isinstance(self.kind, Constant)
        return 0 * self.t if constant else self.at.psi - self.growths[1]

    @cached_property
    def unit(self) -> tuple[Ball, Ball]:
        """|X| and |Y| over the root of the sum of their squares."""
        x, y = self.at.x, self.at.y
        size = self.ar.sqrt(x * x + y * y)
        return x / size, y / size

    def cosine(self) -> Ball:
        """Return cos(theta) (4,6)."""
        x, y = self.unit
        return (x - y) * (x + y)

    def sine(self) -> Ball:
        """Return sin(theta)."""
        x, y = self.unit
        return 2 * x * y

    @cached_property
    def poles(self) -> tuple[Ball, Ball]:
        """(beta + b)/2/(1 + u) and (beta - b)/2/(1 - u), the two parts of the precession rate."""
        (x, y), gaps = self.unit, self.kind.gaps
        south, north = (
            0 * momentum if not momentum else momentum / (4 * part * part)
            for momentum, part in ((gaps.beta_plus_b, x), (gaps.beta_minus_b, y))
        )
        return south, north

    def phi_rate(self) -> Ball:
        """Return the spin rate (4,8)."""
        south, north = self.poles
        return self.kind.state.pole_drift + south - north

    def psi_rate(self) -> Ball:
        """Return the precession rate (4,7)."""
        south, north = self.poles
        return south + north

    def r(self) -> Ball:
        """Return the angular velocity about the figure axis."""
        return self.kind.r0

    def axis_x(self) -> Ball:
        """Return the x part of the figure axis in space."""
        return self.sine() * self.ar.sin(self.at.psi)

    def axis_y(self) -> Ball:
        """Return the y part of the figure axis in space."""
        return -self.sine() * self.ar.cos(self.at.psi)

    def quaternion_w(self) -> Ball:
        """Return the real part of X = w + i z, of the rotation from body to space."""
        return self.unit[0] * self.ar.cos((self.at.psi + self.at.phi) / 2)

    def quaternion_x(self) -> Ball:
        """Return the real part of Y = x + i y."""
        return self.unit[1] * self.ar.cos((self.at.psi - self.at.phi) / 2)

    def quaternion_y(self) -> Ball:
        """Return the imaginary part of Y = x + i y."""
        return self.unit[1] * self.ar.sin((self.at.psi - self.at.phi) / 2)

    def quaternion_z(self) -> Ball:
        """Return the imaginary part of X = w + i z."""
        return self.unit[0] * self.ar.sin((self.at.psi + self.at.phi) / 2)


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
        """Raise LagtopError for an unknown column, and for one that is not proved."""
        self.motion, self.digits, self.radians, self.wrap = motion, digits, radians, wrap
        self.chosen = chosen_columns(columns)
        for part in self.chosen:
            if part.method != "times" and not hasattr(BallSample, part.method):
                known = ", ".join(name for name in COLUMNS if _is_proved(name))
                raise LagtopError(f"columns to certify must be among {known}, got {name_of(part)}")
        self.header = headings(columns, radians=radians)
        self._spinors: dict[int, Spinor[Ball]] = {}
        scene = motion.exact
        rates = (scene.b, scene.r0, scene.theta_rate, scene.psi_rate)
        self._speed = sum(map(abs, rates)) + scene.a + 1

    def sample(self, t: Fraction, bits: int) -> BallSample:
        """Return the motion at a time in balls of so many bits.

        Raises TooFewDigitsError where these do not tell the roots or the half periods apart.
        """
        kind = self.motion.kind(bits)
        ar = kind.ar
        with ar.working():
            if bits not in self._spinors:
                self._spinors[bits] = kind.spinor()
            time = ar.convert(t)
            at = self._spinors[bits](time) if t else _start(kind, time)
            return BallSample(kind, time, at, wrap=self.wrap)

    def row(self, time: Fraction) -> list[Proved[Any]]:
        """Return the numbers of the columns at a time, which is exact.

        Raises LagtopError where no precision tells one from 0 or a tie.
        """
        samples: dict[int, BallSample] = {}

        def enclosure(part: Part, bits: int) -> Ball:
            if bits not in samples:
                samples[bits] = self.sample(time, bits)
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
                exactly=partial(self._known, part, time),
            )
            assert number is not None
            found.append(number)
        return found

    def _bits_of(self, time: Fraction) -> int:
        """Return about how many bits whole turns take, in steps, so that precisions come again."""
        turns = abs(time) * self._speed
        return 64 * (math.ceil(turns).bit_length() // 32)

    def _known(self, part: Part, time: Fraction) -> Fraction | None:
        """Return an angle of a constant motion where it is a fraction; there ties are possible."""
        scene, name = self.motion.exact, part.method
        if not scene.facts.steady:
            return None
        if name == "theta":
            return scene.cosine.radians if self.radians else scene.cosine.degrees
        rate = {"phi": "mean_spin_rate", "psi": "mean_precession_rate"}.get(name)
        if rate is None or self.wrap or not self.radians:
            return None
        known = known_fraction(scene, rate)
        return None if known is None else known * time


def _is_proved(name: str) -> bool:
    """Return whether all parts of a column are methods of `BallSample`, or times."""
    methods = (part.method for part in COLUMNS[name].parts)
    return all(method == "times" or hasattr(BallSample, method) for method in methods)


def _start(kind: Kind[Ball], zero: Ball) -> Attitude[Ball]:
    return Attitude(kind.state.cos_half, kind.state.sin_half, zero, zero, zero)


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
