"""An input as people write it: a number, which may be uncertain, and the unit that may follow."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TypeVar

from ..arithmetic.text import quoted
from ..arithmetic.values import Over, Values
from ..errors import LagtopError

V = TypeVar("V")

_UNIT = re.compile(r"(?:(?:(?<=\s)1\s*)?/\s*)?(?![eE][+-]?\d)(?:[^\W\d_]|°).*", re.DOTALL)
"""From the first letter on that begins no exponent; `1/` or `/` before it belongs to the unit."""


TILT = "theta0"
"""The key of a tilt that has a unit of its own."""
_LOG = "log:"
"""How a range with equal ratios begins."""


class Quantity(Values, Over[V]):
    """A number in a unit of its own, as it was written; nothing is converted yet."""

    number: V
    """What stands before the unit: a Fraction, or whatever reads the number part makes of it."""
    unit: str


def split_unit(text: str) -> tuple[str, str]:
    """Return the number part of an input text and its unit, empty where there is none.

    The number part is what stands before the first letter that is not the e of an exponent; it may
    hold an uncertainty, such as `1587(2)` or `1587 +/- 0.1 %`.  A text without a digit before its
    first letter, such as `nan`, has no unit.  The unit of a range or a list stands at its end,
    behind a number: no colon and no comma follows it or precedes it.
    """
    text = text.strip()
    found = _UNIT.search(text, len(_LOG) if text.startswith(_LOG) else 0)
    if found is None:
        return text, ""
    number, unit = text[: found.start()].rstrip(), found[0]
    if set(unit) & {":", ","} or number.endswith((":", ",")) or not re.search(r"\d", number):
        return text, ""
    return number, unit


def parse_quantity(text: str, parse: Callable[[str], V]) -> V | Quantity[V]:
    """Return what `parse` makes of the number part, with the unit where there is one.

    Raises LagtopError as `parse` does, with the whole text in place of its number part.
    """
    number, unit = split_unit(text)
    if not unit:
        return parse(number)
    try:
        return Quantity(parse(number), unit)
    except LagtopError as error:
        whole = str(error).replace(f"got {quoted(number)}", f"got {quoted(text.strip())}")
        raise LagtopError(whole, error.key) from None
