"""The best fit of one recording: some steps from several starts, and the nearest to their ends."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import DataError, LagtopError
from .harmonics import frame_of, slowest_spin
from .least_squares import LEAST_SIGMA, FittedParameters, Problem
from .nutation import Shown, Turns, shown_by, turns_in
from .parameters import FIT_QUANTITIES, Parameters, parameters_of
from .recording import Recording
from .starting_tops import StartingTop, starting_tops

_BODY = [FIT_QUANTITIES.index(name) for name in ("a", "b", "r0")]
_MOST_STARTS = 6
_COMPARABLE = 50.0
"""Starts, and then attempts, are not tried if they leave more than so many times the least."""
_FIRST_STEPS, _MOST_FINISHED = 15, 3
"""Steps from each start, and the attempts that are then brought to their ends."""
_CHANCE, _APART = 16.0, 2.0
"""Attempts explain a recording equally well if their chi^2 differ by less, over chi^2/dof; they are
of different tops if a number differs by more than so many standard deviations of both.
"""
_MUCH = 1.5
"""How many times the noise a good fit leaves at most."""


class Attempt(NamedTuple):
    """A fit of one recording."""

    problem: Problem
    solution: FittedParameters
    mirrored: bool
    """Whether psi is counted the other way."""
    noise: Mapping[str, float]
    """Noise by channel, in radians, estimated by a fit of plain harmonics."""
    rival: Mapping[str, float] | None = None
    """Another top that explains the recording as well: its quantities by name."""

    @property
    def recording(self) -> Recording:
        """The recording, with psi counted as the attempt has it."""
        return self.problem.recordings[0]

    @property
    def chi2(self) -> float:
        """The sum of the squares of the residuals, each over its standard deviation."""
        return self.solution.chi2

    @property
    def body(self) -> tuple[Array, Array]:
        """The values of a, b and r0, and their standard deviations."""
        values, covariance = self.solution.quantities(0)
        return values[_BODY], np.sqrt(np.diag(covariance))[_BODY]

    def differs(self, other: Attempt) -> bool:
        """Return whether a, b or r0 differ from another one's by more than their uncertainties."""
        (ours, our_spread), (theirs, their_spread) = self.body, other.body
        return bool(np.any(np.abs(ours - theirs) > _APART * (our_spread + their_spread)))

    def explains(self) -> bool:
        """Return whether no residual exceeds what harmonics leave of its channel, but by chance."""
        left = self.solution.residuals[0]
        return all(
            np.isfinite(left[channel]).any()
            and float(np.sqrt(np.nanmean(left[channel] ** 2))) < _MUCH * noise
            for channel, noise in self.noise.items()
        )

    def continued(self, values: Array) -> Attempt:
        """Return where the least squares lead to from some parameters."""
        return self._replace(solution=self.problem.solve(values))


def best_attempt(
    recording: Recording, known: Mapping[str, float], stds: Mapping[str, float], where: str
) -> Attempt:
    """Return the best fit of one recording, from the starts that may lead to it.

    Raises LagtopError, DataError for a recording that cannot be fitted.
    """
    parameters = parameters_of(known, stds, [recording])
    _check(recording, parameters, where)
    ways = _ways(recording, known, where)
    found: list[Attempt] = []
    for wide in (False, True):
        cases = _cases(ways, known, wide=wide)
        begun = [made for case in cases if (made := _begun(*case, parameters)) is not None]
        found += _finished(begun)
        if found and _least(found).explains():
            break
    if not found:
        raise DataError(f"{where}: no motion of a top matches the recording")
    return _told_apart([*map(_slowed, found)])


def _check(recording: Recording, parameters: Parameters, where: str) -> None:
    """Raise DataError for too few numbers, LagtopError for angles that do not determine a top."""
    known = parameters.known
    count = sum(int(np.isfinite(recording.angles[x]).sum()) for x in recording.angles)
    if count <= len(parameters.names):
        raise DataError(
            f"{where} must have more numbers than there are unknowns, got {count} for "
            f"{len(parameters.names)}"
        )
    seen = recording.angles.keys()
    if seen == {"theta"} and "psidot0" not in known:
        raise LagtopError(
            f"{where} has neither psi nor phi, and theta alone does not determine b: fix psidot0 "
            "(0 for a top that is let go in the first row)"
        )
    if seen == {"psi"} and "theta0" not in known:
        raise LagtopError(
            f"{where} has neither theta nor phi, and psi alone does not determine the tilt: fix "
            "theta0, the tilt in the first row"
        )


class _Way(NamedTuple):
    """A recording with psi counted one way or the other, and what it then shows."""

    recording: Recording
    mirrored: bool
    shown: Shown | Turns


def _ways(recording: Recording, known: Mapping[str, float], where: str) -> list[_Way]:
    """Return a recording, and if its spin determines the sense of psi its mirror image too."""
    spins = recording.kind == "angles" and "psi" in recording.angles
    both = spins and ("phi" in recording.angles or "r0" in known)
    ways = [(recording, False), (recording.mirrored, True)][: 1 + both]
    look = shown_by if "theta" in recording.angles else turns_in
    return [_Way(one, mirrored, look(one, where)) for one, mirrored in ways]


def _cases(
    ways: Sequence[_Way], known: Mapping[str, float], *, wide: bool
) -> list[tuple[_Way, StartingTop]]:
    """Return the starts, the nearest first; the nearest of either way is among them."""
    first: list[tuple[_Way, StartingTop]] = []
    others: list[tuple[_Way, StartingTop]] = []
    for way in ways:
        cases = [
            (way, start)
            for start in starting_tops(way.recording, way.shown, known.get("theta0"), wide=wide)
            if "phi" in way.recording.angles
            or start.state[1] * known.get("r0", start.state[1]) >= 0
        ]
        first, others = first + cases[:1], others + cases[1:]
    nearest = min((start.misfit for _, start in first), default=0.0)
    others = [case for case in others if case[1].misfit <= _COMPARABLE * nearest]
    return first + sorted(others, key=lambda case: case[1].misfit)[: _MOST_STARTS - len(first)]


def _begun(way: _Way, start: StartingTop, parameters: Parameters) -> Attempt | None:
    """Return the result of some steps from one start, or None if they lead to no top."""
    noise = way.shown.noise
    problem = Problem([way.recording], [sigma_of(way.recording, noise)], parameters)
    a, b, theta, nutation, precession = start.state
    r0 = parameters.known.get("r0", b + start.excess)
    values = {
        **{"a": a, "b": b, "ratio": b / r0 if r0 else 1.0, "r0": r0},
        **{"theta0": theta, "thetadot0": nutation, "psidot0": precession},
        **{"psi_zero": start.psi_zero, "phi_zero": start.phi_zero},
        **{name: parameters.known[name] for name in parameters.stds},
    }
    try:
        first = np.array([values[name] for name, _ in parameters.names])
        solution = problem.solve(first, _FIRST_STEPS)
    except LagtopError:
        return None
    return Attempt(problem, solution, way.mirrored, noise)


def sigma_of(recording: Recording, noise: Mapping[str, float]) -> Mapping[str, Array]:
    """Return the standard deviations, or those of the noise if they are not known."""
    greatest = max(noise.values())
    return recording.sigma or {
        x: np.full(recording.t.size, max(noise.get(x, greatest), LEAST_SIGMA))
        for x in recording.channels
    }


def _finished(begun: Sequence[Attempt]) -> list[Attempt]:
    """Return the best attempts, each of another top and brought to its end."""
    found: list[Attempt] = []
    nearest = sorted(begun, key=lambda attempt: attempt.chi2)
    for one in nearest:
        if one.chi2 > _COMPARABLE * nearest[0].chi2 or len(found) == _MOST_FINISHED:
            break
        if all(one.differs(other) for other in found):
            found.append(one if one.solution.converged else one.continued(one.solution.values))
    return found


def _least(found: Sequence[Attempt]) -> Attempt:
    return min(found, key=lambda attempt: attempt.chi2)


def _slowed(found: Attempt) -> Attempt:
    """Return an attempt whose spin rate is the slowest that a rigid body can have.

    Rates that are whole turns per frame apart look alike.
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
    return other if other.chi2 < _MUCH * found.chi2 else found


def _told_apart(found: Sequence[Attempt]) -> Attempt:
    """Return the best attempt, with the best of those that explain the recording as well.

    A spin of more than half a turn per frame is left out if a slower one does as well.
    """
    best = _least(found)
    chance = _CHANCE * best.chi2 / max(best.solution.dof, 1)
    alike = [one for one in found if one.chi2 - best.chi2 <= chance]
    alike = [one for one in alike if not _is_fast(one)] or alike
    best = _least(alike)
    others = [one for one in alike if one.differs(best)]
    return best._replace(rival=_least(others).solution.named(0) if others else None)


def _is_fast(found: Attempt) -> bool:
    """Return whether a top spins by more than half a turn per frame."""
    if "phi" not in found.recording.angles:
        return False
    return abs(float(found.body[0][2])) * frame_of(found.recording.t) > math.pi
