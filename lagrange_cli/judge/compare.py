"""`compare(top, t, quaternion=...)`: somebody's motion of a top, judged by the exact one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arithmetic.text import quoted
from ..arithmetic.types import Array
from ..errors import LagtopError, check_type
from ..inputs.seen import Conventions, Quantities
from ..inputs.top import Top
from ..inputs.trajectory_columns import QUANTITIES
from ..motion.over_time.times import times_of
from ..motion.solve import Motion, solve
from .alignment import alignment
from .convergence import Convergence, check_steps, convergence
from .judgement import LIMIT, Given, JudgedRun, Judgement, judge
from .slips import explanation
from .verdict import verdict

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


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
    """Return the judgement of a trajectory at the times t, of n rows.

    Given are any of: quaternion (n, 4) from body to space, matrix (n, 3, 3) or (n, 9), the angles
    theta, phi, psi (n,), three angles about coordinate axes (n, 3) by a sequence in scipy's
    notation, a rotation vector (n, 3), the figure axis (n, 3), the position of the mass centre from
    the pivot (n, 3), angular velocity (n, 3) in the frame of the `body` or of `space`, and the
    rates of theta, phi, psi (n, 3).  Angles are in radians.  `align` names what is done to the
    trajectory first, as in `lagtop compare`.  Up to `max_error` radians it is fine.  `step` is kept
    in the judgement, for `convergence` of several.

    Raises LagtopError for a bad argument, and for times that are not finite, turn back or repeat.
    """
    arrays = {
        **{"quaternion": quaternion, "matrix": matrix, "theta": theta, "phi": phi, "psi": psi},
        **{"euler": euler, "rotvec": rotvec, "axis": axis, "position": position},
        **{"rates": rates, "angle_rates": angle_rates},
    }
    conventions = Conventions(quaternion_order, euler_sequence, rates_frame, True).checked()
    block = _quantities(t, {key: x for key, x in arrays.items() if x is not None})
    given = Given([block], {}, conventions, alignment(align))
    check_type("top", top, Top, Motion)
    motion = top if isinstance(top, Motion) else solve(top)
    (judgement,), _ = settled(motion, [(judge(motion, given), given)], max_error)
    return replace(judgement, step=step)


def _quantities(t: ArrayLike, arrays: dict[str, ArrayLike]) -> Quantities:
    """Return the arrays as quantities.  Raises LagtopError for one of another shape."""
    times = times_of(t).reshape(-1, 1)
    if not arrays:
        raise LagtopError("compare must be given an attitude, an axis, angles or rates, got none")
    steps = times[1:, 0], times[:-1, 0]  # a difference may be beyond all doubles
    if not np.isfinite(times).all() or not (np.all(np.greater(*steps)) or np.all(np.less(*steps))):
        raise LagtopError("t must be finite and go on in one direction, each time once", "t")
    block = {"t": times}
    for key, array in arrays.items():
        size = QUANTITIES[key].size
        try:
            block[key] = _real(array).reshape(len(times), size)
        except (TypeError, ValueError, OverflowError):
            wanted = f"real numbers of shape ({len(times)}, {size})"
            raise LagtopError(f"{key} must be {wanted}, got {_shown(array)}", key) from None
    return block


def _real(array: ArrayLike) -> Array:
    """Return an array of real numbers, NaN where it is masked.

    Raises TypeError, ValueError or OverflowError for anything else.
    """
    values: Any = np.ma.asarray(array)
    if values.dtype.kind not in "iufO":
        raise TypeError(values.dtype)
    with np.errstate(over="ignore"):  # of long doubles
        numbers: Array = values.astype(np.float64).filled(np.nan)
    return numbers


def _shown(array: ArrayLike) -> str:
    """Return the type and the shape of an array, or a short text of what is none."""
    if isinstance(array, np.ndarray):
        return f"{array.dtype} of shape {array.shape}"
    return quoted(array)


def settled(
    motion: Motion,
    cases: Sequence[tuple[JudgedRun, Given]],
    limit: float | None = None,
    steps: Sequence[float] | None = None,
) -> tuple[list[Judgement], Convergence | None]:
    """Return the judgements of trajectories with their verdicts, and how they converge.

    A slip is looked for where a trajectory is beyond the limit, but not where the error falls with
    the step: there the top is the right one.  Raises LagtopError for bad steps.
    """
    limit = LIMIT if limit is None else limit
    judgements = [run.judgement for run, _ in cases]
    found = None
    if steps is not None:
        check_steps(steps, len(cases))
        judgements = [replace(x, step=step) for x, step in zip(judgements, steps, strict=True)]
        found = convergence(judgements)
        judgements = [replace(x, order=found.order if found else None) for x in judgements]
    judgements = [
        replace(judgement, **_slip(motion, *case, limit, found))
        for judgement, case in zip(judgements, cases, strict=True)
    ]
    return [replace(x, verdict=verdict(x, limit, found)) for x in judgements], found


def _slip(
    motion: Motion, run: JudgedRun, given: Given, limit: float, found: Convergence | None
) -> dict[str, Any]:
    """Return the keys of the slip that explains a trajectory, if it needs to be explained."""
    error = run.judgement.error_max
    if error is None or (error <= limit if found is None else found.falls):
        return {}
    best = explanation(motion, run, given)
    return {} if best is None else {"explained_by": best.name, "explained_error": best.error}
