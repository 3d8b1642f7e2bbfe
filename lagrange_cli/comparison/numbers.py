"""Numbers of the top that follow from the axis and the spin of a trajectory."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..recordings.axis_equation import AxisMotion, from_spline
from ..recordings.frames import own_frames
from ..recordings.observed import Observed, rows_of
from ..recordings.recording import Recording
from ..top.top import Top

TRUSTED = 0.01
"""Largest relative residual of the axis with which ratios are printed."""
_MOST, _ENOUGH, _FIRST = 20_000, 5000, 8
"""Most rows, the fewest to which more rows are reduced, and the first rows, from which the rates at
the start follow."""
_OPEN, _SAME, _DECAY = 0.2, 2e-3, 1e-3
"""Relative errors: of an undetermined parameter, of one that agrees, of a spin that is constant."""
_COARSE, _FINE = 0.25, 0.04
"""Turns from row to row, in radians: of a step that may be coarse, and of rows that are left out if
there are too many."""
_UNITS = "per unit of time"
_PARTS = 0.5, 0.25
"""Shares of the rows, from the first one, that are tried if all of them do not suffice."""


class Estimate(NamedTuple):
    """The parameters of a trajectory; the ratios are over those of the given top."""

    axis: AxisMotion
    a: float | None
    b: float | None
    r0: float | None
    """The ratio of the rates of spin; None if the attitude is not given, like any unknown one."""
    decay: float = 0.0
    """The decay of the spin per unit of time."""
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """The tilt, thetadot0 and psidot0 sin(theta0)."""
    step: float = 0.0
    span: float = 0.0

    @property
    def is_trusted(self) -> bool:
        """Whether the axis moves like that of a top."""
        return self.axis.residual <= TRUSTED


def a_and_b(top: Top) -> tuple[float, float]:
    """Return a = 2 m g s/A and b = C r0/A as doubles."""
    m, g, s, A, C, r0 = (float(x) for x in (top.m, top.g, top.s, top.A, top.C, top.r0))
    return 2 * m * g * s / A, C * r0 / A


@np.errstate(all="ignore")  # rows that are not finite
def estimate(top: Top, run: Recording) -> Estimate | None:
    """Return what a trajectory shows, None if it gives no axis in enough rows."""
    if not 0 < np.ptp(run.t) < math.inf:
        return None
    if run.t[0] > run.t[-1]:
        run = run._replace(given=rows_of(run.given, slice(None, None, -1)))
    a, b = a_and_b(top)
    swing, step = abs(b) + math.sqrt(a) + 1e-300, float(np.median(abs(np.diff(run.t))))
    turn = (swing + abs(float(top.r0))) * step
    if len(run.t) > _MOST and turn < _FINE:  # rounding errors of close rows hide the motion
        run = run.few(max(_ENOUGH, math.ceil(len(run.t) * turn / _FINE)))
    seen = run.observed(slice(_MOST))
    if np.ptp(seen.t) == 0:
        return None
    best: tuple[Observed, Array, AxisMotion] | None = None
    for view in _views(run, seen):
        axis = _axis(view)
        found = None if axis is None else from_spline(view.t, axis)
        if axis is not None and found and (best is None or found.residual <= TRUSTED):
            best = view, axis, found
        if best and best[2].residual <= TRUSTED:
            break
    if best is None:
        return None
    seen, axis, found = best
    rate, decay = _spin(seen, float(top.r0))
    span = float(np.ptp(seen.t))
    if rate is None and abs(found.b_slope) * span / 2 > 2 * found.b_spread:
        decay = -found.b_slope / found.b
    decay *= decay * span > _DECAY
    earlier = math.exp(decay * span / 2)  # from the middle to the first row
    return Estimate(
        found,
        found.a / a if a and found.a_spread < _OPEN * max(found.a, a) else None,
        found.b * earlier / b if b and found.b_spread < _OPEN * swing else None,
        rate * earlier / float(top.r0) if rate is not None and top.r0 else None,
        decay,
        _start(seen.t, axis),
        step,
        span,
    )


def _views(run: Recording, seen: Observed) -> Iterator[Observed]:
    """Yield a motion, its first parts, and the motion about its own figure axis.

    A strong decay of the spin is a line only at first.
    """
    yield seen
    yield from (run.observed(slice(int(part * len(seen.t)))) for part in _PARTS)
    if seen.quaternion is not None and (frames := own_frames(seen)):
        turn = rotations.of_matrix(frames[1].reshape(1, 9))[0][0]
        yield seen.turned(rotations.IDENTITY, turn)


def _axis(seen: Observed) -> Array | None:
    if seen.quaternion is not None:
        return rotations.axis_of(seen.quaternion)
    if seen.axis is not None or not {"theta", "psi"} <= seen.angles.keys():
        return seen.axis
    tilt, psi = seen.angles["theta"], seen.angles["psi"]
    return rotations.axis_of(rotations.of_angles(tilt, 0 * tilt, psi))


def _spin(seen: Observed, r0: float) -> tuple[float | None, float]:
    """Return the rate of spin, of its aliases that nearest to r0, and its decay."""
    if seen.quaternion is None:
        return None, 0.0
    turn = rotations.product(rotations.conjugate(seen.quaternion[:-1]), seen.quaternion[1:])
    angle, steps = 2 * np.arctan2(turn[:, 3], turn[:, 0]), np.diff(seen.t)
    good = (steps > 0) & np.isfinite(angle)
    expected = r0 * steps[good]
    rates = (expected + rotations.within_half_turn(angle[good] - expected)) / steps[good]
    if rates.size < _FIRST:
        return None, 0.0
    times = seen.t[1:][good] - seen.t[0]
    slope, first = np.polyfit(times, rates, 1)
    middle = first + slope * times[-1] / 2
    return float(middle), float(-slope / middle) if middle else 0.0


def _start(t: Array, axis: Array) -> tuple[float, float, float]:
    """Return the tilt, its rate, and the rate around the vertical in the first row."""
    rows = slice(_FIRST)
    span = t[rows][-1] - t[0] or 1.0
    n, rate = axis[0], np.polyfit((t[rows] - t[0]) / span, axis[rows], 5)[-2] / span
    sine = math.hypot(n[0], n[1])
    slope = -rate[2] / sine if sine > 1e-9 else float(np.linalg.norm(rate))
    return math.acos(min(1, max(-1, n[2]))), slope, (n[0] * rate[1] - n[1] * rate[0]) / (sine or 1)


def sentences(top: Top, found: Estimate) -> Iterator[str]:
    """Yield what an estimate says of the top, the simplest first."""
    axis, turns = found.axis, abs(float(top.r0)) * found.step
    if not found.is_trusted:
        smaller = f"use smaller steps (r0 dt is {turns:.2g} rad), or " * (turns > _FINE / 2)
        said = f"the axis moves like that of no top (residual {axis.residual:.1%})"
        yield f"{said}: {smaller}check the equations"
        return
    same = max(_SAME, 3 * axis.residual)
    ratios = {"a": found.a, "b": found.b, "r0": found.r0}
    hidden = [x for x in ("a", "b") if ratios[x] is None and a_and_b(top)["ab".index(x)]]
    off = {x: y for x, y in ratios.items() if y is not None and abs(y - 1) > same}
    known = {x: y for x, y in ratios.items() if y is not None}
    decay = found.decay
    is_upright = _is_upright(found, same)
    moved = [*_other_start(top, found, same)] if is_upright else []
    if known and (off or decay or moved or not is_upright):
        parts = [f"{x} = {y:.4g} {x}_0" if x in off else f"{x} = {x}_0" for x, y in known.items()]
        yield f"the motion is that of {', '.join(parts)}"
    elif known:
        most = max(axis.residual, *(abs(y - 1) for y in known.values()))
        yield f"the motion is that of the given top, to {most:.2%}: use smaller steps"
    yield from moved
    if hidden:
        yield f"this motion does not show {' and '.join(hidden)}"
    if decay:
        yield f"the spin decays by {decay:.1%} {_UNITS}"
    elif axis.damping * found.span > 10 * same and not decay:
        yield f"the rates across the axis decay by {axis.damping:.1%} {_UNITS}"
    if not is_upright:
        x, y, z = axis.up
        yield f"up is ({x:.4f}, {y:.4f}, {z:.4f}) in the frame of space"
    if turns > _COARSE:
        yield f"if each row is a step (r0 dt is {turns:.2g} rad), use smaller steps"


def _is_upright(found: Estimate, same: float) -> bool:
    """Return whether up is z, or is not determined."""
    is_known = found.a is not None and found.axis.a_spread < same * found.axis.a
    return not is_known or not math.acos(min(1.0, found.axis.up[2])) > max(0.02, same)


def _other_start(top: Top, found: Estimate, same: float) -> Iterator[str]:
    """Yield the initial tilt and rates that differ; engines stagger rates by half a step."""
    tilt = float(top.inputs(radians=True)["theta0_rad"])
    given = tilt, float(top.thetadot0), float(top.psidot0) * math.sin(tilt)
    a, b = a_and_b(top)
    swing = math.sqrt(a) + abs(b) + math.hypot(*given[1:])
    kick = (max(same, 0.01) + found.step * swing) * swing
    theta, slope, around = found.start
    if abs(theta - given[0]) > same:
        yield f"theta0 is {math.degrees(theta):.4g} degrees"
    if abs(slope - given[1]) > kick:
        yield f"thetadot0 is {slope:.3g}"
    if abs(around - given[2]) > kick and (sine := math.sin(theta)) > same:
        yield f"psidot0 is {around / sine:.3g}"
