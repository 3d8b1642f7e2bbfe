"""The worst errors of one scene of the battery: of its record, angles and quaternion.

Errors of numbers are in gaps between doubles, errors of angles in units (see `reference`).  They
are found with a reference in many digits, or they are upper bounds, proved by the enclosures of
`solve` and of `table --certify`.  These balls contain the exact numbers, angles and rates, and
include all errors of rounding and truncation.  Each error is bounded from above, and its unit from
below.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

import mpmath
import numpy as np

from ..arithmetic.ball import Ball, TooFewDigitsError
from ..arithmetic.balls import balls
from ..arithmetic.points import ListedPoints
from ..arithmetic.rounding import decided
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.top import Top
from ..motion.over_time.proved_table import BallSample, ProvedTable
from ..motion.over_time.table import rows
from ..motion.record import NUMBER_KEYS
from ..motion.solve import Motion, solve
from .hard_scenes import STRATA, Scene, in_doubles, signed, ten_to
from .integrators import problem_of
from .measure import check_scene, settled_reference
from .reference import Reference, angle_units, key_ulps, quaternion_units

CONTRACT = 4.0
"""Promised bound of the errors of angles and of the quaternion, in units."""
KEY_CONTRACT = 0.5 + 1e-9
"""Promised bound of the error of a key, in gaps between doubles: half, with a margin for ties."""

JUDGED_COLUMNS = ("theta", "phi", "psi", "quaternion", "energy", "Lz")
"""Columns of `lagtop table` that are judged."""
_NARROW = 2**10
"""Inverse of the radius of a ball, in units, that gives an error to three digits."""
_SHARP = Decimal("1e-12")
"""Radius of the distance of a key, in gaps between doubles; half a gap is the promise."""
_DIGITS = 40
"""Digits of the period, the unit of the times of a scene."""


class Case(NamedTuple):
    """The worst errors of lagtop in one scene, and their times."""

    top: Top
    theta_units: float
    phi_units: float
    psi_units: float
    quaternion_units: float
    key_ulps: float
    """Worst error of a key, in gaps between doubles."""
    worst_key: str
    energy: float
    """Change of the energy since t = 0, over the sum of its terms."""
    Lz: float
    """Change of the vertical angular momentum, over the sum of its terms."""
    worst_time: float
    """Time of the worst angle."""
    worst_attitude_time: float
    """Time of the worst quaternion."""
    agreement: float
    """Greatest difference between references at two precisions, in units."""

    @property
    def angle_units(self) -> float:
        """The worst error of the three angles."""
        return max(self.theta_units, self.phi_units, self.psi_units)

    @property
    def excesses(self) -> tuple[float, float, float]:
        """Errors of angles, quaternion and keys over their promised bounds."""
        key = self.key_ulps / KEY_CONTRACT
        return self.angle_units / CONTRACT, self.quaternion_units / CONTRACT, key

    @property
    def excess(self) -> float:
        """The worst of the excesses."""
        return max(self.excesses)

    def command(self) -> str:
        """Return a command line that shows the worst number of the scene."""
        options, (angle, attitude, key) = self.top.options(), self.excesses
        if key > max(angle, attitude):
            return f"lagtop solve {options} --format json  # {self.worst_key}"
        if attitude > angle:
            t = self.worst_attitude_time
            return f"lagtop table {options} --columns t,quaternion --n 1 --t-min {t!r}"
        return f"lagtop bench --methods lagtop {options} --n 1 --t-max {self.worst_time!r}"


def case_of(
    motion: Motion,
    times: Sequence[float],
    units: Callable[[float, Sequence[float]], Sequence[float]],
    key_error: Callable[[str, float | None], float],
    agreement: float = 0.0,
) -> Case:
    """Return the worst errors of a motion, at times and of its record.

    `units` judges a row of JUDGED_COLUMNS at a time, three angles and the quaternion.  `key_error`
    judges a number of the record, in gaps between doubles.
    """
    points = ListedPoints([Fraction(t) for t in (0.0, *times)])
    _, blocks = rows(motion, points, JUDGED_COLUMNS, radians=True)
    values = np.concatenate(list(blocks))
    errors = np.array([units(t, row) for t, row in zip(times, values[1:].tolist(), strict=True)])
    theta, phi, psi, attitude = errors.max(axis=0).tolist()
    worst_angle, worst_attitude = errors[:, :3].max(axis=1).argmax(), errors[:, 3].argmax()
    key = max((key_error(key, getattr(motion, key)), key) for key in NUMBER_KEYS)
    return Case(
        *(motion.top, theta, phi, psi, attitude, *key),
        *conserved_changes(motion.top, values[:, -2:]),
        *(times[int(worst_angle)], times[int(worst_attitude)], agreement),
    )


class HardScene(NamedTuple):
    """A scene of the battery, and the times at which it is checked."""

    inputs: Scene
    periods: list[float]
    """Random times, in nutation periods."""
    quarters: list[int]
    """Times at which angles might leap, in quarters of a period."""

    def times(self, period: Any) -> list[float]:
        """Return all times, with both neighbours of the double next to each quarter.

        `period` is the exact nutation period, in many digits.
        """
        times = [float(period * number) for number in self.periods]
        for number in self.quarters:
            t = float(period * number / 4)
            times += [t, math.nextafter(t, math.inf), math.nextafter(t, -math.inf)]
        return times


def hard_scene(stratum: str, seed: int, i: int, count: int) -> HardScene:
    """Return the i-th scene of a stratum, with `count` random times and two special ones.

    The special times are a number of half periods, one before and one after the start.  One of them
    may be a number of quarters or whole periods instead.
    """
    rng = random.Random(f"{seed} {stratum} {i}")
    scene = judged_inputs(stratum, rng)
    least, nearest = (11, 11) if stratum == "far times" else (-9, 0)
    periods = [signed(rng, ten_to(rng, least, 14)) for _ in range(count)]
    if stratum == "half periods":
        periods = [round(2 * x) / 2 for x in periods]
    sides = rng.sample([-1, 1], 2)
    halves = [4 * int(ten_to(rng, nearest, 14)) + part for part in (2, rng.randrange(4))]
    return HardScene(scene, periods, [side * n for side, n in zip(sides, halves, strict=True)])


def judged_inputs(stratum: str, rng: random.Random) -> Scene:
    """Return the inputs, as doubles, of a scene of a stratum that the reference can check."""
    while True:
        scene = in_doubles(STRATA[stratum](rng))
        with suppress(LagtopError):
            check_scene(solve(Top(**scene)))
            return scene


def judged_case(scene: HardScene, settled: tuple[Reference, float] | None = None) -> Case:
    """Return the errors of one scene; its `settled_reference` may be passed."""
    motion = solve(Top(**scene.inputs))
    reference, agreement = settled or settled_reference(motion.top)
    record = reference.record()

    def units(t: float, row: Sequence[float]) -> Sequence[float]:
        exact = reference.at(t)
        return *angle_units(row[:3], exact), quaternion_units(row[3:7], exact)

    def key_error(key: str, value: float | None) -> float:
        """Return the error of a key; it is infinite if only one of record and motion has it."""
        exact = record[key]
        if value is None or exact is None:
            return 0.0 if value is exact else math.inf
        return key_ulps(value, exact, reference.digits)

    return case_of(motion, scene.times(reference.T), units, key_error, agreement)


def conserved_changes(top: Top, values: Array) -> tuple[float, float]:
    """Return the changes of energy and Lz, the columns of `values`, since its first row, t = 0.

    The changes are over the sum of the terms.
    """
    sizes = float(top.A) * np.array(problem_of(top).sizes)
    energy, Lz = (np.max(abs(values - values[0]), axis=0) / sizes).tolist()
    return energy, Lz


def prove(scene: HardScene) -> Case:
    """Return proved upper bounds of the errors of a scene."""
    motion = solve(Top(**scene.inputs))
    proofs = ProvedTable(motion, JUDGED_COLUMNS[:4])
    period = motion.number("T_nutation", _DIGITS)
    assert period is not None
    with mpmath.workdps(_DIGITS):
        times = scene.times(mpmath.mpf(period.value))

    def units(t: float, row: Sequence[float]) -> Sequence[float]:
        *angles, w, x, y, z = bounds_at(proofs, t, row[:7])
        return *angles, max(w, x, y, z)

    return case_of(motion, times, units, partial(key_bound, motion))


def key_bound(motion: Motion, key: str, value: float | None) -> float:
    """Return a bound of the error of a key, in gaps between doubles, from fresh enclosures.

    It is infinite if only one of record and motion has the key.
    """

    def bound(digits: int) -> float:
        try:
            exact = motion.enclosure(key, digits)
            if value is None or exact is None:
                return 0.0 if value is None and exact is None else math.inf
            return ulps(value, exact)
        except TooFewDigitsError:
            known = motion.fraction(key)
            if known is None or value is None:
                raise
            return ulps(value, balls(digits).convert(known))

    return decided(key, bound)


def ulps(value: float, exact: Ball) -> float:
    """Return a bound of the distance of a double from all in a ball, in gaps between doubles.

    The gap is the one on the side of the ball.  Raises TooFewDigitsError if the bound is not sharp.
    """
    above, below = (abs(math.nextafter(value, x) - value) for x in (math.inf, -math.inf))
    ar = exact.ar
    away = exact - ar.convert(value)
    gap = above if (away > 0) is True else below if (away < 0) is True else min(above, below)
    ratio = away / ar.convert(gap)
    if not ratio.radius < _SHARP:
        raise TooFewDigitsError
    return math.nextafter(float(abs(ratio.middle) + ratio.radius), math.inf)


def bounds_at(proofs: ProvedTable, t: float, computed: Sequence[float]) -> list[float]:
    """Return upper bounds of the errors of the angles and of the quaternion at a time, in units.

    Raises LagtopError if no precision makes an enclosure small compared with its unit.
    """
    sample = partial(proofs.sample, Fraction(t))
    return decided(f"the error at t = {t}", lambda digits: _bounds(sample(digits), computed))


def _bounds(sample: BallSample, computed: Sequence[float]) -> list[float]:
    if not all(map(math.isfinite, computed)):
        return [math.inf] * len(computed)
    angles = [sample.column(name) for name in JUDGED_COLUMNS[:3]]
    exact = [*angles, *(sample.column(f"quaternion_{part}") for part in "wxyz")]
    return [
        _bound(ball - sample.t.ar.convert(value), size / 2**52)
        for ball, value, size in zip(exact, computed, _sizes(sample, angles), strict=True)
    ]


def _sizes(sample: BallSample, angles: Sequence[Ball]) -> list[Ball]:
    """Return lower bounds of the units of the angles and of the quaternion's parts, over 2^-52."""
    ar, period = sample.t.ar, sample.kind.T_nutation
    assert period is not None
    tau = sample.t - period * ar.nint(sample.t / period)
    square, across, r0 = sample.theta_square, sample.across, sample.kind.r0
    theta_rate = ar.sqrt(square) if (square > 0) is True else 0 * square
    turning = ar.sqrt(theta_rate * theta_rate + across * across + r0 * r0) / 2
    rates = theta_rate, sample.column("phidot"), sample.column("psidot")
    sizes = [
        ar.exact(max(angle.least, Decimal(1))) + ar.exact((tau * rate).least)
        for angle, rate in zip(angles, rates, strict=True)
    ]
    return [*sizes, *[1 + ar.exact((tau * turning).least)] * 4]


def _bound(error: Ball, unit: Ball) -> float:
    """Return a bound of an error in units.  Raises TooFewDigitsError if it is not sharp."""
    if not error.radius * _NARROW < unit.least:
        raise TooFewDigitsError
    return float((error / unit).greatest)  # its few digits are printed as they are
