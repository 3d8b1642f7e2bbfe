"""Differences between a trajectory and the exact motion: row by row, and summaries of them.

A summary takes the rows block by block, so that memory does not grow with their number.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..arithmetic.types import Array
from ..inputs import rotations
from ..inputs.names import ANGLES
from ..inputs.rotations import within_half_turn
from ..inputs.seen import Seen, rows_of
from ..motion.regime import Regime
from ..motion.solve import Motion

MOST_KEPT = 4096
_SURE = 2.0
"""Largest change of a deviation from row to row, in radians, for whole turns to be counted."""


def quaternion_of(table: Mapping[str, Array]) -> Array:
    """Return the quaternion of a table as one array with a row for each time."""
    return np.stack([table[f"quaternion_{part}"] for part in "wxyz"], axis=1)


class Deviations:
    """The differences of one trajectory from one motion."""

    def __init__(self, motion: Motion) -> None:
        self.motion, top = motion, motion.top
        self.A, self.C, self.r0 = float(top.A), float(top.C), float(top.r0)
        self.s = float(top.s)
        self.torque = float(top.m) * float(top.g) * float(top.s)
        self.vertical = motion.regime in {Regime.SLEEPING, Regime.HANGING}
        start = motion.table(0.0, ["p", "q", "r"])
        swing = float(start["p"]) ** 2 + float(start["q"]) ** 2
        kinetic = (self.A * swing + self.C * self.r0**2) / 2
        self.energy_scale = kinetic + self.torque or 1.0
        momentum = math.hypot(self.A * math.sqrt(swing), self.C * self.r0)
        self.momentum_scale = momentum + math.sqrt(self.A * self.torque) or 1.0
        self.rate_scale = math.sqrt(swing) + abs(self.r0) + math.sqrt(self.torque / self.A) or 1.0
        self._first: dict[str, float] = {}

    def of(self, seen: Seen) -> dict[str, Array]:
        """Return the deviations by name; unknown ones are missing.

        `error` is the error of the attitude, or else of the axis, the given angles, or the angular
        velocity over the size of the rates.  It is NaN in a row with values that are not finite.
        """
        found = self._attitude(seen) | self._rates(seen) | self._conserved(seen)
        if seen.norm is not None:
            found["norm"] = abs(seen.norm)
        if seen.distance is not None and self.s:
            found["norm"] = abs(seen.distance / self.s - 1.0)
        angles = [abs(found[key]) for key in ANGLES if key in found]
        if whole := found.keys() & {"attitude"} or found.keys() & {"axis"}:
            error = found[whole.pop()].copy()
        else:
            error = np.max(angles, axis=0) if angles else found["rate"] / self.rate_scale
        for values in found.values():
            error[~np.isfinite(values)] = np.nan
        return found | {"error": error}

    def _attitude(self, seen: Seen) -> dict[str, Array]:
        """Return the errors of the attitude, or of its parts that are given."""
        found: dict[str, Array] = {}
        if seen.quaternion is not None:
            exact = self.motion.table(seen.t, [*ANGLES, "quaternion"], wrap=True)
            angles, q = rotations.angles_of(seen.quaternion), quaternion_of(exact)
            axes = rotations.axis_of(q), rotations.axis_of(seen.quaternion)
            found["attitude"] = rotations.angle_between(q, seen.quaternion)
            found["axis"] = rotations.angle_between_vectors(*axes)
            if self.vertical:  # only the sum or the difference of spin and precession is defined
                sign = 1 if self.motion.regime == Regime.SLEEPING else -1
                for one in (angles, exact):
                    one["phi"] = one["phi"] + sign * one.pop("psi")
        elif seen.axis is not None:
            exact = self.motion.table(seen.t, ["axis", "theta", "psi"], wrap=True)
            angles = rotations.angles_of_axis(seen.axis)
            axis = np.stack([exact[f"axis_{x}"] for x in "xyz"], axis=1)
            found["axis"] = rotations.angle_between_vectors(axis, seen.axis)
            if self.vertical:
                del angles["psi"]
        else:
            exact, angles = self.motion.table(seen.t, ANGLES, wrap=True), dict(seen.angles)
        return found | {key: within_half_turn(x - exact[key]) for key, x in angles.items()}

    def _rates(self, seen: Seen) -> dict[str, Array]:
        if seen.body_rates is None and seen.space_rates is None:
            return {}
        exact = self.motion.table(seen.t, ["p", "q", "r", "quaternion"])
        rates = np.stack([exact[name] for name in "pqr"], axis=1)
        given = seen.body_rates
        if given is None:
            given = seen.space_rates
            rates = rotations.rotated(quaternion_of(exact), rates)
        assert given is not None
        return {"rate": np.linalg.norm(given - rates, axis=1)}

    def _conserved(self, seen: Seen) -> dict[str, Array]:
        """Return changes of energy (4,2) and of vertical momentum (4,3) since the first row."""
        q, rates, fixed = seen.quaternion, seen.body_rates, seen.space_rates
        if q is None or (rates is None and fixed is None):
            return {}
        up = rotations.rotated(rotations.conjugate(q), np.broadcast_to([0.0, 0, 1], (len(q), 3)))
        if rates is None:
            assert fixed is not None
            rates = rotations.rotated(rotations.conjugate(q), fixed)
        moments = np.array([self.A, self.A, self.C])
        energy = (moments * rates**2).sum(axis=1) / 2 + self.torque * up[:, 2]
        momentum = (moments * rates * up).sum(axis=1)
        return {
            "energy": self._change("energy", energy) / self.energy_scale,
            "Lz": self._change("Lz", momentum) / self.momentum_scale,
        }

    def _change(self, key: str, values: Array) -> Array:
        """Return the change of a quantity since the first row of all blocks."""
        if key not in self._first and values.size:
            self._first[key] = float(values[0])
        return values - self._first.get(key, 0.0)


class Extremes:
    """The greatest size of a deviation, and its last size."""

    def __init__(self) -> None:
        self.greatest = self.last = math.nan

    def add(self, values: Array) -> None:
        """Add the deviations of some rows; NaN is a missing value."""
        known = abs(values[np.isfinite(values)])
        if known.size:
            self.greatest = float(np.fmax(self.greatest, known.max()))
            self.last = float(known[-1])


class LineFit:
    """A straight line through an angle's deviations, unwrapped, by least squares."""

    def __init__(self) -> None:
        self.count, self.last, self.turns_are_sure = 0, 0.0, True
        self.t = self.x = self.tt = self.tx = self.xx = 0.0

    def add(self, t: Array, wrapped: Array) -> None:
        """Add deviations in (-pi, pi], unwrapped from row to row."""
        known = np.isfinite(wrapped)
        if not known.any():
            return
        t, x = t[known], np.unwrap(np.concatenate([[self.last], wrapped[known]]))
        steps = np.diff(x)[self.count == 0 :]  # the first row has no predecessor
        self.turns_are_sure &= not np.any(np.abs(steps) > _SURE)
        x = x[1:]
        self.last = float(x[-1])
        self._merge(len(t), float(t.mean()), float(x.mean()), t - t.mean(), x - x.mean())

    def _merge(self, n: int, t: float, x: float, around_t: Array, around_x: Array) -> None:
        """Add a block to the moments about the means (Chan, Golub and LeVeque 1979)."""
        whole = self.count + n
        step_t, step_x, share = t - self.t, x - self.x, self.count * n / whole
        self.tt += float((around_t * around_t).sum()) + step_t * step_t * share
        self.tx += float((around_t * around_x).sum()) + step_t * step_x * share
        self.xx += float((around_x * around_x).sum()) + step_x * step_x * share
        self.t += step_t * n / whole
        self.x += step_x * n / whole
        self.count = whole

    def line(self) -> tuple[float, float] | None:
        """Return the slope of the line and the root mean square of the residuals.

        Returns None for fewer than three rows or if whole turns are uncertain.
        """
        if self.count < 3 or not self.turns_are_sure:
            return None
        slope = self.tx / self.tt
        return slope, math.sqrt(max(self.xx - slope * self.tx, 0.0) / self.count)


class Kept:
    """At most MOST_KEPT rows, spread evenly over a trajectory of unknown length."""

    def __init__(self) -> None:
        self.stride, self.seen, self.size = 1, 0, 0
        self._parts: list[dict[str, Array]] = []

    def add(self, rows: Mapping[str, Array]) -> None:
        """Add some rows: arrays of the same length by name."""
        count = len(next(iter(rows.values())))
        start = -self.seen % self.stride
        if start < count:
            every = rows_of(rows, slice(start, None, self.stride))
            self._parts.append({key: values.copy() for key, values in every.items()})
            self.size += -(-(count - start) // self.stride)
        self.seen += count
        while self.size > MOST_KEPT:
            self.stride *= 2
            self._parts = [rows_of(self.rows(), slice(None, None, 2))]
            self.size = -(-self.size // 2)

    def rows(self) -> dict[str, Array]:
        """Return the rows that are kept."""
        return {key: np.concatenate([part[key] for part in self._parts]) for key in self._parts[0]}
