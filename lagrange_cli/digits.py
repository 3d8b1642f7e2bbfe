"""Any number of digits: compute with more and more until the digits asked for have settled."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from .elliptic import Arithmetic, Real
from .general import (
    Solution,
    analyse,
    general_record,
    many_digits,
    separatrix_swing,
    steady_rates,
    theta_constants,
)
from .record import Regime
from .released import released_record
from .series import Constants, evaluate, theta_series
from .top import LagtopError, Number, Top, number

MOST_RECORD_DIGITS, MOST_TABLE_DIGITS = 1000, 100


class NumberText(str):
    """A number written out, to be printed as it stands."""

    __slots__ = ()


def settled_record(top: Top, digits: int, *, radians: bool = False) -> dict[str, Any]:
    """The record with every number to so many significant digits, inputs read as decimals."""
    record_in = released_record if top.is_released else general_record
    return _settle(lambda ar: record_in(ar, top).record(radians=radians, ar=ar), digits)


def settled_rows(
    top: Top, times: Sequence[Number], digits: int, *, radians: bool = False, wrap: bool = False
) -> list[list[NumberText]]:
    """Rows of t, tilt, spin and precession to so many significant digits."""

    def compute(ar: Arithmetic) -> dict[tuple[int, int], Real]:
        angles_at = _angles(ar, top)
        unit = 1 if radians else 180 / ar.pi
        values: dict[tuple[int, int], Real] = {}
        for i, time in enumerate(times):
            t = number(ar, time)
            theta, phi, psi = angles_at(t)
            if wrap:
                phi, psi = (
                    x - 2 * ar.pi * ar.ceil(x / (2 * ar.pi) - ar.mpf(0.5)) for x in (phi, psi)
                )
            values |= {(i, j): x for j, x in enumerate((t, theta * unit, phi * unit, psi * unit))}
        return values

    settled = _settle(compute, digits)
    return [[settled[i, j] for j in range(4)] for i in range(len(times))]


def _wrapped(ar: Arithmetic, angle: Real) -> Real:
    """In (-pi, pi]."""
    return angle - 2 * ar.pi * ar.ceil(angle / (2 * ar.pi) - ar.mpf(0.5))


def _angles(ar: Arithmetic, top: Top) -> Callable[[Real], tuple[Real, Real, Real]]:
    """The angles as a function of time."""
    solution = analyse(ar, top)
    if solution.regime is Regime.SEPARATRIX:
        args = _separatrix_args(ar, solution)
    elif solution.nutates:
        args = _theta_args(ar, theta_constants(ar, solution))
    else:
        args = _steady_args(ar, top, solution)
    start_x, start_y = args(ar.mpf(0))[1::2]

    def angles_at(t: Real) -> tuple[Real, Real, Real]:
        x, arg_x, y, arg_y = args(t)
        noise = ar.mpf(10) ** (8 - ar.dps) * (1 + abs(arg_x) + abs(arg_y))
        plus, minus = arg_x - start_x, arg_y - start_y
        phi, psi = (0 * t if abs(z) < noise or not t else z for z in (plus - minus, plus + minus))
        return 2 * ar.atan2(y, x), phi, psi

    return angles_at


Args = Callable[[Real], tuple[Real, Real, Real, Real]]
"""|X|, arg X, |Y| and arg Y, the arguments counted on, at a time."""


def _theta_args(ar: Arithmetic, c: Constants) -> Args:
    terms = 4 + math.isqrt(int(ar.dps * math.log(10) / math.pi))  # the nome is at most exp(-pi)
    series = theta_series(ar, c, terms)
    steps = len(series.frames)
    turn_x, turn_y = ((c.precession + z * c.spin) / (2 * steps) for z in (1, -1))

    def args(t: Real) -> tuple[Real, Real, Real, Real]:
        passed = (t / c.period + c.offset) * steps
        step = int(ar.nint(passed))
        phase = passed - step
        x, arg_x, y, arg_y = evaluate(ar, series, series.frames[step % steps], phase, c.rises)
        arg_x += step * turn_x + phase * series.slope_x
        arg_y += step * turn_y + phase * series.slope_y
        return x, arg_x, y, arg_y

    return args


def _steady_args(ar: Arithmetic, top: Top, solution: Solution) -> Args:
    tilt, (spin, precession) = top.tilt(ar), steady_rates(solution)

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
        arg_x = begin.r0 * t / 2 + ar.atan2(imag, real)
        return ar.hypot(real, imag), arg_x, swing.y / ar.cosh(h), (begin.b - begin.r0) * t / 2

    return args


def _settle(compute: Callable[[Arithmetic], Mapping[Any, Any]], digits: int) -> dict[Any, Any]:
    """Ziv's strategy: raise the precision until two in a row print alike.

    Raises LagtopError where none do, which takes a number that is zero without our knowing it.
    """
    previous, working = None, digits + 15
    while working <= 20 * digits + 4000:
        ar = many_digits(working)
        texts = {key: _text(ar, value, digits) for key, value in compute(ar).items()}
        if texts == previous:
            return texts
        previous, working = texts, working * 3 // 2
    raise LagtopError(f"{digits} digits did not settle with {working} to work with")


def _text(ar: Arithmetic, value: Any, digits: int) -> Any:
    if value is None or isinstance(value, str):
        return value
    return NumberText(ar.nstr(number(ar, value), digits, min_fixed=-5, max_fixed=16))
