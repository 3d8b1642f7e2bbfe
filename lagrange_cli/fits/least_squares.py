"""The least squares of some recordings: parameters, their covariance, and what is left."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from .model import STATE, angles_and_slopes
from .parameters import QUANTITIES, Parameters
from .recording import Recording
from .residuals import Residuals, residuals

_FAR = 1e3
"""Residuals, in standard deviations, of a state that is no top."""
_MOST_STEPS = 40
_DEPENDENT = 1e-7
"""Singular values below this one, over the largest, belong to what the data do not tell."""
_N = len(STATE)


class Solution(NamedTuple):
    """Parameters that leave least."""

    parameters: Parameters
    values: Array
    covariance: Array
    chi2: float
    dof: int
    left: Sequence[Array]
    """What is left of each recording in radians, shape (channels, times)."""
    converged: bool
    unknown: Sequence[str]
    """Parameters that the data do not tell."""


class Problem:
    """Recordings with their standard deviations, and the parameters to be found."""

    def __init__(
        self,
        recordings: Sequence[Recording],
        sigma: Sequence[Mapping[str, Array]],
        parameters: Parameters,
    ) -> None:
        self.recordings, self.parameters = recordings, parameters
        self.sigma = [
            np.stack([spread[channel] for channel in recording.channels])
            for recording, spread in zip(recordings, sigma, strict=True)
        ]
        self._last: tuple[Array, Array, Array, list[Array]] | None = None

    def solve(self, start: Array) -> Solution:
        """Return the parameters that leave least, from a start.  Raises LagtopError."""
        from scipy.optimize import least_squares

        low, high = self._bounds()
        inside = np.clip(start, low, high)
        if (self._at(inside)[0] == _FAR).all():
            raise LagtopError("the fit cannot start: no top moves as the recording shows")
        ended = least_squares(
            lambda x: self._at(x)[0],
            inside,
            lambda x: self._at(x)[1],
            bounds=(low, high),
            x_scale="jac",
            xtol=1e-9,
            ftol=1e-8,
            gtol=1e-9,
            max_nfev=_MOST_STEPS,
        )
        values, slopes, left = self._at(ended.x)
        covariance, unknown = _covariance(slopes, self.parameters)
        chi2 = float(np.sum(values**2))
        dof = values.size - len(ended.x)
        return Solution(
            self.parameters, ended.x, covariance, chi2, dof, left, ended.status > 0, unknown
        )

    def _bounds(self) -> tuple[Array, Array]:
        names = [name for name, _ in self.parameters.names]
        low = [{"a": 1e-30, "theta0": 1e-9}.get(name, -np.inf) for name in names]
        high = [{"theta0": np.pi - 1e-9}.get(name, np.inf) for name in names]
        return np.array(low), np.array(high)

    def _at(self, values: Array) -> tuple[Array, Array, list[Array]]:
        """Return residuals over their standard deviations, derivatives, and what is left."""
        if self._last is None or not np.array_equal(self._last[0], values):
            self._last = (values.copy(), *self._computed(values))
        return self._last[1:]

    def _computed(self, values: Array) -> tuple[Array, Array, list[Array]]:
        whole, slopes, left = [], [], []
        for i, (recording, sigma) in enumerate(zip(self.recordings, self.sigma, strict=True)):
            quantities, by_parameter = self.parameters.quantities(values, i)
            known = np.isfinite(sigma) & recording.known
            rest = _left(recording, quantities, by_parameter)
            if rest is None:
                whole.append(np.full(int(known.sum()), _FAR))
                slopes.append(np.zeros((int(known.sum()), values.size)))
                left.append(np.full(sigma.shape, np.nan))
                continue
            residual, change = rest
            whole.append((residual.values / sigma)[known])
            slopes.append(np.nan_to_num((change / sigma[..., np.newaxis])[known]))
            left.append(np.where(known, residual.values, np.nan))
        return np.concatenate(whole), np.concatenate(slopes), left


def _left(
    recording: Recording, quantities: Array, by_parameter: Array
) -> tuple[Residuals, Array] | None:
    """Return what is left and its derivatives by the parameters; None where there is no top."""
    try:
        angles, by_state = angles_and_slopes(quantities[:_N], recording.t)
    except LagtopError:
        return None
    moved, by_values = _seen_angles(recording.t, quantities, by_parameter, angles, by_state)
    rest = residuals(recording, moved)
    return rest, np.einsum("cta,atp->ctp", rest.slopes, by_values)


def _seen_angles(
    t: Array, quantities: Array, by_parameter: Array, angles: Array, by_state: Array
) -> tuple[Array, Array]:
    """Return the angles from the zeros of the recording, with the spin rate, and derivatives."""
    value = dict(zip(QUANTITIES, quantities, strict=True))
    slope = dict(zip(QUANTITIES, by_parameter, strict=True))
    by_values = by_state @ by_parameter[:_N]
    moved = angles.copy()
    spins = bool(value["r0"] or slope["r0"].any())
    if spins:
        moved[1] += (value["r0"] - value["b"]) * t
        by_values[1] += t[:, np.newaxis] * (slope["r0"] - slope["b"])
    for i, name in ((1, "phi_zero"), (2, "psi_zero")):
        moved[i] += value[name]
        by_values[i] += slope[name]
    return moved, by_values


def _covariance(slopes: Array, parameters: Parameters) -> tuple[Array, list[str]]:
    """Return the covariance of the parameters, and the names of those that are not told."""
    size = np.linalg.norm(slopes, axis=0)
    size = np.where(size > 0, size, 1.0)
    _, values, rows = np.linalg.svd(slopes / size, full_matrices=False)
    told = values > _DEPENDENT * values[0]
    inverse = np.where(told, 1 / np.where(told, values, 1.0), 0.0)
    half = rows.T * inverse
    covariance: Array = half @ half.T / np.outer(size, size)
    untold = np.abs(rows[~told]).max(axis=0, initial=0.0) > 0.05
    names = [name for (name, _), is_one in zip(parameters.names, untold, strict=True) if is_one]
    return covariance, list(dict.fromkeys(names))


def sigma_left(solution: Solution, recordings: Sequence[Recording]) -> list[dict[str, Any]]:
    """Return standard deviations from what is left: one for each channel of all recordings."""
    channels: dict[str, list[Array]] = {}
    for recording, left in zip(recordings, solution.left, strict=True):
        for channel, values in zip(recording.channels, left, strict=True):
            channels.setdefault(channel, []).append(values[np.isfinite(values)])
    joined = {channel: np.concatenate(values) for channel, values in channels.items()}
    count = sum(values.size for values in joined.values())
    share = count / max(solution.dof, 1)
    rms = {
        channel: max(float(np.sqrt(np.mean(values**2) * share)), 1e-15)
        for channel, values in joined.items()
    }
    return [
        {channel: np.full(recording.t.size, rms[channel]) for channel in recording.channels}
        for recording in recordings
    ]
