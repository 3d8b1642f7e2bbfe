"""From a top to what evaluates it: the many-digit constants, rounded to doubles once and kept."""

from __future__ import annotations

from functools import lru_cache

from ..arithmetic.double_double import pair
from ..arithmetic.generic import Arithmetic, Real, many_digits
from ..arithmetic.points import MAX_PERIODS
from ..inputs.top import Tilt, Top
from .attitude import growths
from .general import (
    Solution,
    analyse,
    separatrix_swing,
    steady_rates,
    theta_constants,
)
from .record import Regime
from .samplers import Sampler, SeparatrixSampler, SteadySampler, ThetaSampler
from .theta_series import (
    Component,
    Frame,
    Polynomial,
    Swing,
    ThetaConstants,
    evaluate,
    theta_series,
)

_NEGLIGIBLE = 2.0**-60


@lru_cache(maxsize=128)
def sampler_of(top: Top) -> Sampler:
    """What gives the angles of a top at any time.  Raises LagtopError as `solve` does."""
    ar, solution = many_digits(), solution_of(top)
    if solution.regime is Regime.SEPARATRIX:
        begin = solution.start
        swing = separatrix_swing(ar, solution)
        return separatrix_sampler(ar, swing, solution.speed, begin.r0, begin.b)
    if not solution.nutates:
        return steady_sampler(ar, top.tilt(ar), *steady_rates(solution.start))
    return theta_sampler(ar, theta_constants(ar, solution))


@lru_cache(maxsize=128)
def solution_of(top: Top) -> Solution:
    """The motion in many digits."""
    return analyse(many_digits(), top)


def theta_sampler(ar: Arithmetic, c: ThetaConstants) -> ThetaSampler:
    """The sampler of a nutating top from its constants in an mpmath context `ar`."""
    series = theta_series(ar, c)
    steps = len(series.frames)
    nearest = int(ar.nint(c.offset * steps))
    offset = c.offset * steps - nearest
    frames = [series.frames[(nearest + i) % steps] for i in range(steps)]
    return ThetaSampler(
        steps_per_time=pair(steps / c.period),
        offset=float(offset),
        max_time=float(MAX_PERIODS * c.period),
        scale=float(series.scale),
        hyperbolic=series.hyperbolic,
        frames=[_rounded(frame, series.hyperbolic) for frame in frames],
        growths=growths(
            ar,
            steps=(series.turn_x, series.turn_y),
            slopes=(series.slope_x, series.slope_y),
            starts=evaluate(ar, series, frames[0], offset, c.rises)[1::2],
        ),
    )


def steady_sampler(
    ar: Arithmetic, tilt: Tilt, spin_rate: Real, precession_rate: Real
) -> SteadySampler:
    """The sampler of a constant tilt and two constant rates, in an mpmath context `ar`."""
    half_sum, half_difference = (precession_rate + spin_rate) / 2, (precession_rate - spin_rate) / 2
    return SteadySampler(
        x=float(tilt.cos_half),
        y=float(tilt.sin_half),
        growths=growths(ar, (half_sum, half_difference)),
        max_time=_reach(abs(half_sum) + abs(half_difference)),
    )


def separatrix_sampler(
    ar: Arithmetic, swing: Swing, speed: Real, spin_rate: Real, b: Real
) -> SeparatrixSampler:
    """The sampler of the separatrix, in an mpmath context `ar`."""
    halves = spin_rate / 2, (b - spin_rate) / 2
    return SeparatrixSampler(
        speed=float(speed),
        offset=float(swing.offset),
        x=float(swing.x),
        y=float(swing.y),
        sign=swing.sign,
        growths=growths(ar, halves, starts=(swing.start, 0 * swing.start)),
        max_time=_reach(abs(halves[0]) + abs(halves[1]) + speed),
    )


def _reach(rate: Real) -> float:
    return float(MAX_PERIODS / rate) if rate else float("inf")


def _rounded(frame: Frame, hyperbolic: bool) -> Frame:
    """The frame in doubles, without the coefficients that are too small to matter."""

    def component(c: Component) -> Component:
        return Component(_trimmed(c.real, hyperbolic), _trimmed(c.imag, hyperbolic), c.even)

    return Frame(component(frame.x), component(frame.y), _trimmed(frame.rate, hyperbolic))


def _trimmed(polynomial: Polynomial, hyperbolic: bool) -> Polynomial:
    kept = [float(coefficient) for coefficient in polynomial]
    smallest = 0.0 if hyperbolic else _NEGLIGIBLE * abs(kept[0])
    while len(kept) > 2 and abs(kept[-1]) <= smallest:
        del kept[-1]
    return kept
