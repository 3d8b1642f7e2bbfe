"""Causes of errors that engines and students produce: each is tried by computing without it.

Another cause is one line of CAUSES.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs import rotations
from ..inputs.observed import Observed
from ..inputs.top import Top
from ..motion.solve import Motion, solve
from .differences import Alignment, Trajectory, sizes

EXPLAINS = 0.1
"""Largest share of the error that may remain if a cause explains it."""
_AS_GOOD, _ROUNDING = 10.0, 1e-9
"""Factor between the remaining errors of two causes, and least error, that make no difference."""
_MOST_SHIFTS = 500


class Cause(NamedTuple):
    """A cause of errors: another top that moved, another reading of the rows, or both."""

    name: str
    top: Callable[[Top], Top] | None = None
    """The top that moved, from the intended one."""
    change: Callable[[Observed, Top], Observed] = lambda run, _: run
    """The motion of that top, from the given motion and the intended top."""
    rows: Callable[[Trajectory], Trajectory] = lambda trajectory: trajectory
    """The trajectory as it was meant."""

    def error(self, motion: Motion, trajectory: Trajectory, most: int) -> float:
        """Return the greatest error without the cause, in some rows; infinite if impossible."""
        try:
            moved = motion if self.top is None else solve(self.top(motion.top))
            few = self.rows(trajectory).few(most)
            return few.greatest(moved, lambda run: self.change(run, motion.top))
        except LagtopError:
            return math.inf


def likely_cause(motion: Motion, trajectory: Trajectory, limit: float) -> tuple[str, float] | None:
    """Return the cause that explains the error best, and the greatest error without it.

    A cause explains an error if it takes off nine tenths.  Of those that bring the error below the
    limit, return the simplest that leaves about as little as the best; else return the best.
    """
    count = len(trajectory.given["t"])
    enough = EXPLAINS * Cause("").error(motion, trajectory, count)
    causes = [*CAUSES, _shifted_clock(motion, trajectory)]
    hopeful = [x for x in causes if x.error(motion, trajectory, 300) <= enough]
    found = [(x.name, x.error(motion, trajectory, count)) for x in hopeful]
    least = min((error for _, error in found), default=math.inf)
    if least <= limit:
        enough = min(enough, limit, max(_AS_GOOD * least, _ROUNDING))
    else:
        enough = min(enough, least)
    return next((x for x in found if x[1] <= enough), None)


def _input(name: str, **changes: Callable[[Top], Any]) -> Cause:
    """Return the cause that some inputs were others."""
    return Cause(name, lambda top: top.replace(**{key: of(top) for key, of in changes.items()}))


def _gravity(g: str) -> Cause:
    return _input(f"g is {g} (or m or s is wrong by as much)", g=lambda _: Fraction(g))


def _moment(name: str, sign: int) -> Cause:
    return _input(name, A=lambda x: Fraction(x.A) + sign * Fraction(x.m) * Fraction(x.s) ** 2)


def _spin(name: str, factor: float) -> Cause:
    return _input(f"r0 {name}", r0=lambda top: float(top.r0) * factor)


def _tilt(top: Top) -> float:
    return float(top.inputs(radians=True)["theta0_rad"])


def _tilted(name: str, angle_of: Callable[[float], float]) -> Cause:
    """Return the cause that the tilt was another, perhaps to the other side of the vertical."""

    def moved(top: Top) -> Top:
        angle = math.remainder(angle_of(_tilt(top)), 2 * math.pi)
        rate = math.copysign(1.0, angle) * float(top.thetadot0)
        return top.replace(theta0_rad=abs(angle), thetadot0=rate)

    return Cause(f"theta0 {name}", moved, rows=_aligned("start"))


def _upside_down(top: Top) -> Top:
    """Return the top seen upside down, so that gravity points upwards."""
    tilt = math.pi - _tilt(top)
    return top.replace(theta0_rad=tilt, psidot0=-top.psidot0, thetadot0=-top.thetadot0)


def _exchanged_moments(top: Top) -> Top:
    """Return a top with the a and b of one with A and C exchanged, which need not be a body."""
    return top.replace(A=top.C, C=top.C, r0=Fraction(top.r0) * Fraction(top.A) / Fraction(top.C))


def _spun_back(run: Observed, top: Top) -> Observed:
    """Return the attitude of a body that spins as the top of `_exchanged_moments`."""
    if run.quaternion is None and run.axis is None and not run.angles:
        raise LagtopError("there is no attitude")
    rate = float(Fraction(top.r0) * (1 - Fraction(top.A) / Fraction(top.C)))
    angles = {x: y - rate * run.t if x == "phi" else y for x, y in run.angles.items()}
    alone = Observed(run.t, run.quaternion, run.axis, angles)
    return alone.turned(rotations.IDENTITY, rotations.about_z(rate * run.t))


def _quaternion(name: str, change: Callable[[Array], Array]) -> Cause:
    """Return the cause that a quaternion is written in another way."""

    def changed(run: Observed, _: Top) -> Observed:
        q = run.quaternion
        return run if q is None else replace(run, quaternion=change(q))

    return Cause(f"the quaternion is {name}", change=changed)


def _rates_in(frame: str) -> Cause:
    """Return the cause that the rates are in this frame, not in the other one."""

    def change(run: Observed, _: Top) -> Observed:
        own, fixed = run.body_rates, run.space_rates
        if (own if frame == "space" else fixed) is None:
            raise LagtopError("there are no rates in the other frame")
        return replace(run, body_rates=fixed, space_rates=own)

    return Cause(f"the rates are in the frame of {frame}: --rates-frame {frame}", change=change)


def _in_other_unit(trajectory: Trajectory) -> Trajectory:
    """Return the trajectory with its angles in radians taken as degrees, or the reverse."""
    conventions = trajectory.conventions
    return trajectory._replace(conventions=conventions._replace(radians=not conventions.radians))


def _angles(name: str, *, phi: str = "phi", psi: str = "psi") -> Cause:
    """Return the cause that spin and precession have these names; "-psi" has the other sign."""
    other = {"theta": "theta", "phi": phi, "psi": psi}

    def changed(angles: Mapping[str, Array]) -> dict[str, Array]:
        return {other[x].strip("-"): -y if "-" in other[x] else y for x, y in angles.items()}

    def change(run: Observed, _: Top) -> Observed:
        if run.quaternion is None:
            return replace(run, angles=changed(run.angles))
        angles = changed(rotations.angles_of(run.quaternion))
        return replace(run, quaternion=rotations.of_angles(**angles))

    return Cause(name, change=change)


def _aligned(words: str) -> Callable[[Trajectory], Trajectory]:
    """Return the reading of a trajectory with these words of `--align`."""
    new = Alignment.of(words.split(","))
    return lambda x: x._replace(align=new._replace(time=x.align.time))


def _framed(words: str) -> Cause:
    """Return the cause that the frames are those of some words of `--align`."""
    said = "spin and precession do not start at 0" if words == "start" else "the axes are others"
    if "left" in words:
        up, q = ("y", "(-x, -z, -y, w)") if "up=y" in words else ("z", "(-x, y, -z, w)")
        said = f"the frame is left-handed with {up} up: read the quaternion as {q}"
    return Cause(f"{said} (--align {words})", rows=_aligned(words))


def _shifted_rows(shift: int, trajectory: Trajectory) -> Trajectory:
    """Return the trajectory whose rows belong to the times of the next or the previous rows."""
    if len(trajectory.given["t"]) < 3:
        raise LagtopError("too few rows")
    cut = [slice(1, None), slice(None, -1)][::shift]
    moved = {key: x[cut[key != "t"]] for key, x in trajectory.given.items()}
    return trajectory._replace(given=moved)


def _shifted_clock(motion: Motion, trajectory: Trajectory) -> Cause:
    """Return the cause that the clock is shifted, by the time that explains most."""
    from scipy.optimize import minimize_scalar  # start-up

    few, t = trajectory.few(20), trajectory.given["t"][:, 0]
    step = 0.3 / sizes(motion.top)[2]
    reach = max(motion.T_nutation or 0.0, 2 * abs(t[0]), 10 * abs(t[-1] - t[0]) / len(t))
    count = math.ceil(min(reach / step, _MOST_SHIFTS))
    shifts = step * np.arange(-count, count + 1.0)
    rows = {key: np.tile(x, (len(shifts), 1)) for key, x in few.given.items()}
    rows["t"] -= np.repeat(shifts, len(few.given["t"]))[:, np.newaxis]
    errors = few._replace(given=rows).errors(motion).reshape(len(shifts), -1)
    best = float(shifts[np.argmin(np.nan_to_num(np.fmax.reduce(errors, axis=1), nan=np.inf))])

    found = minimize_scalar(
        lambda shift: few.greatest(motion, lambda run: replace(run, t=run.t - shift)),
        bounds=(best - step, best + step),
        method="bounded",
        options={"xatol": 1e-9 * step},
    )
    shift = float(found.x)
    remedy = " (--align time)" if math.isclose(shift, t[0], rel_tol=1e-4) else ""
    return Cause(
        f"the clock is shifted by {shift:.5g}{remedy}",
        change=lambda run, _: replace(run, t=run.t - shift),
    )


_FRAMES = (
    *("left", "up=y,left"),
    *(f"axis={x},up={x}" for x in ("x", "y", "-z")),
    *(f"{word}={x}" for x in ("x", "y", "-z") for word in ("axis", "up")),
)
"""Other frames, as words of `--align`."""

CAUSES = [
    _input("the gyroscopic term is left out of Euler's equations (as if C = A)", C=lambda x: x.A),
    Cause("A and C are exchanged", _exchanged_moments, _spun_back),
    _moment("A about the pivot was taken as A about the mass centre (A + m s^2)", 1),
    _moment("A about the mass centre was taken as A about the pivot (A - m s^2)", -1),
    _spin("has the wrong sign", -1),
    _spin("in radians was taken as degrees", math.pi / 180),
    _spin("in degrees was taken as radians", 180 / math.pi),
    _spin("in radians was taken as rpm", math.pi / 30),
    _spin("in rpm was taken as radians", 30 / math.pi),
    _input(
        "r0 was taken as the gimbal's rate phi'",
        r0=lambda x: float(x.r0) + float(x.psidot0) * math.cos(_tilt(x)),
    ),
    _input("psidot0 has the wrong sign", psidot0=lambda x: -x.psidot0),
    _input("thetadot0 has the wrong sign", thetadot0=lambda x: -x.thetadot0),
    _tilted("has the wrong sign", lambda tilt: -tilt),
    _tilted("in radians was taken as degrees", math.radians),
    _tilted("in degrees was taken as radians", math.degrees),
    *map(_gravity, ("0", "9.8", "9.80665", "9.81", "10", "980", "980.665", "981")),
    Cause("g points upwards", _upside_down, rows=_aligned("up=-z,start")),
    _quaternion("the conjugate, from space to body", rotations.conjugate),
    _quaternion("xyzw and was read as wxyz: --quaternion-order xyzw", lambda q: np.roll(q, 1, 1)),
    _quaternion("wxyz and was read as xyzw: --quaternion-order wxyz", lambda q: np.roll(q, -1, 1)),
    _rates_in("space"),
    _rates_in("body"),
    _angles("phi and psi are exchanged", phi="psi", psi="phi"),
    _angles("psi is counted backwards", psi="-psi"),
    _angles("phi is counted backwards", phi="-phi"),
    Cause("angles in degrees were taken as radians, or the reverse", rows=_in_other_unit),
    Cause(
        "rows are off by one: each holds the state of the next time",
        rows=partial(_shifted_rows, 1),
    ),
    Cause(
        "rows are off by one: each holds the state of the previous time",
        rows=partial(_shifted_rows, -1),
    ),
    Cause("time runs backwards", change=lambda run, _: replace(run, t=-run.t)),
    *map(_framed, ("start", *_FRAMES, *(f"{words},start" for words in _FRAMES))),
]
"""Causes, the simplest first.  `_shifted_clock` comes last."""
