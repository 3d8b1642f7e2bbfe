"""The one grammar of ranges, `[log:]start:stop:count`, also of multiples of K; blocks of tops."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from ..arithmetic.points import MOST_POINTS, EvenPoints, ListedPoints, LogPoints, Points
from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError

if TYPE_CHECKING:
    from ..arithmetic.types import Array


def parse_range(text: str, parse: Callable[[str], Fraction] = parse_number) -> Points:
    """Return the points of `start:stop:count` or, with equal ratios, `log:start:stop:count`.

    `parse` reads the two ends.  Raises LagtopError for anything else, for a count of 1 between
    different ends, and for a logarithmic range over 0.
    """
    parts = text.removeprefix("log:").split(":")
    if len(parts) != 3:
        raise LagtopError(f"must be a range [log:]start:stop:count, got {text!r}")
    first, last, exact_count = parse(parts[0]), parse(parts[1]), parse_number(parts[2])
    if exact_count.denominator != 1 or not 1 <= exact_count <= MOST_POINTS:
        raise LagtopError(f"must have a whole count of 1 to 1e9 in its range, got {text!r}")
    count = int(exact_count)
    if count == 1 and first != last:
        raise LagtopError(f"must have a count of 2 or more between different ends, got {text!r}")
    if not text.startswith("log:"):
        return EvenPoints(first, (last - first) / max(count - 1, 1), count)
    if not first * last > 0:
        raise LagtopError(f"must have two ends of one sign, not 0, in a log: range, got {text!r}")
    return LogPoints(first, last, count)


def parse_values(text: str) -> Points:
    """Return the points of a number, of a list `1,2,3` or of a range.  Raises LagtopError."""
    if ":" in text:
        return parse_range(text)
    return ListedPoints([parse_number(part) for part in text.split(",")])


class Span(NamedTuple):
    """The values that an unknown input may have: from one end to the other."""

    first: Fraction
    last: Fraction
    logarithmic: bool = False
    """Whether it is cut into equal ratios, not into equal steps."""

    def points(self, count: int) -> Points:
        """Return so many points of it, the ends among them."""
        if self.logarithmic:
            return LogPoints(self.first, self.last, count)
        return EvenPoints(self.first, (self.last - self.first) / (count - 1), count)

    def scaled(self, factor: Fraction) -> Span:
        """Return the values times a factor > 0."""
        return self._replace(first=self.first * factor, last=self.last * factor)

    def __str__(self) -> str:
        return f"{float(self.first):g} to {float(self.last):g}"


def parse_span(text: str) -> Span:
    """Return the values of `from:to` or `log:from:to`: a range without its count.

    Raises LagtopError for anything else, and where the second end is not the larger one.
    """
    logarithmic, ends = text.startswith("log:"), text.removeprefix("log:").split(":")
    if len(ends) != 2:
        raise LagtopError(f"must be a number or a range [log:]from:to, got {quoted(text)}")
    first, last = map(parse_number, ends)
    if not first < last:
        raise LagtopError(f"must be a range whose first end is the smaller one, got {quoted(text)}")
    if logarithmic and not first * last > 0:
        raise LagtopError(f"must have two ends of one sign, not 0, in a log: range, got {text!r}")
    return Span(first, last, logarithmic)


def parse_number_or_span(text: str) -> Fraction | Span:
    """Return a number, or the values of a range `[log:]from:to`.  Raises LagtopError."""
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
    """Return a number such as `0.5` or, in units of K, one such as `K`, `-2.5K`, `K/2` or `3K/4`.

    Raises LagtopError for anything else.
    """
    before, has_unit, after = text.strip().partition("K")
    if not has_unit:
        return Multiple(parse_number(text), False)
    sign = {"": 1, "+": 1, "-": -1}.get(before)
    try:
        factor = parse_number(before) if sign is None else Fraction(sign)
        divisor = parse_number(after.removeprefix("/")) if after else Fraction(1)
        if after[:1] not in {"", "/"} or divisor <= 0:
            raise LagtopError(text)
    except LagtopError:
        raise LagtopError(
            f"must be a multiple of K such as K, -2.5K, K/2 or 3K/4, got {text!r}"
        ) from None
    return Multiple(factor / divisor, True)


def parse_multiples(text: str) -> Multiples:
    """Return the points of a range whose ends are `parse_multiple`s, both of one kind.

    Raises LagtopError as `parse_range` does, and for one end alone in units of K (0 goes with both
    kinds).
    """
    units = set()

    def parse(end: str) -> Fraction:
        multiple = parse_multiple(end)
        if multiple.factor:
            units.add(multiple.in_quarters)
        return multiple.factor

    points = parse_range(text, parse)
    if len(units) > 1:
        raise LagtopError(f"must have both ends in units of K or none, got {text!r}")
    return Multiples(points, True in units)


def listed_multiples(single: tuple[Multiple, ...]) -> Multiples:
    """Return multiples that are listed one by one.  Raises LagtopError for both kinds together."""
    units = {multiple.in_quarters for multiple in single if multiple.factor}
    if len(units) > 1:
        raise LagtopError("u must be in units of K every time or never, got both", "u")
    return Multiples(ListedPoints([multiple.factor for multiple in single]), True in units)


class InputArrays(NamedTuple):
    """The inputs of some tops and what goes with each of them."""

    size: int
    """The number of tops."""
    inputs: Mapping[str, Array | float]
    """An array for each input, or one number for all; NaN where a top lacks it."""
    carried: Sequence[Sequence[Any]] = ()
    """The columns that are carried through."""
    lines: Sequence[int] | None = None
    """The number of the line of each top, if they come from a file."""
    errors: Mapping[int, str] = {}
    """What is already known to be wrong, by row."""


class Block(Protocol):
    """Neighbouring tops of a grid or of a file, not read yet."""

    @property
    def size(self) -> int:
        """The number of tops."""

    def arrays(self, shared: Mapping[str, float]) -> InputArrays:
        """Return the inputs of the tops; `shared` ones stand where a top has none of its own."""


class Product(NamedTuple):
    """All combinations of the values of several inputs; the last input varies fastest."""

    axes: Mapping[str, Points]
    """The values of each input, by its name."""

    @property
    def size(self) -> int:
        """The number of combinations."""
        return prod(axis.count for axis in self.axes.values())

    def blocks(self, size: int) -> Iterator[Combinations]:
        """Yield the combinations, `size` at a time."""
        for first in range(0, self.size, size):
            yield Combinations(self, first, min(first + size, self.size))

    def check(self) -> None:
        """Raise LagtopError where there are more than 1e9 combinations."""
        if self.size > MOST_POINTS:
            raise LagtopError(f"a sweep has at most 1e9 tops, this one would have {self.size:.4g}")


class Combinations(NamedTuple):
    """The combinations of a product from one number to before another."""

    product: Product
    first: int
    stop: int

    @property
    def size(self) -> int:
        """The number of combinations."""
        return self.stop - self.first

    def values(self) -> dict[str, Array]:
        """Return the values of each input in these combinations."""
        import numpy as np

        left = np.arange(self.first, self.stop)
        values = {}
        for name, axis in reversed(list(self.product.axes.items())):
            values[name] = axis.at(left % axis.count)
            left //= axis.count
        return values

    def arrays(self, shared: Mapping[str, float]) -> InputArrays:
        """Return the inputs of the combinations; those that do not vary are `shared`."""
        return InputArrays(self.size, {**shared, **self.values()})
