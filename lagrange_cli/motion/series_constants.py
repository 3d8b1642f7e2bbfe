"""From a kind of motion to its attitude over time: in any number of digits, or for doubles.

A spinor is a function of time, in the arithmetic of the motion.  A sampler evaluates arrays of
doubles; its constants are those of the motion in many digits, rounded once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from decimal import Decimal
from typing import TYPE_CHECKING, Any, Generic, NamedTuple

from ..arithmetic.numbers import R, absolute
from ..arithmetic.points import MAX_PERIODS
from ..elliptic.carlson import carlson_rf
from .theta_series import (
    Component,
    Frame,
    Place,
    Polynomial,
    Series,
    ThetaConstants,
    evaluate,
    theta_series,
)

if TYPE_CHECKING:
    from .kinds import Constant, Nutating, Separatrix
    from .samplers import ConstantSampler, SeparatrixSampler, ThetaSampler

_NEGLIGIBLE = Decimal(2) ** -60
_SIZE = 2**16
"""The largest coefficient of a frame, or half of it."""


class Attitude(NamedTuple, Generic[R]):
    """The attitude at one time."""

    x: R
    """cos(theta/2), up to a factor common with y."""
    y: R
    """sin(theta/2), up to that factor."""
    phi: R
    """Spin, counted on from 0 at t = 0."""
    psi: R
    """Precession, counted on from 0 at t = 0."""
    size: R
    """Greatest number that was added up to give the angles: their noise is eps times it."""


Spinor = Callable[[R], Attitude[R]]
"""The attitude as a function of time."""


def theta_constants(motion: Nutating[R], offset: R, rises: int = 1) -> ThetaConstants:
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
            plus=Place(gaps.below_u2, gaps.u1_u2),
            minus=Place(gaps.above_u1 * gaps.a_u3_u2, gaps.a_u3_above * gaps.u1_u2),
            x_size=ar.sqrt(gaps.below_u1 / 2),
            y_size=ar.sqrt(motion.k_prime * gaps.above_u2 / 2),
            sign_plus=facts.sign_plus,
            sign_minus=facts.sign_minus,
            offset=offset,
            rises=rises,
            nutation=8 * squares * gaps.u1_u2 / (ar.pi * motion.T_nutation),
        )


def periods_since_top(motion: Nutating[R]) -> R:
    """Return w/2K for the argument w of (4,22)-(4,24) at t = 0, with the sign of theta'.

    sn^2 w = (u1 - u)(u3 - u2)/((u3 - u)(u1 - u2)); on a turning point it is 0 or 1/2 exactly.
    """
    ar, gaps = motion.ar, motion.gaps
    zero = 0 * motion.K
    if not gaps.u1_u > 0:
        return zero
    if not gaps.u_u2 > 0:
        return zero + 1 / (zero + 2)
    scale = gaps.a_u3_u * gaps.u1_u2
    sn2, cn2 = gaps.u1_u * gaps.a_u3_u2 / scale, gaps.a_u3_u1 * gaps.u_u2 / scale
    w: R = ar.sqrt(sn2) * carlson_rf(ar, cn2, gaps.a_u3_u1 / gaps.a_u3_u, zero + 1)
    return _direction(motion) * w / (2 * motion.K)


def _direction(motion: Nutating[R] | Separatrix[R]) -> int:
    """Return the sign of the nutation rate at t = 0, and 1 where it is 0."""
    return -1 if motion.state.theta_rate < 0 else 1


def nutating_spinor(motion: Nutating[R]) -> Spinor[R]:
    """Return the attitude of a nutating top by its theta series."""
    ar: Any = motion.ar
    with ar.working():
        constants = theta_constants(motion, periods_since_top(motion), _direction(motion))
        terms = 2 + math.isqrt(int(ar.digits * math.log(10) / math.pi))  # nome <= exp(-pi)
        series = theta_series(ar, constants, terms)

    def position(t: R) -> tuple[R, R, R, R, R]:
        passed = (t / constants.period + constants.offset) * 2
        step = ar.nint(passed)
        phase = passed - step
        frame = series.frames[step % 2]
        return *evaluate(ar, series, frame, phase, constants.rises), phase

    with ar.working():
        _, x_start, _, y_start, since_first = position(0 * motion.K)
        rates = motion.mean_spin_rate, motion.mean_precession_rate
        rate_size = abs(rates[0]) + abs(rates[1]) + 4 / constants.period

    def spinor(t: R) -> Attitude[R]:
        with ar.working():
            x, arg_x, y, arg_y, phase = position(t)
            within, size = phase - since_first, 8 + abs(t) * rate_size
            plus, minus = arg_x - x_start, arg_y - y_start
            phi = t * rates[0] + within * series.spin_slope + (plus - minus)
            psi = t * rates[1] + within * series.precession_slope + (plus + minus)
            if motion.facts.plane:
                phi, psi = _half_turns(ar, phi), _half_turns(ar, psi)
            return Attitude(x, y, phi, psi, size)

    return spinor


def _half_turns(ar: Any, angle: R) -> R:
    """Return the nearest number of half turns: in a plane an angle only leaps, at the poles."""
    turned: R = ar.pi * ar.nint(angle / ar.pi)
    return turned


def constant_spinor(motion: Constant[R]) -> Spinor[R]:
    """Return the attitude of a constant tilt and constant rates."""
    state = motion.state

    def spinor(t: R) -> Attitude[R]:
        with motion.ar.working():
            phi, psi = motion.mean_spin_rate * t, state.psi_rate * t
            return Attitude(state.cos_half, state.sin_half, phi, psi, absolute(phi) + absolute(psi))

    return spinor


def separatrix_spinor(motion: Separatrix[R]) -> Spinor[R]:
    """Return the attitude on the separatrix: 1 - u = (1 - u2)/cosh^2 h, h = speed t + offset."""
    ar: Any = motion.ar
    with ar.working():
        swing = _swing(motion)

    def spinor(t: R) -> Attitude[R]:
        with ar.working():
            h = motion.argument_rate * t + swing.offset
            sinh, cosh = ar.sinh(h), ar.cosh(h)
            real, imag = swing.x * cosh, swing.sign * swing.y * sinh
            turned = ar.atan2(imag, real) - swing.start if t else 0 * t
            half_spin, half_b = motion.r0 * t / 2, motion.b * t / 2
            phi, psi = motion.r0 * t - half_b + turned, half_b + turned
            if motion.facts.plane:
                phi, psi = _half_turns(ar, phi), _half_turns(ar, psi)
            x = ar.sqrt(real * real + imag * imag)
            return Attitude(x, swing.y, phi, psi, 8 + abs(h) + abs(half_spin) + abs(half_b))

    return spinor


class Swing(NamedTuple, Generic[R]):
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


def _swing(motion: Separatrix[Any]) -> Swing[Any]:
    ar: Any = motion.ar
    gaps, falls = motion.gaps, _direction(motion)
    sign = -1 if motion.b < 0 else 1
    offset = -falls * ar.asinh(ar.sqrt(gaps.u_u2 / gaps.u1_u))
    x, y = ar.sqrt(gaps.below_u2 / 2), ar.sqrt(gaps.above_u2 / 2)
    side = ar.sinh(offset) / ar.cosh(offset) if offset or x else -falls  # on the lower pole
    return Swing(offset, x, y, sign, ar.atan2(sign * y * side, x))


def nutating_sampler(motion: Nutating[Decimal]) -> ThetaSampler:
    """Return the sampler of a nutating top."""
    from ..arithmetic.sums_of_doubles import pair
    from .attitude import growths
    from .samplers import ThetaSampler

    ar: Any = motion.ar
    with ar.working():
        c = theta_constants(motion, periods_since_top(motion), _direction(motion))
        series = theta_series(ar, c)
        nearest = ar.nint(c.offset * 2)
        offset = c.offset * 2 - nearest
        frames = [series.frames[(nearest + i) % 2] for i in range(2)]
        return ThetaSampler(
            steps_per_time=pair(2 / c.period),
            offset=float(offset),
            max_time=float(int(MAX_PERIODS) * c.period),
            scale=float(series.scale),
            hyperbolic=series.hyperbolic,
            frames=[_rounded(ar, frame, series) for frame in frames],
            growths=growths(
                ar,
                rates=(motion.mean_spin_rate, motion.mean_precession_rate),
                slopes=(series.spin_slope, series.precession_slope),
                starts=evaluate(ar, series, frames[0], offset, c.rises)[1::2],
            ),
        )


def constant_sampler(motion: Constant[Decimal]) -> ConstantSampler:
    """Return the sampler of a constant tilt and constant rates."""
    from .attitude import growths
    from .samplers import ConstantSampler

    ar: Any = motion.ar
    with ar.working():
        rates = motion.mean_spin_rate, motion.state.psi_rate
        return ConstantSampler(
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
        swing, speed = _swing(motion), motion.argument_rate
        rates = motion.r0 - motion.b / 2, motion.b / 2
        return SeparatrixSampler(
            speed=float(speed),
            offset=float(swing.offset),
            x=float(swing.x),
            y=float(swing.y),
            sign=swing.sign,
            growths=growths(ar, rates, starts=(swing.start, 0 * swing.start)),
            max_time=_reach(max(map(abs, (*rates, speed)))),
        )


def _reach(rate: Decimal) -> float:
    return float(int(MAX_PERIODS) / rate) if rate else float("inf")


def _rounded(ar: Any, frame: Frame, series: Series) -> Frame:
    """Return the frame in doubles, without the coefficients that are too small to matter."""
    # sin^2 and sinh^2 are at most this where a step ends, half of `scale` from its middle
    greatest = ar.exp(series.scale) / 4 if series.hyperbolic else ar.convert(0.5)

    # X and Y may have any size in common: one that keeps the smallest and the largest in doubles
    parts = (frame.x.real, frame.x.imag, frame.y.real, frame.y.imag)
    size = ar.convert(2) ** math.frexp(float(max(abs(part[0]) for part in parts)))[1] / _SIZE

    def scaled(polynomial: Polynomial, size: Any) -> Polynomial:
        count = needed([abs(x) for x in polynomial], greatest, _NEGLIGIBLE)
        return [float(x / size) for x in polynomial[:count]]

    def component(c: Component) -> Component:
        return Component(scaled(c.real, size), scaled(c.imag, size), c.even)

    return Frame(component(frame.x), component(frame.y), scaled(frame.rate, size**4))


def needed(sizes: Sequence[Decimal], greatest: Decimal, negligible: Decimal) -> int:
    """Return how many coefficients, two at least, matter beside the first to an argument."""
    count = len(sizes)
    while count > 2 and sizes[count - 1] * greatest ** (count - 1) <= negligible * sizes[0]:
        count -= 1
    return count
