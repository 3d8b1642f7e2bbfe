"""Causes of errors that engines and students produce: each is tried by computing without it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from ..errors import LagtopError
from ..files import rotations
from ..files.observed import Observed
from ..names import ANGLES
from ..solver.solve import Motion, solve
from ..top.top import Top
from .differences import Alignment, Trajectory, errors, sizes

EXPLAINS = 0.1
"""Largest share of the error that may remain if a cause explains it."""
_AS_GOOD, _ROUNDING = 10.0, 1e-9
"""Factor between the remaining errors of two causes, and least error, that make no difference."""
_MOST_SHIFTS = 500
_GRAVITY = "0", "9.8", "9.80665", "9.81", "10", "980", "980.665", "981"
_FRAMES = {
    "start": "spin and precession do not start at 0",
    "left": "the frame is left-handed with z up: read the quaternion as (-x, y, -z, w)",
    "up=y,left": "the frame is left-handed with y up: read the quaternion as (-x, -z, -y, w)",
    **{
        words: "the axes are others"
        for x in ("x", "y", "-z")
        for words in (f"axis={x},up={x}", f"axis={x}", f"up={x}")
    },
}
"""Other frames: words of `--align`, with their names."""
_ANGLES = {
    "phi and psi are exchanged": {"phi": "psi", "psi": "phi"},
    "psi is counted backwards": {"psi": "-psi"},
    "phi is counted backwards": {"phi": "-phi"},
}
"""The meanings of columns of angles, by cause; a minus sign reverses the direction."""


class Cause(NamedTuple):
    """A cause of errors: the trajectory as it was meant, and inputs of the top that moved."""

    name: str
    run: Observed
    inputs: Mapping[str, Any] = MappingProxyType({})
    """The inputs in which the top that moved differs."""
    words: str = ""
    """Words of `--align` that replace the given ones."""

    def error(self, motion: Motion, align: Alignment) -> float:
        """Return the greatest error without the cause; infinite if there is no such motion."""
        if self.words:
            align = Alignment.of(self.words.split(","))._replace(time=align.time)
        try:
            moved = solve(motion.top.replace(**self.inputs)) if self.inputs else motion
            worst = np.fmax.reduce(errors(moved, self.run, align))
        except LagtopError:
            return math.inf
        return math.inf if np.isnan(worst) else float(worst)


def likely_cause(motion: Motion, trajectory: Trajectory, limit: float) -> tuple[str, float] | None:
    """Return the cause that explains the error best, and the greatest error without it.

    A cause explains an error if it takes off nine tenths.  Of those that bring the error below the
    limit, return the simplest that leaves about as little as the best; else return the best.
    """
    align, count = trajectory.align, len(trajectory.given["t"])
    shift = _clock_shift(motion, trajectory)
    enough = EXPLAINS * Cause("", trajectory.observed()).error(motion, align)
    some = causes(motion.top, trajectory, shift, 300)
    hopeful = {x.name for x in some if x.error(motion, align) <= enough}
    every = causes(motion.top, trajectory, shift, count) if hopeful else ()
    found = [(x.name, x.error(motion, align)) for x in every if x.name in hopeful]
    least = min((error for _, error in found), default=math.inf)
    enough = min(enough, max(least, min(limit, max(_AS_GOOD * least, _ROUNDING))))
    return next((x for x in found if x[1] <= enough), None)


def causes(top: Top, trajectory: Trajectory, shift: float, most: int) -> Iterator[Cause]:
    """Yield the causes, the simplest first, with at most so many rows.

    `top` is the intended one, and `shift` the time by which the clock may be shifted.
    """
    run = trajectory.few(most).observed()
    for name, inputs in _other_tops(top).items():
        words = "up=-z,start" if "upwards" in name else "start" if "theta0" in name else ""
        yield Cause(name, run, inputs, words)
    yield from _other_attitudes(top, run)
    for frame, rates in (("space", run.body_rates), ("body", run.space_rates)):
        if rates is not None:
            other = replace(run, body_rates=run.space_rates, space_rates=run.body_rates)
            yield Cause(f"the rates are in the frame of {frame}: --rates-frame {frame}", other)
    other_unit = np.radians if trajectory.conventions.radians else np.degrees
    turned = {x: other_unit(y) for x, y in trajectory.given.items() if x in {*ANGLES, "euler"}}
    in_other_unit = trajectory._replace(given={**trajectory.given, **turned}).few(most).observed()
    yield Cause("angles in degrees were taken as radians, or the reverse", in_other_unit)
    later, earlier = slice(1, None), slice(None, -1)
    for word, times, states in (("next", later, earlier), ("previous", earlier, later)):
        given = {key: x[times if key == "t" else states] for key, x in trajectory.given.items()}
        if len(given["t"]) > 1:
            moved = trajectory._replace(given=given).few(most).observed()
            yield Cause(f"rows are off by one: each holds the state of the {word} time", moved)
    yield Cause("time runs backwards", replace(run, t=-run.t))
    for more in ("", ",start"):
        for words, said in _FRAMES.items():
            yield Cause(f"{said} (--align {words}{more})", run, words=words + more)
    is_start = math.isclose(shift, trajectory.given["t"][0, 0], rel_tol=1e-4)
    name = f"the clock is shifted by {shift:.5g}" + " (--align time)" * is_start
    yield Cause(name, replace(run, t=run.t - shift))


def _other_tops(top: Top) -> dict[str, dict[str, Any]]:
    """Return the inputs in which the top that moved differs, by cause."""
    A, r0, steiner = Fraction(top.A), float(top.r0), Fraction(top.m) * Fraction(top.s) ** 2
    tilt, rate = float(top.inputs(radians=True)["theta0_rad"]), float(top.thetadot0)
    folded = math.remainder(math.degrees(tilt), math.tau)
    gimbal = r0 + float(top.psidot0) * math.cos(tilt)
    over = {"theta0_rad": math.pi - tilt, "psidot0": -top.psidot0, "thetadot0": -top.thetadot0}
    left_out = "the gyroscopic term is left out of Euler's equations (as if C = A)"
    return {
        left_out: {"C": top.A},
        "A about the pivot was taken as A about the mass centre (A + m s^2)": {"A": A + steiner},
        "A about the mass centre was taken as A about the pivot (A - m s^2)": {"A": A - steiner},
        "r0 has the wrong sign": {"r0": -top.r0},
        "r0 in radians was taken as degrees": {"r0": math.radians(r0)},
        "r0 in degrees was taken as radians": {"r0": math.degrees(r0)},
        "r0 in radians was taken as rpm": {"r0": r0 * math.pi / 30},
        "r0 in rpm was taken as radians": {"r0": r0 * 30 / math.pi},
        "r0 was taken as the gimbal's rate phi'": {"r0": gimbal},
        "psidot0 has the wrong sign": {"psidot0": -top.psidot0},
        "thetadot0 has the wrong sign": {"thetadot0": -rate},
        "theta0 has the wrong sign": {"theta0_rad": tilt, "thetadot0": -rate},
        "theta0 in radians was taken as degrees": {"theta0_rad": math.radians(tilt)},
        "theta0 in degrees was taken as radians": {
            "theta0_rad": abs(folded),
            "thetadot0": math.copysign(1.0, folded) * rate,
        },
        **{f"g is {g} (or m or s is wrong by as much)": {"g": Fraction(g)} for g in _GRAVITY},
        "g points upwards": over,
    }


def _other_attitudes(top: Top, run: Observed) -> Iterator[Cause]:
    """Yield the causes that an attitude was written in another way, or its A and C exchanged."""
    q = run.quaternion
    angles = dict(run.angles) if q is None else rotations.angles_of(q)
    if q is not None:
        for name, other in {
            "the conjugate, from space to body": rotations.conjugate(q),
            "xyzw and was read as wxyz: --quaternion-order xyzw": np.roll(q, 1, 1),
            "wxyz and was read as xyzw: --quaternion-order wxyz": np.roll(q, -1, 1),
        }.items():
            yield Cause(f"the quaternion is {name}", replace(run, quaternion=other))

    def with_angles(changed: dict[str, Any]) -> Observed:
        other = {"angles": changed} if q is None else {"quaternion": rotations.of_angles(**changed)}
        return replace(run, **other)

    for name, meanings in _ANGLES.items():
        meant = {meanings.get(x, x): y for x, y in angles.items()}
        changed = {x.strip("-"): -y if "-" in x else y for x, y in meant.items()}
        yield Cause(name, with_angles(changed))
    if angles or run.axis is not None:
        # A top with the same a and b, which need be no body: its spin differs by a constant rate.
        ratio = Fraction(top.A) / Fraction(top.C)
        lag = float(Fraction(top.r0) * (1 - ratio)) * run.t
        back = with_angles({x: y - lag if x == "phi" else y for x, y in angles.items()})
        inputs = {"A": top.C, "C": top.C, "r0": Fraction(top.r0) * ratio}
        back = replace(back, body_rates=None, space_rates=None)
        yield Cause("A and C are exchanged", back, inputs)


def _clock_shift(motion: Motion, trajectory: Trajectory) -> float:
    """Return the time by which the clock is shifted, if it is: the time that explains most."""
    from scipy.optimize import minimize_scalar  # start-up

    few, t = trajectory.few(20), trajectory.given["t"][:, 0]
    step = 0.3 / sizes(motion.top)[2]
    reach = max(motion.T_nutation or 0.0, 2 * abs(t[0]), 10 * abs(t[-1] - t[0]) / len(t))
    count = math.ceil(min(reach / step, _MOST_SHIFTS))
    shifts = step * np.arange(-count, count + 1.0)
    rows = {key: np.tile(x, (len(shifts), 1)) for key, x in few.given.items()}
    rows["t"] -= np.repeat(shifts, len(few.given["t"]))[:, np.newaxis]
    found = errors(motion, few._replace(given=rows).observed(), few.align)
    worst = np.fmax.reduce(found.reshape(len(shifts), -1), axis=1)
    best, run = float(shifts[np.argmin(np.nan_to_num(worst, nan=np.inf))]), few.observed()
    refined = minimize_scalar(
        lambda shift: Cause("", replace(run, t=run.t - shift)).error(motion, few.align),
        bounds=(best - step, best + step),
        method="bounded",
        options={"xatol": 1e-9 * step},
    )
    return float(refined.x)
