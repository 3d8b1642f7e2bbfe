"""Convergence of several trajectories of the same motion, computed with different steps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from .judgement import Judgement

LOST_PHASE = 0.3
"""Error in radians beyond which the phase is lost, and no order can be measured."""
ROUNDING = 1e-8
"""Error that need not fall any more."""
LEAST_ORDER = 0.5
"""Least order of a method that converges."""


class Convergence(NamedTuple):
    """The dependence of the error on the step."""

    order: float | None
    """Fitted exponent; None if there are fewer than two errors to fit."""
    falls: bool
    """Whether the error depends on the step, or is a rounding error."""
    until: float
    """Time up to which the errors were compared, at which the first trajectory loses the phase."""
    errors: Sequence[float]
    """Greatest error of each trajectory up to that time."""


def check_step_sizes(step_sizes: Sequence[float], count: int) -> None:
    """Raise LagtopError for steps that are not positive, or not one per trajectory."""
    if len(step_sizes) != count:
        raise LagtopError(
            f"step_sizes must have one number per trajectory ({count}), got {len(step_sizes)}",
            "step_sizes",
        )
    for step in step_sizes:
        if not step > 0:
            raise LagtopError(f"step_sizes must be > 0, got {step}", "step_sizes")


def convergence(judgements: Sequence[Judgement]) -> Convergence | None:
    """Return how the errors of trajectories fall with their steps, or None for fewer than two.

    The order is fitted to the greatest errors up to the time at which the first one exceeds 0.3
    rad.  Steps finer than the step of the least error do not count, because rounding grows there.
    """
    curves = [_greatest_so_far(judgement) for judgement in judgements]
    if len({judgement.step for judgement in judgements}) < 2:
        return None
    until = min(_time_within(*curve) for curve in curves)
    errors = [float(error[np.searchsorted(t, until, "right") - 1]) for t, error in curves]
    points = sorted((x.step or 0.0, error) for x, error in zip(judgements, errors, strict=True))
    least = min(range(len(points)), key=lambda i: points[i][1])
    known = [(step, error) for step, error in points[least:] if 0 < error < LOST_PHASE]
    order = _slope(known) if len({step for step, _ in known}) > 1 else None
    return Convergence(order, _depends_on_step(points), until, errors)


def _depends_on_step(points: Sequence[tuple[float, float]]) -> bool:
    """Return whether some error is a rounding error, or much less than another, for its step.

    Errors that hardly depend on the step belong to another motion.
    """
    steps, errors = zip(*points, strict=True)
    if not ROUNDING <= min(errors) < math.inf:
        return True
    return bool(max(errors) >= min(errors) * (max(steps) / min(steps)) ** LEAST_ORDER)


def _greatest_so_far(judgement: Judgement) -> tuple[Array, Array]:
    """Return times since the first row, and the greatest error so far; infinite when lost."""
    assert judgement.t is not None
    assert judgement.error is not None
    error = np.nan_to_num(judgement.error, nan=np.inf)
    return abs(judgement.t - judgement.t[0]), np.maximum.accumulate(error)


def _time_within(t: Array, error: Array) -> float:
    """Return the last time at which the phase is not lost, or the first time if there is none."""
    return float(t[max(int(np.searchsorted(error, LOST_PHASE)) - 1, 0)])


def _slope(points: Sequence[tuple[float, float]]) -> float:
    """Return the exponent of a power law through points, by least squares of the logarithms."""
    x, y = (np.log(values) for values in zip(*points, strict=True))
    x = x - x.mean()
    return float(x @ y / (x @ x))
