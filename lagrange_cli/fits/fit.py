"""The fit: the top behind a recording, or behind several recordings of one body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import DataError, LagtopError
from .least_squares import Problem, Solution, sigma_left
from .nutation import Shown, shown_by
from .parameters import Parameters, parameters_of
from .recording import Recording
from .start import Start, placed, starts

_FIRST_SIGMA = 0.01
"""Standard deviation in radians that is taken for all channels where none is known."""
_MOST_STARTS = 4
_COMPARABLE = 50.0
"""Starts that leave no more than so many times what the best fit leaves are tried too."""
_REWEIGHTINGS = 2
_MUCH = 1.5
"""How many times the noise a good fit leaves at most."""


class Fit(NamedTuple):
    """The motion that leaves least of some recordings of one body."""

    recordings: Sequence[Recording]
    """Recordings as they were understood: psi may be counted the other way."""
    solution: Solution
    sigma_known: bool
    """Whether the standard deviations were given; else they are those of what is left."""
    mirrored: Sequence[bool]
    """Whether psi had to be counted the other way."""
    noise: Sequence[float]
    """What plain harmonics leave of the tilt of each recording, rms in radians."""

    def values(self, i: int) -> tuple[Array, Array]:
        """Return what recording i depends on, in the order of `parameters.QUANTITIES`.

        Their covariance follows.
        """
        found, slopes = self.solution.parameters.quantities(self.solution.values, i)
        return found, slopes @ self.solution.covariance @ slopes.T


class _Case(NamedTuple):
    """A recording, one way or the other, with what it shows and a start."""

    recording: Recording
    mirrored: bool
    shown: Shown
    start: Start


def fit_recordings(
    recordings: Sequence[Recording], known: Mapping[str, float], where: str = "data"
) -> Fit:
    """Return the top whose motions leave least of some recordings; all are of one body.

    `known` are inputs by key, theta0 in radians; nothing else is taken for known.  Raises
    LagtopError, DataError for recordings that cannot be fitted.
    """
    alone = [_fit_one(recording, known, _named(where, recording)) for recording in recordings]
    if len(alone) == 1:
        return _reweighted(alone[0])
    together = parameters_of(known, [one.recordings[0] for one in alone])
    understood = [one.recordings[0] for one in alone]
    problem = Problem(understood, _sigma(understood), together)
    solution = problem.solve(_joined(together, alone))
    mirrored = [one.mirrored[0] for one in alone]
    noise = [one.noise[0] for one in alone]
    return _reweighted(Fit(understood, solution, alone[0].sigma_known, mirrored, noise))


def _named(where: str, recording: Recording) -> str:
    return f"{where}, {recording.name}" if recording.name else where


def _sigma(recordings: Sequence[Recording]) -> list[Mapping[str, Array]]:
    """Return the standard deviations, or one for all where they are not known."""
    return [
        recording.sigma or {x: np.full(recording.t.size, _FIRST_SIGMA) for x in recording.channels}
        for recording in recordings
    ]


def _fit_one(recording: Recording, known: Mapping[str, float], where: str) -> Fit:
    """Return the best fit of one recording, from the starts that may lead to it."""
    parameters = parameters_of(known, [recording])
    _check(recording, parameters, where)
    best: Fit | None = None
    for wide in (False, True):
        for case in _cases(recording, known, where, wide=wide):
            if best is not None and case.start.left > _COMPARABLE * _left(best):
                break
            found = _from(case, parameters)
            if found is not None and (best is None or _left(found) < _left(best)):
                best = found
        if best is not None and _explains(best):
            break
    if best is None:
        raise DataError(f"{where}: no top moves as the recording shows")
    return best


def _from(case: _Case, parameters: Parameters) -> Fit | None:
    """Return the fit from one start, or None where that is no top."""
    problem = Problem([case.recording], _sigma([case.recording]), parameters)
    try:
        solution = problem.solve(_first(parameters, case.start))
    except LagtopError:
        return None
    sine = float(np.nanmean(np.sin(case.recording.angles["theta"])))
    noise = case.shown.noise / max(sine, 0.1)
    return Fit([case.recording], solution, bool(case.recording.sigma), [case.mirrored], [noise])


def _left(found: Fit) -> float:
    return sum(float(np.nansum(left**2)) for left in found.solution.left)


def _explains(found: Fit) -> bool:
    """Return whether a fit leaves no more of the tilt than the harmonics do, but for chance."""
    left = found.solution.left[0][0]
    return float(np.sqrt(np.nanmean(left**2))) < _MUCH * found.noise[0]


def _cases(
    recording: Recording, known: Mapping[str, float], where: str, *, wide: bool
) -> list[_Case]:
    """Return the starts, the nearest first; both ways of psi where the spin tells which."""
    spins = recording.kind == "angles" and "psi" in recording.angles
    both = spins and ("phi" in recording.angles or "r0" in known)
    cases = []
    for mirrored in (False, True) if both else (False,):
        one = recording.mirrored if mirrored else recording
        shown = shown_by(one, where)
        for start in starts(one, shown, wide=wide)[:_MOST_STARTS]:
            if "phi" in one.angles or start.state[1] * known.get("r0", start.state[1]) >= 0:
                cases.append(_Case(one, mirrored, shown, placed(start)))
    return sorted(cases, key=lambda case: case.start.left)[:_MOST_STARTS]


def _check(recording: Recording, parameters: Parameters, where: str) -> None:
    """Raise DataError for a recording that has too few numbers, or tells too little."""
    count = sum(int(np.isfinite(recording.angles[x]).sum()) for x in recording.angles)
    if count <= len(parameters.names):
        raise DataError(
            f"{where} must have more numbers than there are unknowns, got {count} for "
            f"{len(parameters.names)}"
        )
    if not {"phi", "psi"} & recording.angles.keys() and "psidot0" not in parameters.known:
        raise LagtopError(
            f"{where} has neither psi nor phi, and theta alone does not tell b: fix psidot0 "
            "(0 for a top that is let go in the first row)"
        )


def _first(parameters: Parameters, start: Start) -> Array:
    """Return the parameters of a start."""
    a, b, theta, nutation, precession = start.state
    known = parameters.known
    r0 = known.get("r0", b + start.excess)
    ratio = b / r0 if r0 else 1.0
    values = {
        "a": a,
        "b": b,
        "ratio": ratio,
        "r0": r0,
        "theta0": theta,
        "thetadot0": nutation,
        "psidot0": precession,
        "psi_zero": start.psi_zero,
        "phi_zero": start.phi_zero,
    }
    return np.array([values[name] for name, _ in parameters.names])


def _joined(together: Parameters, alone: Sequence[Fit]) -> Array:
    """Return where a fit of several recordings starts: from the fits of each."""
    values = np.zeros(len(together.names))
    for column, (name, i) in enumerate(together.names):
        sources = [
            float(one.solution.values[one.solution.parameters.names.index(key)])
            for j, one in enumerate(alone)
            for key in ((name, -1), (name, 0))
            if i in {-1, j} and key in one.solution.parameters.names
        ]
        values[column] = float(np.median(sources))
    return values


def _reweighted(found: Fit) -> Fit:
    """Return a fit with standard deviations from what is left, where they are not known."""
    if found.sigma_known:
        return found
    recordings, solution = found.recordings, found.solution
    for _ in range(_REWEIGHTINGS):
        sigma = sigma_left(solution, recordings)
        solution = Problem(recordings, sigma, solution.parameters).solve(solution.values)
    return found._replace(solution=solution)
