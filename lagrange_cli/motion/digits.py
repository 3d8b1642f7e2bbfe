"""Any number of digits of a motion: its record and its angles."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from ..arithmetic.correct_digits import NumberText, TooFewDigitsError, settle
from ..arithmetic.generic import Arithmetic, Number, Real, number
from ..inputs.top import Top
from .general import (
    Solution,
    analyse,
    separatrix_swing,
    steady_rates,
    theta_constants,
)
from .general_record import general_record
from .record import Regime
from .released import released_record
from .theta_series import ThetaConstants, evaluate, theta_series


def settled_record(top: Top, digits: int, *, radians: bool = False) -> dict[str, Any]:
    """The record with every number to so many significant digits, inputs read as decimals."""
    record_in = released_record if top.is_released else general_record
    return settle(lambda ar: record_in(ar, top).record(radians=radians, ar=ar), digits)


def settled_rows(
    top: Top, times: Sequence[Number], digits: int, *, radians: bool = False, wrap: bool = False
) -> list[list[NumberText]]:
    """Rows of t, tilt, spin and precession to so many significant digits."""

    def compute(ar: Arithmetic) -> dict[tuple[int, int], Real]:
        angles_at = angles_in(ar, top)
        unit = 1 if radians else 180 / ar.pi
        values: dict[tuple[int, int], Real] = {}
        for i, time in enumerate(times):
            t = number(ar, time)
            theta, phi, psi, noise = angles_at(t)
            if wrap:
                phi, psi = _wrapped(ar, phi), _wrapped(ar, psi)
            if any(0 < abs(angle) < noise * 10**digits for angle in (theta, phi, psi)):
                raise TooFewDigitsError
            values |= {(i, j): x for j, x in enumerate((t, theta * unit, phi * unit, psi * unit))}
        return values

    settled = settle(compute, digits)
    return [[settled[i, j] for j in range(4)] for i in range(len(times))]


def _wrapped(ar: Arithmetic, angle: Real) -> Real:
    """In (-pi, pi]."""
    return angle - 2 * ar.pi * ar.ceil(angle / (2 * ar.pi) - ar.mpf(0.5))


def angles_in(ar: Arithmetic, top: Top) -> Callable[[Real], tuple[Real, Real, Real, Real]]:
    """The angles as a function of time, and how far they may be off."""
    solution = analyse(ar, top)
    plane = not (solution.start.beta_plus_b or solution.start.beta_minus_b)
    if solution.regime is Regime.SEPARATRIX:
        args = _separatrix_args(ar, solution)
    elif solution.nutates:
        args = _theta_args(ar, theta_constants(ar, solution))
    else:
        args = _steady_args(ar, top, solution)
    start_x, start_y = args(ar.mpf(0))[1::2]

    def angles_at(t: Real) -> tuple[Real, Real, Real, Real]:
        if not t:
            return 2 * ar.atan2(top.tilt(ar).sin_half, top.tilt(ar).cos_half), t, t, t
        x, arg_x, y, arg_y = args(t)
        plus, minus = arg_x - start_x, arg_y - start_y
        theta, phi, psi = 2 * ar.atan2(y, x), plus - minus, plus + minus
        if plane:  # over the poles in half turns
            phi, psi = (ar.pi * ar.nint(angle / ar.pi) for angle in (phi, psi))
        size = 1 + abs(arg_x) + abs(arg_y) + abs(t * solution.speed)
        return theta, phi, psi, size * ar.mpf(10) ** (8 - ar.dps) if solution.speed else 0 * t

    return angles_at


Args = Callable[[Real], tuple[Real, Real, Real, Real]]
"""|X|, arg X, |Y| and arg Y, the arguments counted on, at a time."""


def _theta_args(ar: Arithmetic, c: ThetaConstants) -> Args:
    terms = 4 + math.isqrt(int(ar.dps * math.log(10) / math.pi))  # the nome is at most exp(-pi)
    series = theta_series(ar, c, terms)
    steps = len(series.frames)

    def args(t: Real) -> tuple[Real, Real, Real, Real]:
        passed = (t / c.period + c.offset) * steps
        step = int(ar.nint(passed))
        phase = passed - step
        x, arg_x, y, arg_y = evaluate(ar, series, series.frames[step % steps], phase, c.rises)
        arg_x += step * series.turn_x + phase * series.slope_x
        arg_y += step * series.turn_y + phase * series.slope_y
        return x, arg_x, y, arg_y

    return args


def _steady_args(ar: Arithmetic, top: Top, solution: Solution) -> Args:
    tilt, (spin, precession) = top.tilt(ar), steady_rates(solution.start)

    def args(t: Real) -> tuple[Real, Real, Real, Real]:
        return (
            tilt.cos_half,
            (precession + spin) * t / 2,
            tilt.sin_half,
            (precession - spin) * t / 2,
        )

    return args


def _separatrix_args(ar: Arithmetic, solution: Solution) -> Args:
    begin, swing = solution.start, separatrix_swing(ar, solution)

    def args(t: Real) -> tuple[Real, Real, Real, Real]:
        h = solution.speed * t + swing.offset
        real, imag = swing.x, swing.sign * swing.y * ar.tanh(h)
        arg_x = begin.r0 * t / 2 + (ar.atan2(imag, real) if t else swing.start)
        return ar.hypot(real, imag), arg_x, swing.y / ar.cosh(h), (begin.b - begin.r0) * t / 2

    return args
