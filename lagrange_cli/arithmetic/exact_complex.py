"""Complex numbers read from text, both parts exactly."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from ..errors import LagtopError
from .text import parse_number


class ExactComplex(NamedTuple):
    """A complex number with two exact parts."""

    real: Fraction
    imag: Fraction = Fraction(0)

    def __str__(self) -> str:
        """Return the number as it can be typed."""
        real, imag = f"{float(self.real)}", f"{float(self.imag):+}i"
        if not self.imag:
            return real
        return imag.removeprefix("+") if not self.real else real + imag

    def nearest(self) -> ExactComplex:
        """Return the number whose parts are the nearest doubles."""
        return ExactComplex(Fraction(float(self.real)), Fraction(float(self.imag)))

    def __complex__(self) -> complex:
        """Return the nearest complex double."""
        return complex(float(self.real), float(self.imag))


def parse_complex(text: str) -> ExactComplex:
    """Return the exact value of `0.3`, `0.7i`, `i` or `0.3-0.7i`.

    Raises LagtopError, with the remedy, for anything else and for parts that no double can hold.
    """
    text = text.strip()
    if not text.endswith("i"):
        return ExactComplex(parse_number(text))
    signs = [i for i, sign in enumerate(text) if sign in "+-" and text[i - 1 : i] not in {"e", "E"}]
    split = signs[-1] if signs else 0
    imag = text[split:-1]
    try:
        real = parse_number(text[:split] or "0")
        return ExactComplex(real, parse_number(f"{imag}1" if imag in {"", "+", "-"} else imag))
    except LagtopError as error:
        raise LagtopError(f"{error} (a complex number is written 0.3+0.7i)") from None
