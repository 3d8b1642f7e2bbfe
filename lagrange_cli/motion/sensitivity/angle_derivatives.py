"""The angles of a top over time, and their derivatives by the parameters of its neighbourhood.

The angles of a nutating top are given by its theta series.  X and Y about a turning point are
polynomials in s = sin^2 z or sinh^2 z, with factors S and C (see `theta_series`).  Their
coefficients, and the constants of z = scale (2t/T + offset), are computed as dual numbers.  This
module stores them as rows of doubles, the value first and the derivatives below it.

Motions next to a steady precession are small nutations about a tilt next to it.  Let u = cos(theta)
= u0 + x.  To first order in x, the derivative of (4,9) by t is x'' = c1/2 - D x.  At the steady
precession itself c1 = 0 and D = a (u3 - u0).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from ...arithmetic.arrays import ARRAYS
from ...arithmetic.double_double import period_of, reduce_phase, whole_periods
from ...arithmetic.duals import Dual
from ...arithmetic.numbers import polynomial
from ...arithmetic.points import MAX_PERIODS
from ...arithmetic.rounding import Pair, pair
from ...arithmetic.types import Array
from ...elliptic.jacobi import jacobi
from ...elliptic.modulus import Modulus
from ..any_start import cubic
from ..gaps import State
from ..over_time.attitude import Growths, Times, growths
from ..over_time.series_constants import series_from_start
from ..over_time.theta_sampler import kept_frame
from ..over_time.theta_series import Coefficients, Component
from ..spin_precession import Nutating
from .neighbourhood import PARAMETERS, Neighbourhood

_NEGLIGIBLE = Fraction(1, 2**100)
_SMALL = 0.5


class Rows(NamedTuple):
    """Derivatives in rows, and the sizes of the summands of each."""

    slopes: Array
    sizes: Array

    @classmethod
    def of(cls, slopes: Array) -> Rows:
        """Return derivatives with a single summand."""
        return cls(slopes, abs(slopes))

    def __add__(self, other: Any) -> Rows:
        return Rows(self.slopes + other.slopes, self.sizes + other.sizes)

    def times(self, factor: Any, size: Array | None = None) -> Rows:
        """Return the product with a factor, whose summands may have a total `size`."""
        return Rows(self.slopes * factor, self.sizes * (abs(factor) if size is None else size))


class Polar(NamedTuple):
    """The squared modulus and the argument of X or Y, and their derivatives."""

    square: Array
    squares: Rows
    argument: Array
    arguments: Rows


class SeriesDerivatives:
    """Angles of a nutating top over time, and their derivatives by `PARAMETERS`."""

    def __init__(self, motion: Nutating[Dual], means: Nutating[Dual]) -> None:
        """Take the constants from a motion, and the mean rates from `means`."""
        ar: Any = motion.ar
        with ar.working():
            found = series_from_start(motion, rates=True)
            series, (x_start, y_start) = found.series, found.starts
            self.hyperbolic = series.hyperbolic
            self.frames = [
                kept_frame(frame, ar, series, _NEGLIGIBLE).mapped(
                    _rows, lambda row: [float(x) for x in row]
                )
                for frame in found.frames
            ]
            self.about_means = rates_about_means(motion, means, first_is_upper=found.first_is_upper)
            speed, step = 2 / motion.T_nutation, motion.T_nutation.value / 2
            rates = means.mean_spin_rate, means.mean_precession_rate
            slope_x, slope_y = series.slopes
            slopes = slope_x - slope_y, slope_x + slope_y
            self.speed = float(speed.value)
            self.step = period_of(pair(step), self.speed)
            self.speeds, self.offsets, self.scales = map(_row, (speed, found.offset, series.scale))
            self.rates, self.slopes = (np.array([_row(x) for x in y]) for y in (rates, slopes))
            starts = x_start - y_start, x_start + y_start
            self.starts = np.array(
                [
                    _row(start + found.offset * ar.fixed(slope))  # of the phase at t = 0
                    for start, slope in zip(starts, slopes, strict=True)
                ]
            )
            self.growths: Growths = growths(ar.plain, (rates[0].value, rates[1].value))
            self.max_time = float(int(MAX_PERIODS) * motion.T_nutation.value)

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Return tilt, spin and precession at times, and their derivatives by the parameters.

        The last array has the sum of the sizes of the summands of each derivative; its error is a
        few eps of the sum.  The shapes are (3, times), and (3, parameters, times) for both others.
        """
        farthest, space = float(np.max(np.abs(t), initial=0.0)), np.empty((3, t.size))
        step, since, lost = whole_periods(t, self.step, farthest, space, self.offsets[0])
        since = (since - lost) * self.speed
        phase, times = since + self.offsets[0], Times(t, farthest, space[2:])
        x, y = (self._polar(i, step, phase) for i in range(2))
        moved = Rows.of(np.multiply.outer(self.speeds[1:], t)) + Rows.of(self.offsets[1:, None])
        *gains, size = self._rates(step, phase, x.square, y.square)
        both = np.sqrt(x.square * y.square) * (x.square + y.square)
        angles = np.empty((3, t.size))
        angles[0] = 2.0 * np.arctan2(np.sqrt(y.square), np.sqrt(x.square))
        tilt = y.squares.times(x.square / both) + x.squares.times(-y.square / both)
        found = [tilt + moved.times(gains[0])]
        for i, growth in enumerate((self.growths.phi, self.growths.psi)):
            sign = (-1, 1)[i]
            periodic = x.argument + sign * y.argument + self.slopes[i, 0] * phase
            angles[i + 1] = growth.unwrapped(periodic - self.starts[i, 0], times)
            wound = np.multiply.outer(self.slopes[i, 1:], since) - self.starts[i, 1:, None]
            grown = np.multiply.outer(self.rates[i, 1:], t)
            rows = x.arguments + y.arguments.times(sign) + Rows.of(wound) + Rows.of(grown)
            found.append(rows + moved.times(gains[i + 1], size))
        derivatives, sizes = (np.array(part) for part in zip(*found, strict=True))
        return angles, derivatives, sizes

    def _rates(self, step: Array, phase: Array, x2: Array, y2: Array) -> list[Array]:
        """Return the rates of tilt, spin and precession per step, without the mean rates.

        The last array has the sizes of the summands of the rates of spin and precession.  The rates
        are computed from the width of the nutation, so that they keep their digits if it is small.
        """
        z = phase * self.scales[0]
        S, C = (np.sinh(z), np.cosh(z)) if self.hyperbolic else (np.sin(z), np.cos(z))
        odd = np.remainder(step, 2.0) != 0
        even_rate, odd_rate = (polynomial(frame.rate, S * S) for frame in self.frames)
        rate = np.where(odd, odd_rate, even_rate) * S * C
        norm = x2 + y2
        theta = rate / (2.0 * norm * np.sqrt(x2 * y2))
        spinning = self.about_means(phase, odd, 2.0 * x2 / norm, 2.0 * y2 / norm)
        return [gain / self.speed for gain in (theta, *spinning)]

    def _polar(self, which: int, step: Array, phase: Array) -> Polar:
        """Return X (0) or Y (1) with its derivatives at a fixed phase."""
        z = phase * self.scales[0]
        dz = Rows.of(np.multiply.outer(self.scales[1:], phase))
        odd = np.remainder(step, 2.0) != 0
        values, slopes, sizes = np.empty((2, z.size)), *np.empty((2, 2, *dz.slopes.shape))
        for rows, frame in ((~odd, self.frames[0]), (odd, self.frames[1])):
            parts = _component((frame.x, frame.y)[which], z[rows], self.hyperbolic)
            for i, (at_phase, slope) in enumerate(parts):
                turned = Rows(dz.slopes[:, rows], dz.sizes[:, rows]).times(slope)
                values[i, rows] = at_phase[0]
                slopes[i][:, rows], sizes[i][:, rows] = Rows.of(at_phase[1:]) + turned
        (re, im), dre, dim = values, *(Rows(*pair) for pair in zip(slopes, sizes, strict=True))
        square = re * re + im * im
        return Polar(
            square,
            dre.times(2.0 * re) + dim.times(2.0 * im),
            np.arctan2(im, re),
            dim.times(re / square) + dre.times(-im / square),
        )


def _component(component: Component, z: Array, hyperbolic: bool) -> list[tuple[Array, Array]]:
    """Return real and imaginary parts, each in rows and with its derivative by z."""
    S, C = (np.sinh(z), np.cosh(z)) if hyperbolic else (np.sin(z), np.cos(z))
    s, rising, curvature = S * S, 2.0 * S * C, 1.0 if hyperbolic else -1.0
    factors = (C, curvature * S), (S, C)
    if component.even:
        factors = (np.ones_like(z), np.zeros_like(z)), (S * C, C * C + curvature * s)
    parts = []
    both: Any = component.real, component.imag
    for coefficients, (factor, slope) in zip(both, factors, strict=True):
        powers = s ** np.arange(coefficients.shape[1])[:, None]
        rows = coefficients @ powers
        growing = coefficients[0, 1:] * np.arange(1, coefficients.shape[1]) @ powers[:-1]
        parts.append((factor * rows, slope * rows[0] + factor * growing * rising))
    return parts


def _row(x: Dual) -> Array:
    """Return the value and the derivatives of a number as doubles."""
    return np.array([float(x), *map(float, x.partials or [0.0] * len(PARAMETERS))])


def _rows(coefficients: Coefficients) -> Array:
    return np.array([_row(x) for x in coefficients]).T


def rates_about_means(
    motion: Nutating[Dual], means: Nutating[Dual], *, first_is_upper: bool
) -> Callable[..., tuple[Array, Array, Array]]:
    """Return the rates of spin and precession about their means, from the distances to u1 and u2.

    The result is a function of the phase, of the mask of odd steps, of 1 + u and of 1 - u.  It
    returns both rates minus their means, and the size of their summands.  The turning point of the
    even steps is u1 if `first_is_upper`.  Constants are rounded from many digits.
    """
    gaps = motion.gaps
    plus, minus = gaps.beta_plus_b.value / 2, gaps.beta_minus_b.value / 2
    drift = means.mean_spin_rate.value - motion.state.pole_drift.value
    precession, width = means.mean_precession_rate.value, gaps.u1_u2.value
    at_u1, at_u2 = plus / gaps.below_u1.value, minus / gaps.above_u2.value
    # over 1 + u and 1 - u: the changes of both parts of the precession rate from u1 and from u2
    from_u1, from_u2 = float(at_u1 * width), float(at_u2 * width)
    # the parts at u1 and at u2, less their means
    south_at_u1 = float(at_u1 - (precession + drift) / 2)
    north_at_u2 = float(at_u2 - (precession - drift) / 2)
    quarter = float(motion.K.value)
    modulus = Modulus(float(motion.k.value), float(motion.k_prime.value))

    def rates(phase: Array, odd: Array, below: Array, above: Array) -> tuple[Array, Array, Array]:
        _, sn, cn, dn = jacobi(ARRAYS, phase * quarter, modulus)
        away = sn * sn  # (u - u2)/(u1 - u2) about u2, and cn^2 its complement
        mirrored = (modulus.k_prime * sn / dn) ** 2
        upper = odd != first_is_upper
        under_u1 = np.where(upper, mirrored, cn * cn)
        over_u2 = np.where(upper, (cn / dn) ** 2, away)
        south, north = from_u1 * under_u1 / below, from_u2 * over_u2 / above
        size = abs(south) + abs(north) + abs(south_at_u1) + abs(north_at_u2)
        south, north = south + south_at_u1, north + north_at_u2
        return south - north, south + north, size

    return rates


class SteadyDerivatives:
    """Angles of a steady precession over time, and their derivatives by `PARAMETERS`."""

    def __init__(self, near: Neighbourhood) -> None:
        ar = near.ar.middles
        with ar.working():
            state = State(*(x.middle for x in near.moved))
            _, c1, c2 = cubic(state)
            self.force = _row(c1)[1:] / 2
            frequency = ar.plain.sqrt(-c2.value)
            self.frequency = float(frequency)
            self.turns = pair(frequency / (2 * ar.plain.pi))
            self.sine, self.cosine, self.psi_rate, self.b = (
                float(x.value) for x in (state.sin, state.cos, state.psi_rate, state.b)
            )
            self.tilt = 2 * math.atan2(float(state.sin_half.value), float(state.cos_half.value))
            self.tilts = -_row(state.cos)[1:] / self.sine
            self.speeds = -self.sine * _row(state.theta_rate)[1:]
            self.r0s, self.psi_rates = _row(state.r0)[1:], _row(state.psi_rate)[1:]
            self.spin_rate = float((state.r0 - state.psi_rate * state.cos).value)
        rate = max(abs(self.spin_rate), abs(self.psi_rate), self.frequency)
        self.max_time = int(MAX_PERIODS) / rate if rate else math.inf

    def at(self, t: Array) -> tuple[Array, Array]:
        """Return tilt, spin and precession at times, and their derivatives by the parameters.

        The shapes are (3, times) and (3, parameters, times).
        """
        sine, one_less_cosine, rest = oscillation(self.frequency, self.turns, t)
        x = np.outer(self.force, one_less_cosine) + np.outer(self.speeds, sine)
        passed = np.outer(self.force, rest) + np.outer(self.speeds, one_less_cosine)
        answer = (2 * self.cosine * self.psi_rate - self.b) / self.sine**2  # of psi' to x
        psi = np.outer(self.psi_rates, t) + answer * passed
        turned = passed - np.outer(self.sine * self.tilts, t)  # the integral of the change of u
        phi = np.outer(self.r0s, t) - self.psi_rate * turned - self.cosine * psi
        angles = np.array([np.full_like(t, self.tilt), self.spin_rate * t, self.psi_rate * t])
        return angles, np.array([self.tilts[:, None] - x / self.sine, phi, psi])


def oscillation(frequency: float, turns: Pair, t: Array) -> tuple[Array, Array, Array]:
    """Return sin(wt)/w, (1 - cos(wt))/w^2 and (wt - sin(wt))/w^3, or their limits for w = 0.

    `turns` is w/2 pi as a pair of doubles, so that whole turns are subtracted exactly.
    """
    if not frequency:
        return t, t * t / 2, t**3 / 6
    x = frequency * t
    within = 2 * np.pi * reduce_phase(t, turns)[1]
    sine, half = np.sin(within), np.sin(within / 2)
    rest = x - sine
    near = np.abs(x) < _SMALL
    square = x[near] ** 2
    series = np.ones_like(square)
    for n in (14, 12, 10, 8, 6, 4):
        series = 1 - square / (n * (n + 1)) * series
    rest[near] = x[near] ** 3 / 6 * series
    return sine / frequency, 2 * half * half / frequency**2, rest / frequency**3
