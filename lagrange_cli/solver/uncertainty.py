"""First-order propagation of uncertainties (GUM 5.1.2) for the record."""

from __future__ import annotations

import math
from collections.abc import Mapping
from decimal import Context, Decimal
from fractions import Fraction
from functools import cache, partial
from typing import Any, NamedTuple

from ..arithmetic.enclosures import rounded
from ..errors import OutOfRangeError
from .derivatives import DIFFERENTIABLE, Derivatives, moved
from .keys import INPUT_KEYS, TEXT_KEYS, degree_name
from .solve import Motion

_CONTEXT = Context(prec=40)
MISLEADING = 0.15
"""Least error of linear propagation that is reported, over the uncertainty."""
_WEIGHTS = {1: 1 / 6, 2: 1 / 12}
"""Weights by number of standard deviations, on either side of an input.

With them, the second and the fourth moment are those of a normal distribution.
"""
_LEAST = 1e-9
"""Least error that is reported, over the number."""


class Contribution(NamedTuple):
    """A line of a budget: the contribution of an input to the uncertainty of a number.

    The number itself has a line that ends with its uncertainty.
    """

    quantity: str
    value: float
    std: float
    sensitivity: float | None = None
    """The derivative of the number with respect to the input."""
    contribution: float | None = None
    """The product of sensitivity and uncertainty, with its sign."""
    elasticity: float | None = None
    """The relative change of the number over the relative change of the input, or None."""
    share: float | None = None
    """The share of the variance, or None."""


class FirstOrder:
    """Standard uncertainties of the record of a top, correctly rounded.

    A key in radians ends in `_rad`.
    """

    def __init__(self, motion: Motion, stds: Mapping[str, float]) -> None:
        """Take the uncertainties of the inputs as given."""
        self.motion, self.stds = motion, stds
        self.derivatives = Derivatives(motion)
        self.away = cache(partial(away, motion, stds))

    def has(self, key: str) -> bool:
        """Return whether a key is an input, or a number of the motion with derivatives."""
        name = degree_name(key)
        return name in INPUT_KEYS or (name in DIFFERENTIABLE and self.motion.has(name))

    def slope(self, key: str, name: str) -> Fraction | None:
        """Return the derivative of a key or input with respect to a given input, or None."""
        if key in self.derivatives.inputs:
            return Fraction(key == name)
        return self.derivatives.of(key, name)

    def std(self, key: str) -> float | None:
        """Return the standard uncertainty of a key or an input, or None.

        Raises OutOfRangeError if it is beyond the doubles.
        """
        variance = self._variance(key) if self.has(key) else None
        if variance is None:
            return None
        ratio = Decimal(variance.numerator), Decimal(variance.denominator)
        found = _CONTEXT.sqrt(_CONTEXT.divide(*ratio))
        nearest: float = rounded(f"the uncertainty of {key}", found, None) if float(found) else 0.0
        return nearest

    def _variance(self, key: str) -> Fraction | None:
        slopes = {name: self.slope(key, name) for name in self.stds}
        if None in slopes.values():
            return None
        parts = [(slopes[name] or 0) * Fraction(std) for name, std in self.stds.items()]
        return sum((part * part for part in parts), Fraction(0))

    def misleads(self, key: str, std: float) -> bool:
        """Return whether linear propagation misleads for a number with an uncertainty.

        It does if motions one and two standard deviations away have a different spread about the
        number, or lack it.
        """
        if degree_name(key) not in DIFFERENTIABLE:
            return False
        here, parts = _value(self.motion, key) or 0.0, []
        for weight, motion in self.away():
            there = _value(motion, key)
            if there is None:
                return True
            parts.append(math.sqrt(weight) * (there - here))
        return abs(math.hypot(*parts) - std) > MISLEADING * std + _LEAST * abs(here)

    def budget(self, key: str, given: Mapping[str, float]) -> list[Contribution]:
        """Return the contributions of the uncertain inputs to a key, the greatest first.

        `given` holds the values of the inputs.  The key must have an uncertainty.
        """
        found = self.motion.number(key, 40)
        value = Fraction(found.value) if found else None
        variance, lines = self._variance(key), []
        for name, std in self.stds.items():
            slope = self.slope(key, name) or Fraction(0)
            part = slope * Fraction(std)
            parts = {
                "sensitivity": slope,
                "contribution": part,
                "elasticity": slope * Fraction(given[name]) / value if value else None,
                "share": part * part / variance if variance else None,
            }
            numbers = {
                x: None if y is None else rounded(f"the {x} of {name}", y, None)
                for x, y in parts.items()
            }
            lines.append(Contribution(name, given[name], std, **numbers))
        return sorted(lines, key=lambda line: -abs(line.contribution or 0))


def away(motion: Motion, stds: Mapping[str, float]) -> list[tuple[float, Motion]]:
    """Return motions with one input one or two standard deviations away, each after its weight.

    The weighted squares of the changes of a number add up to its variance.  If there is a top on
    one side only, it counts twice.
    """
    found = []
    for name, std in stds.items():
        for number, weight in _WEIGHTS.items():
            changes = (side * number * Fraction(std) for side in (-1, 1))
            beside = [x for change in changes if (x := moved(motion, name, change))]
            found += [(2 * weight / len(beside), x) for x in beside]
    return found


def _value(motion: Motion, key: str) -> float | None:
    """Return a number of a motion as a double; None if it does not exist, or not as a double."""
    try:
        found = motion.number(key)
    except OutOfRangeError:
        return None
    return None if found is None else float(found.value)


def stds_of(
    record: Mapping[str, Any], uncertain: FirstOrder
) -> tuple[dict[str, float | None], list[OutOfRangeError]]:
    """Return `KEY_std` for every number of a record, in its units, and those beyond the doubles."""
    stds: dict[str, float | None] = {}
    beyond = []
    for name, value in record.items():
        if not isinstance(value, str) and name not in TEXT_KEYS:
            stds[f"{name}_std"] = None
            try:
                stds[f"{name}_std"] = None if value is None else uncertain.std(name)
            except OutOfRangeError as error:
                beyond.append(error)
    return stds, beyond
