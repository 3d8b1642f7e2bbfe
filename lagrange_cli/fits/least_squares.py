"""The least squares of some recordings: parameters, their covariance, and residuals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.types import Array
from ..errors import LagtopError
from .model import STATE, angles_and_slopes, residuals
from .parameters import FIT_QUANTITIES, Coordinates, Parameters, parameters_of
from .recording import Recording

_FAR = 1e3
"""Residuals, in standard deviations, assigned to an invalid state."""
MOST_STEPS = 100
LEAST_SIGMA = 1e-15
"""Standard deviation used if all residuals are 0."""
_DEPENDENT = 1e-7
"""Ratio to the largest singular value, below which a direction is not determined."""
_REACH, _BENT = 3.0, 0.2
"""Standard deviations at which chi^2 is checked, and its permitted distance from a parabola."""
_MOST_STRETCHES, _MOST_HELD, _HOLD = 10, 20, 100.0
"""Extensions to find three standard deviations, steps of each, and weight that holds each end."""
_STEADY, _REWEIGHTINGS = 0.01, 6
"""Tolerance of chi^2/dof around 1, and largest number of rounds, when standard deviations are taken
from the residuals.
"""


class FittedParameters(NamedTuple):
    """Parameters with the least sum of squares."""

    parameters: Parameters
    values: Array
    covariance: Array
    chi2: float
    dof: int
    residuals: Sequence[Mapping[str, Array]]
    """Residuals of each recording by channel, in radians; NaN where a number is missing."""
    converged: bool
    unknown: Sequence[str]
    """Parameters that the data do not determine."""

    def quantities(self, i: int) -> tuple[Array, Array]:
        """Return the quantities of recording i, in the order of the labels, and covariance."""
        found, slopes = self.parameters.quantities(self.values, i)
        return found, slopes @ self.covariance @ slopes.T

    def named(self, i: int) -> dict[str, float]:
        """Return the quantities of recording i, by name."""
        return dict(zip(self.parameters.labels, self.quantities(i)[0].tolist(), strict=True))


class Problem:
    """Recordings with the standard deviations of their channels, and the parameters to fit."""

    def __init__(
        self,
        recordings: Sequence[Recording],
        sigma: Sequence[Mapping[str, ArrayLike]],
        parameters: Parameters,
    ) -> None:
        self.recordings, self.parameters = recordings, parameters
        self.sigma = [
            np.stack([np.broadcast_to(spread[x], recording.t.shape) for x in recording.channels])
            for recording, spread in zip(recordings, sigma, strict=True)
        ]
        self.by = Coordinates([name for name, _ in parameters.names])
        self._last: tuple[Array, Array, Array, list[dict[str, Array]]] | None = None

    def solve(self, start: Array, steps: int = MOST_STEPS) -> FittedParameters:
        """Return the parameters with the least chi^2, after at most `steps` steps from a start.

        Raises LagtopError.
        """
        from scipy.optimize import least_squares

        low, high = self._bounds()
        inside = np.clip(start, low, high)
        if (self._at(inside)[0] == _FAR).all():
            raise LagtopError("the fit cannot start: no motion of a top matches the recording")
        free = self.by.apply
        ended = least_squares(
            lambda x: self._at(self.by.parameters(x))[0],
            self.by.of(inside),
            self._slopes,
            bounds=(-np.inf, np.inf) if free else (low, high),
            x_scale="jac",
            xtol=1e-9,
            ftol=1e-8,
            gtol=1e-9,
            max_nfev=steps,
        )
        found = self.by.parameters(ended.x)
        values, slopes, left = self._at(found)
        if (values == _FAR).all():
            raise LagtopError("the fit ends where no motion of a top matches the recording")
        spread = _Inverse(self._slopes(ended.x)).spread
        return FittedParameters(
            self.parameters,
            found,
            self.by.covariance(ended.x, spread),
            float(np.sum(values**2)),
            values.size - len(found),
            left,
            ended.status > 0,
            _Inverse(slopes).undetermined(self.by.names),
        )

    def with_reach(self, solution: FittedParameters) -> FittedParameters:
        """Return a solution whose covariance holds for three standard deviations.

        Along the direction that the data determine least, chi^2 need not be a parabola.  It is
        followed to both sides of the minimum, with the other parameters at their best values, until
        it has risen by about nine.  The longer side counts.
        """
        centre = self.by.of(solution.values)
        inverse = _Inverse(self._slopes(centre))
        spread, weakest = inverse.spread, inverse.weakest
        column, across = spread[:, weakest], inverse.measure
        far = [self.by.parameters(centre + way * column) for way in (_REACH, -_REACH)]
        rises = [float(np.sum(self._at(x)[0] ** 2)) - solution.chi2 for x in far]
        if all(abs(rise / _REACH**2 - 1) < _BENT for rise in rises):
            return solution
        ends = [self._followed(centre, way * column, across, solution.chi2) for way in (1, -1)]
        deviations = np.sqrt(np.diag(solution.covariance))
        off = max((x - solution.values for x in ends), key=lambda x: np.linalg.norm(x / deviations))
        covariance = self.by.covariance(centre, np.delete(spread, weakest, axis=1))
        return solution._replace(covariance=covariance + np.outer(off, off))

    def _followed(self, centre: Array, column: Array, across: Array, chi2: float) -> Array:
        """Return the parameters one standard deviation away, by the rise of chi^2 along a line."""
        from scipy.optimize import least_squares

        values, at, step = self.by.parameters(centre), centre, column
        off = self.by.parameters(centre + column) - values
        for _ in range(_MOST_STRETCHES):
            goal = float(across @ (at + step - centre))

            def residuals(x: Array, goal: float = goal) -> Array:
                held = _HOLD * (across @ (x - centre) - goal)
                return np.append(self._at(self.by.parameters(x))[0], held)

            def slopes(x: Array) -> Array:
                return np.vstack([self._slopes(x), _HOLD * across])

            held = least_squares(residuals, at + step, slopes, x_scale="jac", max_nfev=_MOST_HELD)
            rise = max(2 * held.cost - chi2, 1e-3)
            if not held.status or rise > 2 * _REACH**2:
                break
            off = (self.by.parameters(held.x) - values) / np.sqrt(rise)
            if rise > _REACH**2:
                break
            at, step = held.x, (held.x - at) * (1 if rise > 1 else 2)
        return values + off

    def _slopes(self, coordinates: Array) -> Array:
        """Return the derivatives of the residuals by the coordinates."""
        slopes: Array = self._at(self.by.parameters(coordinates))[1] @ self.by.slopes(coordinates)
        return slopes

    def _bounds(self) -> tuple[Array, Array]:
        names = [name for name, _ in self.parameters.names]
        low = [{"a": 1e-30, "theta0": 1e-9}.get(name, -np.inf) for name in names]
        high = [{"theta0": np.pi - 1e-9}.get(name, np.inf) for name in names]
        return np.array(low), np.array(high)

    def _at(self, values: Array) -> tuple[Array, Array, list[dict[str, Array]]]:
        """Return weighted residuals, their derivatives, and the residuals in radians."""
        if self._last is None or not np.array_equal(self._last[0], values):
            self._last = (values.copy(), *self._computed(values))
        return self._last[1:]

    def _computed(self, values: Array) -> tuple[Array, Array, list[dict[str, Array]]]:
        whole, slopes, left = [], [], []
        for i, (recording, sigma) in enumerate(zip(self.recordings, self.sigma, strict=True)):
            known = np.isfinite(sigma) & recording.known
            rows = np.full(sigma.shape, np.nan)
            off, change = np.full(sigma.shape, _FAR), np.zeros((*sigma.shape, values.size))
            rest = _left(recording, *self.parameters.quantities(values, i))
            if rest is not None:
                rows = np.where(known, rest[0], np.nan)
                off, change = rest[0] / sigma, rest[1] / sigma[..., np.newaxis]
            whole.append(off[known])
            slopes.append(np.nan_to_num(change[known]))
            left.append(dict(zip(recording.channels, rows, strict=True)))
        off, of_off = self.parameters.priors(values)
        return np.concatenate([*whole, off]), np.concatenate([*slopes, of_off]), left


def fitted_from(
    starts: Sequence[Mapping[str, float]],
    recordings: Sequence[Recording],
    noise: Sequence[Mapping[str, float]],
    known: Mapping[str, float],
    stds: Mapping[str, float],
    *,
    steps: int = MOST_STEPS,
) -> tuple[Problem, FittedParameters]:
    """Return the fit of one body to recordings, and its result, from the quantities of each.

    Standard deviations that are not given are estimated from the noise.  Raises LagtopError.
    """
    parameters = parameters_of(known, stds, recordings)
    problem = Problem(recordings, [*map(_sigma_of, recordings, noise)], parameters)
    return problem, problem.solve(parameters.start(starts), steps)


def _sigma_of(recording: Recording, noise: Mapping[str, float]) -> Mapping[str, ArrayLike]:
    """Return the standard deviations, or estimates from the noise if they are unknown."""
    greatest = max(noise.values())
    guessed = {x: max(noise.get(x, greatest), LEAST_SIGMA) for x in recording.channels}
    return recording.sigma or guessed


def reweighted(problem: Problem, solution: FittedParameters) -> tuple[Problem, FittedParameters]:
    """Return a fit with standard deviations from its residuals, unless they are given."""
    if problem.recordings[0].sigma:
        return problem, solution
    for _ in range(_REWEIGHTINGS):
        sigma = [_sigma_left(solution)] * len(problem.recordings)
        problem = Problem(problem.recordings, sigma, problem.parameters)
        solution = problem.solve(solution.values)
        if abs(solution.chi2 / max(solution.dof, 1) - 1) < _STEADY:
            break
    return problem, solution


def _sigma_left(solution: FittedParameters) -> dict[str, float]:
    """Return the standard deviations of residuals by channel, common to all recordings."""
    rest = solution.residuals
    count = sum(int(np.isfinite(values).sum()) for one in rest for values in one.values())
    share = count / max(solution.dof, 1)
    sigma: dict[str, float] = {}
    for channel in {channel: None for one in rest for channel in one}:
        joined = np.concatenate([one[channel] for one in rest if channel in one])
        sigma[channel] = max(float(np.sqrt(np.nanmean(joined**2) * share)), LEAST_SIGMA)
    return sigma


def _left(recording: Recording, quantities: Array, slopes: Array) -> tuple[Array, Array] | None:
    """Return residuals and their derivatives by the parameters; None if there is no such top.

    The motion has the zeros and the spin rate of the recording.
    """
    t = recording.t
    try:
        angles, by_state = angles_and_slopes(quantities[: len(STATE)], t)
    except LagtopError:
        return None
    value = dict(zip(FIT_QUANTITIES, quantities, strict=True))
    slope = dict(zip(FIT_QUANTITIES, slopes, strict=True))
    angles, by_values = angles.copy(), by_state @ slopes[: len(STATE)]
    if value["r0"] or slope["r0"].any():
        angles[1] += (value["r0"] - value["b"]) * t
        by_values[1] += t[:, np.newaxis] * (slope["r0"] - slope["b"])
    for i, name in ((1, "phi_zero"), (2, "psi_zero")):
        angles[i] += value[name]
        by_values[i] += slope[name]
    rest = residuals(recording, angles)
    return rest.values, np.einsum("cta,atp->ctp", rest.slopes, by_values)


class _Inverse:
    """The inverse of a matrix of derivatives (a column for each parameter), by singular values."""

    def __init__(self, slopes: Array) -> None:
        size = np.linalg.norm(slopes, axis=0)
        self.size = np.where(size > 0, size, 1.0)
        _, self.values, self.rows = np.linalg.svd(slopes / self.size, full_matrices=False)
        self.determined = self.values > _DEPENDENT * self.values[0]

    @property
    def spread(self) -> Array:
        """A matrix S with the covariance S S^T; undetermined directions are left out."""
        inverse = np.where(self.determined, 1 / np.where(self.determined, self.values, 1.0), 0.0)
        spread: Array = self.rows.T * inverse / self.size[:, np.newaxis]
        return spread

    @property
    def weakest(self) -> int:
        """The column of the spread along the direction that is determined least."""
        return int(np.flatnonzero(self.determined)[-1])

    @property
    def measure(self) -> Array:
        """The row that measures standard deviations along the weakest column only."""
        row: Array = self.rows[self.weakest] * self.values[self.weakest] * self.size
        return row

    def undetermined(self, names: Sequence[str]) -> list[str]:
        """Return the names of the numbers that are not determined."""
        shares = np.abs(self.rows[~self.determined]).max(axis=0, initial=0.0)
        return [*dict.fromkeys(name for name, x in zip(names, shares, strict=True) if x > 0.05)]
