"""A number with its standard uncertainty, written as `0.4293(48)`.

The uncertainty is rounded by the rule of the Particle Data Group: to two digits where its first
three are at most 354, to one up to 949, and up to 1000 beyond.
"""

from __future__ import annotations

from decimal import ROUND_HALF_EVEN, Decimal, localcontext

_LEAST_EXPONENT = -4
"""Below it, and where a rounded place stands before the point, there is an exponent."""


def uncertain_text(value: float, std: float) -> str:
    """Return a number and its uncertainty in short, such as 0.4293(48) or 73.9(1.2).

    A number that is certain is written in full.
    """
    if not std:
        from ..arithmetic.text import double_text

        return double_text(value)
    with localcontext() as context:
        context.prec = 800
        context.rounding = ROUND_HALF_EVEN
        last = last_place(std)
        number, spread = (Decimal(repr(x)).quantize(Decimal(1).scaleb(last)) for x in (value, std))
        leading = max(x.adjusted() for x in (number, spread) if x)
        if leading >= _LEAST_EXPONENT and last <= 0:
            return _short(number, spread, last)
        short = _short(number.scaleb(-leading), spread.scaleb(-leading), last - leading)
        return f"{short}e{leading:+03d}"


def last_place(std: float) -> int:
    """Return the power of ten of the last digit that an uncertainty keeps."""
    exact = Decimal(repr(std))
    leading = exact.adjusted()
    first_three = int(exact.scaleb(2 - leading))
    return leading - 1 if first_three <= 354 else leading  # beyond 949 rounding makes it 1000


def _short(number: Decimal, spread: Decimal, last: int) -> str:
    """Return both with digits down to a place, the spread as a count of it below 1."""
    places = max(-last, 0)
    inside = f"{spread:.{places}f}" if spread >= 1 else f"{spread.scaleb(places):.0f}"
    return f"{number:.{places}f}({inside})"
