"""The constants of the series of a motion, and its attitude as a function of time.

Both are computed in the arithmetic of the motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Generic, NamedTuple

from ...arithmetic.numbers import R
from ...elliptic.complete import place
from ..kinds import Constant, Kind, Separatrix
from ..spin_precession import Nutating
from .theta_series import (
    TERMS,
    Component,
    Frame,
    Series,
    SquaredRatio,
    ThetaConstants,
    theta_series,
)


def theta_constants(motion: Nutating[R], *, rates: bool = False) -> ThetaConstants:
    """Return the constants of the theta series of a nutating top.

    The parameter of X, with modulus k', has `sn^2 = (1 + u2)/(1 + u1)` and `cn^2 = (u1 - u2)/(1 +
    u1)`.  The parameter of Y has `sn^2 = (1 - u1)(u3 - u2)/((u3 - u1)(1 - u2))` and `cn^2 = (u3 -
    1)(u1 - u2)/((u3 - u1)(1 - u2))`.
    """
    ar, gaps, facts = motion.ar, motion.gaps, motion.facts
    with ar.working():
        squares = motion.K * motion.K * motion.k_prime * motion.k_prime
        return ThetaConstants(
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
            nutation=8 * squares * gaps.u1_u2 / (ar.pi * motion.T_nutation) if rates else None,
        )


def periods_since_top(motion: Nutating[R]) -> R:
    """Return w/2K for the argument w of (4,22)-(4,24) at t = 0, with the sign of theta'.

    Here `sn^2 w = (u1 - u)(u3 - u2)/((u3 - u)(u1 - u2))` and, counted from u2, `sn^2 = (u - u2)/(u1
    - u2)`. Both are expressed by sin(theta) theta', the square root of a (u1 - u) (u - u2) (u3 -
    u). It is smooth at the turning points, and 0 there.
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


def phase_at_start(motion: Nutating[R]) -> R:
    """Return the periods from the nearest passage of u1 to t = 0, in (-1/2, 1/2]."""
    with motion.ar.working():
        since = periods_since_top(motion)
        return since - 1 if motion.state.theta_rate < 0 < since else since


def direction(motion: Kind[R]) -> int:
    """Return the sign of the nutation rate at t = 0, or 1 if the rate is 0."""
    return -1 if motion.state.theta_rate < 0 else 1


def evaluate(
    ar: Any, series: Series, frame: Frame, phase: Any, rises: int
) -> tuple[Any, Any, Any, Any]:
    """Return |X|, arg X, |Y| and arg Y about a turning point, in many digits.

    On the upper pole Y = 0.  Its argument is then the limit from later times if the tilt `rises`,
    else from earlier times.  On the lower pole, where X = 0, the limits are exchanged.
    """
    z = phase * series.scale
    S, C = (ar.sinh(z), ar.cosh(z)) if series.hyperbolic else (ar.sin(z), ar.cos(z))

    def polar(c: Component, side: int) -> tuple[Any, Any]:
        real, imag = c.at(S, C)
        along = imag if real or S else side * c.imag[0]  # on the pole: the limit
        return ar.sqrt(real * real + imag * imag), ar.atan2(along, real)

    return *polar(frame.x, -rises), *polar(frame.y, rises)


class SeriesFromStart(NamedTuple):
    """The theta series of a motion, counted from the turning point nearest to its start."""

    series: Series
    frames: list[Frame]
    """The series about that turning point and about the other one."""
    first_is_upper: bool
    """Whether that turning point is u1."""
    offset: Any
    """Steps of half a period from that turning point to the start, from -1/2 to 1/2."""
    starts: tuple[Any, Any]
    """The arguments of X and Y at the start."""


def series_from_start(
    motion: Nutating[Any], *, proved: bool = False, rates: bool = False
) -> SeriesFromStart:
    """Return the series of a motion, counted from the turning point nearest to its start.

    The series have the terms that doubles need or, if `proved`, all digits.
    """
    ar: Any = motion.ar
    c = theta_constants(motion, rates=rates)
    series = theta_series(ar, c, _terms(ar, c) if proved else TERMS)
    steps = periods_since_top(motion) * 2
    nearest = ar.nint(steps)
    offset = steps - nearest
    frames = [series.frames[(nearest + i) % 2] for i in range(2)]
    _, x_start, _, y_start = evaluate(ar, series, frames[0], offset, direction(motion))
    return SeriesFromStart(series, frames, nearest % 2 == 0, offset, (x_start, y_start))


class SeparatrixConstants(NamedTuple, Generic[R]):
    """The constants of a motion on the separatrix, about its lowest point."""

    offset: R
    """The argument h at t = 0."""
    x: R
    """cos(theta_max/2)."""
    y: R
    """sin(theta_max/2)."""
    sign: float
    """Sign of b."""
    start: R
    """arg X at t = 0."""


def separatrix_constants(motion: Separatrix[Any]) -> SeparatrixConstants[Any]:
    """Return the constants of a motion on the separatrix, about its lowest point."""
    ar: Any = motion.ar
    gaps, falls = motion.gaps, direction(motion)
    sign = -1 if motion.b < 0 else 1
    offset = 0 * gaps.u_u2  # exactly 0 at the lowest point
    if gaps.u_u2:
        offset = -falls * ar.asinh(ar.sqrt(gaps.u_u2 / gaps.u1_u))
    x, y = ar.sqrt(gaps.below_u2 / 2), ar.sqrt(gaps.above_u2 / 2)
    side = ar.sinh(offset) / ar.cosh(offset) if offset or x else -falls  # on the lower pole
    return SeparatrixConstants(offset, x, y, sign, ar.atan2(sign * y * side, x))


class Swing(NamedTuple, Generic[R]):
    """The motion of the tilt on the separatrix: u = u2 + (1 - u2) tanh^2(rate (t - lowest))."""

    rate: R
    """Rate of the argument, in radians per unit of time."""
    lowest: R
    """Time at which the axis is lowest."""


def swing_of(motion: Separatrix[Any]) -> Swing[Any]:
    """Return the swing of a motion on the separatrix."""
    with motion.ar.working():
        rate = motion.argument_rate
        return Swing(rate, -separatrix_constants(motion).offset / rate)


class Pose(NamedTuple, Generic[R]):
    """The attitude at one time."""

    x: R
    """cos(theta/2), up to a factor common with y."""
    y: R
    """sin(theta/2), up to that factor."""
    phi: R
    """Spin, unwrapped from 0 at t = 0."""
    psi: R
    """Precession, unwrapped from 0 at t = 0."""
    tilting: R
    """A number with the sign of the nutation rate."""


def pose_of(motion: Kind[R]) -> Callable[[R], Pose[R]]:
    """Return the attitude of a motion as a function of time, in its arithmetic."""
    ar: Any = motion.ar
    with ar.working():
        if isinstance(motion, Nutating):
            pose = _nutating_pose(motion)
        elif isinstance(motion, Separatrix):
            pose = _separatrix_pose(motion)
        else:
            pose = _constant_pose(motion)

    def at(t: R) -> Pose[R]:
        with ar.working():
            found = pose(t)
            if not motion.facts.plane:
                return found
            # in a plane an angle changes only at the poles, by half turns
            phi, psi = (ar.pi * ar.nint(angle / ar.pi) for angle in (found.phi, found.psi))
            return found._replace(phi=phi, psi=psi)

    return at


def _nutating_pose(motion: Nutating[R]) -> Callable[[R], Pose[R]]:
    """Return the attitude of a nutating top by its theta series."""
    ar: Any = motion.ar
    found = series_from_start(motion, proved=True)
    series = found.series

    def pose(t: R) -> Pose[R]:
        passed = t / motion.T_nutation * 2 + found.offset
        step = ar.nint(passed)
        phase, frame = passed - step, found.frames[step % 2]
        x, arg_x, y, arg_y = evaluate(ar, series, frame, phase, direction(motion))
        plus, minus = (
            (phase - found.offset) * slope + (arg - start)
            for slope, arg, start in zip(series.slopes, (arg_x, arg_y), found.starts, strict=True)
        )
        phi = t * motion.mean_spin_rate + (plus - minus)
        psi = t * motion.mean_precession_rate + (plus + minus)
        about_u1 = found.first_is_upper == (step % 2 == 0)
        return Pose(x, y, phi, psi, phase if about_u1 else -phase)

    return pose


def _terms(ar: Any, c: ThetaConstants) -> int:
    """Return the number of terms of the series that are needed.

    The nome is exp(-pi r), where r is the larger of K'/K and K/K'. The exponent of the last term is
    at least the logarithm of the precision over the logarithm of the nome.
    """
    if c.quarter_prime is None:  # a nome of 0
        return 2
    K, K_prime = c.quarter, c.quarter_prime
    hundredths = max(ar.nint(100 * (x / y)) for x, y in ((K, K_prime), (K_prime, K)))
    return 2 + math.isqrt(int(ar.digits * math.log(10) / math.pi * 100 / hundredths))


def _constant_pose(motion: Constant[R]) -> Callable[[R], Pose[R]]:
    """Return the attitude for a constant tilt and constant rates."""
    state = motion.state

    def pose(t: R) -> Pose[R]:
        phi, psi = motion.mean_spin_rate * t, state.psi_rate * t
        return Pose(state.cos_half, state.sin_half, phi, psi, 0 * t)

    return pose


def _separatrix_pose(motion: Separatrix[R]) -> Callable[[R], Pose[R]]:
    """Return the attitude on the separatrix: 1 - u = (1 - u2)/cosh^2 h, h = speed t + offset."""
    ar: Any = motion.ar
    swing = separatrix_constants(motion)

    def pose(t: R) -> Pose[R]:
        h = motion.argument_rate * t + swing.offset
        real, imag = swing.x, swing.sign * swing.y * ar.tanh(h)
        turned = ar.atan2(imag, real) - swing.start if t else 0 * t
        half_b = motion.b * t / 2
        phi, psi = motion.r0 * t - half_b + turned, half_b + turned
        x = ar.sqrt(real * real + imag * imag)
        return Pose(x, swing.y * ar.sech(h), phi, psi, -h)

    return pose
