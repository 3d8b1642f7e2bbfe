"""`fit` in Python: the top behind arrays of angles, of axes or of quaternions."""

from __future__ import annotations

from collections.abc import Mapping
from types import NoneType

import numpy as np
from numpy.typing import ArrayLike

from ..arithmetic.arrays import doubles_of
from ..arithmetic.types import Array
from ..errors import LagtopError, check_type
from ..inputs.names import ANGLES
from ..inputs.seen import Conventions
from .fit import fit_recordings
from .parameters import known_inputs
from .record import Outcome, outcomes
from .recording import Reading, Source, recording_of

_IN_RADIANS = Conventions("wxyz", radians=True)


def fit(
    t: ArrayLike,
    *,
    theta: ArrayLike | None = None,
    phi: ArrayLike | None = None,
    psi: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    quaternion: ArrayLike | None = None,
    sigma: Mapping[str, float] | float | None = None,
    known: Mapping[str, float] | None = None,
) -> Outcome:
    """Return the top whose motion leaves least of a recording; its numbers are in `record()`.

    Times have the shape (n,), angles too (radians, within whole turns, NaN where missing); instead
    of them the axis in space, shape (n, 3), or the quaternion w, x, y, z from body to space, shape
    (n, 4).  `sigma` are standard deviations in radians, one or by channel; without it they are
    those of what is left.  `known` are inputs by key: nothing else is taken for known.  Raises
    LagtopError, DataError for a recording that cannot be fitted.
    """
    check_type("known", known, Mapping, NoneType)
    times = _numbers("t", t, ())
    given = {"theta": theta, "phi": phi, "psi": psi, "axis": axis, "quaternion": quaternion}
    arrays = {
        name: _numbers(name, x, {"axis": (3,), "quaternion": (4,)}.get(name, ()))
        for name, x in given.items()
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
    recording = recording_of("", source, columns)
    return outcomes(fit_recordings([recording], known_inputs(known or {})))[0]


def _numbers(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return real numbers as an array of rows of this shape.  Raises LagtopError."""
    array = doubles_of(name, values)
    if array.shape[1:] != shape or array.ndim != 1 + len(shape):
        wanted = ", ".join(["n", *map(str, shape)])
        raise LagtopError(f"{name} must have the shape ({wanted}), got {array.shape}", name)
    return array


def _check_alone(arrays: Mapping[str, Array]) -> None:
    """Raise LagtopError unless there are angles only, or a single array of another quantity."""
    angles = sum(name in ANGLES for name in arrays)
    if len(arrays) != max(angles, 1):
        shown = ", ".join(arrays) or "nothing"
        raise LagtopError(f"fit takes angles, or an axis, or a quaternion, got {shown}")
