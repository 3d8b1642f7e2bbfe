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
from ..recordings.misreadings import evenly_timed
from ..recordings.observed import Observed, rows_of
from ..recordings.recording import Recording
from ..top.top import Top

TRUSTED = 0.01
"""Largest relative residual of the axis with which ratios are printed."""
_MOST, _FIRST = 20_000, 8
"""Most rows, and the first rows, from which the rates at the start follow."""
_OPEN, _SAME, _DECAY, _SURE = 0.2, 2e-3, 1e-3, 1e-4
"""Relative errors: of an undetermined parameter, of one that agrees, of a constant spin, and of the
start."""
_COARSE, _FINE = 0.25, 0.04
"""Turns from row to row, in radians: of a step that may be coarse, and of rows that are left out if
there are too many."""
_HIDDEN = 1.0
"""Phase of a nutation from row to row, in radians, beyond which rows do not show it."""


class Estimate(NamedTuple):
    """The parameters of a trajectory; the ratios are over those of the given top."""

    axis: AxisMotion
    a: float | None
    b: float | None
    r0: float | None
    """The ratio of the rates of spin; None if the attitude is not given, like any unknown one."""
    decay: float
    """The decay of the spin per unit of time."""
    start: Array
    """The tilt, thetadot0 and psidot0 sin(theta0)."""
    start_spread: float
    """The likely error of the rates at the start."""
    step: float
    span: float

    @property
    def is_trusted(self) -> bool:
        """Whether the axis moves like that of a top."""
        return self.axis.residual <= TRUSTED

    def is_near(
        self, top: Top, clock: float = 1.0, share: float = 0.02, hidden: bool = False
    ) -> bool:
        """Return whether the axis of a top, with another clock, moves like this one.

        `hidden` is the answer for a nutation that is so fast that rows do not show it.
        """
        (a, b), axis = a_and_b(top), self.axis
        if abs(b * clock) * self.step > _HIDDEN:
            return hidden
        share += 3 * axis.residual
        off_a, off_b = abs(a * clock**2 - axis.a), abs(abs(b * clock) - abs(axis.b))
        is_near_a = off_a <= share * max(a * clock**2, axis.a) + axis.a_spread
        return is_near_a and off_b <= share * max(abs(b * clock), abs(axis.b)) + axis.b_spread


def a_and_b(top: Top) -> tuple[float, float]:
    """Return a = 2 m g s/A and b = C r0/A as doubles."""
    m, g, s, A, C, r0 = (float(x) for x in (top.m, top.g, top.s, top.A, top.C, top.r0))
    return 2 * m * g * s / A, C * r0 / A


@np.errstate(all="ignore")  # rows that are not finite
def estimate(top: Top, run: Recording) -> Estimate | None:
    """Return what a trajectory shows, None if it gives no axis in enough rows."""
    if not 0 < np.ptp(run.t) < math.inf:
        return None
    run = evenly_timed(run)
    if run.t[0] > run.t[-1]:
        run = run._replace(given=rows_of(run.given, slice(None, None, -1)))
    (a, b), r0 = a_and_b(top), float(top.r0)
    swing, step = abs(b) + math.sqrt(a) + 1e-300, float(np.median(abs(np.diff(run.t))))
    turn = (swing + abs(r0)) * step
    if len(run.t) > _MOST and turn < _FINE:  # rounding errors of close rows hide the motion
        run = run.few(max(_MOST // 4, math.ceil(len(run.t) * turn / _FINE)))
    found = [(x, axis, y) for x, axis in _views(run) if (y := from_spline(x.t, axis))]
    if not found:
        return None
    seen, axis, motion = next((x for x in found if x[2].residual <= TRUSTED), found[0])
    span = float(np.ptp(seen.t))
    rate, decay = _spin(seen, r0)
    if rate is None and abs(motion.b_slope) * span / 2 > 2 * motion.b_spread:
        decay = -motion.b_slope / motion.b
    decay *= decay * span > _DECAY
    earlier = math.exp(decay * span / 2)  # from the middle to the first row
    return Estimate(
        motion,
        motion.a / a if a and motion.a_spread < _OPEN * max(motion.a, a) else None,
        motion.b * earlier / b if b and motion.b_spread < _OPEN * swing else None,
        rate * earlier / r0 if rate is not None and r0 else None,
        decay,
        *_start(seen.t, axis),
        step,
        span,
    )


def _views(run: Recording) -> Iterator[tuple[Observed, Array]]:
    """Yield a motion, its first parts, and the motion about its own figure axis, with the axis."""
    seen = run.observed(slice(_MOST))
    parts = (len(seen.t) // x for x in (1, 2, 4))  # a strong decay is linear only at first
    views = [run.observed(slice(x)) for x in parts]
    if seen.quaternion is not None and (frames := own_frames(seen)):
        turn = rotations.of_matrix(frames[1].reshape(1, 9))[0][0]
        views.append(seen.turned(rotations.IDENTITY, turn))
    for view in views:
        if view.quaternion is not None:
            yield view, rotations.axis_of(view.quaternion)
        elif view.axis is not None:
            yield view, view.axis
        elif {"theta", "psi"} <= view.angles.keys():
            tilt, psi = view.angles["theta"], view.angles["psi"]
            yield view, rotations.axis_of(rotations.of_angles(tilt, 0 * tilt, psi))


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


def _start(t: Array, axis: Array) -> tuple[Array, float]:
    """Return the tilt, its rate, and the rate around the vertical in the first row, and an error.

    The error is the difference between polynomials of two degrees.
    """
    t, rows = np.unique(t, return_index=True)  # times may repeat
    span, n = np.ptp(t[:_FIRST]), axis[0]
    since, first = (t[:_FIRST] - t[0]) / span, axis[rows][:_FIRST]
    rate, other = (np.polyfit(since, first, x)[-2] / span for x in (5, 4))
    sine = math.hypot(n[0], n[1])
    slope = -rate[2] / sine if sine > 1e-9 else np.linalg.norm(rate)
    around = (n[0] * rate[1] - n[1] * rate[0]) / (sine or 1.0)
    return np.array([math.atan2(sine, n[2]), slope, around]), float(np.linalg.norm(rate - other))


def sentences(top: Top, found: Estimate) -> Iterator[str]:
    """Yield what an estimate says of the top, the simplest first."""
    axis, turns = found.axis, abs(float(top.r0)) * found.step
    smaller = f"use smaller steps (r0 dt is {turns:.2g} rad)"
    if not found.is_trusted:
        smaller = f"{smaller}, or " * (turns > _FINE / 2)
        said = f"the axis does not move like that of a top (residual {axis.residual:.1%})"
        yield f"{said}: {smaller}check the equations; for measured data, use fit"
        return
    same = max(_SAME, 3 * axis.residual)
    known = {x: y for x in ("a", "b", "r0") if (y := getattr(found, x)) is not None}
    off = {x: y for x, y in known.items() if abs(y - 1) > same}
    lean = math.acos(min(1.0, axis.up[2])) if found.a and axis.a_spread < same * axis.a else 0.0
    is_upright = not lean > max(0.02, same)
    moved = [*_other_start(top, found, same)] if is_upright else []
    is_other = bool(off or found.decay or moved or not is_upright)
    if known and is_other:
        parts = [f"{x} = {y:.4g} {x}_0" if x in off else f"{x} = {x}_0" for x, y in known.items()]
        yield f"the motion is that of a top with {', '.join(parts)}"
    elif known:
        most = max(axis.residual, *(abs(y - 1) for y in known.values()))
        near = " and ".join(_other_start(top, found, same, kicked=False))
        but = f", but {near}: check the start, or" if near else ":"
        yield f"the motion is that of the given top, to {most:.2%}{but} {smaller}"
    yield from moved
    given = dict(zip("ab", a_and_b(top), strict=True))
    if hidden := [x for x, y in given.items() if y and x not in known]:
        yield f"this motion does not show {' and '.join(hidden)}"
    if found.decay:
        yield f"the spin decays at the relative rate {found.decay:.3g} per unit of time"
    elif axis.damping * found.span > 10 * same:
        yield f"the rates across the axis decay at {axis.damping:.3g} per unit of time"
    if not is_upright:
        x, y, z = axis.up
        yield f"up is ({x:.4f}, {y:.4f}, {z:.4f}) in the space frame"
    if turns > _COARSE and (is_other or not known):
        yield f"if each row is a step, {smaller}"


def _other_start(top: Top, found: Estimate, same: float, *, kicked: bool = True) -> Iterator[str]:
    """Yield the initial tilt and rates that differ.

    Engines stagger rates by half a step: `kicked` allows for that.
    """
    tilt = float(top.inputs(radians=True)["theta0_rad"])
    given = np.array([tilt, float(top.thetadot0), float(top.psidot0) * math.sin(tilt)])
    (a, b), rate = a_and_b(top), math.hypot(*given[1:])
    size, kick = math.sqrt(a) + abs(b) + rate, found.step * (a / 2 + abs(b) * rate + rate**2)
    most = max(same, 0.01) * size + kick if kicked else 3 * found.start_spread + _SURE * size
    theta, slope, around = found.start
    is_off = abs(found.start - given) > [same if kicked else _SURE, most, most]
    if is_off[0]:
        yield f"theta0 is {math.degrees(theta):.4g} degrees"
    if is_off[1]:
        yield f"thetadot0 is {slope:.3g}"
    if is_off[2] and math.sin(theta) > same:
        yield f"psidot0 is {around / math.sin(theta):.3g}"
