"""Exact reading of numbers, and writing of numbers in one style, as `orjson` writes them."""

from __future__ import annotations

import decimal
import math
from fractions import Fraction
from typing import Any

from ..errors import LagtopError

_DECIMAL = set("0123456789.eE+-")
_MOST_CHARACTERS = 2000


class NumberText(str):
    """A number written out, to be printed unchanged."""

    __slots__ = ()


def own_context(
    digits: int,
    traps: list[type[decimal.DecimalException]],
    rounding: str = decimal.ROUND_HALF_EVEN,
) -> decimal.Context:
    """Return a decimal context that does not depend on the context of the host program."""
    return decimal.Context(
        prec=digits,
        rounding=rounding,
        Emin=decimal.MIN_EMIN,
        Emax=decimal.MAX_EMAX,
        capitals=0,
        clamp=0,
        flags=[],
        traps=traps,
    )


def value_text(value: Any) -> str:
    """Return the text of a number or a word, empty for None and NaN.

    An instance of a subclass of str is a number that is written out already.
    """
    if value is None or value != value:  # noqa: PLR0124 - NaN
        return ""
    return double_text(value) if isinstance(value, float) else str(value)


def quoted(value: object) -> str:
    """Return a value as Python writes it, for an error message; a long one is cut with `...`."""
    return repr(shortened(value)) if isinstance(value, str) else shortened(repr(value))


def shortened(text: str, most: int = 80) -> str:
    """Return a text, cut with `...` if it is long."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def double_text(value: float) -> str:
    """Return the shortest text that reads back as the same double.

    It is repr, except for 1e-7 in place of 1e-07, and 0.00001 in place of 1e-05.
    """
    text = repr(value)
    mantissa, small, exponent = text.partition("e-0")
    if not small:
        return text
    if exponent != "5":
        return f"{mantissa}e-{exponent}"
    sign = "-" if mantissa.startswith("-") else ""
    return f"{sign}0.0000{mantissa.lstrip('-').replace('.', '')}"


def parse_number(text: str) -> Fraction:
    """Return the exact value of a decimal such as `30`, `-1.5` or `2e-3`.

    Raises LagtopError, with the remedy, for anything else and for values that no double can hold.
    """
    text = text.strip()
    if len(text) > _MOST_CHARACTERS:
        raise LagtopError(f"must have at most {_MOST_CHARACTERS} characters, got {len(text)}")
    if not is_decimal(text):
        raise LagtopError(f"must be a finite decimal number, got {quoted(text)}{_remedy(text)}")
    nearest = float(text)
    if math.isinf(nearest):
        raise LagtopError(f"must be at most 1.8e308 in size, got {text}")
    if nearest == 0 and set(text.lower().partition("e")[0]) & set("123456789"):
        raise LagtopError(f"must be 0 or at least 5e-324 in size, got {text}")
    return Fraction(text)


def is_decimal(text: str) -> bool:
    """Return whether a text is a decimal number of any size."""
    try:
        return set(text) <= _DECIMAL and not math.isnan(float(text))
    except ValueError:
        return False


def _remedy(text: str) -> str:
    if "," in text:
        return " (write a decimal point, not a comma)"
    if "_" in text:
        return " (leave out the underscores)"
    if any(dash in text for dash in "\u2212\u2013\u2014"):
        return " (write the minus sign as an ASCII hyphen, -)"
    return ""
