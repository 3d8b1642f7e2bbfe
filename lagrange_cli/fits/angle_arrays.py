"""Angles of many tops over time: motions in pairs of doubles, and their theta series as arrays.

The constants are computed in pairs of doubles by the formulas of `motion`, and rounded once.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import PAIRS
from ..arithmetic.double_double import DoubleDouble, Period, period_of, whole_periods
from ..arithmetic.points import MAX_TIME
from ..arithmetic.rounding import Pair, Triple
from ..arithmetic.types import Array, Mask
from ..elliptic.carlson import carlson_rf
from ..elliptic.complete import cosine_and_sine, hyperbolic_cosine_and_sine
from ..motion.gaps import Gaps, State, gaps_from_rest
from ..motion.regime import Regime
from ..motion.spin_precession import Nutating
from ..sweep.moving_tops import FACTS, MovingTops
from ..sweep.top_arrays import PAIR_EPS, TopArrays, facts_at_rest
from .attitude import (
    Attitude,
    Growth,
    Growths,
    Times,
    arguments_of,
    moduli_of,
    tilt_of,
    unwound,
)
from .theta_series import (
    Frame,
    Series,
    circular_series,
    hyperbolic_series,
    theta_constants,
)

_SMALL = 2.0**-56
"""Error of a phase, or of a constant, that is far below a unit of the angles."""


class Start(NamedTuple):
    """Positions of tops at t = 0: sn^2 and cn^2 of their argument w."""

    sn2: DoubleDouble
    cn2: DoubleDouble
    direction: Array
    """Sign of the nutation rate."""


class PairMotions(NamedTuple):
    """Motions of many nutating tops in pairs of doubles, and how far they can be trusted."""

    motion: Nutating[DoubleDouble]
    start: Start | None
    """None if all tops start at the top of the nutation."""
    noise: Array
    """Bound of the relative errors of the gaps."""
    rate_size: Array
    """Size of the terms whose sum is the mean rate."""
    sure: Mask

    def part(self, rows: NDArray[np.intp]) -> PairMotions:
        """Return some of the motions, with their starts and error bounds."""
        whole, facts = self.motion, self.motion.facts
        signs = {name: getattr(facts, name)[rows] for name in ("sign_plus", "sign_minus")}
        state, gaps = State(*(x[rows] for x in whole.state)), Gaps(*(x[rows] for x in whole.gaps))
        motion = Nutating(whole.ar, facts._replace(**signs), state, gaps)
        known = {name: x[rows] for name, x in vars(whole).items() if isinstance(x, DoubleDouble)}
        vars(motion).update(known)
        return PairMotions(motion, *_rows_of(list(self[1:]), rows))

    def hyperbolic(self) -> Mask:
        """Return which motions have K > K', so that their series use the complementary nome."""
        return self.motion.m.high > 0.5

    def reach(self) -> Array:
        """Return the latest times at which the angles are trusted; NaN if there are none."""
        with PAIRS.working():
            period = self.motion.T_nutation.high
            reach = _SMALL / self.noise / (self.rate_size + 8 / period)
            usable = self.sure & (self.noise < _SMALL) & np.isfinite(reach) & (period > 0)
            return np.where(usable, np.minimum(reach, MAX_TIME), np.nan)


def released_motions(tops: TopArrays) -> PairMotions:
    """Return the motions of regular tops released from rest."""
    with PAIRS.working():
        state, facts = tops.pair_state(), facts_at_rest(Regime.REGULAR, tops.r0)
        sign = DoubleDouble(facts.sign_plus)
        facts = facts._replace(sign_plus=sign, sign_minus=-sign)
        motion = Nutating(PAIRS, facts, state, gaps_from_rest(PAIRS, state))
        parts = np.maximum(state.a.high, state.b.high**2 / 2)
        noise = PAIR_EPS * (1 + parts / abs(state.sleep.high))  # the cancellation is in lambda - 1
        size = abs(tops.r0) + abs(motion.mean_precession_rate.high)
        return PairMotions(motion, None, noise, size, np.isfinite(noise))


def moving_motions(tops: TopArrays) -> PairMotions:
    """Return the motions of tops that start with any rates."""
    starts = MovingTops(tops)
    with PAIRS.working():
        state, gaps = starts.fine.state, starts.fine.gaps
        signs: dict[str, Any] = {}
        sure = starts.small
        terms = 2 * (abs(state.psi_rate.high) + abs(state.b.high))
        for name, momentum in (("plus", gaps.beta_plus_b), ("minus", gaps.beta_minus_b)):
            signs[f"sign_{name}"] = DoubleDouble(np.where(momentum.high < 0, -1.0, 1.0))
            sure = sure & (abs(momentum.high) > _SMALL * terms)
        motion = Nutating(PAIRS, FACTS._replace(**signs), state, gaps)
        # sn^2 w = (u1 - u)(u3 - u2)/((u3 - u)(u1 - u2)), (4,22)
        sn2, cn2 = gaps.u1_u * gaps.a_u3_u2, gaps.a_u3_u1 * gaps.u_u2
        size = starts.precession_size + abs(state.r0.high)
        start = Start(sn2, cn2, np.where(state.theta_rate.high < 0, -1.0, 1.0))
        return PairMotions(motion, start, starts.noise, size, sure)


class ArraySampler(NamedTuple):
    """The theta series of many tops, all in the same nome; each constant is a column."""

    step: Period
    offset: Array
    lower: Mask
    """Whether the phase of t = 0 is counted from a passage of u2."""
    speed: Array
    """Argument of the functions per unit of time."""
    first: Array
    """Argument at t = 0."""
    hyperbolic: bool
    frames: list[Frame]
    """The coefficients of all tops, about u1 and about u2."""
    slopes: list[Array]
    """Mean rates of arg X and arg Y less their growth in the series, per unit of the argument."""
    growths: Growths

    def part(self, rows: slice) -> ArraySampler:
        """Return the constants of some tops."""
        return ArraySampler(*_rows_of(list(self), rows))

    def attitude(self, t: Array, farthest: float, space: Array) -> Attitude:
        """Return the attitude at times of shape (tops, times), in the workspace `space`."""
        step, since, lost = whole_periods(t, self.step, farthest, space[:3], self.offset)
        since -= lost
        since *= self.speed
        argument = np.add(since, self.first, out=since)
        half = np.multiply(step, 0.5, out=lost)
        upper = (np.rint(half, out=step) != half) == self.lower
        parts = self._parts(argument, upper, space[4:8])
        arguments = unwound(arguments_of(parts, space[8:10]), self.slopes, argument, lost)
        tilt, times = tilt_of(*moduli_of(parts)), Times(t, farthest, space[12:])
        return Attitude(self.growths, times, tilt, arg_x=arguments[0], arg_y=arguments[1])

    def _parts(self, argument: Array, upper: Mask, parts: Array) -> Array:
        """Return real and imaginary parts of X and Y; `upper` marks phases counted from u1."""
        S = np.sinh(argument) if self.hyperbolic else np.tan(argument)
        square = S * S
        C = np.sqrt(square + 1.0) if self.hyperbolic else None
        if C is None:
            square /= square + 1.0
        rows = np.arange(argument.shape[0])[:, None]
        place = rows + np.where(upper, 0, argument.shape[0])
        (x, y, _), (other_x, other_y, _) = self.frames
        for i, (one, other) in enumerate(((x, other_x), (y, other_y))):
            _polynomials(one.real, other.real, place, square, parts[2 * i])
            _polynomials(one.imag, other.imag, place, square, parts[2 * i + 1])
            if C is not None:
                even = upper if one.even else ~upper
                parts[2 * i] *= np.where(even, 1.0, C)
                parts[2 * i + 1] *= np.where(even, C, 1.0)
        parts[1::2] *= S
        return parts


def _polynomials(
    one: list[Array], other: list[Array], place: NDArray[np.intp], x: Array, value: Array
) -> None:
    """Write the value of one of two polynomials of each top, selected by `place`."""
    value[:] = 0.0
    for pair in zip(reversed(one), reversed(other), strict=True):
        value *= x
        value += np.take(np.concatenate(pair), place)


def array_sampler(motions: PairMotions, *, hyperbolic: bool) -> ArraySampler:
    """Return the theta series of motions whose series all use the same nome."""
    motion = motions.motion
    with PAIRS.working():
        c = theta_constants(motion)
        series = (hyperbolic_series if hyperbolic else circular_series)(PAIRS, c)
        phase, lower, *args = _at_start(motions, series)
        count, period = phase.size, motion.T_nutation
        steps, slopes = 2 / period, series.slopes
        x, y = (
            DoubleDouble(arg) + slope * DoubleDouble(phase)
            for arg, slope in zip(args, slopes, strict=True)
        )
        phi = _growth(motion.mean_spin_rate, x - y)
        psi = _growth(motion.mean_precession_rate, x + y)
        return ArraySampler(
            step=period_of(Pair(*_columns(period / 2, count)), _columns(steps, count)[0]),
            offset=phase[:, None],
            lower=lower[:, None],
            speed=_columns(series.scale * steps, count)[0],
            first=_columns(series.scale * DoubleDouble(phase), count)[0],
            hyperbolic=hyperbolic,
            frames=[frame.mapped(_high, _high) for frame in series.frames],
            slopes=[_columns(slope / series.scale, count)[0] for slope in slopes],
            growths=Growths(phi, psi),
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
    args = []
    for components in zip(*(frame[:2] for frame in series.frames), strict=True):  # of X, then of Y
        parts = zip(*(component.at(S, C) for component in components), strict=True)
        real, imag = (PAIRS.where(lower, other, one).high for one, other in parts)
        args.append(np.arctan2(imag, real))
    return direction * _phase(motion, motions.start, lower), lower, *args


def _phase(motion: Nutating[DoubleDouble], start: Start, lower: Mask) -> Array:
    """Return the phase w/K of a start after u1, counted from u2 if that is nearer."""
    sn2, cn2, _ = start
    total = sn2 + cn2
    mc = motion.k_prime * motion.k_prime
    dn2 = (mc * sn2 + cn2) / total
    w = PAIRS.sqrt(sn2 / total) * carlson_rf(PAIRS, cn2 / total, dn2, 0 * dn2 + 1)
    phase: Array = (w / motion.K - DoubleDouble(np.where(lower, 1.0, 0.0))).high
    return phase


def _growth(rate: DoubleDouble, start: DoubleDouble) -> Growth:
    """Return the growth of an angle of each top."""
    count, turns = start.high.size, rate / (2 * PAIRS.pi)
    turn = period_of(Pair(*_columns(1 / turns, count)), _columns(turns, count)[0])
    first, mean = (Pair(*_columns(x, count)) for x in (start, rate))
    return Growth(first, mean, turn, Triple(*_columns(turns, count), 0.0))


def _high(coefficients: list[DoubleDouble]) -> list[Array]:
    """Return coefficients rounded to doubles."""
    return [x.high for x in coefficients]


def _columns(x: DoubleDouble, count: int) -> tuple[Array, Array]:
    """Return both parts of a number of each top (or of one number for all) as columns."""
    return tuple(np.broadcast_to(part, (count,))[:, None] for part in (x.high, x.low))  # type: ignore[return-value]


def _rows_of(value: Any, rows: Any) -> Any:
    """Return nested constants of some tops."""
    if isinstance(value, np.ndarray | DoubleDouble):
        return value[rows]
    if isinstance(value, list):
        return [_rows_of(x, rows) for x in value]
    if isinstance(value, tuple):
        return type(value)(*(_rows_of(x, rows) for x in value))
    return value
