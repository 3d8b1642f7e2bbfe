"""Methods of all kinds in one scene over increasing spans: errors, condition, growth.

An error is the angle (rad) of the rotation between the computed and the exact attitude.  Unlike
errors of Euler angles, it is meaningful next to the vertical.  The condition is the rotation caused
by half a unit in the last place of each input.  No method can do better with inputs in doubles.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import mpmath
import numpy as np

from ..arithmetic.types import Array
from ..inputs.top import Top
from ..motion.derivatives import AngleDerivatives, inputs_of
from ..motion.solve import solve
from .closed_forms import CLOSED_FORMS
from .compare_methods import LOST, growth_of
from .integrators import integrators
from .method import FAILURES, Drift, FailedError, Run, failure_remark, is_out
from .reference import ExactAngles, Reference, quaternion

SPANS, LONG_SPAN = (5.0, 100.0), 1e4
"""Spans in nutation periods for every method; the last one only with `long`."""
EVALUATIONS, LONG_EVALUATIONS = 50_000, 5_000_000
"""Limit of the evaluations of the right-hand side in a run."""
SECONDS = 60.0
_HAIR = 1e-9
TIMES_OF_A_SPAN = 8
"""Number of times in each span; errors are the greatest up to its end."""
PEERS = (
    *("lagtop", "scipy.special", "DOP853-quaternion"),
    *("Radau-quaternion", "Taylor-quaternion", "RK4-quaternion"),
)
_EXACT, _ACCURATE, _ACCURATE_GROWTH = 100, 1e-3, 1.2
VERDICTS = {
    "exact": f"error at most {_EXACT} times the condition",
    "accurate": f"error below {_ACCURATE:g} rad, growing at most like t^{_ACCURATE_GROWTH:g}",
    "drifting": "error that is larger or grows faster",
    "lost": f"error above {LOST:g} rad, or stopped within {SPANS[0]:g} periods",
    "ill-conditioned": f"a scene whose condition exceeds {LOST:g} rad",
}
"""The words of the verdict and their meanings, from good to bad."""


def _most(*, is_long: bool) -> int:
    """Return the limit of the evaluations in a run."""
    return LONG_EVALUATIONS if is_long else EVALUATIONS


def peer_conditions(*, is_long: bool) -> dict[str, str]:
    """Return the conditions of the comparison."""
    return {
        "errors": "radians, the turn from the exact to the computed attitude, the greatest of "
        f"{TIMES_OF_A_SPAN} times from 0.1 to 5 periods, and as many to the end of each further "
        "span, at equal ratios",
        "condition": "radians by which half a unit in the last place of each input turns it",
        "methods": "each at its tightest setting; a run gives up after "
        f"{_most(is_long=is_long):.0e} evaluations of the right-hand side, or {SECONDS:g} s",
        "conserved": "changes of energy and Lz since the start, over the sum of their terms",
        "verdicts": "; ".join(f"{word}: {meaning}" for word, meaning in VERDICTS.items()),
    }


class PeerRun(NamedTuple):
    """One method in one scene."""

    method: str
    points: Sequence[tuple[float, float]]
    """Times in periods, and errors at these times (rad), up to the end of the run."""
    bounds: Sequence[tuple[float, float]]
    """Times in periods, and conditions at these times (rad), over all spans."""
    evaluations: int | None = None
    drift: Drift = (None, None)
    remark: str | None = None
    """The reason why the run ended early, if it did."""

    def error(self, span: float) -> float | None:
        """Return the greatest error in a span; infinite if the method gave up before its end.

        It is None for a missing method, and for a span that was not compared.
        """
        if is_out(self.remark) or not _reaches(self.bounds, span):
            return None
        return _greatest(self.points, span) if _reaches(self.points, span) else math.inf

    def condition(self, span: float) -> float:
        """Return the greatest condition in a span."""
        return _greatest(self.bounds, span)

    @property
    def growth(self) -> float | None:
        """The exponent of the error in time, after the first period."""
        return growth_of([(t, error) for t, error in self.points if t >= 1])

    @property
    def verdict(self) -> str:
        """A word of VERDICTS, for the longest span that was computed; "" for a missing method."""
        if is_out(self.remark):
            return ""
        span = self.points[-1][0] if self.points else SPANS[0]
        worst, condition = self.error(SPANS[0]), self.condition(span)
        if condition > LOST:
            return "ill-conditioned"
        worst = max(worst or 0.0, _greatest(self.points, span))
        if worst > LOST:
            return "lost"
        if worst <= _EXACT * condition:
            return "exact"
        steady = (self.growth or 0) <= _ACCURATE_GROWTH
        return "accurate" if worst < _ACCURATE and steady else "drifting"


def _reaches(points: Sequence[tuple[float, float]], span: float) -> bool:
    return bool(points) and points[-1][0] >= span * (1 - _HAIR)


def _greatest(points: Sequence[tuple[float, float]], span: float) -> float:
    return max((value for t, value in points if t <= span * (1 + _HAIR)), default=0.0)


class ExactSpans(NamedTuple):
    """The exact motion of a top at times of growing spans, for all methods."""

    top: Top
    period: float
    grids: Sequence[Array]
    """Times in periods, an array for each span."""
    angles: Sequence[Sequence[ExactAngles]]
    bounds: Sequence[tuple[float, float]]
    """Times in periods, and conditions at these times (rad)."""
    most: int
    """Limit of the evaluations of the right-hand side in a run."""


def exact_spans(top: Top, reference: Reference, *, is_long: bool = False) -> ExactSpans:
    """Return the exact motion at times of each span."""
    spans = (*SPANS, LONG_SPAN) if is_long else SPANS
    period = float(reference.T)
    ends = zip((0.1, *spans), spans, strict=False)
    grids = [np.geomspace(first, last, TIMES_OF_A_SPAN + 1)[1:] for first, last in ends]
    angles = [[reference.at(t) for t in (grid * period).tolist()] for grid in grids]
    every = np.concatenate(grids)
    bounds = [*zip(every.tolist(), _conditions(top, every * period), strict=True)]
    return ExactSpans(top, period, grids, angles, bounds, _most(is_long=is_long))


def peer_run(name: str, exact: ExactSpans) -> PeerRun:
    """Return the run of one of PEERS over growing spans; its package may be missing."""
    method, run, remark = (CLOSED_FORMS | integrators(SECONDS, exact.most))[name], Run([]), None
    points: list[tuple[float, float]] = []
    try:
        with np.errstate(all="ignore"):
            sample, _ = method.start(exact.top, method.settings[-1])  # the tightest setting
            for grid, true in zip(exact.grids, exact.angles, strict=True):
                run = sample(grid * exact.period)
                found = zip(*run.angles, strict=True)
                errors = [turn(x, y) for x, y in zip(found, true, strict=True)]
                if math.inf in errors:
                    raise FailedError("returned values that are not finite")
                points += zip(grid.tolist(), errors, strict=True)
    except FAILURES as reason:
        remark = failure_remark(reason)
    return PeerRun(name, points, exact.bounds, run.work.evaluations, run.drift, remark)


def turn(angles: Sequence[Any], exact: ExactAngles) -> float:
    """Return the angle of the rotation between two attitudes; infinite if one is not finite."""
    with mpmath.workdps(60):
        theta, phi, psi = (mpmath.mpf(x) for x in angles)
        x, y = mpmath.cos(theta / 2), mpmath.sin(theta / 2)
        parts = quaternion(x, y, (psi + phi) / 2, (psi - phi) / 2)
        pairs = list(zip(parts, exact.quaternion, strict=True))
        away = min(mpmath.sqrt(sum((a - sign * b) ** 2 for a, b in pairs)) for sign in (1, -1))
        return float(4 * mpmath.asin(away / 2)) if mpmath.isfinite(away) else math.inf


def _conditions(top: Top, times: Array) -> list[float]:
    """Return the condition at times: the sum of the rotations by each input."""
    motion, names = solve(top), inputs_of(top)
    steps = np.array([math.ulp(float(getattr(top, name))) / 2 for name in names])
    steps[[not getattr(top, name) for name in names]] = 0.0
    slopes = np.moveaxis(AngleDerivatives(motion, names).at(times), 0, -1)
    theta, phi, psi = np.nan_to_num(slopes) * steps
    together = 2 * phi * psi * np.cos(motion.angles(times).theta)[:, None]
    square = np.maximum(theta**2 + phi**2 + psi**2 + together, 0.0)
    found: list[float] = np.sqrt(square).sum(axis=1).tolist()
    return found
