"""Exact derivatives of the record: how each number answers to a small change of each input.

The formulas of the record are evaluated in dual numbers.  Where a motion is degenerate a number may
have a kink or leap; then it has no derivative along some inputs, and `Sensitivities.reasons` says
why.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from decimal import Decimal, DivisionByZero, InvalidOperation
from fractions import Fraction
from functools import cached_property
from typing import Any

from ..arithmetic.duals import Dual
from ..arithmetic.values import Values
from ..inputs.names import check_names
from ..inputs.top import Top
from .gaps import Gaps, cubic
from .kinds import Nutating, Steady, kind_of
from .neighbourhood import (
    PARAMETERS,
    Neighbourhood,
    by_inputs,
    fine_neighbourhood,
    generic_gaps,
    neighbourhood,
    smallness,
)
from .quantity import quantity
from .record import NUMBER_KEYS
from .regime import Exact, Regime, exact

_NAN = Decimal("NaN")
_NONE = [Decimal(0)] * len(PARAMETERS)
_SPARE, _NOISY = 4, 15
_MEANS = frozenset("mean_spin_rate mean_precession_rate T_spin T_precession".split())
_OF_THE_START = frozenset("spin_rate_start precession_rate_start".split())
_AFTER_REST = frozenset("amplitude_deg alpha".split())


class Sensitivities(Values):
    """Derivatives of the numbers of a record by the inputs; NaN where there is none."""

    top: Top
    inputs: tuple[str, ...]
    """The nine inputs; the tilt is in degrees or radians, as it was given."""
    derivatives: dict[str, dict[str, float]]
    """By key and input, in the units of both; keys that the motion does not have are left out."""
    reasons: dict[str, str]
    """Why a key has no derivative by some input, one sentence for each such key."""


def sensitivities(top: Top, keys: Collection[str] | None = None) -> Sensitivities:
    """Return the derivatives of all numbers of the record of a top by all inputs, or of some keys.

    Each is the nearest double.  Angles are in degrees, by `theta0_rad` too.  Next to a steady
    precession, over a pole or on the separatrix some numbers have a kink or leap: their derivatives
    are NaN.  Raises LagtopError for an unknown key.
    """
    check_names("keys", list(NUMBER_KEYS if keys is None else keys), NUMBER_KEYS)
    partials = Partials(exact(top))
    chain = by_inputs(partials.exact)
    found = {key: partials.of(key) for key in NUMBER_KEYS if keys is None or key in keys}
    derivatives = {}
    for key, row in found.items():
        if row is not None:
            with partials.near.ar.working():
                noise = partials.noise
                derivatives[key] = {name: chained(row, by, noise) for name, by in chain.items()}
    missing = (key for key, row in derivatives.items() if any(map(math.isnan, row.values())))
    reasons = {key: partials.reason(key) for key in missing}
    return Sensitivities(top, tuple(chain), derivatives, reasons)


def chained(partials: list[Decimal], by: dict[str, Fraction], noise: Decimal) -> float:
    """Return the derivative by an input, from those by the parameters that hang on it.

    What is left of parts that cancel is 0 below the `noise`, relative to them.
    """
    terms = [
        partial * by[name].numerator / by[name].denominator
        for name, partial in zip(PARAMETERS, partials, strict=True)
        if name in by
    ]
    total, size = sum(terms, Decimal(0)), sum(map(abs, terms), Decimal(0))
    cancelled = size.is_finite() and abs(total) <= noise * size
    return 0.0 if cancelled else float(total)


class Partials:
    """Derivatives of the numbers of one motion by the parameters of its neighbourhood."""

    def __init__(
        self, scene: Exact, near: Neighbourhood | None = None, spare: int = _SPARE
    ) -> None:
        """Take a motion; a difference may lose so many digits before more are taken."""
        self.exact, self.near, self.spare = scene, near or fine_neighbourhood(scene), spare
        self.noise = self.near.ar.plain.eps.scaleb(_NOISY + smallness(self.near))
        """What is left of parts that cancel is 0 below it, relative to them."""

    def of(self, key: str) -> list[Decimal] | None:
        """Return the derivatives of a key by `PARAMETERS`, or None where the motion has no such."""
        kind = self._at_rest if key in _AFTER_REST else self.here
        if key in kind.lacks:
            return None
        value: Dual | None = getattr(kind, key)
        if value is None:
            return None
        if key == "a":  # without torque it is a constant of the motion, but not of its neighbours
            return self._without_noise(list(self.near.moved.a.partials or ()), value.value)
        if key in _MEANS and self._loses_digits:
            return self._finer.of(key)
        beside = self._beside(key) if self.near.broken else []
        partials = []
        for i, name in enumerate(PARAMETERS):
            if name in self._leaves(key):
                partials.append(_NAN)
            elif name in self.near.broken:
                partials.append(beside[i])
            else:
                partials.append((value.partials or _NONE)[i])
        return self._without_noise(partials, value.value)

    def _without_noise(self, partials: list[Decimal], value: Decimal) -> list[Decimal]:
        """Return derivatives, 0 where a parameter of its usual size would move the last digits."""
        with self.near.ar.working():
            least = abs(value) * self.noise
            pairs = zip(partials, self._sizes, strict=True)
            return [x if x.is_nan() or abs(x) * size > least else Decimal(0) for x, size in pairs]

    @cached_property
    def _sizes(self) -> list[Decimal]:
        """How large the parameters are as a rule: rates and their squares, and a radian."""
        state = self.near.moved
        with self.near.ar.working():
            rates = state.r0, state.b, state.theta_rate, state.psi_rate
            rate = state.a.value.sqrt() + sum(abs(x.value) for x in rates) or Decimal(1)
            radian = Decimal(1 if self.exact.top.theta0_deg is None else 60)
            return [rate * rate, rate, rate, radian, rate, rate]

    def reason(self, key: str) -> str:
        """Return why a key has no derivative along some parameters."""
        facts = self.exact.facts
        if facts.regime is Regime.SEPARATRIX:
            return "next to the separatrix the nutation has a period, which leaps to infinity"
        if facts.pole and facts.steady:
            return "next to the vertical the tilt and both rates have a meaning of their own"
        if facts.steady:
            return f"{key} has a kink: next to a steady precession the axis nods"
        if self._leaves(key):
            return f"{key} is there after such a start only"
        return f"{key} has a kink or leaps where the axis passes over a pole"

    def _leaves(self, key: str) -> frozenset[str]:
        """Return the parameters along which a key is there at the top itself only."""
        if key in _AFTER_REST:
            return frozenset({"theta_rate", "psi_rate"})
        leaves = key == "u_quarter" and not self.exact.facts.pole
        return frozenset({"theta_rate"} if leaves else ())

    @cached_property
    def _loses_digits(self) -> bool:
        """Whether the mean rates are small differences of what they are made of."""
        if not isinstance(self.here, Nutating):
            return False
        with self.near.ar.working():
            rates = self.here.mean_spin_rate.value, self.here.mean_precession_rate.value
            parts = max(abs(self.here.r0.value), *map(abs, rates))
            least = parts * Decimal(10) ** -self.spare
            return any(0 < abs(rate) < least for rate in rates)

    @cached_property
    def _finer(self) -> Partials:
        """Derivatives computed in more digits."""
        digits = self.near.ar.digits
        near = neighbourhood(self.exact, 2 * digits)
        return Partials(self.exact, near, self.spare + near.ar.digits - digits)

    @cached_property
    def here(self) -> Any:
        """The motions next to the top for which the same facts hold."""
        near = self.near
        return kind_of(self.exact.facts)(near.ar, near.facts, near.state, near.gaps)

    @cached_property
    def _at_rest(self) -> Any:
        near, facts = self.near, self.near.facts.replace(at_rest=self.exact.facts.at_rest)
        return kind_of(self.exact.facts)(near.ar, facts, near.state, near.gaps)

    @cached_property
    def generic(self) -> Any:
        """The motions next to one that is free or passes over a pole."""
        near = self.near
        facts = near.facts.replace(over_bottom=False, upper_root=0)
        return kind_of(self.exact.facts)(near.ar, facts, near.moved, generic_gaps(near))

    @cached_property
    def generic_means(self) -> Any:
        """Motions whose means are formed as if there were a torque."""
        generic = self.generic
        facts = generic.facts.replace(free=False)
        return type(generic)(generic.ar, facts, generic.state, generic.gaps)

    @cached_property
    def _above_lowest(self) -> Any:
        near = self.near
        return kind_of(self.exact.facts)(near.ar, near.facts, near.state, lowest_gaps(near))

    @cached_property
    def _about_steady(self) -> NearSteady:
        near = self.near
        return NearSteady(near.ar, near.facts, near.moved, mean_gaps(near))

    def _beside(self, key: str) -> list[Decimal]:
        """Return the derivatives of a key by the formulas that hold next to a degenerate top."""
        kind = self._kind_beside(key)
        return [_NAN] * len(PARAMETERS) if kind is None else _partials(kind, key)

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


def _partials(kind: Any, key: str) -> list[Decimal]:
    """Return the derivatives of a key, NaN where a formula divides by 0."""
    try:
        value: Dual | None = getattr(kind, key)
    except (DivisionByZero, InvalidOperation):
        value = None
    return [_NAN] * len(PARAMETERS) if value is None else list(value.partials or _NONE)


class NearSteady(Steady[Dual]):
    """Tops next to a steady precession, whose gaps are those of the mean (u1 + u2)/2.

    To first order in the nutation the period and the mean rates are those at the mean.
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
    """Return the gaps next to a steady precession, with (u1 + u2)/2 in the place of u1 and of u2.

    There c0 and c1 vanish, so that D = a (u3 - u0) = -c2 - a (x1 + x2) and x1 + x2 = c1/D.
    """
    with near.ar.working():
        _, momentum, (_, c1, c2) = cubic(near.moved)
        x = c1 / -c2 / 2
        D = -c2 - 2 * near.moved.a * x
        x = Dual(Decimal(0), x.partials)
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
    """Return the gaps next to the separatrix, of which only those of the simple root u2 are right.

    As in `dual_root` a step of Newton's method from the root has the derivatives of the root.
    """
    with near.ar.working():
        _, _, (c0, c1, c2) = cubic(near.moved)
        a, x = near.moved.a, -near.gaps.u_u2.value
        slope = (3 * a.value * x + 2 * c2.value) * x + c1.value
        root = Dual(x)
        root = root - (((a * root + c2) * root + c1) * root + c0) / Dual(slope)
        below, above = near.moved.below + root, near.moved.above - root
        return near.gaps.replace(u_u2=-root, below_u2=below, above_u2=above)
