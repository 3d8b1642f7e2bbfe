"""Any number of digits: compute with more and more until the digits asked for have settled."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from ..errors import LagtopError
from .generic import Arithmetic, many_digits, number


class NumberText(str):
    """A number written out, to be printed as it stands."""

    __slots__ = ()


class TooFewDigitsError(Exception):
    """A number has not the digits that are asked for."""


def require_digits(ar: Arithmetic, digits: int, size: Any) -> None:
    """Raise TooFewDigitsError where so many digits behind the point of a number of this size are
    more than the context has."""
    if size > 1 and ar.log10(size) + digits + 5 > ar.dps:
        raise TooFewDigitsError


def settle(compute: Callable[[Arithmetic], Mapping[Any, Any]], digits: int) -> dict[Any, Any]:
    """Ziv's strategy: raise the precision until two in a row print alike.

    Raises LagtopError where none do, which takes a number that is zero without our knowing it.
    """
    previous: dict[Any, Any] | None = None
    for working in _precisions(digits):
        ar = many_digits(working)
        try:
            texts = {key: _text(ar, value, digits) for key, value in compute(ar).items()}
        except TooFewDigitsError:
            continue
        if texts == previous:
            return texts
        previous = texts
    raise LagtopError(f"{digits} digits did not settle with {working} to work with")


def settled_or_rounded(
    compute: Callable[[Arithmetic], Mapping[Any, Any]], digits: int | None
) -> dict[Any, Any]:
    """Settled to so many digits; without them each number the nearest double."""
    if digits is not None:
        return settle(compute, digits)
    exact = compute(many_digits())
    return {key: x if x is None or isinstance(x, str) else float(x) for key, x in exact.items()}


def _precisions(digits: int) -> Iterator[int]:
    """By half as much again each time."""
    working = digits + 15
    while working <= 20 * digits + 4000:
        yield working
        working = working * 3 // 2


def _text(ar: Arithmetic, value: Any, digits: int) -> Any:
    if value is None or isinstance(value, str):
        return value
    if not ar.isfinite(value):
        return NumberText()
    return NumberText(ar.nstr(number(ar, value), digits, min_fixed=-5, max_fixed=16))
