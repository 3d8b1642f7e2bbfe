"""From a kind of motion to its attitude as a function of time, in the arithmetic of the motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Generic, NamedTuple

from ...arithmetic.numbers import R
from ..kinds import Constant, Kind, Nutating, Separatrix
from .series_constants import direction, periods_since_top, separatrix_constants, theta_constants
from .theta_series import ThetaConstants, evaluate, theta_series


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
    tilting: R
    """A number that has the sign of the nutation rate."""


Spinor = Callable[[R], Attitude[R]]
"""The attitude as a function of time."""


def spinor_of(motion: Kind[R]) -> Spinor[R]:
    """Return the attitude of a motion as a function of time, in its arithmetic."""
    if isinstance(motion, Nutating):
        return nutating_spinor(motion)
    return separatrix_spinor(motion) if isinstance(motion, Separatrix) else constant_spinor(motion)


def nutating_spinor(motion: Nutating[R]) -> Spinor[R]:
    """Return the attitude of a nutating top by its theta series."""
    ar: Any = motion.ar
    with ar.working():
        constants = theta_constants(motion, periods_since_top(motion), direction(motion))
        series = theta_series(ar, constants, _terms(ar, constants))

    def position(t: R) -> tuple[int, R, tuple[R, R, R, R]]:
        passed = (t / constants.period + constants.offset) * 2
        step = ar.nint(passed)
        phase = passed - step
        odd = step % 2
        return odd, phase, evaluate(ar, series, series.frames[odd], phase, constants.rises)

    with ar.working():
        _, since_first, (_, x_start, _, y_start) = position(0 * motion.K)
        rates = motion.mean_spin_rate, motion.mean_precession_rate

    def spinor(t: R) -> Attitude[R]:
        with ar.working():
            odd, phase, (x, arg_x, y, arg_y) = position(t)
            within = phase - since_first
            plus, minus = arg_x - x_start, arg_y - y_start
            phi = t * rates[0] + within * series.spin_slope + (plus - minus)
            psi = t * rates[1] + within * series.precession_slope + (plus + minus)
            if motion.facts.plane:
                phi, psi = _half_turns(ar, phi), _half_turns(ar, psi)
            return Attitude(x, y, phi, psi, -phase if odd else phase)

    return spinor


def _terms(ar: Any, c: ThetaConstants) -> int:
    """Return how many terms of the series matter.

    The nome is exp(-pi r), where r is the larger of K'/K and K/K'; the last term has at least the
    digits' logarithm over that of the nome in its exponent.
    """
    if c.quarter_prime is None:  # a nome of 0
        return 2
    K, K_prime = c.quarter, c.quarter_prime
    hundredths = max(ar.nint(100 * (x / y)) for x, y in ((K, K_prime), (K_prime, K)))
    return 2 + math.isqrt(int(ar.digits * math.log(10) / math.pi * 100 / hundredths))


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
            return Attitude(state.cos_half, state.sin_half, phi, psi, 0 * t)

    return spinor


def separatrix_spinor(motion: Separatrix[R]) -> Spinor[R]:
    """Return the attitude on the separatrix: 1 - u = (1 - u2)/cosh^2 h, h = speed t + offset."""
    ar: Any = motion.ar
    with ar.working():
        swing = separatrix_constants(motion)

    def spinor(t: R) -> Attitude[R]:
        with ar.working():
            h = motion.argument_rate * t + swing.offset
            sinh, cosh = ar.sinh(h), ar.cosh(h)
            real, imag = swing.x * cosh, swing.sign * swing.y * sinh
            turned = ar.atan2(imag, real) - swing.start if t else 0 * t
            half_b = motion.b * t / 2
            phi, psi = motion.r0 * t - half_b + turned, half_b + turned
            if motion.facts.plane:
                phi, psi = _half_turns(ar, phi), _half_turns(ar, psi)
            x = ar.sqrt(real * real + imag * imag)
            return Attitude(x, swing.y, phi, psi, -h)

    return spinor
