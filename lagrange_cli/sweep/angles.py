"""Angles of many tops over time: as arrays if their errors are small enough, else one by one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arithmetic.arrays import ARRAYS, BLOCK, blocks, doubles_of, workspace
from ..arithmetic.types import Array, Mask
from ..errors import LagtopError
from ..inputs.names import ANGLES
from ..inputs.top import Top
from ..motion.regime import Regime
from ..motion.solve import solve
from .angle_arrays import (
    ArraySampler,
    PairMotions,
    array_sampler,
    moving_motions,
    released_motions,
)
from .records import BLOCK_ROWS
from .results import ResultColumn, Results, Together
from .top_arrays import TopArrays


def sweep_angles(t: ArrayLike, *, wrap: bool = False, **inputs: ArrayLike) -> Results:
    """Return theta, phi and psi (radians) of many tops at the times t, and `error`.

    Inputs are as for `sweep`.  Pass one time or a list of n times for all tops, or an array of
    shape (*inputs, n).  Here `inputs` is the shape to which the inputs broadcast.  The angles have
    the shape (*inputs, n), and `error` has the shape of the inputs.  If a top has an `error`, its
    angles are NaN.  The angles are as exact as those of `Motion.angles`.  Raises LagtopError for an
    unknown input, or if shapes do not broadcast together.

    >>> sweep_angles([0.0, 0.1], r0=[50.0, 60.0], theta0_deg=30.0)["theta"].shape
    (2, 2)
    """
    together = Together(inputs)
    if together.stds:
        name = min(together.stds)
        raise LagtopError(f"{name} must be certain: the angles of sweeps have no stds", name)
    tops, shape = together.part(slice(None)), together.shape
    times = doubles_of("t", t)
    if times.ndim > 1 and times.shape[:-1] != shape:
        wanted = f"({', '.join(map(str, shape))}, n) or (n,)"
        raise LagtopError(f"t must have the shape {wanted}, got {times.shape}", "t")
    whole = times.shape if times.ndim > 1 else shape + times.shape
    count = whole[-1] if times.ndim else 1
    rows = times.reshape(-1, count) if count else np.empty((1, 0))
    rows = np.broadcast_to(rows, (tops.m.size, count))
    angles, error = angles_of_tops(tops, rows, wrap=wrap)
    found: dict[str, ResultColumn] = {
        name: values.reshape(whole) for name, values in zip(ANGLES, angles, strict=True)
    }
    return together.results(found | {"error": error.reshape(shape)}, times)


def angles_of_tops(tops: TopArrays, t: Array, *, wrap: bool) -> tuple[Array, NDArray[np.object_]]:
    """Return theta, phi and psi of each top at its row of times, and its error message or None."""
    angles = np.full((len(ANGLES), *t.shape), np.nan)
    error = np.full(tops.m.size, None)
    with ARRAYS.working():
        for first in range(0, tops.m.size, BLOCK_ROWS):
            some = slice(first, first + BLOCK_ROWS)
            _fill(tops.part(some), _Block(t[some], wrap, angles[:, some]), error[some])
    return angles, error


class _Block(NamedTuple):
    """The times of a block of tops, a row each, and the arrays for their angles."""

    t: Array
    wrap: bool
    angles: Array


def _fill(tops: TopArrays, block: _Block, error: NDArray[np.object_]) -> None:
    """Write the angles of a block of tops, and their error messages."""
    left = np.ones(tops.m.size, dtype=np.bool_)
    at_rest = tops.regimes().get(Regime.REGULAR, ~left)
    for make, chosen in ((released_motions, at_rest), (moving_motions, tops.moving())):
        index = np.flatnonzero(chosen)
        if index.size:
            trusted = _fill_arrays(make(tops.part(index)), index, block)
            left[index[trusted]] = False
    for row in np.flatnonzero(left).tolist():
        try:
            motion = solve(Top(**tops.one(row)))
            block.angles[:, row] = motion.angles(block.t[row], wrap=block.wrap)
        except LagtopError as refused:
            error[row] = str(refused)


def _fill_arrays(motions: PairMotions, index: NDArray[np.intp], block: _Block) -> Mask:
    """Write the angles of motions that can be trusted; return which motions these are."""
    farthest = np.abs(block.t[index]).max(axis=1, initial=0.0)
    trusted: Mask = farthest <= motions.reach()
    for hyperbolic in (False, True):
        some = np.flatnonzero(trusted & (motions.hyperbolic() == hyperbolic))
        if some.size:
            sampler = array_sampler(motions.part(some), hyperbolic=hyperbolic)
            _sample(sampler, index[some], block)
    return trusted


def _sample(sampler: ArraySampler, index: NDArray[np.intp], block: _Block) -> None:
    """Write the angles of the tops of a sampler, a block of samples at a time."""
    count, farthest = block.t.shape[1], float(np.abs(block.t[index]).max(initial=0.0))
    step = max(1, BLOCK // max(count, 1))
    for first in range(0, index.size, step):
        rows, part = index[first : first + step], sampler.part(slice(first, first + step))
        for columns in blocks(count):
            times = block.t[rows, columns]
            with workspace(*times.shape) as space:
                at = part.attitude(times, farthest, space)
                block.angles[0, rows, columns] = at.theta()
                block.angles[1, rows, columns] = at.phi(wrap=block.wrap)
                block.angles[2, rows, columns] = at.psi(wrap=block.wrap)
