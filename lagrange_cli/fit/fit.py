"""`fit`: the top behind a recording, by least squares from the best of many starts.

The starts are closed-form tops with the nutation of the recording.  Their residuals at some rows
select a few, from which the least squares converge.  If no nutation is visible, or none is
determined, a steady precession is fitted.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from operator import itemgetter
from types import NoneType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.text import parse_number
from ..arithmetic.types import Array
from ..errors import DataError, LagtopError, check_type
from ..inputs.given import gather
from ..inputs.values import value_of
from .motions import STATE
from .nutation import Minimum, Problem, nutating_outcome
from .outcome import CHANCE, GOOD, Outcome, chi2_bounds
from .recording import Known, Recording, known_inputs, recording_from, turned_up
from .starts import noise_of, oscillation_in, signals_in, starts
from .steady import steady_outcome

_FEW_ROWS, _ROWS, _MANY_ROWS = 12, 50, 300
"""Rows at which all starts are compared, then the best, and rows of the first steps."""
_KEPT, _BLOCK = 1500, 2000
_STARTS, _FIRST_STEPS, _FINISHED = 20, 12, 3
"""Starts of the least squares, their first steps, and the number of those that converge."""
_ALIKE = 0.02
"""Relative difference of a and b below which two starts are the same."""
_COMPARABLE, _LIKELY = 50.0, 16.0
"""Factor of chi^2 above the least one, beyond which a start is dropped, and the difference of
-2 log(likelihood) below which two tops explain a recording equally well."""
_WINDOWS = (8, 12, 20, 32, 48)
"""Numbers of windows to suggest if the spin may decay."""
_ROWS_PER_WINDOW, _PERIODS_PER_WINDOW = 24, 1.5


def best_fit(
    recording: Recording,
    known: Known,
    *,
    radians: bool = False,
    chance: float = CHANCE,
    helpful: bool = True,
) -> Outcome:
    """Return the fit of one recording.

    If spin and precession are recorded, psi may count in the other direction.  `chance` is the
    probability that noise fails a test.  A `helpful` fit that fails says what to try.  Raises
    LagtopError, DataError for a recording that cannot be fitted.
    """
    for alone, needed in (("theta", "psidot0"), ("psi", "theta0")):
        if recording.angles.keys() == {alone} and needed not in known:
            flag = f"--{needed}" + (" 0 if the top is released from rest" * (alone == "theta"))
            raise DataError(f"{alone} alone does not determine a top: give {flag}")
    frequency, visible = oscillation_in(signals_in(recording))
    lasts = frequency * recording.t[-1] >= 1
    outcome = None
    if visible and lasts:
        outcome = _nutation(recording, known, frequency, radians=radians)
    outcome = outcome or steady_outcome(recording, known, oscillates=visible, radians=radians)
    outcome.chance = chance
    low = chi2_bounds(outcome.dof)[0]
    if outcome.chi2_dof is not None and outcome.chi2_dof < low:
        shown = f"{outcome.chi2_dof:.3g} is below {low:.3g}"
        outcome.notes.append(f"chi2/dof = {shown}: the noise is below sigma")
    if helpful and outcome.failures():
        near = all(rest.rms < 1 for rest in outcome.residuals.values())
        if visible and not lasts and near:
            outcome.hints.append("a recording must last for a period of the nutation")
        outcome.hints += _hints(recording, known, frequency)
    return outcome


def _nutation(
    recording: Recording, known: Known, frequency: float, *, radians: bool
) -> Outcome | None:
    """Return the best fit of a nutation, with its rival if it has one; None without a start."""
    both = recording.kind == "angles" and {"psi", "phi"} <= recording.angles.keys()
    begun = []
    for problem, x in _best_starts([recording, recording.mirrored][: 1 + both], known, frequency):
        begun.append((problem, problem.thinned(_MANY_ROWS).solve(x, _FIRST_STEPS)))
    distinct: list[tuple[Problem, Any]] = []
    for problem, end in sorted(begun, key=lambda pair: pair[1].cost):
        is_new = all(p is not problem or abs(e.cost / end.cost - 1) > 1e-6 for p, e in distinct)
        near = not distinct or end.cost <= _COMPARABLE * distinct[0][1].cost
        if is_new and near and len(distinct) < _FINISHED:
            distinct.append((problem, end))
    if not distinct:
        return None
    best, *found = sorted((Minimum.of(p, e.x) for p, e in distinct), key=lambda x: x.badness)
    rivals = [x for x in found if x.badness < best.badness + _LIKELY and x.differs(best)]
    return nutating_outcome(best, rivals[0] if rivals else None, frequency, radians=radians)


def _best_starts(
    ways: Sequence[Recording], known: Known, frequency: float
) -> list[tuple[Problem, Array]]:
    """Return the best starts that differ; in each way psi is counted in one direction."""
    tried = [
        (score, problem, x) for way in ways for problem, x, score in _scored(way, known, frequency)
    ]
    kept: list[tuple[Problem, Array]] = []
    for score, problem, x in sorted(tried, key=itemgetter(0)):
        near = _ALIKE * (np.abs(x[:2]) + 1e-300)
        is_new = all(p is not problem or np.any(np.abs(x - y)[:2] > near) for p, y in kept)
        if is_new and len(kept) < _STARTS and math.isfinite(score):
            kept.append((problem, x))
    return kept


def _scored(
    recording: Recording, known: Known, frequency: float
) -> Iterator[tuple[Problem, Array, float]]:
    """Yield the starts of a recording, scored by the logarithm of the noise that they leave."""
    signals = signals_in(recording)
    noise = noise_of(signals, frequency, recording)
    problem = Problem(recording, known, recording.sigma or noise)
    states = starts(signals, frequency, known.get("theta0"))
    for name in known.keys() & {*STATE}:
        states[:, STATE.index(name)] = known[name]
    if "r0" in known or problem.is_even:  # r0 has the sign of b
        states = states[states[:, STATE.index("b")] * known.get("r0", 1.0) >= 0]
    for count in (_FEW_ROWS, _ROWS) if len(states) > _KEPT else (_ROWS,):
        few = problem.thinned(count)
        sizes = np.array([*few.sigma.values()])
        tried, scores = [np.zeros((0, len(problem.names)))], [np.zeros(0)]
        for block in np.array_split(states, len(states) // _BLOCK + 1):
            x = few.parameters_of(block, signals.get("phi"))
            mean = np.nanmean(few.residuals(x) ** 2, axis=2) + sizes**2
            tried.append(x)
            scores.append(np.nan_to_num(np.log(mean).sum(axis=1), nan=np.inf))
        score = np.concatenate(scores)
        order = np.argsort(score)[:_KEPT]
        states = states[order]
    for x, size in zip(np.concatenate(tried)[order], score[order].tolist(), strict=True):
        yield problem, x, size


def _hints(recording: Recording, known: Known, frequency: float) -> list[str]:
    """Return what to try after a failed fit, if another fit confirms it."""
    for axis in ("y", "x") if recording.kind != "angles" else ():
        if best_fit(turned_up(recording, axis), known, helpful=False).verdict == GOOD:
            return [f"the {axis} axis of the data points up: use --align up={axis}"]
    both = recording.kind == "angles" and {"phi", "psi"} <= recording.angles.keys()
    if both and best_fit(recording.exchanged, known, helpful=False).verdict == GOOD:
        return ["phi and psi are exchanged: here phi is the spin and psi the precession"]
    body = known.only({"m", "g", "s", "A", "C"})
    for count in _WINDOWS:
        enough = count * _ROWS_PER_WINDOW < recording.t.size
        if not enough or frequency * recording.t[-1] < count * _PERIODS_PER_WINDOW:
            break
        parts = recording.windows(count)
        some = (parts[0], parts[count // 2], parts[-1])
        chance = CHANCE / count
        if all(best_fit(x, body, chance=chance, helpful=False).verdict == GOOD for x in some):
            return [
                f"one top does not explain the motion: the spin may decay, try --window {count}"
            ]
    return ["check columns, units and axes, or try --window if the spin may decay"]


def fit_windows(
    recording: Recording, count: int, known: Known, *, radians: bool = False
) -> list[Outcome]:
    """Return the fits of equal windows of a recording.

    Raises LagtopError for a bad number of windows, or for a known input of one instant.
    """
    for name in known.keys() & {"r0", "theta0", "thetadot0", "psidot0"}:
        raise LagtopError(f"{name} is not the same in all windows: leave it out", name)
    return [
        best_fit(part, known, radians=radians, chance=CHANCE / count, helpful=False)
        for part in recording.windows(count)
    ]


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
    >>> outcome.verdict, outcome.failures()
    ('good', [])
    >>> [(key, round(x, 1)) for key, (x, std) in outcome.numbers.items()][:3]
    [('a', 319.1), ('b', 22.4), ('r0', 50.0)]
    >>> round(outcome.numbers["A"][0], -2), outcome.record()["dof"]
    (39000.0, 592)
    """
    check_type("known", known, Mapping, NoneType)
    recording = recording_from(
        t, sigma=sigma, theta=theta, phi=phi, psi=psi, axis=axis, quaternion=quaternion
    )
    given = {name: value_of(name, x, parse_number) for name, x in (known or {}).items()}
    found = gather(given)
    return best_fit(recording, known_inputs(found.inputs, found.stds))
