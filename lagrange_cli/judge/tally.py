"""What is kept of the deviations of a trajectory while its rows pass by, in flat memory."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..inputs.seen import rows_of

MOST_KEPT = 4096
_SURE = 2.0
"""Radians that a deviation may change by from row to row; beyond, it may as well be a turn less."""


class Extremes:
    """The greatest size of a deviation, and the last."""

    def __init__(self) -> None:
        self.greatest = self.last = math.nan

    def add(self, values: Array) -> None:
        """Take the deviations of some rows; NaN stands for none."""
        known = abs(values[np.isfinite(values)])
        if known.size:
            self.greatest = float(np.fmax(self.greatest, known.max()))
            self.last = float(known[-1])


class FittedLine(NamedTuple):
    """A straight line through the deviations of an angle."""

    slope: float
    """Growth per unit of time."""
    rest: float
    """Root mean square of what is left."""


class LineFit:
    """A straight line through an angle's deviations, unwrapped, by least squares."""

    def __init__(self) -> None:
        self.count, self.last, self.turns_are_sure = 0, 0.0, True
        self.t = self.x = self.tt = self.tx = self.xx = 0.0

    def add(self, t: Array, wrapped: Array) -> None:
        """Take deviations in (-pi, pi]: each is the one nearest to that of the row before."""
        known = np.isfinite(wrapped)
        if not known.any():
            return
        t, x = t[known], np.unwrap(np.concatenate([[self.last], wrapped[known]]))
        steps = np.diff(x)[self.count == 0 :]  # the first row has none before it
        self.turns_are_sure &= not np.any(np.abs(steps) > _SURE)
        x = x[1:]
        self.last = float(x[-1])
        self._merge(len(t), float(t.mean()), float(x.mean()), t - t.mean(), x - x.mean())

    def _merge(self, n: int, t: float, x: float, around_t: Array, around_x: Array) -> None:
        """Add a block to the moments about the means (Chan, Golub and LeVeque 1979)."""
        whole = self.count + n
        step_t, step_x, share = t - self.t, x - self.x, self.count * n / whole
        self.tt += float((around_t * around_t).sum()) + step_t * step_t * share
        self.tx += float((around_t * around_x).sum()) + step_t * step_x * share
        self.xx += float((around_x * around_x).sum()) + step_x * step_x * share
        self.t += step_t * n / whole
        self.x += step_x * n / whole
        self.count = whole

    def line(self) -> FittedLine | None:
        """Return the line, or None for less than three rows or if whole turns are not sure."""
        if self.count < 3 or not self.turns_are_sure:
            return None
        slope = self.tx / self.tt
        return FittedLine(slope, math.sqrt(max(self.xx - slope * self.tx, 0.0) / self.count))


class Passages:
    """The first times at which a deviation passes some sizes."""

    def __init__(self, sizes: tuple[float, ...]) -> None:
        self.times: dict[float, float | None] = dict.fromkeys(sizes)

    def add(self, t: Array, values: Array) -> None:
        """Take the deviations of some rows."""
        for size, time in self.times.items():
            if time is None and (beyond := np.flatnonzero(values > size)).size:
                self.times[size] = float(t[beyond[0]])


class Kept:
    """Rows spread evenly over a trajectory of unknown length, MOST_KEPT at most."""

    def __init__(self) -> None:
        self.stride, self.seen, self.size = 1, 0, 0
        self._parts: list[dict[str, Array]] = []

    def add(self, rows: Mapping[str, Array]) -> None:
        """Take some rows: arrays of the same length by name."""
        count = len(next(iter(rows.values())))
        start = -self.seen % self.stride
        if start < count:
            every = rows_of(rows, slice(start, None, self.stride))
            self._parts.append({key: values.copy() for key, values in every.items()})
            self.size += -(-(count - start) // self.stride)
        self.seen += count
        while self.size > MOST_KEPT:
            self.stride *= 2
            self._parts = [rows_of(self.rows(), slice(None, None, 2))]
            self.size = -(-self.size // 2)

    def rows(self) -> dict[str, Array]:
        """Return the rows that are kept."""
        return {key: np.concatenate([part[key] for part in self._parts]) for key in self._parts[0]}
