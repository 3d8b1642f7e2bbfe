"""Differences between a trajectory and the exact motion, row by row."""

from __future__ import annotations

import math

import numpy as np

from ..arithmetic.types import Array
from ..inputs import rotations
from ..inputs.names import ANGLES
from ..inputs.rotations import within_half_turn
from ..inputs.seen import Seen
from ..motion.regime import Regime
from ..motion.solve import Motion


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

        `error` is that of the attitude, or else of the axis, of the angles given, or of the angular
        velocity over the size of the rates.  A row with anything that is not finite is NaN there.
        """
        found = self._attitude(seen) | self._rates(seen) | self._conserved(seen)
        if seen.norm is not None:
            found["norm"] = abs(seen.norm)
        if seen.distance is not None and self.s:
            found["norm"] = abs(seen.distance / self.s - 1.0)
        angles = [abs(found[key]) for key in ANGLES if key in found]
        if "attitude" in found:
            error = found["attitude"].copy()
        elif "axis" in found:
            error = found["axis"].copy()
        elif angles:
            error = np.max(angles, axis=0)
        else:
            error = found["rate"] / self.rate_scale
        for values in found.values():
            error[~np.isfinite(values)] = np.nan
        return found | {"error": error}

    def _attitude(self, seen: Seen) -> dict[str, Array]:
        if seen.quaternion is not None:
            return self._whole(seen.t, seen.quaternion)
        if seen.axis is not None:
            names = ["axis", "theta", "psi"]
            exact = self.motion.table(seen.t, names, wrap=True)
            axis = np.stack([exact[f"axis_{part}"] for part in "xyz"], axis=1)
            angles = rotations.angles_of_axis(seen.axis)
            return {"axis": rotations.angle_between_vectors(axis, seen.axis)} | {
                key: within_half_turn(value - exact[key])
                for key, value in angles.items()
                if key == "theta" or not self.vertical
            }
        exact = self.motion.table(seen.t, ANGLES, wrap=True)
        return {key: within_half_turn(value - exact[key]) for key, value in seen.angles.items()}

    def _whole(self, t: Array, quaternion: Array) -> dict[str, Array]:
        exact = self.motion.table(t, [*ANGLES, "quaternion"], wrap=True)
        q = np.stack([exact[f"quaternion_{part}"] for part in "wxyz"], axis=1)
        angles = rotations.angles_of(quaternion)
        axes = rotations.axis_of(q), rotations.axis_of(quaternion)
        found = {
            "attitude": rotations.angle_between(q, quaternion),
            "axis": rotations.angle_between_vectors(*axes),
            "theta": angles["theta"] - exact["theta"],
        }
        if self.vertical:  # of spin and precession only the sum or the difference is defined
            up = self.motion.regime == Regime.SLEEPING
            twist = angles["psi"] + angles["phi"] if up else angles["phi"] - angles["psi"]
            ours = exact["psi"] + exact["phi"] if up else exact["phi"] - exact["psi"]
            return found | {"phi": within_half_turn(twist - ours)}
        return found | {key: within_half_turn(angles[key] - exact[key]) for key in ("phi", "psi")}

    def _rates(self, seen: Seen) -> dict[str, Array]:
        if seen.body_rates is None and seen.space_rates is None:
            return {}
        exact = self.motion.table(seen.t, ["p", "q", "r", "quaternion"])
        rates = np.stack([exact[name] for name in "pqr"], axis=1)
        given = seen.body_rates
        if given is None:
            given = seen.space_rates
            q = np.stack([exact[f"quaternion_{part}"] for part in "wxyz"], axis=1)
            rates = rotations.rotated(q, rates)
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
