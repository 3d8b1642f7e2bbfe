"""Arguments of the elliptic functions: numbers, or rational multiples of the quarter period K."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.text import parse_number
from ..errors import LagtopError
from .ranges import parse_range

if TYPE_CHECKING:
    from ..arithmetic.points import Points


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
    from ..arithmetic.points import ListedPoints

    units = {multiple.in_quarters for multiple in single if multiple.factor}
    if len(units) > 1:
        raise LagtopError("u must be in units of K every time or never, got both", "u")
    return Multiples(ListedPoints([multiple.factor for multiple in single]), True in units)
