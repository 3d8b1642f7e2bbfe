"""Ranges `[log:]start:stop:count`, of numbers or of multiples of K, and grids of tops in blocks."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.points import MOST_POINTS, EvenPoints, ListedPoints, LogPoints, Points
from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError
from .value import LOG

if TYPE_CHECKING:
    from ..arithmetic.types import Array


class Span(NamedTuple):
    """The interval in which an unknown input is searched for, or the ends of a range."""

    first: Fraction
    last: Fraction
    logarithmic: bool = False
    """Whether the interval is divided into equal ratios instead of equal steps."""

    def points(self, count: int) -> Points:
        """Return `count` points of the interval, both ends included."""
        if self.logarithmic:
            return LogPoints(self.first, self.last, count)
        return EvenPoints(self.first, (self.last - self.first) / max(count - 1, 1), count)

    def scaled(self, factor: Fraction) -> Span:
        """Return the interval multiplied by a factor > 0."""
        return self._replace(first=self.first * factor, last=self.last * factor)

    def refuse_zero(self, text: str) -> Span:
        """Return the interval.  Raises LagtopError if a logarithmic one contains 0."""
        if self.logarithmic and not self.first * self.last > 0:
            wanted = "must have two ends of one sign, not 0, in a log: range"
            raise LagtopError(f"{wanted}, got {text!r}")
        return self

    def __str__(self) -> str:
        return f"{float(self.first):g} to {float(self.last):g}"


def parse_range(text: str, parse: Callable[[str], Fraction] = parse_number) -> Points:
    """Return the points of `start:stop:count` or, with equal ratios, of `log:start:stop:count`.

    `parse` reads the two ends.  Raises LagtopError for anything else, for a count of 1 between
    different ends, and for a logarithmic range over 0.
    """
    parts = text.removeprefix(LOG).split(":")
    if len(parts) != 3:
        raise LagtopError(f"must be a range [log:]start:stop:count, got {text!r}")
    span = Span(parse(parts[0]), parse(parts[1]), text.startswith(LOG))
    count = parse_number(parts[2])
    if count.denominator != 1 or not 1 <= count <= MOST_POINTS:
        raise LagtopError(f"must have a whole count of 1 to 1e9 in its range, got {text!r}")
    if count == 1 and span.first != span.last:
        raise LagtopError(f"must have a count of 2 or more between different ends, got {text!r}")
    return span.refuse_zero(text).points(int(count))


def parse_values(text: str) -> Points:
    """Return the points of a number, a list `1,2,3` or a range.  Raises LagtopError."""
    refuse_units_inside(text, "60:80:3 rpm")
    if ":" in text:
        return parse_range(text)
    return ListedPoints([parse_number(part) for part in text.split(",")])


def refuse_units_inside(text: str, example: str) -> None:
    """Raise LagtopError for a range or a list with a unit in front of its last number."""
    if re.search(r"\d\s*(?!e[+-]?\d)(?:[^\W\d_]|°)[^:,]*[:,].*\d", text):
        wanted = f"must have its unit once, at the end, as in {example!r}"
        raise LagtopError(f"{wanted}, got {quoted(text)}")


def parse_span(text: str) -> Span:
    """Parse an interval, `from:to` or `log:from:to`.

    Raises LagtopError for anything else, and unless the second end is the larger one.
    """
    refuse_units_inside(text, "60:80 rpm")
    ends = text.removeprefix(LOG).split(":")
    if len(ends) != 2:
        raise LagtopError(f"must be a number or a range [log:]from:to, got {quoted(text)}")
    span = Span(parse_number(ends[0]), parse_number(ends[1]), text.startswith(LOG))
    if not span.first < span.last:
        raise LagtopError(f"must be a range whose first end is the smaller one, got {quoted(text)}")
    return span.refuse_zero(text)


def parse_number_or_span(text: str) -> Fraction | Span:
    """Parse a number, or an interval `[log:]from:to`.  Raises LagtopError."""
    return parse_span(text) if ":" in text else parse_number(text)


class Multiple(NamedTuple):
    """A number, or a factor of K."""

    factor: Fraction
    in_quarters: bool


class Multiples(NamedTuple):
    """Numbers, or factors of K."""

    factors: Points
    in_quarters: bool


def parse_multiple(text: str) -> Multiple:
    """Parse a number such as `0.5`, or a multiple of K such as `K`, `-2.5K`, `K/2` or `3K/4`.

    Raises LagtopError for anything else.
    """
    before, has_unit, after = text.strip().partition("K")
    if not has_unit:
        return Multiple(parse_number(text), False)
    try:
        factor = parse_number(f"{before}1" if before in {"", "+", "-"} else before)
        divisor = parse_number(after.removeprefix("/")) if after else Fraction(1)
        if after[:1] not in {"", "/"} or divisor <= 0:
            raise LagtopError(text)
    except LagtopError:
        raise LagtopError(
            f"must be a multiple of K such as K, -2.5K, K/2 or 3K/4, got {text!r}"
        ) from None
    return Multiple(factor / divisor, True)


def parse_multiples(text: str) -> Multiples:
    """Parse a range whose ends are read by `parse_multiple`.

    Raises LagtopError as `parse_range` does, and if only one end is in units of K.
    """
    ends: list[Multiple] = []

    def parse(end: str) -> Fraction:
        ends.append(parse_multiple(end))
        return ends[-1].factor

    points = parse_range(text, parse)
    wanted = f"must have both ends in units of K or none, got {text!r}"
    return Multiples(points, _in_quarters(ends, LagtopError(wanted)))


def listed_multiples(single: Sequence[Multiple]) -> Multiples:
    """Return a list of multiples as one object.  Raises LagtopError for a mixture of both kinds."""
    mixed = LagtopError("u must be in units of K every time or never, got both", "u")
    return Multiples(ListedPoints([x.factor for x in single]), _in_quarters(single, mixed))


def _in_quarters(multiples: Sequence[Multiple], mixed: LagtopError) -> bool:
    """Return whether numbers are in units of K; 0 fits both kinds.  Raises `mixed` for both."""
    kinds = {multiple.in_quarters for multiple in multiples if multiple.factor}
    if len(kinds) > 1:
        raise mixed
    return True in kinds


class InputArrays(NamedTuple):
    """The inputs of some tops, with the columns, lines and errors of each."""

    size: int
    """The number of tops."""
    inputs: Mapping[str, Array | float]
    """For each input an array, or one number for all tops; NaN for a top without the input."""
    carried: Sequence[Sequence[Any]] = ()
    """The extra columns, which are copied to the output."""
    lines: Sequence[int] | None = None
    """The line number of each top, if the tops come from a file."""
    errors: Mapping[int, str] = {}
    """Messages of the errors found so far, by row."""


class Product(NamedTuple):
    """Combinations of the values of several inputs; the last input varies fastest."""

    axes: Mapping[str, Points]
    """The values of each input, by its name."""
    first: int = 0
    """The number of the first combination."""
    stop: int | None = None
    """One more than the number of the last combination; None for all combinations."""

    @property
    def size(self) -> int:
        """The number of combinations."""
        stop = prod(x.count for x in self.axes.values()) if self.stop is None else self.stop
        return stop - self.first

    def blocks(self, size: int) -> Iterator[Product]:
        """Yield all combinations, `size` at a time."""
        for first in range(0, self.size, size):
            yield Product(self.axes, first, min(first + size, self.size))

    def values(self) -> dict[str, Array]:
        """Return the values of each input in these combinations."""
        import numpy as np

        left = np.arange(self.first, self.first + self.size)
        values = {}
        for name, axis in reversed(list(self.axes.items())):
            values[name] = axis.at(left % axis.count)
            left //= axis.count
        return values

    def arrays(self, shared: Mapping[str, float]) -> InputArrays:
        """Return the inputs of the combinations; `shared` holds those that do not vary."""
        return InputArrays(self.size, {**shared, **self.values()})

    def checked(self) -> Product:
        """Return the product.  Raises LagtopError for more than 1e9 combinations."""
        if self.size > MOST_POINTS:
            raise LagtopError(f"a sweep has at most 1e9 tops, this one would have {self.size:.4g}")
        return self
