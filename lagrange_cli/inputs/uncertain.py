"""Uncertain inputs: how they are written, and what those that are measured mean for a top.

`1587(2)`, `1587+/-2`, `1587±2` and `1587 +/- 0.1 %` are a value and its standard uncertainty.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from fractions import Fraction
from typing import Any

from ..arithmetic.text import is_decimal, parse_number
from ..arithmetic.values import Values
from ..errors import LagtopError
from .top import Top

_DECIMAL = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_PLUS_MINUS = rf"(?P<value>{_DECIMAL})\s*(?:\+/-|±)\s*(?P<std>{_DECIMAL})\s*(?P<percent>%?)"
_FORMS = (
    re.compile(r"(?P<value>[+-]?(?:\d+\.?\d*|\.\d+))\((?P<last>\d+\.?\d*)\)(?P<exponent>[eE].*)?"),
    re.compile(_PLUS_MINUS),
    re.compile(rf"\(\s*{_PLUS_MINUS}\s*\)(?P<exponent>[eE].*)?"),
)


class Uncertain(Values):
    """A number and its standard uncertainty, both exact."""

    value: Any
    """A Fraction; in a sweep what stands for such an input of all tops."""
    std: Fraction

    def scaled(self, factor: Fraction) -> Uncertain:
        """Return the number in another unit."""
        value = self.value
        value = value.scaled(factor) if hasattr(value, "scaled") else value * factor
        return Uncertain(value, self.std * abs(factor))


def parse_uncertain(text: str) -> Fraction | Uncertain:
    """Return a number, with its standard uncertainty where one is written.

    Raises LagtopError for anything else, and for an uncertainty that is negative.
    """
    text = text.strip()
    found = next((match for form in _FORMS if (match := form.fullmatch(text))), None)
    if is_decimal(text) or found is None:
        if not re.search(r"[(±%]|\+/-", text):
            return parse_number(text)
        forms = "1587(2), 1587+/-2 or 1587+/-0.1%"
        raise LagtopError(f"must be a number, or an uncertain one as {forms}, got {text[:60]!r}")
    parts = found.groupdict(default="")
    exponent = parts.get("exponent", "")
    value = parse_number(parts["value"] + exponent)
    if "last" in parts:
        last = parts["last"]
        decimals = 0 if "." in last else len(parts["value"].partition(".")[2])
        std = parse_number(f"{last}e-{decimals}") * parse_number(f"1{exponent}")
    else:
        std = parse_number(parts["std"]) * parse_number(f"1{exponent}")
        std = abs(value) * std / 100 if parts["percent"] else std
    if std < 0:
        raise LagtopError(f"must have an uncertainty >= 0, got {text[:60]!r}")
    return Uncertain(value, std)


def by_given(top: Top, given: Collection[str]) -> dict[str, dict[str, float]]:
    """Return the derivatives of the inputs of a solved top by those that were given.

    These are the same but for A = A_cm + m s^2 and r0 = phidot0 + psidot0 cos(theta0).
    """
    tilt = "theta0_deg" if top.theta0_rad is None else "theta0_rad"
    angle = float(top.theta0_rad or 0) if top.theta0_deg is None else math.radians(top.theta0_deg)
    arc = 1.0 if top.theta0_deg is None else math.pi / 180
    m, s, psi_rate = float(top.m), float(top.s), float(top.psidot0)
    names = ["m", "A", "C", "s", "g", "r0", tilt, "thetadot0", "psidot0"]
    chain = {name: {name: 1.0} for name in names}
    if "A_cm" in given:
        del chain["A"]
        chain["A_cm"] = {"A": 1.0}
        chain["m"]["A"], chain["s"]["A"] = s * s, 2 * m * s
    if "phidot0" in given:
        del chain["r0"]
        chain["phidot0"] = {"r0": 1.0}
        chain["psidot0"]["r0"] = math.cos(angle)
        chain[tilt]["r0"] = -psi_rate * math.sin(angle) * arc
    return chain
