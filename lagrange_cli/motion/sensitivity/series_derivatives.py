"""The theta series of a nutating top and its derivatives by the parameters of its neighbourhood.

X and Y about a turning point are polynomials in s, s = sin^2 z or sinh^2 z, with factors S and C
(see `theta_series`).  Their coefficients, and what z = scale (2t/T + offset) is made of, are dual
numbers; here they are rows of doubles, the value first and below it the derivatives.
"""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any, NamedTuple

import numpy as np

from ...arithmetic.double_double import period_of, whole_periods
from ...arithmetic.duals import Dual
from ...arithmetic.points import MAX_PERIODS
from ...arithmetic.rounding import pair
from ...arithmetic.types import Array
from ..kinds import Nutating
from ..over_time.attitude import Growths, Times, growths
from ..over_time.multiple_angles import Coefficients
from ..over_time.series_constants import (
    SeriesFromStart,
    direction,
    greatest_argument,
    needed,
    periods_since_top,
    series_from_start,
    theta_constants,
)
from ..over_time.theta_series import Component
from .neighbourhood import PARAMETERS
from .rates_about_means import RatesAboutMeans

_NEGLIGIBLE = Decimal(2) ** -100


class Rows(NamedTuple):
    """X or Y about one turning point, its coefficients in rows."""

    real: Array
    imag: Array
    even: bool


class Polar(NamedTuple):
    """The squared modulus and the argument of X or Y, and their derivatives in rows.

    The sizes are those of the parts that the derivatives are sums of.
    """

    square: Array
    squares: Array
    square_sizes: Array
    argument: Array
    arguments: Array
    argument_sizes: Array


class SeriesDerivatives:
    """Angles of a nutating top over time, and their derivatives by `PARAMETERS`."""

    def __init__(self, motion: Nutating[Dual], means: Nutating[Dual]) -> None:
        """Take the constants from a motion, the mean rates from `means`."""
        ar: Any = motion.ar
        with ar.working():
            constants = theta_constants(
                motion, periods_since_top(motion), direction(motion), rates=True
            )
            found = series_from_start(ar, constants)
            series, (x_start, y_start) = found.series, found.starts
            self.hyperbolic = series.hyperbolic
            self.frames, self.rates_of_tilt = _in_doubles(ar, found)
            self.about_means = RatesAboutMeans.of(
                motion, means, first_is_upper=found.first_is_upper
            )
            speed, step = 2 / constants.period, constants.period.value / 2
            rates = means.mean_spin_rate, means.mean_precession_rate
            slopes = series.spin_slope, series.precession_slope
            self.speed = float(speed.value)
            self.step = period_of(pair(step), self.speed)
            self.speeds, self.offsets, self.scales = map(_row, (speed, found.offset, series.scale))
            self.rates, self.slopes = (np.array([_row(x) for x in y]) for y in (rates, slopes))
            starts = x_start - y_start, x_start + y_start
            self.starts = np.array(
                [
                    _row(start + found.offset * Dual(_decimal(slope)))  # of the phase at t = 0
                    for start, slope in zip(starts, slopes, strict=True)
                ]
            )
            self.growths: Growths = growths(ar.plain, (rates[0].value, rates[1].value))
            self.max_time = float(int(MAX_PERIODS) * constants.period.value)

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Return tilt, spin and precession at times, and their derivatives by the parameters.

        Last come the sums of the sizes of the parts of each derivative: it is wrong by some eps of
        these.  The shapes are (3, times) and, of the others, (3, parameters, times).
        """
        farthest, space = float(np.max(np.abs(t), initial=0.0)), np.empty((3, t.size))
        step, since, lost = whole_periods(t, self.step, farthest, space, self.offsets[0])
        since = (since - lost) * self.speed
        phase, times = since + self.offsets[0], Times(t, farthest, space[2:])
        moved = np.multiply.outer(self.speeds[1:], t)
        x, y = (self._polar(i, step, phase) for i in range(2))
        dphase = moved + self.offsets[1:, None]
        rates = self._rates(step, phase, x.square, y.square)
        angles = np.empty((3, t.size))
        derivatives, sizes = np.empty((2, 3, len(PARAMETERS), t.size))
        dsize = abs(moved) + abs(self.offsets[1:, None])
        angles[0] = 2.0 * np.arctan2(np.sqrt(y.square), np.sqrt(x.square))
        both = np.sqrt(x.square * y.square) * (x.square + y.square)
        derivatives[0] = (x.square * y.squares - y.square * x.squares) / both + rates[0] * dphase
        sizes[0] = (x.square * y.square_sizes + y.square * x.square_sizes) / both
        sizes[0] += abs(rates[0]) * dsize
        series = x.argument - y.argument, x.argument + y.argument
        slopes = x.arguments - y.arguments, x.arguments + y.arguments
        for i, growth in enumerate((self.growths.phi, self.growths.psi)):
            periodic = series[i] + self.slopes[i, 0] * phase - self.starts[i, 0]
            angles[i + 1] = growth.unwrapped(periodic, times)
            grown = np.multiply.outer(self.rates[i, 1:], t)
            wound = np.multiply.outer(self.slopes[i, 1:], since) - self.starts[i, 1:, None]
            derivatives[i + 1] = slopes[i] + wound + grown + rates[i + 1] * dphase
            sizes[i + 1] = x.argument_sizes + y.argument_sizes + abs(wound) + abs(grown)
            sizes[i + 1] += rates[3] * dsize
        return angles, derivatives, sizes

    def _rates(self, step: Array, phase: Array, x2: Array, y2: Array) -> list[Array]:
        """Return what tilt, spin and precession gain per step, of the latter less the mean growth.

        Last comes the size of the parts of the latter.  Formed from the width of the nutation, they
        keep their digits where that is small.
        """
        z = phase * self.scales[0]
        S, C = (np.sinh(z), np.cosh(z)) if self.hyperbolic else (np.sin(z), np.cos(z))
        odd = np.remainder(step, 2.0) != 0
        rate = np.where(odd, *(_value(part, S * S) for part in self.rates_of_tilt[::-1])) * S * C
        norm = x2 + y2
        theta = rate / (2.0 * norm * np.sqrt(x2 * y2))
        spinning = self.about_means.at(phase, odd, 2.0 * x2 / norm, 2.0 * y2 / norm)
        return [gain / self.speed for gain in (theta, *spinning)]

    def _polar(self, which: int, step: Array, phase: Array) -> Polar:
        """Return X (0) or Y (1) with its derivatives at a fixed phase."""
        z = phase * self.scales[0]
        dz = np.multiply.outer(self.scales[1:], phase)
        odd = np.remainder(step, 2.0) != 0
        real, imag, real_size, imag_size = np.empty((4, len(dz) + 1, z.size))
        for rows, frame in ((~odd, self.frames[0]), (odd, self.frames[1])):
            parts = _component(frame[which], z[rows], self.hyperbolic)
            wholes = (real, real_size), (imag, imag_size)
            for (whole, size), (values, slope) in zip(wholes, parts, strict=True):
                turned = slope * dz[:, rows]
                size[:, rows] = abs(values)
                size[1:, rows] += abs(turned)
                values[1:] += turned
                whole[:, rows] = values
        square = real[0] * real[0] + imag[0] * imag[0]
        return Polar(
            square,
            2.0 * (real[0] * real[1:] + imag[0] * imag[1:]),
            2.0 * (real_size[0] * real_size[1:] + imag_size[0] * imag_size[1:]),
            np.arctan2(imag[0], real[0]),
            (real[0] * imag[1:] - imag[0] * real[1:]) / square,
            (real_size[0] * imag_size[1:] + imag_size[0] * real_size[1:]) / square,
        )


def _in_doubles(ar: Any, found: SeriesFromStart) -> tuple[list[tuple[Rows, Rows]], list[Array]]:
    """Return X and Y, and the rate of the tilt, about both turning points as rows of doubles.

    Coefficients that are too small to matter are left out.
    """
    greatest = greatest_argument(ar, found.series).value
    leading = max(abs(c.real[0].value) for frame in found.frames for c in frame[:2])
    size = Decimal(2) ** math.frexp(float(leading))[1]

    def component(c: Component) -> Rows:
        parts = (_kept(part, greatest) for part in (c.real, c.imag))
        real, imag = (_rows([x / Dual(size) for x in part]) for part in parts)
        return Rows(real, imag, c.even)

    def rate(coefficients: Coefficients) -> Array:
        return np.array([float(x.value / size**4) for x in _kept(coefficients, greatest)])

    frames = [(component(frame.x), component(frame.y)) for frame in found.frames]
    return frames, [rate(frame.rate) for frame in found.frames]


def _component(component: Rows, z: Array, hyperbolic: bool) -> list[tuple[Array, Array]]:
    """Return real and imaginary part, each in rows and with its derivative by z."""
    S, C = (np.sinh(z), np.cosh(z)) if hyperbolic else (np.sin(z), np.cos(z))
    s, rising, curvature = S * S, 2.0 * S * C, 1.0 if hyperbolic else -1.0
    factors = (C, curvature * S), (S, C)
    if component.even:
        factors = (np.ones_like(z), np.zeros_like(z)), (S * C, C * C + curvature * s)
    parts = []
    for coefficients, (factor, slope) in zip(component[:2], factors, strict=True):
        powers = s ** np.arange(coefficients.shape[1])[:, None]
        rows = coefficients @ powers
        growing = coefficients[0, 1:] * np.arange(1, coefficients.shape[1]) @ powers[:-1]
        parts.append((factor * rows, slope * rows[0] + factor * growing * rising))
    return parts


def _kept(polynomial: Coefficients, greatest: Decimal) -> Coefficients:
    """Return the coefficients that matter beside the first, up to the greatest argument."""
    sizes = [abs(x.value) for x in polynomial]
    return polynomial[: needed(sizes, greatest, _NEGLIGIBLE)]


def _rows(polynomial: Coefficients) -> Array:
    """Return coefficients as columns of their value and derivatives."""
    return np.array([_row(x) for x in polynomial]).T


def _row(x: Dual | Decimal) -> Array:
    """Return the value and the derivatives of a number as doubles."""
    partials = x.partials if isinstance(x, Dual) else None
    none = [Decimal(0)] * len(PARAMETERS)
    return np.array([float(_decimal(x)), *map(float, partials or none)])


def _value(polynomial: Array, s: Array) -> Array:
    return np.asarray(np.polynomial.polynomial.polyval(s, polynomial), dtype=float)


def _decimal(x: Any) -> Decimal:
    return x.value if isinstance(x, Dual) else Decimal(x)
