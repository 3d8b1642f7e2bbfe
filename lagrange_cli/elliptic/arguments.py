"""Arguments of the functions, exactly: complex numbers, multiples of K, lists and ranges."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from typing import NamedTuple

from ..arithmetic.enclosures import equal_digits, exact, settled
from ..arithmetic.text import is_decimal, parse_number, quoted
from ..errors import LagtopError
from ..top.ranges import ListedPoints, LogPoints, Points
from ..top.values import LOG, parse_range

_UNSIGNED = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_COMPLEX = re.compile(rf"(?:([+-]?{_UNSIGNED})(?=[+-]))?([+-]?)({_UNSIGNED})?i")
_MULTIPLE = re.compile(rf"([+-]?)({_UNSIGNED})?\s*K(?:/({_UNSIGNED}))?")
_LEAST_EXPONENT = -10_000
"""The exponent of the smallest modulus that is accepted."""


class ExactComplex(NamedTuple):
    """A complex number with two exact parts."""

    real: Fraction
    imag: Fraction = Fraction(0)

    def __str__(self) -> str:
        """Return the number in a form that can be typed."""
        real, imag = f"{float(self.real)}", f"{float(self.imag):+}i"
        if not self.imag:
            return real
        return imag.removeprefix("+") if not self.real else real + imag

    def nearest(self) -> ExactComplex:
        """Return the number whose parts are the nearest doubles."""
        return ExactComplex(Fraction(float(self.real)), Fraction(float(self.imag)))


class Arguments(NamedTuple):
    """A list or a range of arguments."""

    real: Points
    imag: Points | None = None
    """The imaginary parts; None if all arguments are real."""
    in_quarters: bool = False
    """Whether the arguments are multiples of K."""

    def numbers(self, digits: int | None) -> Iterator[ExactComplex]:
        """Yield the arguments: the nearest doubles, or exactly; see `places`.

        Multiples of K are always exact.
        """
        real = places(self.real, (digits or 17) if self.in_quarters else digits)
        if self.imag is None:
            return map(ExactComplex, real)
        return map(ExactComplex, real, places(self.imag, digits))


def places(points: Points, digits: int | None) -> Iterator[Fraction]:
    """Yield points as the nearest doubles or, if `digits` is a number, as exact decimals.

    The inner points of a range with equal ratios are then rounded to that number of digits.
    """
    if digits is None:
        return (Fraction(float(x)) for x in points.decimals())
    if not isinstance(points, LogPoints):
        return points.decimals()
    first, last, steps = points.first, points.last, points.count - 1
    most = equal_digits([first, last], digits)

    def place(i: int) -> Fraction:
        """Return first (last/first)^(i/steps)."""
        if i in {0, steps}:
            return last if i else first
        share = exact(Fraction(i, steps))
        found = settled("u", lambda _: exact(first) * exact(last / first) ** share, digits, most)
        return Fraction(found.value if found else 0)

    return map(place, range(points.count))


def parse_complex(text: str) -> ExactComplex:
    """Return the exact value of `0.3`, `0.7i`, `i` or `0.3-0.7i`.

    Raises LagtopError, with the remedy, for anything else and for parts that no double can hold.
    """
    text = text.strip()
    if set("ijIJ").isdisjoint(text):
        return ExactComplex(parse_number(text))
    found = _COMPLEX.fullmatch(text)
    if found is None:
        raise LagtopError(f"must be a finite number, complex as 0.3+0.7i, got {quoted(text)}")
    real, sign, imag = found.groups()
    return ExactComplex(parse_number(real or "0"), parse_number(f"{sign}{imag or 1}"))


def parse_small(text: str) -> ExactComplex:
    """Return the exact value of a complex number, or of a real one down to 1e-10000.

    Raises LagtopError as `parse_complex` does.
    """
    text = text.strip()
    if not (is_decimal(text) and len(text) < 2000 and abs(float(text)) < 1e-300):
        return parse_complex(text)
    with suppress(InvalidOperation):  # of an exponent beyond those of decimals
        number = Decimal(text)
        if not number or number.adjusted() >= _LEAST_EXPONENT:
            return ExactComplex(Fraction(number) if number else Fraction(0))
    raise LagtopError(f"must be 0 or at least 1e{_LEAST_EXPONENT} in size, got {quoted(text)}")


def parse_arguments(text: str) -> Arguments:
    """Return the arguments of a list such as `0.3,1+2i` or `K/2,-2.5K`, or of a range.

    A range is `[log:]start:stop:count`.  Raises LagtopError for anything else, and for a mixture of
    multiples of K with other numbers; 0 fits both.
    """
    if ":" in text:
        ends = [_multiple(end) for end in text.removeprefix(LOG).split(":")[:2]]
        points = parse_range(text, lambda end: _multiple(end)[0])
        mixed = "must have both ends in units of K, or neither"
    elif not set("ijIJ").isdisjoint(text):
        if "K" in text:
            raise LagtopError(f"must not contain K if numbers are complex, got {quoted(text)}")
        real, imag = zip(*map(parse_complex, text.split(",")), strict=True)
        return Arguments(ListedPoints([*real]), ListedPoints([*imag]))
    else:
        ends = [_multiple(part) for part in text.split(",")]
        points = ListedPoints([factor for factor, _ in ends])
        mixed = "must all be in units of K, or none"
    kinds = {is_multiple for factor, is_multiple in ends if factor}
    if len(kinds) > 1:
        raise LagtopError(f"{mixed}, got {quoted(text)}")
    return Arguments(points, in_quarters=True in kinds)


def _multiple(text: str) -> tuple[Fraction, bool]:
    """Return a number and False, or the factor of a multiple of K such as `3K/4` and True."""
    if "K" not in text:
        return parse_number(text), False
    found = _MULTIPLE.fullmatch(text.strip())
    if found is None or parse_number(found[3] or "1") <= 0:
        wanted = "must be a real multiple of K such as K, -2.5K, K/2 or 3K/4"
        raise LagtopError(f"{wanted}, got {quoted(text)}")
    return parse_number(f"{found[1]}{found[2] or 1}") / parse_number(found[3] or "1"), True
