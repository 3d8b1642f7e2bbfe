"""The entry points: `compare` of arrays, and of trajectories in files; verdicts and convergence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import DataError, LagtopError, check_type
from ..inputs.files import shown_path, utf8_path
from ..inputs.scene_file import difference, scene_in
from ..inputs.seen import Conventions, quantities_of
from ..inputs.text_lines import UNDECIDED, Dialect
from ..inputs.top import Top
from ..inputs.trajectory import Trajectory, open_trajectory
from ..motion.solve import Motion, solve
from ..output.terminal import Progress, silent
from .alignment import Alignment, alignment
from .judgement import LIMIT, JudgedRun, Judgement, ReadTrajectory, judge
from .mistakes import explanation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

FINE, RATES, DRIFTS = "fine", "other rates", "drifts"
OFF, ANOTHER, LOST = "off from the start", "another top", "lost"
JUDGEMENTS = {
    FINE: "the error stays below the limit, 1e-3 rad or --max-error",
    RATES: "the attitude is fine, but its angular velocity, over the size of the rates, is not",
    DRIFTS: "the first row is right, but the error grows beyond the limit",
    ANOTHER: "the error exceeds the limit and does not fall with the step, or a mistake causes it",
    OFF: "the first row already exceeds the limit: another start, or other frames",
    LOST: "a row is not finite",
}
"""The words with their meanings; if several apply, the verdict is the last one."""
LOST_PHASE = 0.3
"""Error in radians beyond which the phase is lost, and no order can be measured."""
ROUNDING = 1e-8
"""Error that need not fall any more."""
LEAST_ORDER = 0.5
"""Least order of a method that converges."""
_OF_THE_FILE = {"t", "angle_rates"}
"""Arguments that come from a file, so that errors about them are errors of data."""


def compare(
    top: Top | Motion,
    t: ArrayLike,
    *,
    quaternion: ArrayLike | None = None,
    matrix: ArrayLike | None = None,
    theta: ArrayLike | None = None,
    phi: ArrayLike | None = None,
    psi: ArrayLike | None = None,
    euler: ArrayLike | None = None,
    rotvec: ArrayLike | None = None,
    axis: ArrayLike | None = None,
    position: ArrayLike | None = None,
    rates: ArrayLike | None = None,
    angle_rates: ArrayLike | None = None,
    quaternion_order: str | None = "wxyz",
    euler_sequence: str = "xyz",
    rates_frame: str = "body",
    align: Sequence[str] = (),
    max_error: float = LIMIT,
    step: float | None = None,
) -> Judgement:
    """Compare a trajectory of n rows, at the times t, with the exact motion of a top.

    Pass any of the following arrays.  The attitude: quaternion (n, 4) from body to space, matrix
    (n, 3, 3) or (n, 9), or a rotation vector (n, 3).  Angles: theta, phi, psi (n,), or three angles
    about coordinate axes (n, 3) with a sequence in scipy's notation.  Directions: the figure axis
    (n, 3), or the position of the centre of mass from the pivot (n, 3).  Rates: angular velocity
    (n, 3) in the frame of the `body` or of `space`, or the rates of theta, phi, psi (n, 3).

    Angles are in radians; a masked element is a missing number.  `align` changes the trajectory
    first, as in `lagtop compare`.  A trajectory is fine up to `max_error` radians.  `step` is kept
    in the judgement, for the `convergence` of several trajectories.

    Raises LagtopError for a bad argument, and for times that are not finite or not monotonic.

    >>> motion, t = solve(Top()), np.linspace(0, 1, 50)
    >>> judgement = compare(motion, t, theta=motion.angles(t).theta + 1e-4)
    >>> judgement.verdict, f"{judgement.error_max:.0e}", judgement.record()["rows"]
    ('fine', '1e-04', 50)
    >>> figure, keys = judgement.plot(), judgement.to_dict().keys()
    """
    angles = {"theta": theta, "phi": phi, "psi": psi}
    attitude = {"quaternion": quaternion, "matrix": matrix, "euler": euler, "rotvec": rotvec}
    directions = {"axis": axis, "position": position}
    arrays = attitude | angles | directions | {"rates": rates, "angle_rates": angle_rates}
    conventions = Conventions(quaternion_order, euler_sequence, rates_frame, True).checked()
    block = quantities_of(t, {key: x for key, x in arrays.items() if x is not None})
    if len(block) == 1:
        raise LagtopError("compare must be given an attitude, an axis, angles or rates, got none")
    times = block["t"]
    steps = times[1:], times[:-1]  # a difference may exceed the range of doubles
    if not np.isfinite(times).all() or not (np.all(np.greater(*steps)) or np.all(np.less(*steps))):
        raise LagtopError("t must be finite, and increase or decrease from row to row", "t")
    given = ReadTrajectory([block], {}, conventions, alignment(align))
    check_type("top", top, Top, Motion)
    motion = top if isinstance(top, Motion) else solve(top)
    (judgement,), _ = with_verdicts(motion, [judge(motion, given)], max_error)
    return replace(judgement, step=step)


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


def convergence(judgements: Sequence[Judgement]) -> Convergence | None:
    """Return how the errors of trajectories fall with their steps, or None for fewer than two.

    The order is fitted to the greatest errors up to the time at which the first one exceeds 0.3
    rad.  Steps finer than the step of the least error do not count, because rounding grows there.
    """
    curves = [_greatest_so_far(judgement) for judgement in judgements]
    if len({judgement.step for judgement in judgements}) < 2:
        return None
    # the last time at which no phase is lost, or the first time if there is none
    until = min(
        float(t[max(int(np.searchsorted(error, LOST_PHASE)) - 1, 0)]) for t, error in curves
    )
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


def _slope(points: Sequence[tuple[float, float]]) -> float:
    """Return the exponent of a power law through points, by least squares of the logarithms."""
    x, y = (np.log(values) for values in zip(*points, strict=True))
    x = x - x.mean()
    return float(x @ y / (x @ x))


def with_verdicts(
    motion: Motion,
    runs: Sequence[JudgedRun],
    limit: float | None,
    step_sizes: Sequence[float] | None = None,
) -> tuple[list[Judgement], Convergence | None]:
    """Return the judgements of trajectories with their verdicts, and their convergence.

    The limit is LIMIT by default.  Mistakes are tried if a trajectory exceeds the limit.  They are
    not tried if the error falls with the step, because then the top is right.
    """
    limit = LIMIT if limit is None else limit
    judgements, found = [run.judgement for run in runs], None
    if step_sizes is not None:
        judgements = [replace(x, step=step) for x, step in zip(judgements, step_sizes, strict=True)]
        found = convergence(judgements)
        judgements = [replace(x, order=found.order if found else None) for x in judgements]
    for i, (run, judgement) in enumerate(zip(runs, judgements, strict=True)):
        error, best = judgement.error_max, None
        if error is not None and (error > limit if found is None else not found.falls):
            best = explanation(motion, run)
        name, remaining = best or (None, None)
        explained = replace(judgement, explained_by=name, explained_error=remaining)
        judgements[i] = replace(explained, verdict=_verdict(explained, limit, found))
    return judgements, found


def _verdict(judgement: Judgement, limit: float, found: Convergence | None) -> str:
    """Return the verdict on a trajectory, alone or among others with other steps."""
    beyond = judgement.error_max is not None and judgement.error_max > limit
    if judgement.lost_at is not None:
        return LOST
    if judgement.error_start > limit:
        return OFF
    if judgement.explained_by or (beyond and found is not None and not found.falls):
        return ANOTHER
    if beyond:
        return DRIFTS
    return RATES if judgement.rate_error_relative > limit else FINE


class ComparisonRequest(NamedTuple):
    """Options for comparing trajectories in files."""

    columns: Sequence[str] | None = None
    """The names of all columns from the left; None to take them from the files."""
    conventions: Conventions = Conventions()
    align: Alignment = Alignment()
    limit: float | None = None
    step_sizes: Sequence[float] | None = None
    dialect: Dialect = UNDECIDED


class Comparison(NamedTuple):
    """Trajectories that have been compared together."""

    judgements: Sequence[Judgement]
    convergence: Convergence | None
    motion: Motion
    """The motion with which they were compared."""
    warnings: Sequence[str]
    """Files that describe another scene."""


def compare_files(
    motion: Motion,
    paths: Sequence[str],
    request: ComparisonRequest,
    progress: Progress = silent,
    *,
    is_named: bool = True,
) -> Comparison:
    """Compare the trajectories in files with a motion.

    If no scene is named, a description in the first file gives it.  Raises LagtopError for a bad
    request, DataError for a bad or unreadable file.
    """
    if paths.count("-") > 1:
        raise LagtopError("standard input can be read once, got - twice")
    steps = request.step_sizes
    if steps is not None and len(steps) != len(paths):
        wanted = f"one number per trajectory ({len(paths)})"
        raise LagtopError(f"step_sizes must have {wanted}, got {len(steps)}", "step_sizes")
    if wrong := [step for step in steps or [] if not step > 0]:
        raise LagtopError(f"step_sizes must be > 0, got {wrong[0]}", "step_sizes")
    runs, warnings = [], []
    for path in paths:
        with open_trajectory(path, request.columns, request.dialect) as trajectory:
            top = scene_in(trajectory.description, trajectory.name)
            if top is not None and not is_named:
                motion = solve(top)
            elif top is not None and (other := difference(top, motion.top)):
                warnings.append(f"{trajectory.name} describes another scene: {other}")
            is_named = True
            runs.append(_judged(motion, path, trajectory, request, progress))
    found = with_verdicts(motion, runs, request.limit, request.step_sizes)
    return Comparison(*found, motion, warnings)


def _judged(
    motion: Motion,
    path: str,
    trajectory: Trajectory,
    request: ComparisonRequest,
    progress: Progress,
) -> JudgedRun:
    rows = (block for block, _ in trajectory.blocks())
    blocks = progress(rows, "rows", size=lambda block: len(block["t"]))
    given = ReadTrajectory(blocks, trajectory.quantities, request.conventions, request.align)
    try:
        run = judge(motion, given)
    except DataError:
        raise
    except LagtopError as error:
        if error.key not in {None, *_OF_THE_FILE}:
            raise
        kind = DataError if error.key in _OF_THE_FILE else LagtopError
        raise kind(f"{shown_path(path)}: {error}") from None
    return run._replace(judgement=replace(run.judgement, file=utf8_path(path)))
