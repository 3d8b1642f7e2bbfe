"""The best fit of one recording: some steps from several starts, then convergence of the best."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import DataError, LagtopError
from .harmonics import frame_of, slowest_spin
from .least_squares import FittedParameters, Problem, fitted_from
from .nutation import Shown, Turns, shown_by, turns_in
from .parameters import FIT_QUANTITIES, parameters_of
from .recording import Recording
from .starting_tops import StartingTop, starting_tops

_BODY = [FIT_QUANTITIES.index(name) for name in ("a", "b", "r0")]
_MOST_STARTS = 6
_COMPARABLE = 50.0
"""Starts and attempts are dropped if their chi^2 exceeds the least by more than this factor."""
_FIRST_STEPS, _MOST_FINISHED = 15, 3
"""Steps from each start, and the number of attempts that are then continued to convergence."""
_CHANCE, _APART = 16.0, 2.0
"""Differences that make attempts distinct.  The first is of chi^2, over chi^2/dof: below it
attempts explain a recording equally well.  The second is in standard deviations: beyond it numbers
belong to different tops.
"""
_MUCH = 1.5
"""Largest residual of a good fit, over the noise."""


class Attempt(NamedTuple):
    """A fit of one recording."""

    problem: Problem
    solution: FittedParameters
    noise: Mapping[str, float]
    """Noise by channel, in radians, estimated by a fit of plain harmonics."""
    rival: Mapping[str, float] | None = None
    """Another top that explains the recording as well: its quantities by name."""

    @property
    def recording(self) -> Recording:
        """The recording, with psi counted in the direction that fits."""
        return self.problem.recordings[0]

    @property
    def body(self) -> tuple[Array, Array]:
        """The values of a, b and r0, and their standard deviations."""
        values, covariance = self.solution.quantities(0)
        return values[_BODY], np.sqrt(np.diag(covariance))[_BODY]

    def differs(self, other: Attempt) -> bool:
        """Return whether a, b or r0 of two attempts differ by more than their uncertainties."""
        (ours, our_spread), (theirs, their_spread) = self.body, other.body
        return bool(np.any(np.abs(ours - theirs) > _APART * (our_spread + their_spread)))

    def explains(self) -> bool:
        """Return whether all residuals are, within chance, as small as those of harmonics."""
        left = self.solution.residuals[0]
        return all(
            np.isfinite(left[channel]).any()
            and float(np.sqrt(np.nanmean(left[channel] ** 2))) < _MUCH * noise
            for channel, noise in self.noise.items()
        )

    def continued(self, values: Array) -> Attempt:
        """Return the attempt after least squares from some parameters."""
        return self._replace(solution=self.problem.solve(values))


def best_attempt(
    recording: Recording, known: Mapping[str, float], stds: Mapping[str, float], where: str
) -> Attempt:
    """Return the best fit of one recording, from several starts.

    Raises LagtopError, DataError for a recording that cannot be fitted.
    """
    _check(recording, known, len(parameters_of(known, stds, [recording]).names), where)
    ways = _ways(recording, known, where)
    found: list[Attempt] = []
    for wide in (False, True):
        cases = _cases(ways, known, wide=wide)
        begun = [made for case in cases if (made := _begun(*case, known, stds)) is not None]
        found += _finished(begun)
        if found and min(found, key=_chi2).explains():
            break
    if not found:
        raise DataError(f"{where}: no motion of a top matches the recording")
    return _told_apart([*map(_slowed, found)])


def _check(recording: Recording, known: Mapping[str, float], unknowns: int, where: str) -> None:
    """Raise DataError for too few numbers, LagtopError if no fit is possible.

    No fit is possible without an unknown, or if the angles do not determine a top.
    """
    seen = recording.angles.keys()
    if not unknowns:
        raise LagtopError(
            f"{where}: fit needs an unknown input, but all are known: leave one out, or use "
            "lagtop compare"
        )
    count = sum(int(np.isfinite(x).sum()) for x in recording.angles.values())
    if count <= unknowns:
        raise DataError(
            f"{where} must have more numbers than there are unknowns, got {count} for {unknowns}"
        )
    if seen == {"theta"} and "psidot0" not in known:
        raise LagtopError(
            f"{where} has neither psi nor phi, and theta does not determine b: fix psidot0 "
            "(0 for a top released in the first row)"
        )
    if seen == {"psi"} and "theta0" not in known:
        raise LagtopError(
            f"{where} has neither theta nor phi, and psi does not determine the tilt: fix "
            "theta0, the tilt in the first row"
        )


_Way = tuple[Recording, Shown | Turns]
"""A recording with psi counted in one direction, and the nutation that it then shows."""


def _ways(recording: Recording, known: Mapping[str, float], where: str) -> list[_Way]:
    """Return a recording, and its mirror image too if its spin determines the direction of psi."""
    spins = recording.kind == "angles" and "psi" in recording.angles
    both = spins and ("phi" in recording.angles or "r0" in known)
    look = shown_by if "theta" in recording.angles else turns_in
    return [(one, look(one, where)) for one in [recording, recording.mirrored][: 1 + both]]


def _cases(
    ways: Sequence[_Way], known: Mapping[str, float], *, wide: bool
) -> list[tuple[_Way, StartingTop]]:
    """Return the starts, the nearest first, with the nearest one for each direction of psi."""
    first: list[tuple[_Way, StartingTop]] = []
    others: list[tuple[_Way, StartingTop]] = []
    for way in ways:
        cases = [
            (way, start)
            for start in starting_tops(*way, known.get("theta0"), wide=wide)
            if "phi" in way[0].angles or start.values["b"] * known.get("r0", start.values["b"]) >= 0
        ]
        first, others = first + cases[:1], others + cases[1:]
    nearest = min((start.misfit for _, start in first), default=0.0)
    others = [case for case in others if case[1].misfit <= _COMPARABLE * nearest]
    return first + sorted(others, key=lambda case: case[1].misfit)[: _MOST_STARTS - len(first)]


def _begun(
    way: _Way, start: StartingTop, known: Mapping[str, float], stds: Mapping[str, float]
) -> Attempt | None:
    """Return the result of some steps from one start, or None if they leave the valid tops."""
    recording, noise = way[0], way[1].noise
    values = start.values | {"r0": known.get("r0", start.values["r0"])}
    try:
        fit = fitted_from([values], [recording], [noise], known, stds, steps=_FIRST_STEPS)
    except LagtopError:
        return None
    return Attempt(*fit, noise)


def _finished(begun: Sequence[Attempt]) -> list[Attempt]:
    """Return the best attempts at convergence, each for a different top."""
    found: list[Attempt] = []
    nearest = sorted(begun, key=_chi2)
    for one in nearest:
        if _chi2(one) > _COMPARABLE * _chi2(nearest[0]) or len(found) == _MOST_FINISHED:
            break
        if all(one.differs(other) for other in found):
            found.append(one if one.solution.converged else one.continued(one.solution.values))
    return found


def _chi2(attempt: Attempt) -> float:
    return attempt.solution.chi2


def _slowed(found: Attempt) -> Attempt:
    """Return an attempt with the slowest spin rate that a rigid body can have.

    Rates that differ by whole turns per frame look alike.
    """
    recording, parameters = found.recording, found.problem.parameters
    if "phi" not in recording.angles or ("r0", 0) not in parameters.names or parameters.tied:
        return found
    (_, b, r0), (_, spread, _) = found.body
    frame = frame_of(recording.t[np.isfinite(recording.angles["phi"])])
    slowest = slowest_spin(float(r0), float(b), float(spread), frame)
    if slowest == r0:
        return found
    values = found.solution.values.copy()
    values[parameters.names.index(("r0", 0))] = slowest
    other = found.continued(values)
    return other if _chi2(other) < _MUCH * _chi2(found) else found


def _told_apart(found: Sequence[Attempt]) -> Attempt:
    """Return the best attempt, with the best rival that explains the recording equally well.

    A spin of more than half a turn per frame is dropped if a slower one fits equally well.
    """
    best = min(found, key=_chi2)
    chance = _CHANCE * _chi2(best) / max(best.solution.dof, 1)
    alike = [one for one in found if _chi2(one) - _chi2(best) <= chance]
    alike = [one for one in alike if not _is_fast(one)] or alike
    best = min(alike, key=_chi2)
    others = [one for one in alike if one.differs(best)]
    rival = min(others, key=_chi2, default=None)
    return best._replace(rival=None if rival is None else rival.solution.named(0))


def _is_fast(found: Attempt) -> bool:
    """Return whether a top spins by more than half a turn per frame."""
    if "phi" not in found.recording.angles:
        return False
    return abs(float(found.body[0][2])) * frame_of(found.recording.t) > math.pi
