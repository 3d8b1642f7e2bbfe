"""Common mistakes: each is corrected in turn, and the best explanation of an error is named.

Another mistake is one entry of MISTAKES, or of `_mistakes_of_rates` if a start has rates.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs import rotations
from ..inputs.rotations import HALF_TURN_X, HALF_TURN_Z
from ..inputs.seen import Seen
from ..inputs.top import Top
from ..motion.solve import Motion, solve
from .judgement import JudgedRun, ReadTrajectory, errors_of

EXPLAINS = 0.1
"""Largest share of the error that may remain if a mistake explains it."""


class Mistake(NamedTuple):
    """A mistake: another top that moved instead of the intended one, or another reading."""

    name: str
    top: Callable[[Top], Top] | None = None
    """The top that moved, from the intended one."""
    reading: Callable[[ReadTrajectory, Top], ReadTrajectory] = lambda given, _: given
    """The trajectory of the intended top, as read without the mistake."""


def explanation(motion: Motion, run: JudgedRun) -> tuple[str, float] | None:
    """Return the mistake that leaves the least error in the kept rows, if it explains them.

    The result is its name and the greatest remaining error.  Rows that are not finite do not count.
    """
    left = [
        (mistake.name, error)
        for mistake in [*MISTAKES, *_mistakes_of_rates(motion.top)]
        if (error := _error_without(mistake, motion, run.kept)) is not None
    ]
    best = min(left, key=lambda x: x[1], default=None)
    error = run.judgement.error_max
    return best if best and error and best[1] <= EXPLAINS * error else None


def _error_without(mistake: Mistake, motion: Motion, given: ReadTrajectory) -> float | None:
    """Return the greatest error without a mistake, or None if the mistake is impossible."""
    try:
        moved = motion if mistake.top is None else solve(mistake.top(motion.top))
        errors = errors_of(moved, mistake.reading(given, motion.top))
    except LagtopError:
        return None
    return None if np.isnan(errors).all() else float(np.nanmax(errors))


def _tilt(top: Top) -> float:
    return float(top.inputs(radians=True)["theta0_rad"])


def _moment_moved(sign: int) -> Callable[[Top], Top]:
    return lambda top: top.replace(
        A=Fraction(top.A) + sign * Fraction(top.m) * Fraction(top.s) ** 2
    )


def _spin_times(name: str, factor: float) -> Mistake:
    return Mistake(name, lambda top: top.replace(r0=float(top.r0) * factor))


def _tilt_of(top: Top, side: int) -> Top:
    """Return the top whose tilt in degrees is taken as radians, on one side of the vertical."""
    angle = math.remainder(math.degrees(_tilt(top)), 2 * math.pi)
    if angle * side < 0:
        raise LagtopError("the axis starts on the other side")
    return top.replace(theta0_rad=abs(angle), thetadot0=side * top.thetadot0)


def _upside_down(top: Top) -> Top:
    """Return the top seen upside down, so that gravity points upwards."""
    tilt = math.pi - _tilt(top)
    return top.replace(theta0_rad=tilt, psidot0=-top.psidot0, thetadot0=-top.thetadot0)


def _exchanged_moments(top: Top) -> Top:
    """Return a top that moves like one with A and C exchanged, except for its spin.

    The exchanged top need not be a rigid body, as C may exceed 2A.  The returned top has C = A and
    the same a and b.
    """
    return top.replace(A=top.C, C=top.C, r0=Fraction(top.r0) * Fraction(top.A) / Fraction(top.C))


def _with_its_own_spin(given: ReadTrajectory, meant: Top) -> ReadTrajectory:
    """Return the trajectory of a body that spins as the top of `_exchanged_moments`."""
    rate = float(Fraction(meant.r0) * (1 - Fraction(meant.A) / Fraction(meant.C)))

    def changed(seen: Seen) -> Seen:
        angle = rate * seen.t
        angles = {key: x - angle if key == "phi" else x for key, x in seen.angles.items()}
        own, fixed = seen.body_rates, seen.space_rates
        if own is not None:
            own = own - [0.0, 0.0, rate]
        if fixed is not None and seen.quaternion is not None:
            fixed = fixed - rate * rotations.axis_of(seen.quaternion)
        slower = replace(seen, angles=angles, body_rates=own, space_rates=fixed)
        return slower.turned(rotations.IDENTITY, rotations.about_z(angle))

    return given._replace(change=changed)


def _seen(change: Callable[[Seen], Seen]) -> Callable[[ReadTrajectory, Top], ReadTrajectory]:
    """Return the reading that changes the rows of a trajectory."""
    return lambda given, _: given._replace(change=change)


def _with_quaternion(name: str, change: Callable[[Array], Array]) -> Mistake:
    def changed(seen: Seen) -> Seen:
        q = seen.quaternion
        return seen if q is None else replace(seen, quaternion=change(q))

    return Mistake(name, reading=_seen(changed))


def _exchanged(seen: Seen) -> Seen:
    """Return the motion with the names of spin and precession exchanged."""
    if seen.quaternion is not None:
        angles = rotations.angles_of(seen.quaternion)
        q = rotations.of_angles(angles["theta"], phi=angles["psi"], psi=angles["phi"])
        return replace(seen, quaternion=q)
    names = {"theta": "theta", "phi": "psi", "psi": "phi"}
    return replace(seen, angles={names[key]: x for key, x in seen.angles.items()})


def _framed(name: str, *, axis: str = "z", up: str = "z") -> Mistake:
    """Return the mistake of frames with these axes, with angles counted from the first row."""

    def aligned(given: ReadTrajectory, _: Top) -> ReadTrajectory:
        if given.alignment.hides_frames:
            raise LagtopError("the frames come from the first row")
        return given._replace(alignment=given.alignment._replace(start=True, axis=axis, up=up))

    words = [f"{key}={x}" for key, x in (("axis", axis), ("up", up)) if x != "z"]
    return Mistake(f"{name} (--align {','.join([*words, 'start'])})", reading=aligned)


_SIDES = ("x", "y", "-z")
MISTAKES = [
    Mistake(
        "A: the moment about the pivot taken as about the mass centre (A + m s^2)", _moment_moved(1)
    ),
    Mistake(
        "A: the moment about the mass centre taken as about the pivot (A - m s^2)",
        _moment_moved(-1),
    ),
    Mistake("A and C exchanged", _exchanged_moments, _with_its_own_spin),
    _spin_times("r0 with the wrong sign", -1),
    _spin_times("r0 in radians taken as degrees", math.pi / 180),
    _spin_times("r0 in degrees taken as radians", 180 / math.pi),
    _spin_times("r0 in radians taken as turns a minute", math.pi / 30),
    _spin_times("r0 in turns a minute taken as radians", 30 / math.pi),
    Mistake("theta0 in radians taken as degrees", lambda top: top.replace(theta0_deg=_tilt(top))),
    Mistake("theta0 in degrees taken as radians", lambda top: _tilt_of(top, 1)),
    Mistake(
        "theta0 in degrees taken as radians",
        lambda top: _tilt_of(top, -1),
        _seen(lambda seen: seen.turned(HALF_TURN_Z, HALF_TURN_Z)),
    ),
    Mistake("g left out", lambda top: top.replace(g=0)),
    Mistake(
        "g upwards",
        _upside_down,
        _seen(
            lambda seen: seen.turned(
                rotations.product(rotations.conjugate(HALF_TURN_Z), HALF_TURN_X),
                rotations.conjugate(HALF_TURN_Z),
            )
        ),
    ),
    _with_quaternion("the quaternion is the conjugate, from space to body", rotations.conjugate),
    _with_quaternion("the quaternion is xyzw and was read as wxyz", lambda q: np.roll(q, 1, 1)),
    _with_quaternion("the quaternion is wxyz and was read as xyzw", lambda q: np.roll(q, -1, 1)),
    Mistake("phi and psi are exchanged", reading=_seen(_exchanged)),
    Mistake(
        "the angular velocity is in the other frame (--rates-frame)",
        reading=_seen(lambda x: replace(x, body_rates=x.space_rates, space_rates=x.body_rates)),
    ),
    Mistake(
        "angles in degrees taken as radians, or the reverse",
        reading=lambda given, _: given.with_conventions(radians=not given.conventions.radians),
    ),
    _framed("spin and precession do not start at 0"),
    *(_framed(f"the figure axis is the body's {x} axis", axis=x) for x in _SIDES),
    *(_framed(f"up is the {x} axis of space", up=x) for x in _SIDES),
    *(_framed(f"the figure axis and up are the {x} axes", axis=x, up=x) for x in _SIDES),
]
"""Mistakes that are possible with any top."""


def _mistakes_of_rates(top: Top) -> Iterator[Mistake]:
    """Yield the mistakes of a start that is not at rest."""
    if top.psidot0:
        along = Fraction(top.psidot0) * Fraction(math.cos(_tilt(top)))
        yield Mistake("psidot0 with the wrong sign", lambda x: x.replace(psidot0=-x.psidot0))
        yield Mistake("r0 taken as phi'", lambda x: x.replace(r0=Fraction(x.r0) + along))
        yield Mistake("phi' taken as r0", lambda x: x.replace(r0=Fraction(x.r0) - along))
    if top.thetadot0:
        yield Mistake("thetadot0 with the wrong sign", lambda x: x.replace(thetadot0=-x.thetadot0))
