"""First-order propagation of uncertainties (GUM 5.1.2), with the exact derivatives of the record.

Every number is rounded from an enclosure, like the numbers of the record.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

from ...arithmetic.ball import Ball
from ...arithmetic.balls import balls
from ...arithmetic.numbers import R
from ...arithmetic.protocol import Arithmetic
from ...arithmetic.rounding import rounded
from ...inputs.top import Top
from ...inputs.value import Stds
from ..numbers import Numbers
from ..quantity import degree_name
from ..record import TEXT_KEYS
from ..regime import exact
from .sensitivities import DIFFERENTIABLE, Slopes

_CANCELLED = Decimal("1e-20")


class Contribution(NamedTuple):
    """The contribution of one input to the uncertainty of a number: one line of a budget."""

    input: str
    value: float
    std: float
    sensitivity: float
    """The derivative of the number by the input."""
    contribution: float
    """The product of sensitivity and uncertainty, with its sign."""
    elasticity: float | None
    """The relative change of the number over the relative change of the input, or None."""
    share: float | None
    """The share of the variance, or None."""


class FirstOrder:
    """Standard uncertainties of the record of a top.

    A key in radians ends in `_rad`.  Contributions of correlated inputs that cancel to 20 digits
    count as 0.
    """

    def __init__(self, top: Top, stds: Stds, given: Collection[str]) -> None:
        """Take the uncertainties of the inputs as given, and the names of all given inputs.

        Raises LagtopError for an impossible start.
        """
        self.top, self.stds, self.given = top, stds, given
        self.motion = Numbers(exact(top))
        self.slopes = Slopes(self.motion.exact)

    def has(self, key: str) -> bool:
        """Return whether a key is an input, or a number that the motion has."""
        name = degree_name(key)
        if name in self.top.fields or name in self.given:
            return True
        return name in DIFFERENTIABLE and self.slopes.has(name)

    def slope(self, key: str, name: str, digits: int) -> Ball:
        """Return the derivative of a key or input by a given input; NaN if it does not exist."""
        ar = balls(digits)
        row = by_given(ar, self.top, self.given)[name]
        tilt = "theta0_deg" if self.top.theta0_rad is None else "theta0_rad"
        same = tilt if degree_name(key) == "theta0_deg" else degree_name(key)
        if same in self.slopes.chain or same in self.given:
            total = row.get(same, ar.convert(0))
        else:
            total = self.slopes.enclosure(same, row, digits)
        if same == key:
            return total
        return total * (ar.pi / 180) if key.endswith("_rad") else total * 180 / ar.pi

    def std(self, key: str) -> float | None:
        """Return the standard uncertainty of a key or an input, or None."""
        std = self._rounded(key, lambda digits: balls(digits).sqrt(self._variance(key, digits)))
        return None if std is None or math.isnan(std) else std

    def _rounded(self, key: str, enclosure: Any) -> float | None:
        return rounded(f"the uncertainty of {key}", enclosure) if self.has(key) else None

    def _part(self, key: str, name: str, digits: int) -> Ball:
        return self.slope(key, name, digits) * balls(digits).convert(self.stds[name])

    def _variance(self, key: str, digits: int) -> Ball:
        ar, zero = balls(digits), balls(digits).convert(0)
        parts = {name: self._part(key, name, digits) for name in self.stds}
        variance = zero
        for size, shares in self.stds.sources:
            changes = [parts[name] * ar.convert(share) for name, share in shares.items()]
            change = sum(changes, zero)
            if len(changes) > 1 and not change.is_nan:
                largest = max(x.greatest for x in changes)
                change = change if change.greatest > _CANCELLED * largest else zero
            variance += change * change * ar.convert(size)
        return variance

    def budget(self, key: str, given: Mapping[str, float]) -> list[Contribution]:
        """Return the contributions of the uncertain inputs to a key, the greatest first.

        `given` holds the values of the inputs.
        """
        value, whole = self.motion.number(degree_name(key)), self.std(key)
        assert value is not None
        lines = [
            Contribution(
                name,
                given[name],
                std,
                rounded(key, partial(self.slope, key, name)),
                rounded(key, partial(self._part, key, name)),
                rounded(key, partial(self._elasticity, key, name, given)) if value.value else None,
                rounded(key, partial(self._share, key, name)) if whole else None,
            )
            for name, std in self.stds.items()
        ]
        return sorted(lines, key=lambda line: -abs(line.contribution))

    def _elasticity(self, key: str, name: str, given: Mapping[str, float], digits: int) -> Ball:
        """Return the relative change of a key over the relative change of an input."""
        in_degrees = degree_name(key)
        value = self.motion.enclosure(in_degrees, digits)
        assert value is not None
        slope = self.slope(in_degrees, name, digits)
        return slope * balls(digits).convert(given[name]) / value

    def _share(self, key: str, name: str, digits: int) -> Ball:
        """Return the share of an input in the variance of a key."""
        part = self._part(key, name, digits)
        return part * part / self._variance(key, digits)


def by_given(ar: Arithmetic[R], top: Top, given: Collection[str]) -> dict[str, dict[str, R]]:
    """Return the derivatives of the inputs of a solved top by the given inputs.

    The two sets differ only by A = A_cm + m s^2 and r0 = phidot0 + psidot0 cos(theta0).
    """
    tilt = "theta0_deg" if top.theta0_rad is None else "theta0_rad"
    one, m, s = (ar.convert(Fraction(x)) for x in (1, top.m, top.s))
    names = ["m", "A", "C", "s", "g", "r0", tilt, "thetadot0", "psidot0"]
    chain = {name: {name: one} for name in names}
    if "A_cm" in given:
        del chain["A"]
        chain["A_cm"] = {"A": one}
        chain["m"]["A"], chain["s"]["A"] = s * s, 2 * m * s
    if "phidot0" in given:
        angle, arc = top.tilt(ar), one if top.theta0_deg is None else ar.pi / 180
        del chain["r0"]
        chain["phidot0"] = {"r0": one}
        chain["psidot0"]["r0"] = angle.cos
        chain[tilt]["r0"] = -ar.convert(Fraction(top.psidot0)) * angle.sin * arc
    return chain


def stds_of(record: Mapping[str, Any], uncertain: FirstOrder) -> dict[str, float | None]:
    """Return `KEY_std` for every number of a record, in its units."""
    return {
        f"{name}_std": None if value is None else uncertain.std(name)
        for name, value in record.items()
        if not isinstance(value, str) and name not in TEXT_KEYS
    }
