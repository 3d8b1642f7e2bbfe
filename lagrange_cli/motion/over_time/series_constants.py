"""From a kind of motion to the constants of its series, and to its attitude at arrays of doubles.

A sampler evaluates the arrays; its constants are those of the motion in many digits, rounded once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal
from typing import TYPE_CHECKING, Any, Generic, NamedTuple

from ...arithmetic.numbers import R
from ...arithmetic.points import MAX_PERIODS
from ...arithmetic.protocol import Value
from ...elliptic.complete import place
from ..kinds import Constant, Kind, Nutating, Separatrix
from .multiple_angles import Coefficients
from .theta_series import (
    Component,
    Frame,
    Series,
    SquaredRatio,
    ThetaConstants,
    evaluate,
    theta_series,
)

if TYPE_CHECKING:
    from .samplers import ConstantSampler, Sampler, SeparatrixSampler, ThetaSampler

_NEGLIGIBLE = Decimal(2) ** -60
_SIZE = 2**16
"""The largest coefficient of a frame, or half of it."""


def theta_constants(
    motion: Nutating[R], offset: R, rises: int = 1, *, rates: bool = False
) -> ThetaConstants:
    """Return what the theta series need to know of a nutating top.

    (1 + u2)/(1 + u1) and (1 - u1)(u3 - u2)/((u3 - u1)(1 - u2)) are sn^2 of the parameters of X and
    Y, with modulus k'; their complements are (u1 - u2)/(1 + u1) and
    (u3 - 1)(u1 - u2)/((u3 - u1)(1 - u2)).
    """
    ar, gaps, facts = motion.ar, motion.gaps, motion.facts
    with ar.working():
        squares = motion.K * motion.K * motion.k_prime * motion.k_prime
        return ThetaConstants(
            period=motion.T_nutation,
            quarter=motion.K,
            quarter_prime=motion.K_prime,
            m=motion.m,
            k=motion.k,
            k_prime=motion.k_prime,
            plus=SquaredRatio(gaps.below_u2, gaps.u1_u2),
            minus=SquaredRatio(gaps.above_u1 * gaps.a_u3_u2, gaps.a_u3_above * gaps.u1_u2),
            x_size=ar.sqrt(gaps.below_u1 / 2),
            y_size=ar.sqrt(motion.k_prime * gaps.above_u2 / 2),
            sign_plus=facts.sign_plus,
            sign_minus=facts.sign_minus,
            offset=offset,
            rises=rises,
            nutation=8 * squares * gaps.u1_u2 / (ar.pi * motion.T_nutation) if rates else None,
        )


def periods_since_top(motion: Nutating[R]) -> R:
    """Return w/2K for the argument w of (4,22)-(4,24) at t = 0, with the sign of theta'.

    sn^2 w = (u1 - u)(u3 - u2)/((u3 - u)(u1 - u2)) and, counted from u2, sn^2 = (u - u2)/(u1 - u2).
    As a (u1 - u) (u - u2) (u3 - u) is the square of sin(theta) theta', both are written with that:
    it is smooth at the turning points, and 0 there.
    """
    ar, gaps, state = motion.ar, motion.gaps, motion.state
    m, k_prime, swing = motion.m, motion.k_prime, state.sin * state.theta_rate
    if ar.either(gaps.u1_u <= gaps.u_u2):
        sn = swing * ar.sqrt(gaps.a_u3_u2 / (gaps.u_u2 * gaps.u1_u2)) / gaps.a_u3_u
        cn2 = gaps.a_u3_u1 * gaps.u_u2 / (gaps.a_u3_u * gaps.u1_u2)
        return place(ar, m=m, k_prime=k_prime, sn=sn, cn2=cn2) / ar.pi
    sn = swing / ar.sqrt(gaps.u1_u * gaps.a_u3_u * gaps.u1_u2)
    half = (0 * swing + 1) / 2
    return half - place(ar, m=m, k_prime=k_prime, sn=sn, cn2=gaps.u1_u / gaps.u1_u2) / ar.pi


def direction(motion: Nutating[R] | Separatrix[R]) -> int:
    """Return the sign of the nutation rate at t = 0, and 1 where it is 0."""
    return -1 if motion.state.theta_rate < 0 else 1


class SeriesFromStart(NamedTuple):
    """The theta series of a motion, counted from the turning point that is nearest to its start."""

    series: Series
    frames: list[Frame]
    """The series about that turning point and about the other one."""
    first_is_upper: bool
    """Whether that turning point is u1."""
    offset: Value
    """Steps, each of them half a period, from there to the start: at most 1/2 either way."""
    starts: tuple[Value, Value]
    """The arguments of X and Y at the start."""


def series_from_start(ar: Any, c: ThetaConstants) -> SeriesFromStart:
    """Return the series that some constants have, counted from next to the start."""
    series = theta_series(ar, c)
    nearest = ar.nint(c.offset * 2)
    offset = c.offset * 2 - nearest
    frames = [series.frames[(nearest + i) % 2] for i in range(2)]
    _, x_start, _, y_start = evaluate(ar, series, frames[0], offset, c.rises)
    return SeriesFromStart(series, frames, nearest % 2 == 0, offset, (x_start, y_start))


def greatest_argument(ar: Any, series: Series) -> Any:
    """Return what s, sin^2 or sinh^2, is at most where a step ends, half of `scale` from 0."""
    return ar.exp(series.scale) / 4 if series.hyperbolic else ar.convert(0.5)


class SeparatrixConstants(NamedTuple, Generic[R]):
    """The separatrix by its lowest point."""

    offset: R
    """The argument h at t = 0."""
    x: R
    """cos(theta_max/2)."""
    y: R
    """sin(theta_max/2)."""
    sign: int
    """Sign of b."""
    start: R
    """arg X at t = 0."""


def separatrix_constants(motion: Separatrix[Any]) -> SeparatrixConstants[Any]:
    """Return the separatrix by its lowest point."""
    ar: Any = motion.ar
    gaps, falls = motion.gaps, direction(motion)
    sign = -1 if motion.b < 0 else 1
    offset = -falls * ar.asinh(ar.sqrt(gaps.u_u2 / gaps.u1_u))
    x, y = ar.sqrt(gaps.below_u2 / 2), ar.sqrt(gaps.above_u2 / 2)
    side = ar.sinh(offset) / ar.cosh(offset) if offset or x else -falls  # on the lower pole
    return SeparatrixConstants(offset, x, y, sign, ar.atan2(sign * y * side, x))


def sampler_of(motion: Kind[Decimal]) -> Sampler:
    """Return the attitude of a motion as a function of arrays of doubles."""
    if isinstance(motion, Nutating):
        return nutating_sampler(motion)
    if isinstance(motion, Separatrix):
        return separatrix_sampler(motion)
    return constant_sampler(motion)


def nutating_sampler(motion: Nutating[Decimal]) -> ThetaSampler:
    """Return the sampler of a nutating top."""
    from ...arithmetic.double_double import period_of
    from ...arithmetic.rounding import pair
    from .attitude import growths
    from .samplers import ThetaSampler

    ar: Any = motion.ar
    with ar.working():
        c = theta_constants(motion, periods_since_top(motion), direction(motion), rates=True)
        found = series_from_start(ar, c)
        series = found.series
        steps, spin, precession = 2 / c.period, series.spin_slope, series.precession_slope
        slopes = (precession + spin) / 2, (precession - spin) / 2
        x, y = (
            start + slope * found.offset for start, slope in zip(found.starts, slopes, strict=True)
        )
        return ThetaSampler(
            tilt=tilt_of(motion),
            step=period_of(pair(c.period / 2), float(steps)),
            offset=float(found.offset),
            max_time=float(int(MAX_PERIODS) * c.period),
            scale=float(series.scale),
            speed=float(series.scale * steps),
            first=float(series.scale * found.offset),
            hyperbolic=series.hyperbolic,
            frames=[_rounded(ar, frame, series) for frame in found.frames],
            slopes=[float(slope / series.scale) for slope in slopes],
            growths=growths(ar, (motion.mean_spin_rate, motion.mean_precession_rate), (x, y)),
        )


def constant_sampler(motion: Constant[Decimal]) -> ConstantSampler:
    """Return the sampler of a constant tilt and constant rates."""
    from .attitude import growths
    from .samplers import ConstantSampler

    ar: Any = motion.ar
    with ar.working():
        rates = motion.mean_spin_rate, motion.state.psi_rate
        return ConstantSampler(
            tilt=tilt_of(motion),
            x=float(motion.state.cos_half),
            y=float(motion.state.sin_half),
            growths=growths(ar, rates),
            max_time=_reach(max(map(abs, rates))),
        )


def separatrix_sampler(motion: Separatrix[Decimal]) -> SeparatrixSampler:
    """Return the sampler of the separatrix."""
    from .attitude import growths
    from .samplers import SeparatrixSampler

    ar: Any = motion.ar
    with ar.working():
        swing, speed = separatrix_constants(motion), motion.argument_rate
        rates = motion.r0 - motion.b / 2, motion.b / 2
        return SeparatrixSampler(
            tilt=tilt_of(motion),
            speed=float(speed),
            offset=float(swing.offset),
            x=float(swing.x),
            y=float(swing.y),
            sign=swing.sign,
            growths=growths(ar, rates, (swing.start, 0 * swing.start)),
            max_time=_reach(max(map(abs, (*rates, speed)))),
        )


def tilt_of(motion: Nutating[Decimal] | Constant[Decimal] | Separatrix[Decimal]) -> float:
    """Return the tilt at the start."""
    state = motion.state
    return float(2 * motion.ar.atan2(state.sin_half, state.cos_half))


def _reach(rate: Decimal) -> float:
    return float(int(MAX_PERIODS) / rate) if rate else float("inf")


def _rounded(ar: Any, frame: Frame, series: Series) -> Frame:
    """Return the frame in doubles, without the coefficients that are too small to matter."""
    greatest = greatest_argument(ar, series)
    # X and Y may have any size in common: one that keeps the smallest and the largest in doubles
    parts = (frame.x.real, frame.x.imag, frame.y.real, frame.y.imag)
    size = ar.convert(2) ** math.frexp(float(max(abs(part[0]) for part in parts)))[1] / _SIZE

    def scaled(polynomial: Coefficients, size: Any) -> Coefficients:
        count = needed([abs(x) for x in polynomial], greatest, _NEGLIGIBLE)
        return [float(x / size) + 0.0 for x in polynomial[:count]]  # no -0

    def component(c: Component) -> Component:
        return Component(scaled(c.real, size), scaled(c.imag, size), c.even)

    return Frame(component(frame.x), component(frame.y), scaled(frame.rate, size**4))


def needed(sizes: Sequence[Decimal], greatest: Decimal, negligible: Decimal) -> int:
    """Return how many coefficients, two at least, matter beside the first to an argument."""
    count = len(sizes)
    while count > 2 and sizes[count - 1] * greatest ** (count - 1) <= negligible * sizes[0]:
        count -= 1
    return count
