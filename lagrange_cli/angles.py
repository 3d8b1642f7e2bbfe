"""Tilt, spin and precession at given times, by theta series: about one ulp at any time.

The attitude is a pair of complex numbers (Klein's Cayley-Klein parameters; the Pi functions of
Chrapan's sections 3 and 4 are their logarithms), with x = pi t/T and signs s+ = sgn r0, s- = -s+:

    X = cos(theta/2) exp(i (psi + phi)/2)  ~  exp(i rate+ t) theta2(x - i s+ y+)
    Y = sin(theta/2) exp(i (psi - phi)/2)  ~  exp(i rate- t) theta1(x - i s- y-)

One atan2 each gives the tilt and the half sum and half difference of the other two angles.  Of the
half-period representations these are the ones whose zeros are the passes over the poles (y+ = 0
below, y- = 0 above): there real and imaginary part vanish each by itself, and nothing cancels.

A time is first reduced, exactly, to whole steps and a phase.  While K <= K' the step is a period
and the series run in the nome q; beyond, it is half a period, and Jacobi's imaginary transformation
about the nearer turning point gives series in q' = exp(-pi K/K').  The nome in use is at most
exp(-pi), so four terms are enough for doubles.  Written as polynomials in sin^2 or sinh^2 of the
phase, with coefficients from the many-digit arithmetic of the caller, they cost a few
multiplications a sample, however far the time.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .elliptic import Arithmetic, Real
from .top import LagtopError

Array = NDArray[np.float64]

BLOCK = 16384
"""Samples at a time, so that the work arrays stay in the cache."""

MAX_PERIODS = 2.0**50
"""Beyond, neighbouring doubles lie so far apart that a time no longer names a phase."""

_TERMS = 4
_SPLITTER = 2.0**27 + 1


class Pair(NamedTuple):
    """A number to twice the precision: the nearest double and the rest."""

    high: float
    low: float


class Angles(NamedTuple):
    """Euler angles in radians, each a float64 array in the shape of the times."""

    theta: Array
    """Tilt of the figure axis (nutation), 0 to pi."""
    phi: Array
    """Spin."""
    psi: Array
    """Precession."""


class Component(NamedTuple):
    """X or Y about one turning point: two polynomials in s = S^2, the lowest power first.

    Real and imaginary part are C P(s) and S Q(s), or P(s) and S C Q(s) where `even`.
    """

    real: list[float]
    imag: list[float]
    even: bool = False


class Frame(NamedTuple):
    """X and Y about one turning point."""

    x: Component
    y: Component


class Growth(NamedTuple):
    """How an angle grows: per step, in turns per step, and with the phase within a step."""

    step: Pair
    turns: Pair
    slope: float


class Sampler:
    """Evaluation block by block, for any shape of the times."""

    max_time: float

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """See `Motion.angles`."""
        times = np.asarray(t, dtype=np.float64)
        self.check(times)
        flat = np.ascontiguousarray(times).reshape(-1)
        angles = Angles(*(np.empty_like(flat) for _ in range(3)))
        for start in range(0, flat.size, BLOCK):
            part = slice(start, start + BLOCK)
            self._sample(flat[part], wrap, Angles(*(angle[part] for angle in angles)))
        return Angles(*(angle.reshape(times.shape) for angle in angles))

    def check(self, t: ArrayLike) -> None:
        """Raise LagtopError where a time is not finite or names no phase."""
        times = np.asarray(t, dtype=np.float64)
        bad = ~(np.isfinite(times) & (np.abs(times) <= self.max_time))
        if bad.any():
            raise LagtopError(
                f"t must be finite and within 2^50 periods = {self.max_time:.3g}, "
                f"got {times[bad].flat[0]}",
                "t",
            )

    def _sample(self, t: Array, wrap: bool, out: Angles) -> None:
        raise NotImplementedError


@dataclass(frozen=True)
class ThetaSampler(Sampler):
    """The constants of a nutating top that its angles need, ready to be evaluated."""

    steps_per_time: Pair
    max_time: float
    scale: float
    hyperbolic: bool
    frames: Sequence[Frame]
    phi: Growth
    psi: Growth

    def _sample(self, t: Array, wrap: bool, out: Angles) -> None:
        step, phase = reduce_phase(t, self.steps_per_time)
        if len(self.frames) == 1:
            arg_x, arg_y = self._spinor(self.frames[0], phase, out.theta)
        else:
            arg_x, arg_y = self._spinor_by_parity(step, phase, out.theta)
        assemble = _wrapped if wrap else _unwrapped
        assemble(self.phi, step, phase, arg_x - arg_y, out.phi)
        assemble(self.psi, step, phase, arg_x + arg_y, out.psi)

    def _spinor_by_parity(self, step: Array, phase: Array, theta: Array) -> tuple[Array, Array]:
        arg_x, arg_y = np.empty_like(phase), np.empty_like(phase)
        odd = np.rint(step * 0.5) != step * 0.5
        for frame, chosen in zip(self.frames, (~odd, odd), strict=True):
            index = np.flatnonzero(chosen)
            tilt = np.empty(index.size)
            arg_x[index], arg_y[index] = self._spinor(frame, phase[index], tilt)
            theta[index] = tilt
        return arg_x, arg_y

    def _spinor(self, frame: Frame, phase: Array, theta: Array) -> tuple[Array, Array]:
        """arg X and arg Y about the turning point; theta = 2 atan2(|Y|, |X|) is written out."""
        S, C, s = (_hyperbolic if self.hyperbolic else _circular)(phase * self.scale)
        x_real, x_imag = _component(frame.x, S, C, s)
        y_real, y_imag = _component(frame.y, S, C, s)
        np.arctan2(_modulus(y_real, y_imag), _modulus(x_real, x_imag), out=theta)
        theta *= 2.0
        return np.arctan2(x_imag, x_real, out=x_imag), np.arctan2(y_imag, y_real, out=y_imag)


@dataclass(frozen=True)
class SteadySampler(Sampler):
    """A constant tilt and constant rates of spin and precession."""

    theta: float
    phi: Growth
    psi: Growth
    max_time: float

    def _sample(self, t: Array, wrap: bool, out: Angles) -> None:
        out.theta.fill(self.theta)
        for growth, angle in ((self.phi, out.phi), (self.psi, out.psi)):
            if wrap:
                _, turns = reduce_phase(t, growth.turns)
                _into_half_open(turns * (2.0 * np.pi), angle)
            else:
                np.add(t * growth.step.low, t * growth.step.high, out=angle)


def theta_sampler(
    ar: Arithmetic,
    *,
    period: Real,
    quarter: Real,
    quarter_prime: Real,
    eta_plus: Real,
    eta_minus: Real,
    x_size: Real,
    y_size: Real,
    spin: Real,
    precession: Real,
    sign_plus: int,
    sign_minus: int,
) -> ThetaSampler:
    """The sampler of a nutating top from its constants in an mpmath context `ar`.

    Nutation period, quarter periods K and K', eta+- = 2K y+-/pi, the sizes of X at u1 and of Y at
    u2 (cos(theta_min/2) and, as theta3 shrinks by sqrt(k') on the way, sqrt(k') sin(theta_max/2)),
    the advance of spin and precession over a period, and the signs s+ and s-.
    """
    hyperbolic = quarter > quarter_prime
    steps = 2 if hyperbolic else 1
    divisor = quarter_prime if hyperbolic else quarter
    y_plus, y_minus = ar.pi * eta_plus / (2 * divisor), ar.pi * eta_minus / (2 * divisor)
    q = ar.exp(-ar.pi * (quarter / quarter_prime if hyperbolic else quarter_prime / quarter))
    components = _hyperbolic_components if hyperbolic else _circular_components
    x_frames = components(ar, q, y_plus, x_size, sign_plus)
    y_frames = components(ar, q, y_minus, y_size, sign_minus)
    # Linear rates: the whole advance less the winding of the series (and, transformed, plus its
    # own linear exponent).
    slope_x = ((precession + spin) / 2 - sign_plus * ar.pi) / steps
    slope_y = ((precession - spin) / 2 - sign_minus * ar.pi) / steps
    if hyperbolic:
        slope_x, slope_y = slope_x + sign_plus * y_plus, slope_y + sign_minus * y_minus
    return ThetaSampler(
        steps_per_time=_pair(steps / period),
        max_time=float(MAX_PERIODS * period),
        scale=float(ar.pi / 2 * quarter / quarter_prime if hyperbolic else ar.pi),
        hyperbolic=hyperbolic,
        frames=[Frame(x_frames[i], y_frames[1 - i]) for i in range(steps)],
        phi=_growth(ar, spin / steps, slope_x - slope_y),
        psi=_growth(ar, precession / steps, slope_x + slope_y),
    )


def steady_sampler(
    ar: Arithmetic, theta: Real, spin_rate: Real, precession_rate: Real
) -> SteadySampler:
    """The sampler of a constant tilt and two constant rates, in an mpmath context `ar`."""
    fastest = max(abs(spin_rate), abs(precession_rate))
    return SteadySampler(
        theta=float(theta),
        phi=_growth(ar, spin_rate, ar.mpf(0)),
        psi=_growth(ar, precession_rate, ar.mpf(0)),
        max_time=float(MAX_PERIODS / fastest) if fastest else float("inf"),
    )


def _growth(ar: Arithmetic, step: Real, slope: Real) -> Growth:
    return Growth(_pair(step), _pair(step / (2 * ar.pi)), float(slope))


def _pair(value: Real) -> Pair:
    high = float(value)
    return Pair(high, float(value - high))


# The series.  sin and cos of multiples of x are polynomials in s = sin^2 x (for even multiples
# and sines over C or S or S C), all four families by one recurrence; sinh^2 flips a sign.

_COS_ODD, _SIN_ODD, _COS_EVEN, _SIN_EVEN = (
    ([1], [1, -4]),
    ([1], [3, -4]),
    ([1], [1, -2]),
    ([0], [2]),
)


def _circular_components(
    ar: Arithmetic, q: Real, y: Real, size: Real, sign: int
) -> list[Component]:
    """theta2(x - i sign y) and theta1(x - i sign y) over i^-sign, as series in the nome q."""
    weights = [q ** (n * (n + 1)) for n in range(_TERMS)]
    cosh = [w * ar.cosh((2 * n + 1) * y) for n, w in enumerate(weights)]
    sinh = [w * ar.sinh((2 * n + 1) * y) for n, w in enumerate(weights)]
    unit = size / sum(cosh)
    return [
        Component(_sum(_COS_ODD, 1, unit, cosh), _sum(_SIN_ODD, 1, sign * unit, sinh)),
        Component(
            _sum(_COS_ODD, 1, unit, _alternate(sinh)),
            _sum(_SIN_ODD, 1, sign * unit, _alternate(cosh)),
        ),
    ]


def _hyperbolic_components(
    ar: Arithmetic, q: Real, v: Real, size: Real, sign: int
) -> list[Component]:
    """The same two functions after Jacobi's transformation: theta4 and theta1 of v + i h."""
    even = [(2 if n else 1) * q ** (n * n) for n in range(_TERMS)]
    odd = [2 * ar.sqrt(ar.sqrt(q)) * q ** (n * (n + 1)) for n in range(_TERMS)]
    cos_even = _alternate([w * ar.cos(2 * n * v) for n, w in enumerate(even)])
    sin_even = _alternate([w * ar.sin(2 * n * v) for n, w in enumerate(even)])
    cos_odd = _alternate([w * ar.cos((2 * n + 1) * v) for n, w in enumerate(odd)])
    sin_odd = _alternate([w * ar.sin((2 * n + 1) * v) for n, w in enumerate(odd)])
    unit = size / sum(cos_even)
    return [
        Component(
            _sum(_COS_EVEN, -1, unit, cos_even), _sum(_SIN_EVEN, -1, -sign * unit, sin_even), True
        ),
        Component(_sum(_COS_ODD, -1, unit, sin_odd), _sum(_SIN_ODD, -1, sign * unit, cos_odd)),
    ]


def _alternate(terms: list[Real]) -> list[Real]:
    return [-term if n % 2 else term for n, term in enumerate(terms)]


def _sum(
    family: tuple[list[int], list[int]], curvature: int, unit: Real, weights: list[Real]
) -> list[float]:
    """Coefficients in s of the weighted sum of a family, P(n+1) = (2 - 4 s) P(n) - P(n-1)."""
    total: list[Real] = [0] * len(weights)
    power, following = family
    for weight in weights:
        for i, coefficient in enumerate(power):
            total[i] += unit * weight * coefficient * curvature**i
        power, following = following, _next(power, following)
    return [float(coefficient) for coefficient in total]


def _next(previous: list[int], current: list[int]) -> list[int]:
    doubled, shifted = [2 * c for c in current] + [0], [0] + [4 * c for c in current]
    padded = previous + [0] * (len(doubled) - len(previous))
    return [a - b - c for a, b, c in zip(doubled, shifted, padded, strict=True)]


# Evaluation.


def reduce_phase(t: Array, rate: Pair) -> tuple[Array, Array]:
    """The nearest integer to t * rate, and what is left, |phase| <= 1/2, free of cancellation."""
    product, rest = _two_product(t, rate.high)
    step = np.rint(product)
    rest += t * rate.low
    product -= step
    product += rest
    return step, product


def _two_product(x: Array, factor: float) -> tuple[Array, Array]:
    """x * factor and its rounding error, exactly (Dekker)."""
    scaled = factor * _SPLITTER
    factor_high = scaled - (scaled - factor)
    factor_low = factor - factor_high
    high = x * _SPLITTER
    high -= high - x
    low = x - high
    product = x * factor
    error = high * factor_high
    error -= product
    high *= factor_low
    error += high
    error += low * factor_high
    low *= factor_low
    error += low
    return product, error


def _circular(x: Array) -> tuple[Array, None, Array]:
    """S, C and s for angles; X and Y share the factor cos x, which is divided out."""
    tangent = np.tan(x)
    square = tangent * tangent
    square /= square + 1.0
    return tangent, None, square


def _hyperbolic(x: Array) -> tuple[Array, Array, Array]:
    sinh = np.sinh(x)
    square = sinh * sinh
    return sinh, np.sqrt(square + 1.0), square


def _component(component: Component, S: Array, C: Array | None, s: Array) -> tuple[Array, Array]:
    real, imag = _polynomial(component.real, s), _polynomial(component.imag, s)
    imag *= S
    if C is not None:
        (imag if component.even else real).__imul__(C)
    return real, imag


def _polynomial(coefficients: list[float], s: Array) -> Array:
    value = s * coefficients[-1]
    for coefficient in coefficients[-2:0:-1]:
        value += coefficient
        value *= s
    value += coefficients[0]
    return value


def _modulus(real: Array, imag: Array) -> Array:
    square = real * real
    square += imag * imag
    return np.sqrt(square, out=square)


def _unwrapped(growth: Growth, step: Array, phase: Array, args: Array, out: Array) -> None:
    np.multiply(phase, growth.slope, out=out)
    out += step * growth.step.low
    out += args
    out += step * growth.step.high


def _wrapped(growth: Growth, step: Array, phase: Array, args: Array, out: Array) -> None:
    _, turns = reduce_phase(step, growth.turns)
    _into_half_open(turns * (2.0 * np.pi) + (phase * growth.slope + args), out)


def _into_half_open(angle: Array, out: Array) -> None:
    """Bring angles to (-pi, pi]."""
    turns = np.ceil(angle / (2.0 * np.pi) - 0.5)
    np.subtract(angle, turns * (2.0 * np.pi), out=out)
