"""The least squares of some recordings: parameters, their covariance, and residuals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.types import Array
from ..errors import LagtopError
from .model import STATE, angles_and_slopes, as_recorded, residuals
from .parameters import FIT_QUANTITIES, Coordinates, KnownInputs, Parameters, parameters_of
from .recording import Recording
from .starting_tops import FitStart

_FAR = 1e3
"""Residuals, in standard deviations, assigned to an invalid state."""
_MOST_STEPS = 100
_LEAST_SIGMA = 1e-15
"""Standard deviation used if all residuals are 0."""
_DEPENDENT = 1e-7
"""Ratio to the largest singular value, below which a direction is not determined."""
_REACH, _BENT = 3.0, 0.2
"""Standard deviations at which chi^2 is checked, and its permitted distance from a parabola."""
_MOST_STRETCHES, _MOST_HELD, _HOLD = 10, 20, 100.0
"""Extensions to find three standard deviations, steps of each, and weight that holds each end."""
_STEADY, _REWEIGHTINGS = 0.01, 6
"""Tolerance of chi^2/dof around 1, and most rounds, if standard deviations are of the residuals."""


class Fit(NamedTuple):
    """Parameters with the least sum of squares for some recordings of one body."""

    recordings: Sequence[Recording]
    """Recordings as interpreted: psi may be counted in the other direction."""
    parameters: Parameters
    values: Array
    covariance: Array
    chi2: float
    dof: int
    residuals: Sequence[Mapping[str, Array]]
    """Residuals of each recording by channel, in radians; NaN where a number is missing."""
    sigma: Sequence[Array] = ()
    """Standard deviations of each recording in the fit, shape (channels, times)."""
    converged: bool = True
    unknown: Sequence[str] = ()
    """Parameters that the data do not determine."""
    noise: Sequence[Mapping[str, float]] = ()
    """Noise of each recording, as in its `FitStart`; empty if it is not known."""
    rival: Mapping[str, float] | None = None
    """Another top that explains a single recording as well: its quantities by name."""

    @property
    def sigma_known(self) -> bool:
        """Whether the standard deviations were given; otherwise they come from the residuals."""
        return bool(self.recordings[0].sigma)

    @property
    def problem(self) -> Problem:
        """The least squares that this fit solves."""
        return Problem(self.recordings, self.sigma, self.parameters)

    def continued(self, start: Array) -> Fit:
        """Return the fit of the same recordings from other parameters."""
        return self.problem.solve(start)._replace(noise=self.noise, rival=self.rival)

    def quantities(self, i: int) -> tuple[Array, Array]:
        """Return the quantities of recording i, in the order of the labels, and covariance."""
        found, slopes = self.parameters.quantities(self.values, i)
        return found, slopes @ self.covariance @ slopes.T

    @property
    def start(self) -> FitStart:
        """The start of another fit of the first recording."""
        values = dict(zip(self.parameters.labels, self.quantities(0)[0].tolist(), strict=True))
        return FitStart(self.recordings[0], self.noise[0], values)


class Problem:
    """Recordings with the standard deviations of their channels, and the parameters to fit."""

    def __init__(
        self, recordings: Sequence[Recording], sigma: Sequence[Array], parameters: Parameters
    ) -> None:
        self.recordings, self.sigma, self.parameters = recordings, sigma, parameters
        self.by = Coordinates([name for name, _ in parameters.names])
        self._last: tuple[Array, Array, Array, list[dict[str, Array]]] | None = None

    def solve(self, start: Array, steps: int = _MOST_STEPS) -> Fit:
        """Return the parameters with the least chi^2, after at most `steps` steps from a start.

        Raises LagtopError.
        """
        from scipy.optimize import least_squares

        bounds = self._bounds()
        inside = np.clip(start, *bounds)
        if (self._at(inside)[0] == _FAR).all():
            raise LagtopError("the fit cannot start: no motion of a top matches the recording")
        ended = least_squares(
            lambda x: self._at(self.by.parameters(x))[0],
            self.by.of(inside),
            self._slopes,
            bounds=(-np.inf, np.inf) if self.by.apply else bounds,
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
        return Fit(
            self.recordings,
            self.parameters,
            found,
            self.by.covariance(ended.x, spread),
            float(np.sum(values**2)),
            values.size - len(found),
            left,
            self.sigma,
            ended.status > 0,
            _Inverse(slopes).undetermined(self.by.names),
        )

    def with_reach(self, fit: Fit) -> Fit:
        """Return the fit with a covariance that holds for three standard deviations.

        Along the direction that the data determine least, chi^2 need not be a parabola.  It is
        followed to both sides of the minimum, with the other parameters at their best values, until
        it has risen by about nine.  The longer side counts.
        """
        centre = self.by.of(fit.values)
        inverse = _Inverse(self._slopes(centre))
        spread, weakest = inverse.spread, inverse.weakest
        column, across = spread[:, weakest], inverse.measure
        far = [self.by.parameters(centre + way * column) for way in (_REACH, -_REACH)]
        rises = [float(np.sum(self._at(x)[0] ** 2)) - fit.chi2 for x in far]
        if all(abs(rise / _REACH**2 - 1) < _BENT for rise in rises):
            return fit
        ends = [self._followed(centre, way * column, across, fit.chi2) for way in (1, -1)]
        deviations = np.sqrt(np.diag(fit.covariance))
        off = max((x - fit.values for x in ends), key=lambda x: np.linalg.norm(x / deviations))
        covariance = self.by.covariance(centre, np.delete(spread, weakest, axis=1))
        return fit._replace(covariance=covariance + np.outer(off, off))

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


def fitted_from(starts: Sequence[FitStart], known: KnownInputs, *, steps: int = _MOST_STEPS) -> Fit:
    """Return the fit of one body to recordings, from a start for each.

    Standard deviations that are not given are those of the noise.  Raises LagtopError.
    """
    recordings, noise, values = zip(*starts, strict=True)
    parameters = parameters_of(known, recordings)
    sigma = [
        _by_row(one, one.sigma or {**dict.fromkeys(one.channels, max(x.values())), **x})
        for one, x in zip(recordings, noise, strict=True)
    ]
    problem = Problem(recordings, sigma, parameters)
    return problem.solve(parameters.start(values), steps)._replace(noise=noise)


def _by_row(recording: Recording, sigma: Mapping[str, ArrayLike]) -> Array:
    """Return standard deviations by channel in shape (channels, times)."""
    return np.stack([np.broadcast_to(sigma[x], recording.t.shape) for x in recording.channels])


def reweighted(fit: Fit) -> Fit:
    """Return a fit with standard deviations from its residuals, unless they are given."""
    if fit.sigma_known:
        return fit
    for _ in range(_REWEIGHTINGS):
        spread = _spread_of_residuals(fit)
        sigma = [_by_row(recording, spread) for recording in fit.recordings]
        fit = fit._replace(sigma=sigma).continued(fit.values)
        if abs(fit.chi2 / max(fit.dof, 1) - 1) < _STEADY:
            break
    return fit


def _spread_of_residuals(fit: Fit) -> dict[str, float]:
    """Return the standard deviations of residuals by channel, common to all recordings."""
    channels = dict.fromkeys(channel for one in fit.residuals for channel in one)
    joined = {x: np.concatenate([one[x] for one in fit.residuals if x in one]) for x in channels}
    share = sum(int(np.isfinite(x).sum()) for x in joined.values()) / max(fit.dof, 1)
    return {
        channel: max(float(np.sqrt(np.nanmean(x**2) * share)), _LEAST_SIGMA)
        for channel, x in joined.items()
    }


def _left(recording: Recording, quantities: Array, slopes: Array) -> tuple[Array, Array] | None:
    """Return residuals and their derivatives by the parameters; None if there is no such top."""
    try:
        angles, by_state = angles_and_slopes(quantities[: len(STATE)], recording.t)
    except LagtopError:
        return None
    value, slope = (dict(zip(FIT_QUANTITIES, x, strict=True)) for x in (quantities, slopes))
    rest = residuals(recording, as_recorded(angles, value, recording.t))
    by_values = by_state @ slopes[: len(STATE)]
    changes = as_recorded(by_values, slope, recording.t[:, np.newaxis])
    return rest.values, np.einsum("cta,atp->ctp", rest.slopes, changes)


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
        inverse = np.divide(1, self.values, out=0 * self.values, where=self.determined)
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
