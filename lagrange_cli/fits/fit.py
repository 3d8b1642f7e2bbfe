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
from ..inputs.library_values import value_of
from ..inputs.names import ANGLES
from ..inputs.seen import Conventions
from ..inputs.value import Value, parse_value
from .attempts import best_attempt
from .least_squares import fitted_from, reweighted
from .nutation import NoNutationError
from .parameters import known_inputs
from .record import Fit, Outcome
from .recording import Reading, Recording, Source, recording_of
from .steady import SteadyOutcome, steady_fit

_IN_RADIANS = Conventions("wxyz", radians=True)


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
    if len(alone) > 1:
        starts = [one.solution.named(0) for one in alone]
        _, solution = reweighted(*fitted_from(starts, recordings, noise, known, stds))
        return Fit(recordings, solution, noise)
    problem, solution = reweighted(alone[0].problem, alone[0].solution)
    return Fit(recordings, problem.with_reach(solution), noise, alone[0].rival)


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
    if len(arrays) != max(sum(name in ANGLES for name in arrays), 1):
        shown = ", ".join(arrays) or "nothing"
        raise LagtopError(f"fit takes angles, or an axis, or a quaternion, got {shown}")
    rows = {"t": times, **arrays}
    columns = {name: x if x.ndim > 1 else x[:, np.newaxis] for name, x in rows.items()}
    source = Source("the recording", Reading(conventions=_IN_RADIANS, sigma=sigma), {}, {})
    return recording_of("", source, columns)


def _numbers(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return real numbers as an array of rows of this shape.  Raises LagtopError."""
    array = doubles_of(name, values)
    if array.shape[1:] != shape or array.ndim != 1 + len(shape):
        wanted = ", ".join(["n", *map(str, shape)])
        raise LagtopError(f"{name} must have the shape ({wanted}), got {array.shape}", name)
    return array


def _value(name: str, given: Any) -> Value:
    """Return a known input as a value.  Raises LagtopError."""
    if not isinstance(given, str):
        return value_of(name, given)
    try:
        return parse_value(given, uncertain=True)
    except LagtopError as error:
        raise LagtopError(f"{name} {error}", name) from None
