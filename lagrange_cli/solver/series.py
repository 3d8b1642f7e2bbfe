"""The attitude over time by theta series: their coefficients, and their value at one time.

X = `cos(theta/2) exp(i (psi + phi)/2)` is proportional to theta2(x - i s+ y+), and Y =
`sin(theta/2) exp(i (psi - phi)/2)` to theta1(x - i s- y-).  Here x = pi t/T is counted from a
passage of u1.  If K <= K', the series use the nome q.  Otherwise Jacobi's imaginary transformation
gives series in q' = exp(-pi K/K').  The nome in use is at most exp(-pi), so that four terms are
enough for doubles.  The phase is counted from the nearer of u1 and u2.  Arguments therefore stay
away from the end of their branch and cannot jump.

With S = tan x and s = sin^2 x the real parts of X and Y are P(s), and the imaginary parts S Q(s):
all have the factor cos x, which is left out.  The hyperbolic series have S = sinh x, C = cosh x and
s = S^2.  Their parts are P(s) and S C Q(s) for one of X and Y, C P(s) and S Q(s) for the other.

The formulas take any arithmetic.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any, Generic, NamedTuple

from ..arithmetic.numbers import R, polynomial
from ..elliptic.complete import cosine_and_sine, hyperbolic_cosine_and_sine, nome, place
from .kinds import Constant, Kind, Separatrix
from .spin_precession import Nutating

Coefficients = list[Any]
"""Coefficients of a polynomial in s, the lowest power first."""

Family = tuple[tuple[int, ...], tuple[int, ...]]
"""Two first polynomials in s, over C, S or S C; P(n+1) = (2 - 4 s) P(n) - P(n-1) gives the others.

They are cos (2n+1)x, sin (2n+1)x, cos 2nx and sin 2nx; in hyperbolic series s has the other sign.
"""
COS_ODD: Family = ((1,), (1, -4))
SIN_ODD: Family = ((1,), (3, -4))
COS_EVEN: Family = ((1,), (1, -2))
SIN_EVEN: Family = ((0,), (2,))

TERMS = 4
"""Terms of the series that are enough for doubles."""


class Frame(NamedTuple):
    """The series about one turning point."""

    parts: tuple[Coefficients, ...]
    """Re X, Im X, Re Y, Im Y."""
    rate: Coefficients
    """S C times this is theta1(2x), 2 (|X|^2 + |Y|^2) |X| |Y| times the nutation rate."""


class Series(NamedTuple):
    """The series of a motion, with phases in steps of half a period."""

    hyperbolic: bool
    frames: tuple[Frame, Frame]
    """The series about the turning point nearest to the start, and about the other one."""
    first: int
    """0 if that turning point is u1, 1 if it is u2."""
    offset: Any
    """Steps from that turning point to the start, from -1/2 to 1/2."""
    scale: Any
    """Argument of the functions per step."""
    slopes: tuple[Any, Any]
    """Slopes per step that are added to arg X and arg Y to make them periodic."""


def theta_series(motion: Nutating[Any], terms: int = TERMS) -> Series:
    """Return the series of a nutating top, in the smaller nome.

    The parameter of X, with modulus k', has `sn^2 = (1 + u2)/(1 + u1)` and `cn^2 = (u1 - u2)/(1 +
    u1)`.  The parameter of Y has `sn^2 = (1 - u1)(u3 - u2)/((u3 - u1)(1 - u2))` and `cn^2 = (u3 -
    1)(u1 - u2)/((u3 - u1)(1 - u2))`.  |X| at u1 is cos(theta_min/2), and |Y| at u2 is
    sin(theta_max/2) times sqrt(k'), the ratio of theta3 at u2 and at u1.
    """
    ar: Any = motion.ar
    gaps, k, k_prime, ratio = motion.gaps, motion.k, motion.k_prime, 1
    hyperbolic = motion.K_prime is not None and ar.either(motion.K > motion.K_prime)
    sizes = ar.sqrt(gaps.below_u1 / 2), ar.sqrt(k_prime * gaps.above_u2 / 2)
    squares = motion.K * motion.K * k_prime * k_prime
    constants, bend = hyperbolic_cosine_and_sine, -1
    if hyperbolic:
        k, k_prime, ratio = k_prime, k, motion.K / motion.K_prime
        constants, bend = cosine_and_sine, 1
    m = k * k
    q = nome(ar, m=m, k_prime=k_prime)
    odd, even = _weights(ar, q, 2, terms), _weights(ar, q, 1, terms)
    even = [even[0], *(2 * x for x in even[1:])]
    if hyperbolic:
        odd = [2 * ar.sqrt(ar.sqrt(q)) * x for x in odd]

    def components(
        size: Any, sign: Any, s2: Any, c2: Any
    ) -> tuple[list[Coefficients], list[Coefficients], Any]:
        """Return X or Y about both turning points, the own one first, and its slope."""
        cos, sin = constants(ar, m=m, k_prime=k_prime, s2=s2, c2=c2)
        step = 1 - 2 * bend * sin * sin, 2 * sin * cos
        real, imag = _multiples((cos, sin), step, bend, odd)
        other = (COS_ODD, _alternated(imag)), (SIN_ODD, [sign * x for x in _alternated(real)])
        own = (COS_ODD, real), (SIN_ODD, [sign * x for x in imag])
        slope = -sign * ar.pi / 2
        if hyperbolic:
            none = (0 * sin + 1, 0 * sin)
            real, imag = map(_alternated, _multiples(none, step, bend, even))
            own = (COS_EVEN, real), (SIN_EVEN, [-sign * x for x in imag])
            slope = -sign * ar.atan2(cos, sin)
        unit = size / sum(own[0][1])
        both = ([_summed(*part, -bend, unit) for part in parts] for parts in (own, other))
        return *both, slope

    x, other_x, x_slope = components(sizes[0], motion.facts.sign_plus, gaps.below_u2, gaps.u1_u2)
    y, other_y, y_slope = components(
        sizes[1],
        motion.facts.sign_minus,
        gaps.above_u1 * gaps.a_u3_u2,
        gaps.a_u3_above * gaps.u1_u2,
    )
    nutation = 8 * squares * gaps.u1_u2 / (ar.pi * motion.T_nutation) / ratio
    sines = [0 * nutation] * (2 * terms)
    sines[1::2] = _alternated(odd)
    unit = nutation / sum(2 * n * x for n, x in enumerate(sines))
    rate = _summed(SIN_EVEN, sines, -bend, unit)
    frames = Frame((*x, *other_y), rate), Frame((*other_x, *y), [-x for x in rate])
    steps = periods_since_top(motion) * 2
    nearest = ar.nint(steps)
    first = nearest % 2
    return Series(
        hyperbolic=hyperbolic,
        frames=(frames[first], frames[1 - first]),
        first=first,
        offset=steps - nearest,
        scale=ar.pi / 2 * ratio,
        slopes=(x_slope, y_slope),
    )


def _weights(ar: Any, q: Any, first: int, terms: int) -> list[Any]:
    """Return q^(n^2) or, for a first exponent of 2, q^(n(n+1)): weights of theta3 and theta2.

    The truncation error of N terms in a nome q <= 1/20 is added to the first two weights of balls,
    which multiply constants.  In circular series |y| <= log(1/q)/2.  In hyperbolic series |z| <= 3
    log(1/q)/8, because no phase exceeds 3/4.  For x >= 0, `|sin jx| <= j |sin x|`, `sinh jx <= j
    e^((j-1) x) sinh x` and `cosh jx <= e^((j-1) x) cosh x`.  A term over the constant that its
    weight multiplies is therefore at most 2 (2n+1)^2 q^(n(n-1)).  From n = 1 on, each bound is less
    than half of the one before.  The sum of all terms from n = N on is thus at most 4 (2N+1)^2
    times the last weight.
    """
    weights, power = [0 * q + 1], q if first == 1 else q * q
    for _ in range(terms - 1):
        weights.append(weights[-1] * power)
        power = power * q * q
    if hasattr(ar, "between"):
        rest = 4 * (2 * terms + 1) * (2 * terms + 1) * weights[-1]
        weights[:2] = [ar.between(weight - rest, weight + rest) for weight in weights[:2]]
    return weights


def _multiples(
    first: tuple[Any, Any],
    step: tuple[Any, Any],
    bend: int,
    weights: list[Any],
) -> tuple[list[Any], list[Any]]:
    """Return weighted cosines and sines of first, first + step ...; hyperbolic if `bend` is -1.

    A common factor of all sines, or of all cosines, keeps its digits.
    """
    found = [first]
    for _ in weights[1:]:
        cos, sin = found[-1]
        found.append((cos * step[0] - bend * sin * step[1], sin * step[0] + cos * step[1]))
    cosines, sines = zip(*found, strict=True)
    weighted = ([w * x for w, x in zip(weights, part, strict=True)] for part in (cosines, sines))
    return tuple(weighted)  # type: ignore[return-value]


def _alternated(terms: list[Any]) -> list[Any]:
    """Return terms with every second sign changed, starting with the second."""
    return [-term if n % 2 else term for n, term in enumerate(terms)]


def _summed(family: Family, weights: list[Any], bend: int, unit: Any) -> Coefficients:
    """Return a weighted sum of the polynomials of a family, times a unit."""
    total: Coefficients = [0 * unit] * len(weights)
    for weight, coefficients in zip(weights, _polynomials(family, len(weights)), strict=True):
        for i, coefficient in enumerate(coefficients):
            total[i] += weight * coefficient
    return [unit * x if i % 2 == 0 else bend * unit * x for i, x in enumerate(total)]


@lru_cache(maxsize=64)
def _polynomials(family: Family, count: int) -> list[list[int]]:
    """Return the first polynomials of a family."""
    found = [list(polynomial) for polynomial in family]
    while len(found) < count:
        before, last = found[-2:]
        twice, shifted = [2 * c for c in last] + [0], [0] + [4 * c for c in last]
        padded = before + [0] * (len(twice) - len(before))
        found.append([a - b - c for a, b, c in zip(twice, shifted, padded, strict=True)])
    return found[:count]


def evaluate(ar: Any, series: Series, step: int, phase: Any, rises: int) -> tuple[Any, ...]:
    """Return |X|, arg X, |Y| and arg Y at a phase counted from a step, in many digits.

    The moduli have a common factor, and the arguments lack their growth.  On the upper pole Y = 0.
    Its argument is then the limit from later times if the tilt `rises`, else from earlier times.
    On the lower pole, where X = 0, the limits are exchanged.
    """
    z, even = phase * series.scale, (step + series.first) % 2
    frame = series.frames[step % 2]
    if series.hyperbolic:
        S, C = ar.sinh(z), ar.cosh(z)
        s = S * S
    else:
        sine = ar.sin(z)
        S, C, s = sine / ar.cos(z), 1, sine * sine
    found = []
    for which, side in ((0, -rises), (1, rises)):
        real, imag = (polynomial(part, s) for part in frame.parts[2 * which : 2 * which + 2])
        along = S * imag
        if series.hyperbolic:
            real, along = (real, C * along) if which == even else (C * real, along)
        if not (real or S):  # on the pole: the limit
            along = side * frame.parts[2 * which + 1][0]
        found += [ar.sqrt(real * real + along * along), ar.atan2(along, real)]
    return tuple(found)


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


def separatrix_constants(motion: Separatrix[Any]) -> tuple[Any, Any, Any, Any]:
    """Return the constants of a motion on the separatrix, about its lowest point.

    They are the argument h at t = 0, cos(theta_max/2), sin(theta_max/2) with the sign of b, and
    arg X at t = 0.
    """
    ar: Any = motion.ar
    gaps, falls = motion.gaps, direction(motion)
    offset = 0 * gaps.u_u2  # exactly 0 at the lowest point
    if gaps.u_u2:
        offset = -falls * ar.asinh(ar.sqrt(gaps.u_u2 / gaps.u1_u))
    x, y = ar.sqrt(gaps.below_u2 / 2), ar.sqrt(gaps.above_u2 / 2)
    y = -y if motion.b < 0 else y
    side = ar.sinh(offset) / ar.cosh(offset) if offset or x else -falls  # on the lower pole
    return offset, x, y, ar.atan2(y * side, x)


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
        return Swing(rate, -separatrix_constants(motion)[0] / rate)


class ExactAttitude(NamedTuple, Generic[R]):
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
    """A number with the sign of the nutation rate; on the separatrix the argument -h."""


def exact_attitude(motion: Kind[R]) -> Callable[[R], ExactAttitude[R]]:
    """Return the attitude of a motion as a function of time, in its arithmetic."""
    ar: Any = motion.ar
    with ar.working():
        if isinstance(motion, Nutating):
            attitude = _nutating(motion)
        elif isinstance(motion, Separatrix):
            attitude = _on_separatrix(motion)
        else:
            attitude = _constant(motion)

    def at(t: R) -> ExactAttitude[R]:
        with ar.working():
            found = attitude(t)
            if not motion.facts.plane:
                return found
            # in a plane an angle changes only at the poles, by half turns
            phi, psi = (ar.pi * ar.nint(angle / ar.pi) for angle in (found.phi, found.psi))
            return found._replace(phi=phi, psi=psi)

    return at


def _nutating(motion: Nutating[R]) -> Callable[[R], ExactAttitude[R]]:
    """Return the attitude of a nutating top by its theta series, with the terms for all digits.

    The nome is exp(-pi r), where r is the larger of K'/K and K/K'. The exponent of the last term is
    at least the logarithm of the precision over the logarithm of the nome.
    """
    ar: Any = motion.ar
    K, K_prime, terms = motion.K, motion.K_prime, 2
    if K_prime is not None:
        hundredths = max(ar.nint(100 * (x / y)) for x, y in ((K, K_prime), (K_prime, K)))
        terms += math.isqrt(int(ar.digits * math.log(10) / math.pi * 100 / hundredths))
    series, rises = theta_series(motion, terms), direction(motion)
    _, first_x, _, first_y = evaluate(ar, series, 0, series.offset, rises)

    def attitude(t: R) -> ExactAttitude[R]:
        passed = t / motion.T_nutation * 2 + series.offset
        step = ar.nint(passed)
        phase = passed - step
        x, arg_x, y, arg_y = evaluate(ar, series, step, phase, rises)
        x_slope, y_slope = ((phase - series.offset) * slope for slope in series.slopes)
        plus, minus = x_slope + (arg_x - first_x), y_slope + (arg_y - first_y)
        phi = t * motion.mean_spin_rate + (plus - minus)
        psi = t * motion.mean_precession_rate + (plus + minus)
        about_u2 = (step + series.first) % 2
        return ExactAttitude(x, y, phi, psi, -phase if about_u2 else phase)

    return attitude


def _constant(motion: Constant[R]) -> Callable[[R], ExactAttitude[R]]:
    """Return the attitude for a constant tilt and constant rates."""
    state = motion.state

    def attitude(t: R) -> ExactAttitude[R]:
        phi, psi = motion.mean_spin_rate * t, state.psi_rate * t
        return ExactAttitude(state.cos_half, state.sin_half, phi, psi, 0 * t)

    return attitude


def _on_separatrix(motion: Separatrix[R]) -> Callable[[R], ExactAttitude[R]]:
    """Return the attitude on the separatrix: 1 - u = (1 - u2)/cosh^2 h, h = speed t + offset."""
    ar: Any = motion.ar
    offset, real, y, start = separatrix_constants(motion)

    def attitude(t: R) -> ExactAttitude[R]:
        h = motion.argument_rate * t + offset
        imag = y * ar.tanh(h)
        turned = ar.atan2(imag, real) - start if t else 0 * t
        half_b = motion.b * t / 2
        phi, psi = motion.r0 * t - half_b + turned, half_b + turned
        x = ar.sqrt(real * real + imag * imag)
        return ExactAttitude(x, abs(y) * ar.sech(h), phi, psi, -h)

    return attitude
