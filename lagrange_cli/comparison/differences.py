"""The differences between a trajectory and the exact motion, row by row."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.rotations import within_half_turn
from ..arithmetic.types import Array, Mask
from ..names import ANGLES
from ..recordings.observed import Observed
from ..recordings.recording import Recording
from ..solver.facts import Regime
from ..solver.solve import Motion
from ..top.top import Top

CONSERVED = {"energy_drift", "Lz_drift", "pivot_slip"}
"""Differences that are counted from the first row."""
_Z = np.array([0.0, 0.0, 1.0])
_NEAR_POLE, _OFF_POLE = 1e-9, 0.01
"""Sines of the tilt: up to which only one angle is defined, and from which the azimuth is exact."""
_BLOCK, _KEPT = 1 << 14, 300
"""Rows of a block, and the most times whose exact motion is kept."""


class ExactMotion:
    """The exact motion of a top, or one that follows from it by symmetry.

    `space` turns the motion, `body` is a turn before it, and `spin` is more rate of spin.
    """

    def __init__(
        self,
        motion: Motion,
        space: Array = rotations.IDENTITY,
        body: Array = rotations.IDENTITY,
        spin: float = 0.0,
    ) -> None:
        self.motion, self.turns = motion, (space, body, spin)
        self._kept: dict[bytes, dict[str, Array]] = {}

    def at(self, t: Array) -> dict[str, Array]:
        """Return the angles, and the `quaternion` and `rates` as arrays of shape (n, parts)."""
        if (key := t.tobytes()) in self._kept:
            return self._kept[key]
        turn, rates = self.computed(t)
        states = rotations.angles_of(turn) | {"quaternion": turn, "rates": rates}
        if t.size <= _KEPT:
            self._kept[key] = states
        return states

    def computed(self, t: Array) -> tuple[Array, Array]:
        """Return attitudes from body to space, and rates in the body."""
        found = np.stack([*self.motion.table(t, ["quaternion", *"pqr"]).values()], axis=1)
        turn, rates, (space, body, spin) = found[:, :4], found[:, 4:], self.turns
        if spin or not space[0] == 1 == body[0]:
            body = rotations.product(rotations.about_z(spin * t), body)
            turn = rotations.product(rotations.product(space, turn), body)
            rates = rotations.rotated(rotations.conjugate(body), rates) + _Z * spin
        return turn, rates


def angles_of(seen: Observed) -> dict[str, Array]:
    """Return tilt, spin and precession of a motion, as far as they are known."""
    if seen.quaternion is not None:
        return rotations.angles_of(seen.quaternion)
    return dict(seen.angles) if seen.axis is None else rotations.angles_of_axis(seen.axis)


def start_of(seen: Observed, exact: dict[str, Array]) -> tuple[float, float] | None:
    """Return the spin and the precession less those of the exact motion, in the first row.

    If the axis starts next to the vertical, they are taken from the first row off it.  Return None
    if no row is finite.
    """
    given = angles_of(seen)
    finite = np.isfinite([*given.values()]).all(axis=0) if given else np.isfinite(seen.t)
    rows = np.flatnonzero(finite)[:1000]
    if not rows.size:
        return None
    sine = np.sin(exact["theta"][rows])
    row = int(rows[np.argmax(sine >= min(_OFF_POLE, sine.max() / 2))])
    phi, psi = (float(given[x][row] - exact[x][row]) if x in given else 0.0 for x in ANGLES[1:])
    if seen.quaternion is not None and math.sin(exact["theta"][row]) < _NEAR_POLE:
        phi, psi = (phi + psi if exact["theta"][row] < 1 else phi - psi), 0.0  # one angle is free
    return phi, psi


def blocks(exact: ExactMotion, run: Recording) -> Iterator[dict[str, Array]]:
    """Yield the times `t` of some rows and their differences from the exact motion, by name.

    `attitude`, `axis` and the angles are in radians; `rates` are over the size of the rates of the
    top.  `norm_error` is the distance of a norm from 1.  CONSERVED are the energy and Lz (4,2),
    (4,3) over their sizes, and the distance of the centre of mass from the pivot.  Quantities that
    are not given are missing.  `error` is the error of the attitude, or else of the axis, the
    angles, or the rates.  It is NaN in a row with a value that is not finite, unless only another
    quantity has empty cells.  Raises LagtopError if the attitude is not complete enough for the
    alignment.
    """
    start = None
    for first in range(0, len(run.given["t"]), _BLOCK):
        rows = slice(first, first + _BLOCK)
        seen = run.observed(rows)
        states = exact.at(seen.t)
        if run.align.start and (start := start or start_of(seen, states)):
            shifts = dict(zip(ANGLES, (0.0, *start), strict=True))
            angles = {key: x - shifts[key] for key, x in seen.angles.items()}
            seen = seen.turned(rotations.about_z(-start[1]), rotations.about_z(start[0]))
            seen = replace(seen, angles=angles)
        missing = run.missing[rows]
        yield {"t": seen.t} | _differences(exact.motion, seen, states, missing)


def errors(exact: ExactMotion, run: Recording) -> Array:
    """Return the error of each row and that of its rates, if they are given; shape (2, n)."""
    found = ([x["error"], x.get("rates", x["error"])] for x in blocks(exact, run))
    return np.concatenate([*found], axis=1)


def _differences(
    motion: Motion, run: Observed, states: dict[str, Array], missing: Mask
) -> dict[str, Array]:
    q, exact = states["quaternion"], {x: states[x] for x in ANGLES}
    axis, angles, found = run.axis, angles_of(run), dict[str, Array]()
    if run.quaternion is not None:
        found["attitude"] = rotations.angle_between(q, run.quaternion)
        axis = rotations.axis_of(run.quaternion)
    if axis is not None:
        found["axis"] = rotations.angle_between_vectors(rotations.axis_of(q), axis)
    if axis is not None and motion.regime in {Regime.SLEEPING, Regime.HANGING}:
        upright = exact["theta"][0] < 1
        for one in (angles, exact) if "phi" in angles else ():  # only phi + psi, phi - psi exist
            one["phi"] = one["phi"] + (1 if upright else -1) * one["psi"]
        del angles["psi"]
    found |= {key: within_half_turn(x - exact[key]) for key, x in angles.items()}
    found |= _rates(motion.top, run, q, states["rates"])
    given = {"norm_error": run.norm, "pivot_slip": run.distance}
    found |= {key: x for key, x in given.items() if x is not None}
    compared = {"attitude", "axis"} & found.keys()
    parts = [min(compared)] if compared else [*angles] or ["rates"]
    error = np.max([abs(found[x]) for x in parts], axis=0)
    lost = ~np.all([np.isfinite(x) for x in found.values()], axis=0)
    error[lost & ~missing] = np.nan
    return found | {"error": error}


def _rates(top: Top, run: Observed, q: Array, exact: Array) -> dict[str, Array]:
    """Return the differences of the angular velocity, and the energy and Lz of the motion."""
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
    up = rotations.rotated(to_body, _Z)
    A, C, r0 = float(top.A), float(top.C), float(top.r0)
    momentum, kinetic = np.array([A, A, C]) * own, (A * swing**2 + C * r0**2) / 2
    energy, spin = (momentum * own).sum(axis=1) / 2, math.hypot(A * swing, C * r0)
    found["energy_drift"] = (energy + torque * up[:, 2]) / (kinetic + torque or 1.0)
    found["Lz_drift"] = (momentum * up).sum(axis=1) / (spin + math.sqrt(A * torque) or 1.0)
    return found


def sizes(top: Top) -> tuple[float, float, float]:
    """Return the initial rate across the figure axis, m g s, and the size of all rates."""
    tilt = float(top.inputs(radians=True)["theta0_rad"])
    swing = math.hypot(float(top.thetadot0), float(top.psidot0) * math.sin(tilt))
    torque = float(top.m) * float(top.g) * float(top.s)
    return swing, torque, swing + abs(float(top.r0)) + math.sqrt(torque / float(top.A)) or 1.0
