"""The fit: the top behind a recording, or behind several recordings of one body."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType, NoneType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import ARRAYS, doubles_of
from ..arithmetic.types import Array
from ..errors import LagtopError, check_type
from ..inputs.given import gather
from ..inputs.names import ANGLES
from ..inputs.seen import Conventions
from ..inputs.value import Value, parse_value, value_of
from .attempts import best_attempt, sigma_of
from .least_squares import LEAST_SIGMA, FittedParameters, Problem
from .nutation import NoNutationError
from .parameters import Parameters, known_inputs, parameters_of
from .record import Fit, Outcome
from .recording import Reading, Recording, Source, recording_of
from .steady import SteadyOutcome, steady_fit

_IN_RADIANS = Conventions("wxyz", radians=True)
_STEADY, _REWEIGHTINGS = 0.01, 6
"""Tolerance of chi^2/dof around 1, and largest number of rounds, when standard deviations are taken
from the residuals.
"""


def fit_recordings(
    recordings: Sequence[Recording],
    known: Mapping[str, float],
    where: str = "data",
    *,
    stds: Mapping[str, float] = MappingProxyType({}),
    radians: bool = False,
) -> list[Outcome]:
    """Fit one body to some recordings by least squares, and return the results of each.

    A single recording whose nutation is below its noise gets a steady precession.  `known` are
    inputs by key, theta0 in radians, and `stds` the standard deviations of some of them.  Inputs
    with a standard deviation are fitted too, with the known value as a prior.  Raises LagtopError,
    DataError for recordings that cannot be fitted.
    """
    with ARRAYS.working():
        try:
            found = _fitted(recordings, known, stds, where)
        except NoNutationError:
            if len(recordings) > 1 or "psi" not in recordings[0].angles:
                raise
            found = steady_fit(recordings[0], known, stds, where)
            return [SteadyOutcome(found, 0, radians=radians)]
    return [Outcome(found, i, radians=radians) for i in range(len(recordings))]


def _fitted(
    recordings: Sequence[Recording],
    known: Mapping[str, float],
    stds: Mapping[str, float],
    where: str,
) -> Fit:
    names = [f"{where}, {x.name}" if x.name else where for x in recordings]
    alone = [best_attempt(x, known, stds, name) for x, name in zip(recordings, names, strict=True)]
    noise, recordings = [one.noise for one in alone], [one.recording for one in alone]
    problem, solution, rival = alone[0].problem, alone[0].solution, alone[0].rival
    if len(alone) > 1:
        sigma = [*map(sigma_of, recordings, noise)]
        together = parameters_of(known, stds, recordings)
        problem, rival = Problem(recordings, sigma, together), None
        solution = problem.solve(joined(together, [one.solution.named(0) for one in alone]))
    sigma_known = bool(recordings[0].sigma)
    if not sigma_known:
        problem, solution = reweighted(problem, solution)
    if len(alone) == 1:
        solution = problem.with_reach(solution)
    return Fit(recordings, solution, sigma_known, [one.mirrored for one in alone], noise, rival)


def reweighted(problem: Problem, solution: FittedParameters) -> tuple[Problem, FittedParameters]:
    """Return a problem with standard deviations taken from its residuals, and its solution."""
    for _ in range(_REWEIGHTINGS):
        problem = Problem(problem.recordings, sigma_left(solution), problem.parameters)
        solution = problem.solve(solution.values)
        if abs(solution.chi2 / max(solution.dof, 1) - 1) < _STEADY:
            break
    return problem, solution


def sigma_left(solution: FittedParameters) -> list[dict[str, Array]]:
    """Return the standard deviations of residuals by recording, common to all recordings."""
    rest = solution.residuals
    count = sum(int(np.isfinite(values).sum()) for one in rest for values in one.values())
    share = count / max(solution.dof, 1)
    sigma: dict[str, float] = {}
    for channel in {channel: None for one in rest for channel in one}:
        joined = np.concatenate([one[channel] for one in rest if channel in one])
        sigma[channel] = max(float(np.sqrt(np.nanmean(joined**2) * share)), LEAST_SIGMA)
    return [{name: np.full(x.size, sigma[name]) for name, x in one.items()} for one in rest]


def joined(together: Parameters, alone: Sequence[Mapping[str, float]]) -> Array:
    """Return the start of a fit of several recordings, from the quantities of each."""
    found = [
        {
            **one,
            "ratio": one["b"] / one["r0"] if one["r0"] else 1.0,
            **{name: together.known[name] for name in together.stds},
        }
        for one in alone
    ]
    values = [
        np.median([one[name] for j, one in enumerate(found) if i in {-1, j}])
        for name, i in together.names
    ]
    return np.array(values)


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
    given = gather({name: _value(name, x) for name, x in (known or {}).items()})
    inputs, stds = known_inputs(given.inputs, given.stds)
    return fit_recordings([recording], inputs, stds=stds)[0]


def recording_from(
    t: ArrayLike,
    *,
    sigma: Mapping[str, float] | float | None = None,
    **angles: ArrayLike | None,
) -> Recording:
    """Return the recording in the arguments of `fit`.  Raises LagtopError, DataError."""
    times = _numbers("t", t, ())
    arrays = {
        name: _numbers(name, x, {"axis": (3,), "quaternion": (4,)}.get(name, ()))
        for name, x in angles.items()
        if x is not None
    }
    for name, x in arrays.items():
        if len(x) != times.size:
            raise LagtopError(f"{name} must have {times.size} rows as t has, got {len(x)}", name)
    if not np.isfinite(times).all():
        raise LagtopError("t must be finite numbers", "t")
    if (back := np.flatnonzero(np.diff(times) < 0)).size:
        before, after = times[back[0] : back[0] + 2].tolist()
        raise LagtopError(f"t must not turn back, got {after} after {before}", "t")
    _check_alone(arrays)
    rows = {"t": times, **arrays}
    columns = {name: x if x.ndim > 1 else x[:, np.newaxis] for name, x in rows.items()}
    source = Source("the recording", Reading(conventions=_IN_RADIANS, sigma=sigma), {}, {})
    return recording_of("", source, columns)


def _value(name: str, given: Any) -> Value:
    """Return a known input as a value.  Raises LagtopError."""
    if not isinstance(given, str):
        return value_of(name, given)
    try:
        return parse_value(given, uncertain=True)
    except LagtopError as error:
        raise LagtopError(f"{name} {error}", name) from None


def _numbers(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return real numbers as an array of rows of this shape.  Raises LagtopError."""
    array = doubles_of(name, values)
    if array.shape[1:] != shape or array.ndim != 1 + len(shape):
        wanted = ", ".join(["n", *map(str, shape)])
        raise LagtopError(f"{name} must have the shape ({wanted}), got {array.shape}", name)
    return array


def _check_alone(arrays: Mapping[str, Array]) -> None:
    """Raise LagtopError unless the arrays are angles only, or a single other quantity."""
    angles = sum(name in ANGLES for name in arrays)
    if len(arrays) != max(angles, 1):
        shown = ", ".join(arrays) or "nothing"
        raise LagtopError(f"fit takes angles, or an axis, or a quaternion, got {shown}")
