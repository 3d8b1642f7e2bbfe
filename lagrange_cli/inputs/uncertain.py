"""Uncertain inputs: how they are written.

`1587(2)`, `1587+/-2`, `1587+-2`, `1587±2` and `1587 +/- 0.1 %` are a value and its standard
uncertainty.
"""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

from ..arithmetic.text import is_decimal, parse_number, quoted
from ..arithmetic.values import Values
from ..errors import LagtopError

_DECIMAL = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_PLUS_MINUS = rf"(?P<value>{_DECIMAL})\s*(?:\+/?-|±)\s*(?P<std>{_DECIMAL})\s*(?P<percent>%?)"
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
        if not re.search(r"[(±%]|\+/?-", text):
            return parse_number(text)
        forms = "1587(2), 1587+/-2 or 1587+/-0.1%"
        raise LagtopError(f"must be a number, or an uncertain one as {forms}, got {quoted(text)}")
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
        raise LagtopError(f"must have an uncertainty >= 0, got {quoted(text)}")
    return Uncertain(value, std)
