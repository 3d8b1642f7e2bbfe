"""The motion of a top from the attitude and the angular velocity in its first row, and residuals.

The parameters are a = 2mgs/A, b = C r0/A, a small turn of an approximate first attitude about the
line of nodes (`tilt`) and across it (`lean`), the rates p and q about the line of nodes and across
it in the body, and if the spin is recorded, its rate r0 and its zero.  None is singular on the
vertical.  If psi is not recorded, a turn about the vertical is invisible, so that `lean` is about
the axis across the vertical, and no zero of phi is needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.rotations import within_half_turn
from ..arithmetic.types import Array
from .descent import GAIN, descended
from .measured import Measured
from .motions import angles

_LEAST_A = 1e-9
"""Least a, in units of the period."""
_FAR = 1e3
"""Weighted residual of a motion that does not exist."""
_AT_ONCE = 50_000
"""Angles that are computed at once."""
_ESTIMATES = 3
"""Estimates of the noise from the residuals."""
Ties = Callable[[dict[str, Array]], Array]
"""Distances of motions from known inputs, in standard deviations, in the last axis."""


@dataclass(frozen=True)
class Problem:
    """The parameters of a recording, whose unit of time is about a period, and its residuals.

    Arrays of parameters have the shape (starts, tries, parameters).
    """

    recording: Measured
    sizes: Array
    """Standard deviations of the channels."""
    first: Array
    """Approximate theta, phi and psi in the first row, shape (starts, 3)."""
    ties: Ties | None = None
    turns: float = 0.0
    """Whole turns of the spin per row, as a rate, that r0 exceeds the visible rate by."""

    @property
    def spins(self) -> bool:
        """Whether the spin is recorded."""
        return "phi" in self.recording.angles

    @property
    def names(self) -> list[str]:
        """The names of the parameters."""
        angles = self.recording.angles
        lean, zero = ["lean"] * (angles.keys() != {"theta"}), ["phi_zero"] * ("psi" in angles)
        return ["a", "b", "tilt", *lean, "p", "q", *["r0", *zero] * self.spins]

    def at(self, start: int) -> Problem:
        """Return the problem of one start."""
        return replace(self, first=self.first[start : start + 1])

    def _started(self, x: Array, who: Any) -> tuple[dict[str, Array], Array, Array, Array]:
        """Return parameters by name, the states of `motions.angles`, and phi and psi at first."""
        v: dict[str, Array] = dict(zip(self.names, np.moveaxis(x, -1, 0), strict=True))
        theta, spun, turned = np.moveaxis(self.first[who][:, np.newaxis], -1, 0)
        lean, zero = v.get("lean", 0.0), v.get("phi_zero", 0.0)
        if "psi" not in self.recording.angles:
            lean, zero = lean * np.cos(theta), -lean * np.sin(theta)
        turn = np.stack(np.broadcast_arrays(v["tilt"], lean, 0.0), axis=-1) / 2
        size = np.linalg.norm(turn, axis=-1, keepdims=True)
        small = np.concatenate([np.cos(size), np.sinc(size / np.pi) * turn], axis=-1)
        first = rotations.of_angles(theta, 0 * turned, turned)
        w, i, j, k = np.moveaxis(rotations.product(first, small), -1, 0)
        upper, lower = np.arctan2(k, w), np.arctan2(j, i)
        phi, psi = upper - lower, upper + lower
        sine, cosine = np.sin(phi), np.cos(phi)
        across, along = v["p"] * cosine - v["q"] * sine, v["p"] * sine + v["q"] * cosine  # (4,1)
        motion = np.maximum(v["a"], _LEAST_A), v["b"], np.hypot(i, j), np.hypot(w, k), across, along
        states = np.stack(motion, axis=-1)
        v["r0"] = v["r0"] if self.spins else states[..., 1]
        return v, states, phi + spun + zero, psi

    def values(self, x: Array, who: Any = slice(None)) -> dict[str, Array]:
        """Return the quantities of motions; psi' on the vertical is infinite or undefined."""
        v, states, phi, psi = self._started(x, who)
        a, b, half_sine, half_cosine, p, q = np.moveaxis(states, -1, 0)
        with np.errstate(all="ignore"):
            rate = q / (2 * half_sine * half_cosine)
        found = {"a": a, "b": b, "r0": v["r0"], "theta0": 2 * np.arctan2(half_sine, half_cosine)}
        return found | {"thetadot0": p, "psidot0": rate, "psi_zero": psi, "phi_zero": phi}

    def angles(self, x: Array, t: Array, who: Any = slice(None)) -> Array:
        """Return theta, phi and psi, shape (3, starts, tries, times)."""
        v, states, phi, psi = self._started(x, who)
        different, same = np.unique(states.reshape(-1, 6), axis=0, return_inverse=True)
        blocks = np.array_split(t, different.shape[0] * t.size // _AT_ONCE + 1)
        motion = np.concatenate([angles(different, x) for x in blocks], axis=-1)
        found = motion[:, same].reshape(3, *states.shape[:2], t.size)
        rate = v["r0"] - self.turns - states[..., 1]
        found[1] += rate[..., np.newaxis] * t + phi[..., np.newaxis]
        found[2] += psi[..., np.newaxis]
        return found

    def residuals(self, x: Array, who: Any = slice(None)) -> Array:
        """Return recording minus motion in radians, shape (starts, tries, channels, times)."""
        return self.recording.residuals(*self.angles(x, self.recording.t, who))

    def weighted(self, x: Array, who: Any = slice(None)) -> Array:
        """Return residuals over standard deviations, shape (starts, tries, numbers)."""
        return self._numbers(self.residuals(x, who), x, who)

    def _numbers(self, rest: Array, x: Array, who: Any) -> Array:
        found = [(rest / self.sizes[:, np.newaxis])[..., self.recording.present]]
        if self.ties:
            found.append(self.ties(self.values(x, who)))
        numbers = np.nan_to_num(np.concatenate(found, axis=-1), nan=_FAR, posinf=_FAR, neginf=-_FAR)
        return np.asarray(numbers)

    def settled(self, x: Array, who: Any) -> tuple[Array, Array]:
        """Return parameters with the spin that suits the others best, and weighted residuals."""
        rest = self.residuals(x, who)
        if self.spins and not self.ties:
            one, x = self.recording, x.copy()
            at = [self.names.index(y) for y in ("r0", "phi_zero") if y in self.names]
            channel = one.channels.index(one.spin_channel)
            seen, line = one.present[channel], np.stack([one.t, 0 * one.t + 1][: len(at)])
            change = rest[..., channel, :][..., seen] @ np.linalg.pinv(line[:, seen])
            x[..., at] += change
            rest[..., channel, :] = within_half_turn(rest[..., channel, :] - change @ line)
        return x, self._numbers(rest, x, who)

    def thinned(self, rows: int) -> Problem:
        """Return the problem for some rows of the recording that weigh as much as all."""
        few = self.recording.thinned(rows)
        share = few.t.size / self.recording.t.size
        return replace(self, recording=few, sizes=self.sizes * math.sqrt(share))

    def solve(self, x: Array, steps: int, gain: float = GAIN, *, central: bool = True) -> Any:
        """Return the least squares from some starts, and chi^2."""
        how: dict[str, Any] = {"central": central, "settled": self.settled}
        return descended(self.weighted, x, steps, gain=gain, **how)

    def with_noise(self, x: Array, least: Array) -> Problem:
        """Return the problem with the standard deviations of the residuals of one start."""
        present = self.recording.present
        share = present.sum() / max(present.sum() - x.size, 1)
        rest = np.where(present, self.residuals(x[:, np.newaxis])[0, 0], np.nan)
        sizes = np.maximum(np.sqrt(np.nanmean(rest**2, axis=1) * share), least)
        return replace(self, sizes=sizes)

    def reweighted(self, x: Array, least: Array, steps: int, gain: float) -> tuple[Problem, Array]:
        """Return the least squares whose standard deviations are those of the residuals."""
        problem = self
        for _ in range(_ESTIMATES):
            problem = problem.with_noise(x, least)
            x, _ = problem.solve(x, steps, gain)
        return problem.with_noise(x, least), x


def problem_of(
    recording: Measured, sizes: Array, states: Array, zeros: Array, ties: Ties | None
) -> tuple[Problem, Array]:
    """Return the problem around states (a, b, theta0, thetadot0, psidot0) of the period 1.

    `zeros` are psi and phi in the first row, and r0, shape (3, starts).
    """
    a, b, theta, rate, turn = states.T
    psi, phi, spin = zeros
    problem = Problem(recording, sizes, np.stack([theta, phi, psi], axis=-1), ties)
    v = {"a": a, "b": b, "p": rate, "q": turn * np.sin(theta), "r0": spin}
    return problem, np.stack([v.get(name, 0 * a) for name in problem.names], axis=-1)
