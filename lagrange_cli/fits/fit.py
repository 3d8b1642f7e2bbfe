"""The fit: the top behind a recording, or behind several recordings of one body.

Each recording alone is fitted first: some steps from several starts, then convergence of the best.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from types import NoneType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.text import parse_number
from ..arithmetic.types import Array
from ..errors import DataError, LagtopError, check_type
from ..inputs.given import gather
from ..inputs.values import value_of
from .harmonics import frame_of, slowest_spin
from .least_squares import Fit, fitted_from, reweighted
from .nutation import NoNutationError, Shown, Turns, shown_by, turns_in
from .parameters import FIT_QUANTITIES, KnownInputs, known_inputs, parameters_of
from .record import Outcome
from .recording import Recording, recording_from
from .starting_tops import FitStart, starting_tops
from .steady import SteadyOutcome, steady_fit

_BODY = [FIT_QUANTITIES.index(name) for name in ("a", "b", "r0")]
_MOST_STARTS = 6
_COMPARABLE = 50.0
"""Starts and fits are dropped if their chi^2 exceeds the least by more than this factor."""
_FIRST_STEPS, _MOST_FINISHED = 15, 3
"""Steps from each start, and the number of fits that are then continued to convergence."""
_CHANCE, _APART = 16.0, 2.0
"""Differences that make fits distinct.  The first is of chi^2, over chi^2/dof: below it
they explain a recording equally well.  The second is in standard deviations: beyond it numbers
belong to different tops.
"""
_MUCH = 1.5
"""Largest residual of a good fit, over the noise."""


def fit_recordings(
    recordings: Sequence[Recording],
    known: KnownInputs,
    where: str = "data",
    *,
    radians: bool = False,
) -> list[Outcome]:
    """Fit one body to some recordings by least squares, and return the results of each.

    A single recording whose nutation is below its noise gets a steady precession.  Known inputs
    with a standard deviation are fitted too, with the known value as a prior.  Raises LagtopError,
    DataError for recordings that cannot be fitted.
    """
    with ARRAYS.working():
        try:
            found = _fitted(recordings, known, where)
        except NoNutationError:
            if len(recordings) > 1 or "psi" not in recordings[0].angles:
                raise
            found = steady_fit(recordings[0], known, where)
            return [SteadyOutcome(found, 0, radians=radians)]
    return [Outcome(found, i, radians=radians) for i in range(len(recordings))]


def _fitted(recordings: Sequence[Recording], known: KnownInputs, where: str) -> Fit:
    names = [f"{where}, {x.name}" if x.name else where for x in recordings]
    alone = [best_fit(x, known, name) for x, name in zip(recordings, names, strict=True)]
    if len(alone) > 1:
        return reweighted(fitted_from([fit.start for fit in alone], known))
    found = reweighted(alone[0])
    return found.problem.with_reach(found)


def fit(
    t: ArrayLike,
    *,
    theta: ArrayLike | None = None,
    phi: ArrayLike | None = None,
    psi: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    quaternion: ArrayLike | None = None,
    sigma: Mapping[str, float] | float | None = None,
    known: Mapping[str, Any] | None = None,
) -> Outcome:
    """Fit a top to a recording; the results are in `record()`.

    Times have the shape (n,), angles too (radians, within whole turns, NaN where missing).  Instead
    of angles, pass the axis in space, shape (n, 3), or the quaternion w, x, y, z from body to
    space, shape (n, 4).  `sigma` is a standard deviation in radians, or a mapping by channel; by
    default it is estimated from the residuals.  `known` are known inputs by key.  Texts such as
    `"0.070(5)"`, and numbers of uncertainties, are uncertain; units are converted to SI.  Raises
    LagtopError, DataError for a recording that cannot be fitted.

    >>> t = np.linspace(0, 2, 200)
    >>> noise = np.random.default_rng(2).normal(scale=1e-3, size=(3, 200))
    >>> theta, phi, psi = solve(Top()).angles(t) + noise
    >>> outcome = fit(t, theta=theta, phi=phi, psi=psi, known={"C": 17458})
    >>> outcome.verdict, outcome.failures(), outcome.warnings(), outcome.notes()
    ('good', [], [], [])
    >>> [(key, round(x, 1)) for key, x, *_ in outcome.numbers()][:3]
    [('a', 319.1), ('b', 22.4), ('r0', 50.0)]
    >>> outcome.undetermined(), round(outcome.inputs()["A"], -2), round(outcome.chi2_dof, 1)
    (['m, s and g are known only as m*s*g'], 39000.0, 1.0)
    >>> list(outcome.correlations())[0][:2], outcome.record()["dof"], list(outcome.angles(t))
    (('a', 'b'), 592, ['theta', 'phi', 'psi'])
    >>> figure, record = outcome.plot(), outcome.to_dict()
    """
    check_type("known", known, Mapping, NoneType)
    angles = {"theta": theta, "phi": phi, "psi": psi, "axis": axis, "quaternion": quaternion}
    recording = recording_from(t, **angles, sigma=sigma)
    given = gather({name: value_of(name, x, parse_number) for name, x in (known or {}).items()})
    return fit_recordings([recording], known_inputs(given.inputs, given.stds))[0]


def best_fit(recording: Recording, known: KnownInputs, where: str) -> Fit:
    """Return the best fit of one recording, from several starts.

    Raises LagtopError, DataError for a recording that cannot be fitted.
    """
    _check(recording, known, len(parameters_of(known, [recording]).names), where)
    ways = _ways(recording, known, where)
    found: list[Fit] = []
    for wide in (False, True):
        begun = [_begun(start, known) for start in _starts(ways, known, wide=wide)]
        found += _finished([fit for fit in begun if fit is not None])
        if found and _is_noise(min(found, key=_chi2)):
            break
    if not found:
        raise DataError(f"{where}: no motion of a top matches the recording")
    return _told_apart([*map(_slowed, found)])


def _check(recording: Recording, known: KnownInputs, unknowns: int, where: str) -> None:
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


def _ways(
    recording: Recording, known: KnownInputs, where: str
) -> list[tuple[Recording, Shown | Turns]]:
    """Return a recording, and its mirror image too if its spin determines the direction of psi.

    Each of them has the nutation that it shows.
    """
    spins = recording.kind == "angles" and "psi" in recording.angles
    both = spins and ("phi" in recording.angles or "r0" in known)
    look = shown_by if "theta" in recording.angles else turns_in
    return [(one, look(one, where)) for one in [recording, recording.mirrored][: 1 + both]]


def _starts(
    ways: Iterable[tuple[Recording, Shown | Turns]], known: KnownInputs, *, wide: bool
) -> list[FitStart]:
    """Return the starts, the nearest first, with the nearest one for each direction of psi."""
    first: list[tuple[float, FitStart]] = []
    others: list[tuple[float, FitStart]] = []
    for recording, shown in ways:
        found = starting_tops(recording, shown, known.get("theta0"), wide=wide)
        if "phi" not in recording.angles and "r0" in known:  # r0 has the sign of b
            found = [x for x in found if x[1].values["b"] * known["r0"] >= 0]
        first, others = first + found[:1], others + found[1:]
    most = _COMPARABLE * min((misfit for misfit, _ in first), default=0.0)
    nearest = sorted((x for x in others if x[0] <= most), key=lambda x: x[0])
    return [start for _, start in first + nearest[: _MOST_STARTS - len(first)]]


def _begun(start: FitStart, known: KnownInputs) -> Fit | None:
    """Return the result of some steps from one start, or None if they leave the valid tops."""
    values = start.values | {"r0": known.get("r0", start.values["r0"])}
    try:
        return fitted_from([start._replace(values=values)], known, steps=_FIRST_STEPS)
    except LagtopError:
        return None


def _finished(begun: Sequence[Fit]) -> list[Fit]:
    """Return the best fits at convergence, each of a different top."""
    found: list[Fit] = []
    nearest = sorted(begun, key=_chi2)
    for fit in nearest:
        if fit.chi2 > _COMPARABLE * nearest[0].chi2 or len(found) == _MOST_FINISHED:
            break
        if all(_differ(fit, other) for other in found):
            found.append(fit if fit.converged else fit.continued(fit.values))
    return found


def _chi2(fit: Fit) -> float:
    return fit.chi2


def _body(fit: Fit) -> tuple[Array, Array]:
    """Return the values of a, b and r0 of one recording, and their standard deviations."""
    values, covariance = fit.quantities(0)
    return values[_BODY], np.sqrt(np.diag(covariance))[_BODY]


def _differ(one: Fit, other: Fit) -> bool:
    """Return whether a, b or r0 of two fits differ by more than their uncertainties."""
    (ours, our_spread), (theirs, their_spread) = _body(one), _body(other)
    return bool(np.any(np.abs(ours - theirs) > _APART * (our_spread + their_spread)))


def _is_noise(fit: Fit) -> bool:
    """Return whether all residuals are, within chance, as small as those of harmonics."""
    return all(
        np.isfinite(left := fit.residuals[0][channel]).any()
        and float(np.sqrt(np.nanmean(left**2))) < _MUCH * noise
        for channel, noise in fit.noise[0].items()
    )


def _slowed(fit: Fit) -> Fit:
    """Return a fit with the slowest spin rate that a rigid body can have.

    Rates that differ by whole turns per frame look alike.
    """
    (recording,), parameters = fit.recordings, fit.parameters
    if "phi" not in recording.angles or ("r0", 0) not in parameters.names or parameters.tied:
        return fit
    (_, b, r0), (_, spread, _) = _body(fit)
    frame = frame_of(recording.t[np.isfinite(recording.angles["phi"])])
    slowest = slowest_spin(float(r0), float(b), float(spread), frame)
    if slowest == r0:
        return fit
    values = fit.values.copy()
    values[parameters.names.index(("r0", 0))] = slowest
    other = fit.continued(values)
    return other if other.chi2 < _MUCH * fit.chi2 else fit


def _told_apart(found: Sequence[Fit]) -> Fit:
    """Return the best fit, with the best rival that explains the recording equally well.

    A spin of more than half a turn per frame is dropped if a slower one fits equally well.
    """
    best = min(found, key=_chi2)
    chance = _CHANCE * best.chi2 / max(best.dof, 1)
    alike = [fit for fit in found if fit.chi2 - best.chi2 <= chance]
    alike = [fit for fit in alike if not _is_fast(fit)] or alike
    best = min(alike, key=_chi2)
    rival = min((fit for fit in alike if _differ(fit, best)), key=_chi2, default=None)
    return best._replace(rival=None if rival is None else rival.start.values)


def _is_fast(fit: Fit) -> bool:
    """Return whether a top spins by more than half a turn per frame."""
    (recording,) = fit.recordings
    if "phi" not in recording.angles:
        return False
    return abs(float(_body(fit)[0][2])) * frame_of(recording.t) > math.pi
