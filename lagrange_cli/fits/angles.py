"""Angles of many tops over time: as arrays if their errors are small enough, else one by one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import ARRAYS, BLOCK, blocks, workspace
from ..arithmetic.types import Array, Mask
from ..errors import LagtopError
from ..inputs.input_keys import EXAMPLE
from ..inputs.names import ANGLES
from ..inputs.top import Top
from ..motion.regime import Regime
from ..motion.solve import solve
from ..sweep.records import BLOCK_ROWS
from ..sweep.top_arrays import TopArrays, top_arrays
from .angle_arrays import (
    ArraySampler,
    PairMotions,
    array_sampler,
    moving_motions,
    released_motions,
)


def sweep_angles(t: Array, inputs: Mapping[str, Array]) -> tuple[Array, NDArray[np.object_]]:
    """Return theta, phi and psi (radians), shape (3, tops, times), and the errors of the tops.

    `t` is one row of times for all tops, or a row for each.
    """
    size = max(np.size(x) for x in inputs.values())
    tops = top_arrays(EXAMPLE | {"theta0_deg": np.nan} | dict(inputs), size)
    return angles_of_tops(tops, np.broadcast_to(t, (size, np.shape(t)[-1])), wrap=False)


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
