"""Exact derivatives of the numbers of the record with respect to the inputs.

The formulas of the record are evaluated in dual numbers.  In a degenerate motion a number may have
a kink or a jump.  It then has no derivative along some inputs, and `Sensitivities.reasons` gives
the reason.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from functools import cache, cached_property, partial
from typing import Any

from ...arithmetic.ball import Ball, UndefinedError
from ...arithmetic.balls import balls
from ...arithmetic.duals import Dual
from ...arithmetic.rounding import decided, rounded
from ...arithmetic.values import Values
from ...inputs.names import check_names
from ...inputs.top import Top
from ..any_start import cubic
from ..exact.rational_keys import is_endless
from ..gaps import Gaps, State
from ..kinds import Constant
from ..numbers import kind_of
from ..paper.requested import TEXTBOOK
from ..quantity import quantity
from ..record import NUMBER_KEYS
from ..regime import Exact, Regime, exact
from .neighbourhood import (
    PARAMETERS,
    Neighbourhood,
    by_inputs,
    generic_gaps,
    moving_root,
    neighbourhood,
    textbook_partials,
)

_MEANS = frozenset("mean_spin_rate mean_precession_rate T_spin T_precession".split())
_OF_THE_START = frozenset("spin_rate_start precession_rate_start".split())
_AFTER_REST = frozenset("amplitude_deg alpha".split())
DIFFERENTIABLE = [*NUMBER_KEYS, *TEXTBOOK]
"""The keys that have derivatives."""


class Sensitivities(Values):
    """Derivatives of the numbers of a record by the inputs; NaN if one does not exist."""

    top: Top
    inputs: tuple[str, ...]
    """The nine inputs; the tilt is in degrees or radians, as given."""
    derivatives: dict[str, dict[str, float]]
    """Derivatives by key and input, in the units of both, without keys that the motion lacks."""
    reasons: dict[str, str]
    """The reason why a key has no derivative by some input, in one sentence, by key."""


def sensitivities(top: Top, keys: Collection[str] | None = None) -> Sensitivities:
    """Return the derivatives of all numbers of the record of a top by all inputs, or of some keys.

    Keys of elementary theory have derivatives if they are named.  Each derivative is correctly
    rounded, as proved by an enclosure.  Angles are in degrees, also in derivatives by `theta0_rad`.
    In steady precession, over a pole or on the separatrix some numbers have a kink or a jump: their
    derivatives are NaN.  Raises LagtopError for an unknown key.

    >>> sensitivities(Top(), ["T_nutation"]).derivatives["T_nutation"]["r0"]
    -0.0047282954028118425
    """
    chosen = check_names("keys", list(NUMBER_KEYS if keys is None else keys), DIFFERENTIABLE)
    slopes = Slopes(exact(top))
    names = tuple(slopes.chain)
    rows = {
        key: {name: slopes.derivative(key, name) for name in names}
        for key in DIFFERENTIABLE
        if key in chosen and slopes.has(key)
    }
    missing = [key for key, row in rows.items() if any(map(math.isnan, row.values()))]
    return Sensitivities(top, names, rows, {key: slopes.reason(key) for key in missing})


class Slopes:
    """Derivatives of the numbers of one motion by its inputs, in balls of any number of digits."""

    def __init__(self, scene: Exact) -> None:
        self.exact, self.chain = scene, by_inputs(scene)
        self.at: Callable[[int], Partials] = cache(partial(Partials, scene))
        """Returns the derivatives by the parameters of the neighbourhood in a number of digits."""

    def has(self, key: str) -> bool:
        """Return whether the motion has a key."""
        return decided(key, lambda digits: self._by_parameters(key, digits)) is not None

    def _by_parameters(self, key: str, digits: int) -> dict[str, Ball] | None:
        """Return the derivatives of a key by the parameters on which it may depend."""
        if key in TEXTBOOK:
            return textbook_partials(self.exact, key, digits)
        partials = self.at(digits).of(key)
        return None if partials is None else dict(zip(PARAMETERS, partials, strict=True))

    def enclosure(self, key: str, by: Mapping[str, Ball | int], digits: int) -> Ball:
        """Return a ball that contains the sum of derivatives by inputs, each with its weight.

        The ball is NaN if one of them does not exist, or if the motion has no such key.
        """
        partials, ar = self._by_parameters(key, digits), balls(digits)
        if partials is None:
            return ar.nan
        total = ar.convert(0)
        for name, weight in by.items():
            for parameter, factor in self.chain[name].items():
                if parameter in partials:
                    total = total + partials[parameter] * ar.convert(factor) * weight
        return total

    def derivative(self, key: str, name: str) -> float:
        """Return the correctly rounded derivative of a key by an input; NaN if there is none."""
        return rounded(f"a derivative of {key}", lambda x: self.enclosure(key, {name: 1}, x))

    def reason(self, key: str) -> str:
        """Return why a key has no derivative along some parameters."""
        if key in TEXTBOOK:
            return f"{key} has an infinite slope or a kink, because a square root in it is 0"
        return decided(key, lambda digits: self.at(digits).reason(key))


class Partials:
    """Derivatives of the numbers of one motion by the parameters of its neighbourhood, in balls."""

    def __init__(self, scene: Exact, digits: int) -> None:
        """Raise TooFewDigitsError if `digits` digits do not separate the roots."""
        self.exact, self.near = scene, neighbourhood(scene, digits)
        self._none = [self.near.ar.plain.convert(0)] * len(PARAMETERS)
        self._nan = self.near.ar.plain.nan

    def of(self, key: str) -> list[Ball] | None:
        """Return the derivatives of a key by `PARAMETERS`, or None if the motion lacks the key."""
        kind = self._at_rest if key in _AFTER_REST else self.here
        if key in kind.lacks or is_endless(self.exact, key):
            return None
        value: Dual | None = getattr(kind, key)
        if value is None:
            return None
        if key == "a":  # constant without torque, but not in the neighbours
            return list(self.near.moved.a.partials or ())
        beside = self._beside(key) if self.near.broken else []
        partials = []
        for i, name in enumerate(PARAMETERS):
            if name in self._leaves(key):
                partials.append(self._nan)
            elif name in self.near.broken:
                partials.append(beside[i])
            else:
                partials.append((value.partials or self._none)[i])
        return partials

    def reason(self, key: str) -> str:
        """Return why a key has no derivative along some parameters."""
        facts = self.exact.facts
        if facts.regime is Regime.SEPARATRIX:
            return "the period of the nutation is finite next to the separatrix and infinite on it"
        if facts.pole and facts.steady:
            return "next to the vertical, unlike on it, the tilt and both rates are independent"
        if facts.steady:
            return f"{key} has a kink: next to a steady precession the axis nutates"
        if self._leaves(key):
            return f"{key} does not exist for neighbouring starts"
        return f"{key} has a kink or a jump because the axis passes over a pole"

    def _leaves(self, key: str) -> frozenset[str]:
        """Return the parameters along which a key exists only at the top itself."""
        if key in _AFTER_REST:
            return frozenset({"theta_rate", "psi_rate"})
        leaves = key == "u_quarter" and not self.exact.facts.pole
        return frozenset({"theta_rate"} if leaves else ())

    def _kind(self, start: State[Dual], gaps: Gaps[Dual], **changes: Any) -> Any:
        """Return motions next to the top, with some of the facts changed."""
        facts = self.near.facts.replace(**changes)
        return kind_of(self.exact.facts)(self.near.ar, facts, start, gaps)

    @cached_property
    def here(self) -> Any:
        """The motions next to the top for which the same facts hold."""
        return self._kind(self.near.state, self.near.gaps)

    @cached_property
    def _at_rest(self) -> Any:
        return self._kind(self.near.state, self.near.gaps, at_rest=self.exact.facts.at_rest)

    @cached_property
    def generic(self) -> Any:
        """The motions next to a torque-free one, or next to one that passes over a pole."""
        gaps = generic_gaps(self.near)
        return self._kind(self.near.moved, gaps, over_bottom=False, upper_root=0)

    @cached_property
    def generic_means(self) -> Any:
        """Motions whose mean rates use the formulas for tops with torque."""
        generic = self.generic
        return self._kind(generic.state, generic.gaps, over_bottom=False, upper_root=0, free=False)

    @cached_property
    def _above_lowest(self) -> Any:
        return self._kind(self.near.state, lowest_gaps(self.near))

    @cached_property
    def _about_steady(self) -> NearSteady:
        near = self.near
        return NearSteady(near.ar, near.facts, near.moved, mean_gaps(near))

    def _beside(self, key: str) -> list[Ball]:
        """Return the derivatives of a key by the formulas that hold next to a degenerate top."""
        kind = self._kind_beside(key)
        try:
            value: Dual | None = None if kind is None else getattr(kind, key)
        except UndefinedError:  # the formula divides by zero
            value = None
        if value is None or value.value.is_nan:
            return [self._nan] * len(PARAMETERS)
        return list(value.partials or self._none)

    def _kind_beside(self, key: str) -> Any:
        """Return the motion whose formulas hold next to a degenerate top, or None."""
        facts = self.exact.facts
        vertical = facts.steady and bool(facts.pole)
        if key == "b" or (key in _OF_THE_START and not vertical):
            return self.here
        if facts.regime is Regime.SEPARATRIX:
            return self._above_lowest if key in {"u2", "theta_max_deg"} else None
        if facts.steady:
            stands = facts.free and facts.at_rest and not facts.spins
            mean = key in _MEANS | {"T_nutation", "u3"} and not (vertical or stands)
            return self._about_steady if mean else None
        return self.generic_means if key in _MEANS else self.generic


class NearSteady(Constant[Dual]):
    """Tops next to a steady precession, whose gaps are measured from the mean (u1 + u2)/2.

    To first order in the nutation, the period and the mean rates take their values at the mean.
    """

    @quantity
    def mean_precession_rate(self) -> Dual:
        """The precession rate (4,7) at the mean."""
        return self.gaps.momentum_u1 / self.gaps.below_u1 / self.gaps.above_u1

    @quantity
    def mean_spin_rate(self) -> Dual:
        """The spin rate (4,8) at the mean."""
        return self.r0 - self.mean_precession_rate * self.u1


def mean_gaps(near: Neighbourhood) -> Gaps[Dual]:
    """Return the gaps next to a steady precession, with (u1 + u2)/2 in place of u1 and of u2.

    In steady precession c0 = c1 = 0.  Hence D = a (u3 - u0) = -c2 - a (x1 + x2) and x1 + x2 = c1/D.
    """
    momentum, (_, c1, c2) = near.moved.momentum, cubic(near.moved)
    x = c1 / -c2 / 2
    D = -c2 - 2 * near.moved.a * x
    x = Dual(near.ar.plain.convert(0), x.partials)
    gap = D - near.moved.a * x
    below, above = near.moved.below + x, near.moved.above - x
    return near.gaps.replace(
        u1_u=x,
        below_u1=below,
        above_u1=above,
        a_u3_u=D,
        a_u3_u1=gap,
        a_u3_u2=gap,
        a_u3_above=D - near.moved.a * near.moved.above,
        momentum_u1=momentum - near.moved.b * x,
    )


def lowest_gaps(near: Neighbourhood) -> Gaps[Dual]:
    """Return the gaps next to the separatrix; only the gaps of the simple root u2 are correct."""
    c0, c1, c2 = cubic(near.moved)
    root = moving_root(near.moved.a, c2, c1, c0, -near.gaps.u_u2.value)
    below, above = near.moved.below + root, near.moved.above - root
    return near.gaps.replace(u_u2=-root, below_u2=below, above_u2=above)
