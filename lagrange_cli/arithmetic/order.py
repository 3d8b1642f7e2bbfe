"""Arrays in the order of a parity: first the elements at even numbers, then those at odd ones."""

from __future__ import annotations

from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from .types import Array

Order = NDArray[np.intp] | list[slice]
"""Where the elements are, one by one or in runs."""
_RUN = 250
"""Elements in a row, on average, from which on it costs less to copy the runs as wholes."""


def order_by_parity(whole: Array) -> tuple[int, Order | None]:
    """Return how many whole numbers are even, and their order; None if all have one parity."""
    ends = np.flatnonzero(whole[1:] != whole[:-1]) + 1
    if ends.size * _RUN > whole.size:
        half = 0.5 * whole
        odd = half != np.rint(half)
        even = np.flatnonzero(~odd)
        return even.size, np.concatenate([even, np.flatnonzero(odd)])
    runs: list[list[slice]] = [[], []]
    for start, stop in pairwise([0, *ends.tolist(), whole.size]):
        if start < stop:
            runs[int(whole[start]) % 2].append(slice(start, stop))
    return sum(run.stop - run.start for run in runs[0]), runs[0] + runs[1] if all(runs) else None


def taken(values: Array, order: Order, out: Array) -> Array:
    """Write values in the order."""
    if isinstance(order, list):
        return np.concatenate([values[run] for run in order], out=out)
    return np.take(values, order, out=out, mode="clip")  # all are in range


def placed(values: Array, order: Order, out: Array) -> Array:
    """Write values that are in the order to their places."""
    if isinstance(order, list):
        ends = accumulate((run.stop - run.start for run in order), initial=0)
        for run, (start, stop) in zip(order, pairwise(ends), strict=True):
            out[run] = values[start:stop]
    else:
        out[order] = values
    return out
