"""Arguments of the functions, exactly: complex numbers, multiples of K and K', lists and ranges."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from itertools import repeat
from typing import NamedTuple

from ..arithmetic.enclosures import equal_digits, exact, settled
from ..arithmetic.text import is_decimal, parse_number, quoted
from ..errors import LagtopError
from ..top.ranges import EvenPoints, ListedPoints, LogPoints, Points
from ..top.values import LOG, parse_range

_UNSIGNED = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_TERM = re.compile(
    rf"([+-]?)({_UNSIGNED})?(?:\*(?=[iIjK]))?([iIj])?(?:\*?(K'?))?(?:/({_UNSIGNED}))?"
)
_BEFORE_SIGNS = re.compile(r"(?<=[^eE])(?=[+-])")
_LEAST_EXPONENT = -10_000
"""The exponent of the smallest modulus that is accepted."""


class ExactComplex(NamedTuple):
    """A complex number with two exact parts, plus complex multiples of K and K'."""

    real: Fraction
    imag: Fraction = Fraction(0)
    K: Fraction = Fraction(0)
    iK: Fraction = Fraction(0)
    K_prime: Fraction = Fraction(0)
    iK_prime: Fraction = Fraction(0)

    def __str__(self) -> str:
        """Return the number, without multiples of K and K', in a form that can be typed."""
        real, imag = f"{float(self.real)}", f"{float(self.imag):+}i"
        if not self.imag:
            return real
        return imag.removeprefix("+") if not self.real else real + imag

    def nearest(self) -> ExactComplex:
        """Return the number whose two parts are the nearest doubles."""
        real, imag = (Fraction(float(x)) for x in self[:2])
        return self._replace(real=real, imag=imag)


class Arguments(NamedTuple):
    """A list or a range of arguments; parts that are 0 everywhere are None."""

    real: Points
    imag: Points | None = None
    K: Points | None = None
    iK: Points | None = None
    K_prime: Points | None = None
    iK_prime: Points | None = None

    @property
    def has_quarters(self) -> bool:
        """Whether K or K' occurs."""
        return any(points is not None for points in self[2:])

    def numbers(self, digits: int | None) -> Iterator[ExactComplex]:
        """Yield the arguments: the nearest doubles, or exactly; see `places`.

        Multiples of K and K' are always exact.
        """
        wanted = (digits, digits, *[digits or 17] * 4)  # 17 only rounds ranges of equal ratios
        parts = (
            repeat(Fraction(0)) if x is None else places(x, n)
            for x, n in zip(self, wanted, strict=True)
        )
        return map(ExactComplex, *parts)


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


def parse_sum(text: str, *, has_quarters: bool = True) -> ExactComplex:
    """Return the exact value of `0.3`, `0.7i`, `1-2j`, `K/2+0.3i` or `K+iK'`.

    Raises LagtopError, with the remedy, for anything else and for parts that no double can hold.
    """
    found = " ".join(text.split())
    for mark in "+-":
        found = found.replace(f" {mark}", mark).replace(f"{mark} ", mark)
    if set("iIjK").isdisjoint(found):
        return ExactComplex(parse_number(found))
    parts = [Fraction(0)] * 6
    for term in _BEFORE_SIGNS.split(found):
        matched = _TERM.fullmatch(term)
        sign, number, i, K, divisor = matched.groups() if matched else [None] * 5
        below, unit = parse_number(divisor or "1"), i or K
        is_read = unit or (number and not divisor)
        if not (is_read and below) or (K and not has_quarters):
            examples = "2, 0.3+0.7i, K/2-0.3i or K+iK'" if has_quarters else "2 or 0.3+0.7i"
            wanted = f"must be a finite number, such as {examples}"
            raise LagtopError(f"{wanted}, got {quoted(text)}")
        place = 2 * ["", "K", "K'"].index(K or "") + bool(i)
        parts[place] += parse_number(f"{sign}{number or 1}") / below
    return ExactComplex(*parts)


def parse_complex(text: str) -> ExactComplex:
    """Return the exact value of a complex number, as `parse_sum` does, but without K and K'."""
    return parse_sum(text, has_quarters=False)


def parse_small(text: str) -> ExactComplex:
    """Return the exact value of a complex number, or of a real one down to 1e-10000.

    Raises LagtopError as `parse_complex` does.
    """
    text = text.strip()
    is_small = is_decimal(text) and len(text) < 2000 and abs(float(text)) < 1e-300
    if not is_small or text.lstrip("+-0.")[:1] in "eE":  # a zero has any exponent
        return parse_complex(text)
    with suppress(InvalidOperation):  # of an exponent beyond those of decimals
        number = Decimal(text)
        if number.adjusted() >= _LEAST_EXPONENT:
            return ExactComplex(Fraction(number))
    raise LagtopError(f"must be 0 or at least 1e{_LEAST_EXPONENT} in magnitude, got {quoted(text)}")


def parse_arguments(text: str) -> Arguments:
    """Return the arguments of a list such as `0.3,1+2i,K/2`, or of a range on a line.

    A range is `[log:]start:stop:count`.  Raises LagtopError for anything else, and for a range with
    equal ratios that is not on an axis.
    """
    if ":" not in text:
        real, *others = zip(*map(parse_sum, text.split(",")), strict=True)
        return Arguments(ListedPoints(real), *(ListedPoints(x) if any(x) else None for x in others))
    first, last = (parse_sum(end) for end in [*text.removeprefix(LOG).split(":"), ""][:2])
    used = [i for i in range(6) if first[i] or last[i]] or [0]
    if text.startswith(LOG) and len(used) > 1:
        raise LagtopError(f"must be multiples of 1, i, K, iK, K' or iK', got {quoted(text)}")

    def part(i: int) -> Points:
        return parse_range(text, lambda end: parse_sum(end)[i])

    parts = {i: part(i) for i in used}
    zeros = EvenPoints(Fraction(0), Fraction(0), parts[used[0]].count)
    return Arguments(parts.get(0, zeros), *map(parts.get, range(1, 6)))
