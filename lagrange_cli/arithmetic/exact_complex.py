"""Complex numbers read from text, both parts exactly."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from ..errors import LagtopError
from .text import is_decimal, parse_number


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
    real, imag = _part_texts(text)
    if looks_complex(text) and not (is_decimal(real) and is_decimal(imag)):
        raise LagtopError(f"must be a finite number, complex as 0.3+0.7i, got {text!r}")
    return ExactComplex(parse_number(real), parse_number(imag))


def looks_complex(text: str) -> bool:
    """Return whether a text has a letter for the imaginary unit, right or wrong."""
    return not set("ijIJ").isdisjoint(text)


def _part_texts(text: str) -> tuple[str, str]:
    """Return the texts of the real and of the imaginary part, as they stand."""
    if not text.endswith("i"):
        return text, "0"
    signs = [i for i, sign in enumerate(text) if sign in "+-" and text[i - 1 : i] not in {"e", "E"}]
    split = signs[-1] if signs else 0
    imag = text[split:-1]
    return text[:split] or "0", f"{imag}1" if imag in {"", "+", "-"} else imag
