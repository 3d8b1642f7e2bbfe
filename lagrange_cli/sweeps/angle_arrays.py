"""Angles of many tops over time: the constants of their theta series as arrays, and the sampling.

The constants are computed in pairs of doubles by the formulas of `motion`, and rounded once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import PAIRS
from ..arithmetic.double_double import DoubleDouble, reduce_phase
from ..arithmetic.sums_of_doubles import Pair, Triple
from ..arithmetic.types import Array, Mask
from ..arithmetic.workspace import Workspace
from ..elliptic.carlson import carlson_rf
from ..elliptic.landen import cosine_and_sine, hyperbolic_cosine_and_sine
from ..motion.attitude import Attitude, Growth, Growths, Spinor
from ..motion.kinds import Nutating
from ..motion.series_constants import theta_constants
from ..motion.theta_series import Component, Frame, Series, circular_series, hyperbolic_series
from .pair_motions import PairMotions, Start


@dataclass(frozen=True)
class ArraySampler:
    """The theta series of many tops that all run in the same nome; each constant is a column."""

    steps_per_time: Pair
    offset: Array
    first: Mask
    """Whether the phase of t = 0 is counted from a passage of u2."""
    scale: Array
    hyperbolic: bool
    frames: list[Frame]
    """The coefficients of all tops, about u1 and about u2."""
    growths: Growths

    def part(self, rows: slice) -> ArraySampler:
        """Return the constants of some tops."""
        constants = {name: _mapped(x, lambda array: array[rows]) for name, x in vars(self).items()}
        return ArraySampler(**constants)

    def attitude(self, t: Array, space: Workspace) -> Attitude:
        """Return the attitude at times, a row per top, in arrays of a workspace of that shape."""
        step, since = reduce_phase(t, self.steps_per_time, self.offset, space)
        half = np.multiply(step, 0.5, out=space.new())
        odd = np.rint(half, out=step) != half
        argument = np.add(since, self.offset, out=half)
        argument *= self.scale
        upper = odd == self.first
        spinor = self._spinor(argument, upper, space)
        return Attitude(self.growths, space, slice(None), t, since, spinor)

    def _spinor(self, argument: Array, upper: Mask, space: Workspace) -> Spinor:
        """Return X and Y; `upper` says which phases are counted from u1."""
        S = np.sinh(argument) if self.hyperbolic else np.tan(argument)
        square = S * S
        C = np.sqrt(square + 1.0) if self.hyperbolic else None
        if C is None:
            square /= square + 1.0
        rows = np.arange(argument.shape[0])[:, None]
        place = rows + np.where(upper, 0, argument.shape[0])

        def polar(one: Component, other: Component) -> tuple[Array, Array]:
            real = _polynomials(one.real, other.real, place, square)
            imag = _polynomials(one.imag, other.imag, place, square)
            imag *= S
            if C is not None:
                even = upper if one.even else ~upper
                real *= np.where(even, 1.0, C)
                imag *= np.where(even, C, 1.0)
            return real * real + imag * imag, np.arctan(imag / real)

        upper_frame, lower_frame = self.frames
        x2, arg_x = polar(upper_frame.x, lower_frame.x)
        y2, arg_y = polar(upper_frame.y, lower_frame.y)
        return Spinor(x2, y2, arg_x, arg_y)


def _polynomials(one: list[Array], other: list[Array], place: NDArray[np.intp], x: Array) -> Array:
    """Return the value of a polynomial of each top, or of another one, by its place in both."""
    value: Array | None = None
    for pair in zip(reversed(one), reversed(other), strict=True):
        coefficients = np.take(np.concatenate(pair), place)
        if value is None:
            value = coefficients
        else:
            value *= x
            value += coefficients
    assert value is not None
    return value


def array_sampler(motions: PairMotions, *, hyperbolic: bool) -> ArraySampler:
    """Return the theta series of motions that all run in the same nome."""
    motion = motions.motion
    with PAIRS.working():
        c = theta_constants(motion, 0 * motion.K)
        series = (hyperbolic_series if hyperbolic else circular_series)(PAIRS, c)
        phase, lower, *args = _at_start(motions, series)
        count = phase.size
        return ArraySampler(
            steps_per_time=Pair(*_columns(2 / c.period, count)),
            offset=phase[:, None],
            first=lower[:, None],
            scale=_columns(series.scale, count)[0],
            hyperbolic=hyperbolic,
            frames=[_rounded(frame) for frame in series.frames],
            growths=_growths(motion, series, *args),
        )


def _at_start(motions: PairMotions, series: Series) -> tuple[Array, Mask, Array, Array]:
    """Return the phase at t = 0, whether it is counted from u2, and arg X and arg Y there."""
    if motions.start is None:
        zero = np.zeros_like(motions.noise)
        return zero, zero > 0, zero, zero
    motion, (sn2, cn2, direction) = motions.motion, motions.start
    mc = motion.k_prime * motion.k_prime
    # w = K/2 where sn^2 = 1/(1 + k'); beyond, K - w is smaller: sn(K - w)/cn(K - w) = cn/(k' sn)
    lower = sn2.high * motion.k_prime.high > cn2.high
    s2, c2 = PAIRS.where(lower, cn2, sn2), PAIRS.where(lower, mc * sn2, cn2)
    if series.hyperbolic:
        C, S = hyperbolic_cosine_and_sine(PAIRS, m=mc, k_prime=motion.k, s2=s2, c2=c2)
    else:
        C, S = cosine_and_sine(PAIRS, m=motion.m, k_prime=motion.k_prime, s2=s2, c2=c2)
    S *= DoubleDouble(np.where(lower, -direction, direction))
    arg_x, arg_y = (
        _start_argument([getattr(frame, name) for frame in series.frames], lower, S, C)
        for name in ("x", "y")
    )
    return direction * _phase(motion, motions.start, lower), lower, arg_x, arg_y


def _phase(motion: Nutating[DoubleDouble], start: Start, lower: Mask) -> Array:
    """Return the phase w/K of a start after u1, counted from u2 where that is nearer."""
    sn2, cn2, _ = start
    total = sn2 + cn2
    mc = motion.k_prime * motion.k_prime
    dn2 = (mc * sn2 + cn2) / total
    w = PAIRS.sqrt(sn2 / total) * carlson_rf(PAIRS, cn2 / total, dn2, 0 * dn2 + 1)
    phase: Array = (w / motion.K - DoubleDouble(np.where(lower, 1.0, 0.0))).high
    return phase


def _start_argument(
    components: list[Component], lower: Mask, S: DoubleDouble, C: DoubleDouble
) -> Array:
    """Return the argument of X or Y at t = 0."""
    square, found = S * S, []
    for component in components:
        real, imag = (
            reduce(lambda value, x: value * square + x, reversed(part))
            for part in (component.real, component.imag)
        )
        found.append((real, S * C * imag) if component.even else (C * real, S * imag))
    (real, imag), (other_real, other_imag) = found
    real, imag = PAIRS.where(lower, other_real, real), PAIRS.where(lower, other_imag, imag)
    argument: Array = np.arctan2(imag.high, real.high)
    return argument


def _growths(
    motion: Nutating[DoubleDouble], series: Series, start_x: Array, start_y: Array
) -> Growths:
    """Return the growth of spin and precession; arg X and arg Y at t = 0 are given."""

    def growth(rate: DoubleDouble, slope: DoubleDouble, start: Array) -> Growth:
        turns = _columns(rate / (2 * PAIRS.pi), start.size)
        pairs = (Pair(*_columns(x, start.size)) for x in (slope, DoubleDouble(start)))
        return Growth(Pair(*_columns(rate, start.size)), Triple(*turns, 0.0), *pairs)

    phi = growth(motion.mean_spin_rate, series.spin_slope, start_x - start_y)
    psi = growth(motion.mean_precession_rate, series.precession_slope, start_x + start_y)
    return Growths(phi, psi, phi, psi)


def _columns(x: DoubleDouble, count: int) -> tuple[Array, Array]:
    """Return both parts of a number of each top, or of one for all, as columns."""
    return tuple(np.broadcast_to(part, (count,))[:, None] for part in (x.high, x.low))  # type: ignore[return-value]


def _rounded(frame: Frame) -> Frame:
    def component(c: Component) -> Component:
        return Component([x.high for x in c.real], [x.high for x in c.imag], c.even)

    return Frame(component(frame.x), component(frame.y), [])


def _mapped(value: Any, change: Callable[[Any], Any]) -> Any:
    """Return nested constants with every array changed."""
    if isinstance(value, np.ndarray):
        return change(value)
    if isinstance(value, list):
        return [_mapped(x, change) for x in value]
    if isinstance(value, tuple):
        return type(value)(*(_mapped(x, change) for x in value))
    return value
