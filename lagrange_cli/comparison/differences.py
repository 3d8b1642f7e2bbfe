"""The differences between a trajectory and the exact motion, row by row."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.text import quoted
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..files import rotations
from ..files.observed import Conventions, Observed, Quantities, observe, rows_of
from ..files.rotations import within_half_turn
from ..names import ANGLES
from ..solver.facts import Regime
from ..solver.solve import Motion
from ..top.top import Top

WORDS = {
    "axis=y": "the figure axis is the body's y axis (or x, -x, -y, -z)",
    "up=y": "up is the y axis of space (or x, -x, -y, -z)",
    "left": "both frames are left-handed; the figure axis is then the axis of `up`, unless given",
    "start": "spin and precession are 0 in the first row",
    "time": "the first row is at time 0",
}
"""The words of `--align`, with their meanings."""

_EXCHANGE_XY = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
_NEAR_POLE = 1e-9


class Alignment(NamedTuple):
    """Changes of a trajectory before it is compared: the words of `--align`."""

    axis: str = ""
    up: str = "z"
    left: bool = False
    start: bool = False
    time: bool = False

    @classmethod
    def of(cls, words: Sequence[str]) -> Alignment:
        """Return the alignment of some words.  Raises LagtopError for an unknown word."""
        found: dict[str, Any] = {}
        for word in words:
            if not re.fullmatch("(axis|up)=-?[xyz]|left|start|time", str(word)):
                wanted = f"align must be among {', '.join(WORDS)}"
                raise LagtopError(f"{wanted}, got {quoted(word)}", "align")
            key, _, axis = word.partition("=")
            found[key] = axis or True
        return cls(**found)

    def aligned(self, run: Observed, motion: Motion) -> Observed:
        """Return a trajectory in the frames of lagtop and with its clock.

        Raises LagtopError if the attitude is not complete enough.
        """
        axis = self.axis or (self.up if self.left else "z")
        if run.quaternion is None and (axis != "z" or self.left):
            raise LagtopError("align axis and left need the whole attitude: omit them", "align")
        if self.up != "z" and all(x is None for x in (run.quaternion, run.axis, run.space_rates)):
            raise LagtopError("align up needs the axis or the whole attitude: omit it", "align")
        run = run.turned(rotations.to_z(self.up), rotations.to_z(axis))
        if self.left:  # as is usual: Unreal turns y round, Unity exchanges y and z
            run = _mirrored(run, np.diag([1.0, -1, 1]) if self.up[-1] == "z" else _EXCHANGE_XY)
        if self.time:
            run = replace(run, t=run.t - run.t[0])
        return _counted_from_start(run, motion) if self.start else run


def _mirrored(run: Observed, mirror: Array) -> Observed:
    """Return the motion after a reflection of both frames, a matrix of shape (3, 3)."""
    assert run.quaternion is not None
    names = (x for x in ("body_rates", "space_rates") if getattr(run, x) is not None)
    rates = {x: -getattr(run, x) @ mirror for x in names}
    q = np.concatenate([run.quaternion[:, :1], -run.quaternion[:, 1:] @ mirror], axis=1)
    return replace(run, quaternion=q, **rates)


def _counted_from_start(run: Observed, motion: Motion) -> Observed:
    """Return the motion turned about the vertical and the figure axis, to fit its first row."""
    given = dict(run.angles) if run.axis is None else rotations.angles_of_axis(run.axis)
    given = given if run.quaternion is None else rotations.angles_of(run.quaternion)
    row = int(np.argmax(np.isfinite([*given.values()]).all(axis=0)))
    exact = {x: float(y[0]) for x, y in motion.table(run.t[[row]], ANGLES, wrap=True).items()}
    phi, psi = (float(given[x][row]) - exact[x] if x in given else 0.0 for x in ("phi", "psi"))
    if run.quaternion is not None and math.sin(exact["theta"]) < _NEAR_POLE:  # one angle is free
        phi, psi = (phi + psi if exact["theta"] < 1 else phi - psi), 0.0
    shifts = {"theta": 0.0, "phi": phi, "psi": psi}
    angles = {key: x - shifts[key] for key, x in run.angles.items()}
    return replace(run.turned(rotations.about_z(-psi), rotations.about_z(phi)), angles=angles)


class Trajectory(NamedTuple):
    """A trajectory as it is given, with its conventions."""

    given: Quantities
    """Arrays of quantities, with all angles in radians."""
    conventions: Conventions
    align: Alignment = Alignment()
    file: str | None = None

    def few(self, most: int) -> Trajectory:
        """Return at most so many rows, evenly spread."""
        every = -(-len(self.given["t"]) // most)
        return self._replace(given=rows_of(self.given, slice(None, None, every)))

    def observed(self) -> Observed:
        """Return the motion of the trajectory, in its own frames."""
        return observe(self.given, self.conventions)


def errors(motion: Motion, run: Observed, align: Alignment) -> Array:
    """Return the error of each row, or that of its rates if it is greater."""
    found = differences(motion, align.aligned(run, motion))
    worst: Array = np.maximum(found["error"], found.get("rates", 0.0))
    return worst


def differences(motion: Motion, run: Observed) -> dict[str, Array]:
    """Return the differences from the exact motion in each row, by name; missing if not given.

    `attitude`, `axis` and the angles are in radians; `rates` are over the size of the rates of the
    top; `energy` and `Lz` are the changes of (4,2) and (4,3) since the first row, over their sizes;
    `norm` is the distance of a norm from 1.  `error` is the error of the attitude, or else of the
    axis, the angles, or the rates; it is NaN in a row with a value that is not finite.
    """
    exact = motion.table(run.t, [*ANGLES, "quaternion", *"pqr"], wrap=True)
    q = np.stack([exact[f"quaternion_{x}"] for x in "wxyz"], axis=1)
    angles, axis, found = dict(run.angles), run.axis, dict[str, Array]()
    if run.quaternion is not None:
        found["attitude"] = rotations.angle_between(q, run.quaternion)
        angles, axis = rotations.angles_of(run.quaternion), rotations.axis_of(run.quaternion)
    elif axis is not None:
        angles = rotations.angles_of_axis(axis)
    if axis is not None:
        found["axis"] = rotations.angle_between_vectors(rotations.axis_of(q), axis)
    if axis is not None and motion.regime in {Regime.SLEEPING, Regime.HANGING}:
        for one in (angles, exact) if "phi" in angles else ():  # only phi + psi, phi - psi exist
            one["phi"] = one["phi"] + (1 if motion.regime is Regime.SLEEPING else -1) * one["psi"]
        del angles["psi"]
    found |= {key: within_half_turn(x - exact[key]) for key, x in angles.items()}
    found |= _rates(motion.top, run, q, np.stack([exact[x] for x in "pqr"], axis=1))
    if run.norm is not None:
        found["norm"] = abs(run.norm)
    if run.distance is not None and motion.top.s:
        found["norm"] = abs(run.distance / float(motion.top.s) - 1.0)
    parts = [abs(found[key]) for key in angles] or [found["rates"]]
    error = np.array(found.get("attitude", found.get("axis", np.max(parts, axis=0))))
    error[~np.all([np.isfinite(x) for x in found.values()], axis=0)] = np.nan
    return found | {"error": error}


def _rates(top: Top, run: Observed, q: Array, exact: Array) -> dict[str, Array]:
    """Return the differences of the angular velocity, and the changes of what it conserves."""
    swing, torque, size = sizes(top)
    own, fixed = run.body_rates, run.space_rates
    given = own if fixed is None else fixed
    if given is None:
        return {}
    off = given - (exact if fixed is None else rotations.rotated(q, exact))
    found = {"rates": np.linalg.norm(off, axis=1) / size}
    if run.quaternion is None:
        return found
    to_body = rotations.conjugate(run.quaternion)
    own = given if fixed is None else rotations.rotated(to_body, fixed)
    up = rotations.rotated(to_body, np.array([0.0, 0.0, 1.0]))
    A, C, r0 = float(top.A), float(top.C), float(top.r0)
    moments = np.array([A, A, C])
    energy = (moments * own**2).sum(axis=1) / 2 + torque * up[:, 2]
    momentum = (moments * own * up).sum(axis=1)
    kinetic, spin = (A * swing**2 + C * r0**2) / 2, math.hypot(A * swing, C * r0)
    found["energy"] = (energy - energy[0]) / (kinetic + torque or 1.0)
    found["Lz"] = (momentum - momentum[0]) / (spin + math.sqrt(A * torque) or 1.0)
    return found


def sizes(top: Top) -> tuple[float, float, float]:
    """Return the initial rate across the figure axis, m g s, and the size of all rates."""
    tilt = float(top.inputs(radians=True)["theta0_rad"])
    swing = math.hypot(float(top.thetadot0), float(top.psidot0) * math.sin(tilt))
    torque = float(top.m) * float(top.g) * float(top.s)
    return swing, torque, swing + abs(float(top.r0)) + math.sqrt(torque / float(top.A)) or 1.0
