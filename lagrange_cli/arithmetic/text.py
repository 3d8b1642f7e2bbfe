"""Exact reading of numbers, and writing of numbers in one style, as `orjson` writes them."""

from __future__ import annotations

import decimal
import math
from decimal import Decimal
from fractions import Fraction
from typing import Any

from ..errors import LagtopError

_DECIMAL = set("0123456789.eE+-")
_MOST_CHARACTERS = 2000


class NumberText(str):
    """A number written out, to be printed unchanged."""

    __slots__ = ()


def own_context(digits: int, rounding: str = decimal.ROUND_HALF_EVEN) -> decimal.Context:
    """Return a decimal context that does not depend on the context of the host program."""
    return decimal.Context(
        prec=digits,
        rounding=rounding,
        Emin=decimal.MIN_EMIN,
        Emax=decimal.MAX_EMAX,
        capitals=0,
        clamp=0,
        flags=[],
        traps=[],
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


def uncertain_text(value: float | str, std: float) -> str:
    """Return a number with its standard uncertainty, such as 0.4293(48) or 73.9(1.2).

    The uncertainty is rounded by the rule of the Particle Data Group.  It has two digits if its
    first three are at most 354, and one digit up to 949; beyond, it is rounded up to 1000.  Numbers
    below 1e-4, or rounded before the point, have an exponent.  A number without uncertainty is
    written in full.  A value with more digits than a double has is given as a text.
    """
    if not std:
        return double_text(float(value))
    with decimal.localcontext(prec=800, rounding=decimal.ROUND_HALF_EVEN):
        exact = Decimal(repr(std))
        leading = exact.adjusted()
        last = leading - 1 if int(exact.scaleb(2 - leading)) <= 354 else leading
        number, spread = (Decimal(str(x)).quantize(Decimal(1).scaleb(last)) for x in (value, std))
        leading = max(x.adjusted() for x in (number, spread) if x)
        shift = 0 if leading >= -4 and last <= 0 else leading
        places = max(shift - last, 0)
        number, spread = number.scaleb(-shift), spread.scaleb(-shift)
        inside = f"{spread:.{places}f}" if spread >= 1 else f"{spread.scaleb(places):.0f}"
        return f"{number:.{places}f}({inside})" + (f"e{shift:+03d}" if shift else "")


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
        raise LagtopError(f"must be at most 1.8e308 in magnitude, got {shortened(text)}")
    if nearest == 0 and set(text.lower().partition("e")[0]) & set("123456789"):
        raise LagtopError(f"must be 0 or at least 5e-324 in magnitude, got {shortened(text)}")
    return Fraction(text) if nearest else Fraction(0)  # 0e999999999 would be 0 times 10^999999999


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
