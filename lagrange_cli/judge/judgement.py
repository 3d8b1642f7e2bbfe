"""The judgement of one trajectory: its keys, and its computation from the rows."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.names import ANGLES
from ..inputs.seen import ORDERS, Conventions, Named, Quantities, Seen, rows_of, see
from ..inputs.trajectory_columns import NAMELESS
from ..motion.notebook import HasRecord
from ..motion.solve import Motion
from .alignment import Alignment, frames_of
from .deviations import Deviations, Extremes, Kept, LineFit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LIMIT = 1e-3
"""The error in radians up to which a trajectory is fine by default."""
PASSED = {"t_past_1e_6": 1e-6, "t_past_1e_3": 1e-3, "t_past_0_1": 0.1, "t_past_1": 1.0}
_JUDGED = {
    "attitude": "attitude",
    "axis": "axis",
    "theta": "angles",
    "phi": "angles",
    "psi": "angles",
    "rate": "rates",
}
"""The quantity of the error, by the first deviation that is available."""
PROVED, DISPROVED = 1e-6, 1e-3
"""Errors at the first row that prove one order of a quaternion right, and the other wrong."""


def _field(meaning: str, default: Any = None) -> Any:
    """Return the field of a key of the record, with its meaning."""
    return field(default=default, metadata={"meaning": meaning})


@dataclass(frozen=True, kw_only=True, repr=False)
class Judgement(HasRecord):
    """The judgement of one trajectory; angles are in radians, and an unknown number is None.

    >>> compare(Top(), [0.0], theta=[0.5]).verdict
    'off from the start'
    """

    file: str | None = _field("the file, `-` for standard input")
    step: float | None = _field("step size of the trajectory (--step-sizes)")
    verdict: str = _field("verdict on the trajectory", "fine")
    rows: int = _field("the number of rows", 0)
    judged: str = _field("quantity of the error: attitude, axis, angles or rates", "")
    error_max: float | None = _field(
        "greatest error of the quantity in judged; that of rates is relative to their size"
    )
    attitude_error_max: float | None = _field("greatest angle between the given and exact attitude")
    attitude_error_final: float | None = _field("the angle at the last row")
    axis_error_max: float | None = _field("greatest angle between the figure axes")
    theta_error_max: float | None = _field("greatest difference of the tilt")
    theta_error_final: float | None = _field("its size at the last row")
    phi_error_max: float | None = _field("greatest difference of the spin, in (-pi, pi]")
    phi_error_final: float | None = _field("its size at the last row")
    psi_error_max: float | None = _field("greatest difference of the precession, in (-pi, pi]")
    psi_error_final: float | None = _field("its size at the last row")
    rate_error_max: float | None = _field("greatest difference of the angular velocity, rad/time")
    rate_error_final: float | None = _field("its size at the last row")
    theta_drift: float | None = _field("growth of the tilt's difference per period, fitted")
    phi_drift: float | None = _field("growth of the spin's difference per period, fitted")
    psi_drift: float | None = _field("growth of the precession's difference per period, fitted")
    theta_rest: float | None = _field("root mean square of that difference about the line")
    phi_rest: float | None = _field("the same of the spin")
    psi_rest: float | None = _field("the same of the precession")
    period: float | None = _field(
        "the period: that of the nutation, or else of the spin, or else 1"
    )
    norm_drift: float | None = _field(
        "greatest distance from 1: of the norm of a quaternion or axis, of the matrix R R^T, or "
        "of the mass centre's distance divided by s"
    )
    energy_drift: float | None = _field("greatest change of energy, over its size at the start")
    Lz_drift: float | None = _field("greatest change of the vertical angular momentum, likewise")
    t_past_1e_6: float | None = _field("first time at which the error is beyond 1e-6 rad")
    t_past_1e_3: float | None = _field("beyond 1e-3 rad")
    t_past_0_1: float | None = _field("beyond 0.1 rad")
    t_past_1: float | None = _field("beyond 1 rad")
    lost_at: float | None = _field("time of the first row that is not finite")
    quaternion_order: str | None = _field(
        "order of the quaternion, if it was found from the first row"
    )
    order: float | None = _field("order of convergence of all files (--step-sizes)")
    explained_by: str | None = _field("the mistake that explains the error best")
    explained_error: float | None = _field("greatest error with that mistake corrected")

    error_start: float = field(default=math.nan, compare=False)
    """Error at the first row."""
    rate_error_relative: float = field(default=math.nan, compare=False)
    """Greatest error of the angular velocity over the size of the rates; NaN without rates."""
    t: Array | None = field(default=None, compare=False)
    """Times of at most 4096 rows, spread evenly."""
    error: Array | None = field(default=None, compare=False)
    """Errors at these times; NaN where the trajectory is lost."""

    def record(self) -> dict[str, Any]:
        """Return the judgement by key."""
        return {name: getattr(self, name) for name in JUDGEMENT_KEYS}

    def plot(self, figure: Figure | None = None) -> Figure:
        """Draw the error over time, on a figure of matplotlib or a new one, and return the figure.

        Raises LagtopError if the trajectory has no rows with an error.
        """
        from ..plot.reports import ErrorCurve, draw_error_panels, new_figure  # start-up: matplotlib

        if self.t is None or self.error is None:
            raise LagtopError("the judgement has no errors to draw")
        figure = figure or new_figure()
        curve = ErrorCurve(self.file or "trajectory", self.t, self.error, None, self.error_max)
        draw_error_panels(figure, [curve], LIMIT)
        return figure

    def __repr__(self) -> str:
        return f"<Judgement: {self.verdict}, error_max = {self.error_max}, {self.rows} rows>"


JUDGEMENT_KEYS: dict[str, str] = {
    x.name: x.metadata["meaning"] for x in fields(Judgement) if "meaning" in x.metadata
}
"""The keys of a record with their meanings."""


class ReadTrajectory(NamedTuple):
    """A trajectory as it is given: blocks of quantities, and their conventions."""

    blocks: Iterable[Quantities]
    named: Named
    conventions: Conventions
    alignment: Alignment
    change: Callable[[Seen], Seen] | None = None
    """Change of the trajectory before its conversion to the frames of lagtop."""

    def see(self, block: Quantities) -> Seen:
        """Return the motion in a block, in its original frames."""
        seen = see(block, self.conventions, self.named)
        return seen if self.change is None else self.change(seen)

    def with_conventions(self, **changes: Any) -> ReadTrajectory:
        """Return the trajectory with other conventions."""
        return self._replace(conventions=self.conventions._replace(**changes))


class JudgedRun(NamedTuple):
    """A trajectory that has been read to its end, with its judgement."""

    judgement: Judgement
    kept: ReadTrajectory
    """Some of its rows, as they were given, with the conventions in which they were read."""


def judge(motion: Motion, given: ReadTrajectory) -> JudgedRun:
    """Return the judgement of a trajectory, except for its verdict.

    Raises LagtopError for a trajectory without rows, or if the order of a quaternion is unknown.
    """
    tally: _Tally | None = None
    with ARRAYS.working():
        for block in given.blocks:
            if not len(block["t"]):
                continue
            if tally is None:
                tally = _Tally(motion, given, _first_row(block))
            tally.add(block)
        if tally is None:
            raise LagtopError("t must have at least one row", "t")
        return JudgedRun(tally.judgement(), tally.kept_rows())


def errors_of(motion: Motion, given: ReadTrajectory) -> Array:
    """Return the errors of a trajectory in one block, compared with another motion."""
    (block,) = given.blocks
    with ARRAYS.working():
        frames = frames_of(given.alignment, motion, given.see(_first_row(block)))
        return Deviations(motion).of(frames.aligned(given.see(block)))["error"]


def _first_row(block: Quantities) -> dict[str, Array]:
    """Return the first row that is finite, or else the first row."""
    finite = np.all([np.isfinite(values).all(axis=1) for values in block.values()], axis=0)
    row = int(np.argmax(finite))
    return rows_of(block, slice(row, row + 1))


class _Tally:
    """The summary of a trajectory so far."""

    def __init__(self, motion: Motion, given: ReadTrajectory, first: Mapping[str, Array]) -> None:
        self.motion, self.proved = motion, None
        said_order = given.named.get("quaternion", NAMELESS).says or given.conventions.quaternion
        if "quaternion" in first and not said_order:
            self.proved = _proved_order(motion, given, first)
            given = given.with_conventions(quaternion=self.proved)
        self.given = given
        self.frames = frames_of(given.alignment, motion, given.see(first))
        self.deviations = Deviations(motion)
        self.extremes: defaultdict[str, Extremes] = defaultdict(Extremes)
        self.fits = {name: LineFit() for name in ANGLES}
        self.first: dict[str, Any] = dict.fromkeys([*PASSED, "lost_at"])
        self.kept, self.rows, self.start = Kept(), 0, math.nan

    def add(self, block: Quantities) -> None:
        """Add a block of rows."""
        seen = self.frames.aligned(self.given.see(block))
        found = self.deviations.of(seen)
        for name, values in found.items():
            self.extremes[name].add(values)
        for name in ANGLES:
            if name in found:
                self.fits[name].add(seen.t, found[name])
        error = found["error"]
        events = {key: error > size for key, size in PASSED.items()} | {"lost_at": np.isnan(error)}
        for key, happens in events.items():
            if self.first[key] is None and happens.any():
                self.first[key] = float(seen.t[np.argmax(happens)])
        self.kept.add({**block, "error": error[:, np.newaxis]})
        if not self.rows:
            self.start = float(error[0])
            self.judged = next(word for name, word in _JUDGED.items() if name in found)
        self.rows += len(error)

    def kept_rows(self) -> ReadTrajectory:
        """Return some of the rows, as they were given."""
        rows = {name: x for name, x in self.kept.rows().items() if name != "error"}
        return self.given._replace(blocks=[rows])

    def judgement(self) -> Judgement:
        """Return the judgement, except for the verdict."""
        period = self.motion.T_nutation or self.motion.T_spin or 1.0
        values = {"error_max": self.extremes["error"].greatest}
        for name in ("attitude", "axis", *ANGLES, "rate"):
            values[f"{name}_error_max"] = self.extremes[name].greatest
            if name != "axis":
                values[f"{name}_error_final"] = self.extremes[name].last
        for name in ("norm", "energy", "Lz"):
            values[f"{name}_drift"] = self.extremes[name].greatest
        for name, fit in self.fits.items():
            if line := fit.line():
                slope, values[f"{name}_rest"] = line
                values[f"{name}_drift"] = slope * period
        known: dict[str, Any] = {x: None if math.isnan(y) else y for x, y in values.items()}
        kept = self.kept.rows()
        return Judgement(
            rows=self.rows,
            judged=self.judged,
            period=period,
            quaternion_order=self.proved,
            error_start=self.start,
            rate_error_relative=self.extremes["rate"].greatest / self.deviations.rate_scale,
            t=kept["t"][:, 0] - self.frames.time,
            error=kept["error"][:, 0],
            **known,
            **self.first,
        )


def _proved_order(motion: Motion, given: ReadTrajectory, first: Mapping[str, Array]) -> str:
    """Return the order of a quaternion that makes the first row right, if only one does.

    Raises LagtopError otherwise.
    """
    errors = {}
    for order in ORDERS:
        one = given.with_conventions(quaternion=order)._replace(blocks=[first])
        errors[order] = float(np.nan_to_num(errors_of(motion, one)[0], nan=math.inf))
    right, wrong = sorted(ORDERS, key=lambda order: errors[order])
    if errors[right] < PROVED and errors[wrong] > DISPROVED:
        return right
    shown = ", ".join(f"{errors[order]:.1e} rad off by {order}" for order in ORDERS)
    raise LagtopError(
        f"the first row does not prove the order of the quaternion ({shown}): give the order "
        "(--quaternion-order wxyz or xyzw)"
    )
