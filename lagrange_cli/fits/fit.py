"""The fit: the top behind a recording, or behind several recordings of one body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.types import Array
from .attempts import Attempt, best_attempt, sigma_of
from .least_squares import FittedParameters, Problem, sigma_left
from .parameters import FIT_QUANTITIES, Parameters, parameters_of
from .recording import Recording

_STEADY, _REWEIGHTINGS = 0.01, 6
"""Standard deviations that change by a smaller part are those of the residuals, and the most
changes that are made.
"""


class Fit(NamedTuple):
    """The motion that leaves least of some recordings of one body."""

    recordings: Sequence[Recording]
    """Recordings as they were understood: psi may be counted the other way."""
    solution: FittedParameters
    sigma_known: bool
    """Whether the standard deviations were given; else they are those of the residuals."""
    mirrored: Sequence[bool]
    """Whether psi had to be counted the other way."""
    noise: Sequence[Mapping[str, float]]
    """Noise of each recording by channel, in radians, estimated by a fit of plain harmonics."""
    rival: Array | None = None
    """Another top that explains the only recording as well, as of `FittedParameters.quantities`."""


def fit_recordings(
    recordings: Sequence[Recording], known: Mapping[str, float], where: str = "data"
) -> Fit:
    """Return the top whose motions leave least of some recordings; all are of one body.

    `known` are inputs by key, theta0 in radians; nothing else is taken for known.  Raises
    LagtopError, DataError for recordings that cannot be fitted.
    """
    with ARRAYS.working():
        return _fitted(recordings, known, where)


def _fitted(recordings: Sequence[Recording], known: Mapping[str, float], where: str) -> Fit:
    alone = [best_attempt(recording, known, _named(where, recording)) for recording in recordings]
    understood = [one.recording for one in alone]
    noise, mirrored = [one.noise for one in alone], [one.mirrored for one in alone]
    solution, rival = alone[0].solution, alone[0].rival
    if len(alone) > 1:
        together, rival = parameters_of(known, understood), None
        problem = Problem(understood, [*map(sigma_of, understood, noise)], together)
        solution = problem.solve(_joined(together, alone))
    sigma_known = bool(understood[0].sigma)
    found = Fit(understood, solution, sigma_known, mirrored, noise, rival)
    if not sigma_known:
        found = _reweighted(found)
    return _far_enough(found) if len(alone) == 1 else found


def _named(where: str, recording: Recording) -> str:
    return f"{where}, {recording.name}" if recording.name else where


def _joined(together: Parameters, alone: Sequence[Attempt]) -> Array:
    """Return where a fit of several recordings starts: from the fits of each."""
    found = [
        dict(zip(FIT_QUANTITIES, one.solution.quantities(0)[0].tolist(), strict=True))
        for one in alone
    ]
    for one in found:
        one["ratio"] = one["b"] / one["r0"] if one["r0"] else 1.0
    values = [
        np.median([one[name] for j, one in enumerate(found) if i in {-1, j}])
        for name, i in together.names
    ]
    return np.array(values)


def _reweighted(found: Fit) -> Fit:
    """Return a fit with the standard deviations of its residuals."""
    recordings, solution = found.recordings, found.solution
    for _ in range(_REWEIGHTINGS):
        sigma = sigma_left(solution, recordings)
        solution = Problem(recordings, sigma, solution.parameters).solve(solution.values)
        if abs(solution.chi2 / max(solution.dof, 1) - 1) < _STEADY:
            break
    return found._replace(solution=solution)


def _far_enough(found: Fit) -> Fit:
    """Return the fit of one recording with uncertainties that hold for three of them."""
    recordings, solution = found.recordings, found.solution
    known = [recording.sigma for recording in recordings]
    sigma = known if found.sigma_known else sigma_left(solution, recordings)
    problem = Problem(recordings, sigma, solution.parameters)
    return found._replace(solution=problem.with_reach(solution))
