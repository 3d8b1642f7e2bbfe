"""Derivatives of the numbers and angles of a motion with respect to the inputs of its top.

The record: each input is moved by 2^-200 of its size to either side, and the numbers have 140
digits or more.  The difference quotient agrees with the derivative to some 60 digits.  If a
degenerate motion may be too near, the step is 2^-1000.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

from flint import arb

from ..arithmetic.enclosures import BITS, TooFewDigitsError, decided, exact, fraction, rounded, sign
from ..errors import LagtopError
from ..names import check_names
from ..top.inputs import DECLARED
from ..top.top import Top
from .keys import NUMBER_KEYS, TEXTBOOK_KEYS, bare_name
from .solve import Motion, solve

DIFFERENTIABLE = [*NUMBER_KEYS, *TEXTBOOK_KEYS]
"""The keys that have derivatives."""
NO_DERIVATIVE = "there is a kink or a jump at this top, or no value next to it"
"""The reason why a number of a motion has no derivative with respect to some input."""

_STEPS, _SHARP = (200, 1_000), 30
"""Binary orders of the steps to try, over the size of an input, and digits of a derivative."""
_ALIKE, _NEGLIGIBLE = 1e-20, 1e-55
_LEAST_DOUBLE = Fraction(1, 2**1075)
_CENTRAL, _AHEAD = {-1: -0.5, 0: 0.0, 1: 0.5}, {0: -1.5, 1: 2.0, 2: -0.5}
"""Weights of neighbours in a derivative, by place in steps."""


class Sensitivities(NamedTuple):
    """Derivatives of the numbers of a record with respect to the inputs; NaN if undefined."""

    top: Top
    inputs: tuple[str, ...]
    """The nine inputs as they were given: A_cm in place of A, a tilt in radians ..."""
    derivatives: dict[str, dict[str, float]]
    """Derivatives by key and input, in the units of both, without keys that the motion lacks."""


def sensitivities(top: Top, keys: Collection[str] | None = None) -> Sensitivities:
    """Return the derivatives of the numbers of a record, or of some keys, with respect to inputs.

    Keys of elementary theory have derivatives if they are named.  Each derivative is the nearest
    double; below 1e-55 of the number over the input it may be 0.  Angles are in degrees, also if
    the input is `theta0_rad`.  A derivative is one-sided if the input is at the end of its range,
    such as g = 0, and 0 if the input can have no other value.  It is NaN if the number has a kink
    or a jump at this top, or does not exist next to it.  Raises LagtopError for an unknown key, and
    OutOfRangeError for a derivative that no double holds.

    >>> sensitivities(Top(), ["T_nutation"]).derivatives["T_nutation"]["r0"]
    -0.0047282954028118425
    """
    chosen = check_names("keys", list(NUMBER_KEYS if keys is None else keys), DIFFERENTIABLE)
    found = Derivatives(solve(top))
    rows = {
        key: {name: found.nearest(key, name) for name in found.inputs}
        for key in DIFFERENTIABLE
        if key in chosen and found.motion.has(key)
    }
    return Sensitivities(top, found.inputs, rows)


class Derivatives:
    """Derivatives of the numbers of one motion with respect to the inputs of its top."""

    def __init__(self, motion: Motion) -> None:
        self.motion, self.inputs = motion, inputs_of(motion.top)
        self.of, self.neighbours = cache(self._of), cache(self._neighbours)

    def nearest(self, key: str, name: str) -> float:
        """Return the derivative of a key with respect to an input as a double, or NaN.

        Raises OutOfRangeError for a derivative beyond the doubles.
        """
        found = self.of(key, name)
        if found is None:
            return math.nan
        if abs(found) < _LEAST_DOUBLE:
            return 0.0
        nearest: float = rounded(f"the derivative of {key} with respect to {name}", found, None)
        return nearest

    def _neighbours(self, name: str, order: int = _STEPS[0]) -> tuple[Fraction, Neighbours]:
        step = Fraction(size_of(self.motion, name)) / 2**order
        return step, neighbours(self.motion, name, step)

    def _of(self, key: str, name: str) -> Fraction | None:
        """Return the derivative of a key with respect to an input to 30 digits, or None."""
        quotients = (self._quotient(key, name, order) for order in _STEPS)
        return next((x for x in quotients if x is not None), None)

    def _quotient(self, key: str, name: str, order: int) -> Fraction | None:
        """Return the derivative from differences, with the step 2^-order of the size of the input.

        It is None if the motion differs too much from its neighbours.
        """
        step, beside = self.neighbours(name, order)
        if not beside:
            return Fraction(0)
        h, size = exact(step), exact(step * 2**order)

        def quotient(digits: int) -> Fraction | None:
            values = [_value(x, key, digits) for x, _ in beside]
            if any(x is None for x in values):
                return None
            first, last = ((y - x) / h for x, y in pairwise(values))
            bent = last - first
            largest = max(x.abs_lower() for x in values)
            steepest = max(x.abs_upper() for x in (first, last))
            scale = (arb(1) if largest.is_zero() else largest) / size
            limit = _ALIKE * (steepest + scale)
            if _exceeds(abs(bent), limit) or _exceeds(4 * h * steepest, largest):
                # a kink or a jump, unless the number is 0 here and its curvature is constant
                middle, end = (Fraction(getattr(x.top, name)) for x, _ in beside[1:])
                beyond = moved(beside[2][0], name, end - middle)
                more = _value(beyond, key, digits) if beyond else None
                if more is None:
                    return None
                bent = (more - values[2]) / h - last - bent
            if _exceeds(abs(bent), limit):
                return None
            slope = sum(x * weight for x, (_, weight) in zip(values, beside, strict=True)) / h
            if not _exceeds(slope.abs_upper(), _NEGLIGIBLE * scale * size.min(arb(1))):
                return Fraction(0)
            if slope.rel_accuracy_bits() < _SHARP * BITS:
                raise TooFewDigitsError
            return fraction(slope.mid())

        most = max(x.facts.equal for x, _ in beside) + order
        what = f"a derivative of {key}"
        return decided(quotient, most, digits=order // 2, lost=order // 4, what=what)


def _value(motion: Motion, key: str, digits: int) -> Any:
    """Return a ball that holds a number; None if the number does not exist."""
    ball = motion.ball(key, digits)
    if ball is not None and not ball.is_finite():
        raise TooFewDigitsError
    return ball


def _exceeds(x: arb, limit: arb) -> bool:
    return sign(limit - x) < 0


def inputs_of(top: Top) -> tuple[str, ...]:
    """Return the keys of the inputs of a top that were given as numbers."""
    names = [name for name, x in top.as_dict().items() if x is not None]
    order = [name for key in DECLARED for name in names if bare_name(name) == key]
    return tuple(name for name in order if not (name == "psidot0" and top.steady_word))


def moved(motion: Motion, name: str, change: Fraction) -> Motion | None:
    """Return the motion with one input changed, or None if there is no such top."""
    if not change:
        return motion
    try:
        return solve(motion.top.replace(**{name: Fraction(getattr(motion.top, name)) + change}))
    except LagtopError:
        return None


Neighbours = list[tuple[Motion, float]]
"""Three motions at equal steps of one input, with their weights in a derivative times the step."""


def neighbours(motion: Motion, name: str, step: Fraction) -> Neighbours:
    """Return neighbours on both sides or, if the input is at the end of its range, on one.

    The list is empty if the input can have no other value.
    """
    for weights, side in ((_CENTRAL, 1), (_AHEAD, 1), (_AHEAD, -1)):
        motions = {place: moved(motion, name, side * place * step) for place in weights}
        found = [(x, side * weights[place]) for place, x in motions.items() if x]
        if len(found) == len(weights):
            return found
    return []


def size_of(motion: Motion, name: str) -> float:
    """Return the size of an input or, for 0, a size that changes the motion."""
    if value := float(getattr(motion.top, name)):
        return abs(value)
    A, C, m, s, g = (float(getattr(motion.top, x)) for x in ("A", "C", "m", "s", "g"))
    rate = 2 * math.pi / (motion.T_nutation or 1.0)
    if name in {"g", "s"}:
        other = m * (s if name == "g" else g)
        return A * rate * rate / other if other else 1.0
    if name == "thetadot0":
        return rate * min(sines(motion).values(), default=1.0)
    spin = rate * max(1.0, A / C)
    return {"r0": spin, "phidot0": spin, "psidot0": rate, "A_cm": A}.get(name, 1.0)


def sines(motion: Motion) -> dict[str, float]:
    """Return the sines of the extreme tilts that are not 0, by key."""
    tilts = {key: getattr(motion, key) for key in ("theta_min_deg", "theta_max_deg")}
    return {key: math.sin(math.radians(x)) for key, x in tilts.items() if x and x < 180}
