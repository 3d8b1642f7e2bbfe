"""`compare`: a trajectory against the exact motion, its verdict, and the order of convergence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import repeat
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from ..arithmetic.types import Array
from ..errors import DataError, LagtopError, OutOfRangeError, check_type, joined
from ..file_bytes import shown_path
from ..names import ANGLES
from ..output.notebook import HasRecord
from ..recordings.recording import Given, Recording, recording_of
from ..solver.solve import Motion, solve
from ..top.top import Top
from .causes import likely_causes
from .convergence import Convergence, convergence, named_at_step_0
from .differences import CONSERVED, ExactMotion, blocks
from .mistakes import Cause
from .numbers import Estimate, estimate, sentences

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

LIMIT, LEAST_LIMIT = 1e-3, 1e-15
"""The error in radians up to which a trajectory is fine by default, and the least one: doubles."""
VERDICTS = {
    "fine": "the errors of attitude and rates stay below the limit, by default 1e-3",
    "drifts": "the first row is right, but an error grows beyond the limit, or the pivot slips",
    "another top": "the error does not fall with the step, or other inputs explain it",
    "off from the start": "the first row already exceeds the limit: another start, other frames",
    "lost": "a row is not finite",
}
"""The verdicts with their meanings; if several apply, the last one."""
_SURE = 2.0
"""Largest change of a difference from row to row, in radians, for whole turns to be counted."""

_KEPT = {"t", "error", *ANGLES}
"""Columns that are kept whole; only the extremes of the others are, to save memory."""


def _key(meaning: str, default: Any = None) -> Any:
    """Return the field of a key of the record, with its meaning."""
    return field(default=default, metadata={"meaning": meaning})


@dataclass(frozen=True, kw_only=True, repr=False)
class Comparison(HasRecord):
    """The comparison of one trajectory; angles are in radians, and an unknown number is None.

    >>> compare(Top(), [0.0], theta=[0.5]).verdict
    'off from the start'
    """

    file: str | None = _key("the file, `-` for standard input")
    step: float | None = _key("step size of the trajectory, if it was given")
    verdict: str = _key("verdict on the trajectory", "fine")
    rows: int = _key("the number of rows", 0)
    rows_missing: int = _key("the number of rows with empty cells", 0)
    columns: str | None = _key("the columns of the file that are used")
    unused: str | None = _key("its other columns")
    read: str | None = _key("what the columns were read as")
    compared: str = _key("the quantity of the error: attitude, axis, angles or rates", "")
    error_max: float | None = _key("greatest error of that quantity")
    error_final: float | None = _key("its error in the last row")
    attitude_error_max: float | None = _key("greatest angle between the given and exact attitude")
    axis_error_max: float | None = _key("greatest angle between the figure axes")
    theta_error_max: float | None = _key("greatest difference of the tilt")
    phi_error_max: float | None = _key("greatest difference of the spin, in (-pi, pi]")
    psi_error_max: float | None = _key("greatest difference of the precession, in (-pi, pi]")
    rates_error_max: float | None = _key("greatest error of the angular velocity, over its size")
    theta_drift: float | None = _key("growth of the tilt's difference per unit of time, fitted")
    phi_drift: float | None = _key("the same for the spin")
    psi_drift: float | None = _key("the same for the precession")
    norm_error: float | None = _key(
        "greatest distance from 1 of the norm of a quaternion or axis, or of the matrix R R^T"
    )
    pivot_slip: float | None = _key(
        "greatest change of the distance from pivot to centre of mass, over that in the first row"
    )
    energy_drift: float | None = _key("greatest change of energy, over its size at the start")
    Lz_drift: float | None = _key("greatest change of the vertical angular momentum, likewise")
    lost_at: float | None = _key("time of the first row that is not finite")
    order: float | None = _key("order of convergence of all trajectories")
    order_error: float | None = _key("error from which the order follows: before a phase is lost")
    a_ratio: float | None = _key("a of the motion of the axis, over that of the top")
    b_ratio: float | None = _key("b of the motion of the axis, over that of the top")
    r0_ratio: float | None = _key("the rate of spin, over that of the top")
    numbers: str | None = _key("what the motion shows of its top, if no cause explains it")
    cause: str | None = _key("the cause of the error")
    explained: str | None = _key("`most likely` if `cause_error` is below the limit, else `partly`")
    cause_error: float | None = _key("greatest error with this cause corrected")
    remedy: str | None = _key("arguments `name=value` that undo the cause, or what else to do")

    error_start: float = field(default=0.0, compare=False)
    """Error of the first row, or of its rates."""
    t: Array = field(default_factory=lambda: np.empty(0), compare=False)
    """Times of the rows."""
    error: Array = field(default_factory=lambda: np.empty(0), compare=False)
    """Errors of the rows; NaN where the trajectory is lost."""

    def exceeds(self, limit: float) -> bool:
        """Return whether an error is greater than a limit."""
        return max(self.error_max or 0.0, self.rates_error_max or 0.0) > limit

    def record(self) -> dict[str, Any]:
        """Return the comparison by key."""
        return {name: getattr(self, name) for name in COMPARISON_KEYS}

    def plot(self, figure: Figure | None = None) -> Figure:
        """Draw the error over time, on a figure of matplotlib or a new one, and return it."""
        from ..plot import new_figure  # start-up: matplotlib

        figure = figure or new_figure()
        from ..plot.reports import draw_errors

        return draw_errors([self], LIMIT, figure=figure)

    def __repr__(self) -> str:
        return f"<Comparison: {self.verdict}, error_max = {self.error_max}, {self.rows} rows>"


COMPARISON_KEYS: dict[str, str] = {
    x.name: x.metadata["meaning"] for x in fields(Comparison) if "meaning" in x.metadata
}
"""The keys of a record with their meanings."""


def compare(
    top: Top | Motion,
    t: ArrayLike | None = None,
    *,
    max_error: float = LIMIT,
    **trajectory: Unpack[Given],
) -> Comparison:
    """Compare a trajectory of n rows, at the times t, with the exact motion of a top.

    Pass any of the following arrays by name.  The attitude: `quaternion` (n, 4) from body to space,
    `matrix` (n, 3, 3) or (n, 9), or a rotation vector `rotvec` (n, 3).  Angles: `theta`, `phi`,
    `psi` (n,), or `euler` (n, 3), angles about coordinate axes with a sequence in scipy's notation.
    Directions: the figure axis `axis` (n, 3), or the `position` (n, 3) of the centre of mass from
    the pivot.  Rates: angular velocity `rates` (n, 3) in the frame of the `body` or of `space`, or
    `angle_rates` (n, 3), the rates of theta, phi, psi.

    Angles are in radians; a masked element is a missing number.  The options are those of `lagtop
    compare`: `quaternion_order`, `euler_sequence`, `rates_frame`, `align` (words, or a text such as
    "up=y,left"), `t_min` and `t_max`, and `dt` or `fps` if there is no t, or if it counts frames.
    A trajectory is fine up to `max_error` radians.

    Raises LagtopError for a bad argument, and for times that are not finite or that turn back.

    >>> motion, t = solve(Top()), np.linspace(0, 1, 50)
    >>> found = compare(motion, t, theta=motion.angles(t).theta + 1e-4)
    >>> found.verdict, f"{found.error_max:.0e}", found.record()["rows"]
    ('fine', '1e-04', 50)
    >>> figure = found.plot()
    """
    check_type("top", top, Top, Motion)
    run = recording_of(t, trajectory)
    motion = top if isinstance(top, Motion) else solve(top)
    return compared(motion, [run], max_error)[0][0]


@np.errstate(all="ignore")  # rows that are not finite raise no warnings
def compared(
    motion: Motion,
    runs: Sequence[Recording],
    limit: float = LIMIT,
    step_sizes: Sequence[float] | None = None,
) -> tuple[list[Comparison], Convergence | None]:
    """Return the comparison of each trajectory, and their convergence if there are step sizes.

    Causes are tried for a trajectory that exceeds the limit, unless the error falls with the step:
    then the top is right.  Raises LagtopError for bad step sizes, DataError for times that are
    too late in a file.
    """
    if not limit >= LEAST_LIMIT:
        raise LagtopError(f"max_error must be at least {LEAST_LIMIT:g}, got {limit}", "max_error")
    if not motion.sampler().is_ordinary:  # the search for causes would take minutes
        raise OutOfRangeError("numbers of this top are too large or too small: choose other units")
    if step_sizes and (len(step_sizes) != len(runs) or not all(x > 0 for x in step_sizes)):
        wanted = f"one number > 0 per trajectory ({len(runs)})"
        raise LagtopError(f"step_sizes must have {wanted}, got {step_sizes}", "step_sizes")
    exact, steps = ExactMotion(motion), step_sizes or repeat(None)
    results = [_measured(exact, *x) for x in zip(runs, steps, strict=False)]
    wrong = [x.exceeds(limit) for x in results]
    seen = [estimate(motion.top, x) if y else None for x, y in zip(runs, wrong, strict=True)]
    found = None
    if step_sizes:
        found = convergence([(x.step or 0.0, x.t, x.error) for x in results], limit)
        found = found and named_at_step_0(motion.top, found, step_sizes, seen)
    for i, x in enumerate(results):
        known, is_other = dict[str, Any](), bool(found and not found.converges)
        if wrong[i] and not (found and found.converges):
            causes = likely_causes(exact, runs[i], limit, seen[i])
            known = _explained(motion.top, seen[i], causes, limit)
            is_other |= any(y.is_top(limit) for y in causes)
        if found:
            known |= {"order": found.order, "order_error": found.errors[i]}
        applies = {
            "drifts": wrong[i] or (x.pivot_slip or 0.0) > limit,
            "another top": wrong[i] and is_other,
            "off from the start": x.error_start > limit,
            "lost": x.lost_at is not None,
        }
        verdict = ["fine", *(word for word, it in applies.items() if it)][-1]
        results[i] = replace(x, verdict=verdict, **known)
    return results, found


def _explained(
    top: Top, seen: Estimate | None, causes: list[Cause], limit: float
) -> dict[str, Any]:
    """Return the keys of causes, and numbers if no cause brings the error below the limit."""
    known, is_whole = dict[str, Any](), False
    if causes:
        is_whole = causes[0].error <= limit
        known["cause"] = "; or ".join(x.name for x in causes)
        known["explained"] = "most likely" if is_whole else "partly"
        known["cause_error"] = max(x.error for x in causes)
        known["remedy"] = joined(filter(None, (x.remedy for x in causes)), " or ") or None
    if seen and seen.is_trusted:
        known |= {"a_ratio": seen.a, "b_ratio": seen.b, "r0_ratio": seen.r0}
    if seen and not is_whole:
        known["numbers"] = "; ".join(sentences(top, seen)) or None
    return known


def _measured(exact: ExactMotion, run: Recording, step: float | None) -> Comparison:
    """Return a comparison without its verdict and its cause."""
    try:
        parts = [
            {name: y if name in _KEPT else _extremes(y) for name, y in x.items()}
            for x in blocks(exact, run)
        ]
    except LagtopError as wrong:
        if run.source.file is None or wrong.key != "t":
            raise
        raise DataError.at(shown_path(run.source.file), wrong) from None
    found = {name: np.concatenate([x.pop(name) for x in parts]) for name in [*parts[0]]}
    t, error, known = found.pop("t"), found["error"], dict[str, Any]()
    for name, values in found.items():
        if (ends := _extremes(values)).size:
            first = ends[0] if name in CONSERVED else 0.0
            greatest = abs(ends - first).max() / (first if name == "pivot_slip" else 1.0)
            names = name, f"{name}_max", f"{name}_error_max"
            key = next(x for x in names if x in COMPARISON_KEYS)
            known[key] = float(greatest) if np.isfinite(greatest) else None
        if name in ANGLES:
            known[f"{name}_drift"] = _slope(t, values)
    missing, source = run.missing, run.source
    lost = np.isnan(error) & ~missing
    return Comparison(
        file=source.file,
        step=step,
        rows=t.size,
        rows_missing=int(missing.sum()),
        compared=next((x for x in ("attitude", "axis") if x in found), None)
        or ("angles" if found.keys() & {*ANGLES} else "rates"),
        error_final=None if np.isnan(error[-1]) else float(error[-1]),
        lost_at=float(t[np.argmax(lost)]) if lost.any() else None,
        error_start=float(max(error[0], *found.get("rates", error)[:1])),
        t=t,
        error=error,
        **known,
        **source.record(),
    )


def _extremes(values: Array) -> Array:
    """Return the first, the least and the greatest of the finite values, if there are any."""
    finite = values[np.isfinite(values)]
    return np.array([finite[0], finite.min(), finite.max()]) if finite.size else finite


def _slope(t: Array, angle: Array) -> float | None:
    """Return the fitted growth of an angle per unit of time, None if whole turns may be missing."""
    finite = np.isfinite(angle)
    times, angle = t[finite], np.unwrap(angle[finite])
    span = abs(times - times[0]).max() if times.size > 2 else 0.0
    if not span or abs(np.diff(angle)).max() > _SURE:
        return None
    slope = float(np.polyfit((times - times[0]) / span, angle, 1)[0] / span)
    return slope if np.isfinite(slope) else None
