"""A minimum of the least squares of a fit: its covariance, and how far that can be trusted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arithmetic.types import Array
from .descent import GAIN, descended, polished, slopes
from .known import body_of
from .problem import Problem, Ties
from .spins import slowest_rate

MOST_ROWS = 1000
"""Rows of the fit that finds a minimum; its last steps use all rows."""
_STEPS = 40
"""Largest number of steps of a descent."""
_LAST = 10
"""Largest number of steps with all rows."""
_NEAR = 0.1
"""Promised fall of chi^2 that ends a descent to a minimum that is only compared with others."""
_SHAPE_ROWS = 300
"""Rows that show the shape of chi^2."""
_DEPENDENT = 1e-7
"""Ratio of singular values of the slopes below which a direction is not determined."""
_SHARE = 0.05
"""Share of a parameter in such a direction from which it is not determined either."""
SURE = 2.0
"""Standard deviations from which a > 0, and b and r0 have a sign."""
APART = 4.0
"""Standard deviations of a or b between different tops, and off a straight valley."""
_BENT = 2.0
"""Growth of chi^2 over that of a parabola from which the floor of a bent valley is searched."""
_BROKEN = 6.0
"""The same on both sides of a valley without a floor."""
_STIFF = 100.0
"""Weight of the distance at which the floor is searched."""


@dataclass(frozen=True)
class Minimum:
    """A minimum of the least squares, in units of the period."""

    problem: Problem
    x: Array
    spread: Array
    """A matrix S with the covariance S S^T of the parameters."""
    unknown: tuple[str, ...] = ()
    """Parameters that the recording does not determine."""
    is_curved: bool = False
    """Whether chi^2 is not parabolic within two standard deviations."""
    is_hopeless: bool = False
    """Whether no motion of a top is near the recording."""

    def badness(self, rows: int = MOST_ROWS) -> float:
        """Return minus twice the logarithm of the likelihood of some rows."""
        few, one = self.problem.thinned(rows), self.problem.recording
        chi2 = float(np.sum(few.weighted(self.x[np.newaxis, np.newaxis]) ** 2))
        logarithms = float(one.present.sum(axis=1) @ np.log(self.problem.sizes))
        return (chi2 + 2 * logarithms) * few.recording.t.size / one.t.size

    @property
    def spins(self) -> bool:
        """Whether the spin is recorded."""
        return self.problem.spins

    def quantities(self, at: Array, has: Mapping[str, Any]) -> dict[str, Array]:
        """Return the quantities of motions, shape (tries,), from parameters.

        If the spin is not recorded, r0 is that of known inputs, or of a body with C = A.
        """
        found = {name: y[0] for name, y in self.problem.values(at[np.newaxis]).items()}
        return found if self.spins else found | {"r0": body_of(has, found).get("r0", found["b"])}

    @property
    def values(self) -> dict[str, float]:
        """The quantities of the motion."""
        found = self.quantities(self.x[np.newaxis], {})
        return {name: float(y.item()) for name, y in found.items()}

    def std(self, name: str) -> float:
        """Return the standard deviation of a parameter, 0 if it is none."""
        names = self.problem.names
        return float(np.linalg.norm(self.spread[names.index(name)])) if name in names else 0.0

    def differs(self, other: Minimum) -> bool:
        """Return whether another minimum is that of another top, by its a or b."""
        return any(
            abs(self.values[x] - other.values[x]) > APART * self.std(x) + 1e-6 * abs(self.values[x])
            for x in ("a", "b")
        )

    def turned(self, turns: float) -> Minimum:
        """Return the minimum with a spin that is faster by whole turns per row."""
        x = self.x + turns * np.array([name == "r0" for name in self.problem.names])
        problem = replace(self.problem, turns=self.problem.turns + turns)
        return replace(self, problem=problem, x=x)

    def tied(self, ties: Ties) -> Minimum:
        """Return the minimum that obeys known inputs; its spread is that without them."""
        problem = replace(self.problem, ties=ties)
        x = self.x[np.newaxis]
        x, _ = problem.thinned(MOST_ROWS).solve(x, _STEPS)
        if problem.recording.t.size > MOST_ROWS:
            x = polished(problem.weighted, x, _LAST)
        return replace(minimum_at(self.problem, x), is_curved=self.is_curved)


def minimum_at(problem: Problem, x: Array) -> Minimum:
    """Return the minimum at parameters of one start, with their spread to first order."""
    few = problem.thinned(MOST_ROWS)
    rise = slopes(few.weighted, x, np.zeros(1, int), central=True)[1][0]
    size = np.linalg.norm(rise, axis=0) + 1e-300
    _, values, rows = np.linalg.svd(rise / size, full_matrices=False)
    sure = values > _DEPENDENT * values[0]
    loose = np.abs(rows[~sure]).max(axis=0, initial=0.0) > _SHARE
    spread = rows[sure].T / values[sure] / size[:, np.newaxis]
    loose[0] |= x[0, 0] <= SURE * np.linalg.norm(spread[0])  # a <= 0 is no top
    meant = {"tilt": "theta0", "lean": "psi_zero", "p": "thetadot0", "q": "psidot0"}
    unknown = (meant.get(y, y) for y, z in zip(problem.names, loose, strict=True) if z)
    return Minimum(problem, x[0], spread, (*unknown,))


def converged(
    problem: Problem, x: Array, floors: Array, factors: Array | float = 1.0, *, final: bool = False
) -> Minimum:
    """Return the minimum near parameters of one start.

    Standard deviations that were not given come from the residuals, and are at least the
    `floors`.  `factors` widen them for correlated noise.  Only a `final` minimum has the last
    steps, also with all rows, and the shape of chi^2.
    """
    few, gain = problem.thinned(MOST_ROWS), GAIN if final else _NEAR
    if is_given := bool(problem.recording.sigma):
        problem, few = (replace(y, sizes=y.sizes * factors) for y in (problem, few))
        x, _ = few.solve(x, _STEPS, gain)
    else:
        few, x = few.reweighted(x, floors, _STEPS // 2, gain)
        problem = replace(problem, sizes=few.sizes)
    if final and problem.recording.t.size > MOST_ROWS:
        x = polished(problem.weighted, x, _LAST)
        problem = problem if is_given else problem.with_noise(x, floors)
    problem = problem if is_given else replace(problem, sizes=problem.sizes * factors)
    found = minimum_at(problem, x)
    return shaped(found) if final else found


def shaped(found: Minimum) -> Minimum:
    """Return the minimum with a spread that is as wide as chi^2 is two standard deviations away.

    Chi^2 should have grown by 4 at either end of each axis of the spread.  Where it grows by much
    more, its valley is bent, and the floor of the valley is searched for.  Without a floor on
    either side, or if a or b is far aside on it, the covariance is wrong.
    """
    few = found.problem.thinned(_SHAPE_ROWS)
    here, x = few.weighted(found.x[np.newaxis, np.newaxis]), found.x
    rows = np.linalg.pinv(found.spread)
    wanted = np.concatenate([2 * np.eye(len(rows)), -2 * np.eye(len(rows))])
    ends = x + wanted @ found.spread.T
    grown = np.sum((few.weighted(ends[np.newaxis]) - here) ** 2, axis=-1)[0] / 4
    bent, is_aside = np.flatnonzero(grown > _BENT), False
    if bent.size:
        axes = bent % len(rows)
        held = replace(few, first=np.repeat(few.first, bent.size, axis=0))

        def rest(at: Array, who: Array) -> Array:
            off = np.einsum("kti,ki->kt", at - x, rows[axes[who]])
            off = _STIFF * (off - wanted[bent, axes][who, np.newaxis])
            return np.concatenate([held.weighted(at, who) - here, off[..., np.newaxis]], axis=-1)

        floor, chi2 = descended(rest, ends[bent], 20)
        grown[bent] = chi2 / 4
        stds = np.linalg.norm(found.spread[:2], axis=1) + 1e-100
        is_aside = bool(np.any(np.abs(floor - ends[bent])[:, :2] / stds > APART))
    least = grown.reshape(2, -1).min(axis=0, initial=np.inf)
    factors = np.sqrt(1 / np.clip(least, 1e-2, 1))
    is_curved = is_aside or bool(np.any(least > _BROKEN))
    return replace(found, spread=found.spread * factors, is_curved=is_curved)


def slowest(found: Minimum, turn: float) -> Minimum:
    """Return a minimum with the slowest spin of a rigid body that looks alike in the rows.

    Its b has a sign, and r0 with it, if it is SURE standard deviations from 0.
    """
    if not turn or not found.spins or found.problem.ties:
        return found
    v, std = found.values, found.std("b")
    rate = slowest_rate(v["r0"], turn, v["b"] if abs(v["b"]) > SURE * std else 0.0, std)
    return found.turned(rate - v["r0"]) if rate not in {v["r0"], math.inf} else found


def largest(problem: Problem, x: Array) -> Any:
    """Return the largest rms residual of a channel at parameters of one start, in radians."""
    squares = problem.residuals(x[:, np.newaxis]) ** 2
    count = np.maximum(np.isfinite(squares).sum(axis=-1), 1)  # rows of a sparse angle may have none
    return np.sqrt(np.nansum(squares, axis=-1) / count).max()
