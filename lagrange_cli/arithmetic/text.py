"""How a double is written: the same text everywhere, that of `orjson`, which writes the blocks."""

from __future__ import annotations

from typing import Any


def value_text(value: Any) -> str:
    """A number or a word; empty for None and NaN.  A subclass of str is a number written out."""
    if value is None or value != value:  # noqa: PLR0124 - NaN
        return ""
    return double_text(value) if isinstance(value, float) else str(value)


def json_text(value: Any) -> str:
    """Any JSON value."""
    import orjson

    return orjson.dumps(value).decode()


def double_text(value: float) -> str:
    """The shortest text that reads back as the same double.

    As repr, but 1e-7 for 1e-07, and 0.00001 for 1e-05.
    """
    text = repr(value)
    mantissa, small, exponent = text.partition("e-0")
    if not small:
        return text
    if exponent != "5":
        return f"{mantissa}e-{exponent}"
    sign = "-" if mantissa.startswith("-") else ""
    return f"{sign}0.0000{mantissa.lstrip('-').replace('.', '')}"
