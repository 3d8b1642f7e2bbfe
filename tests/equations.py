"""A register of the sources' equations, so that each becomes a test of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from lagrange_cli.arithmetic.generic import many_digits

ar = many_digits(60)
"""The arithmetic of the identities."""

Sides = Iterator[tuple[Any, Any]]
"""Left and right sides, one of them by our functions and the other independent of them."""


class Register:
    """Equations as they hold, and as they are printed where that is wrong."""

    def __init__(self) -> None:
        self.holds: dict[str, Callable[[], Sides]] = {}
        self.fails: dict[str, Callable[[], Sides]] = {}

    def equation(self, number: str) -> Callable[[Callable[[], Sides]], Callable[[], Sides]]:
        """Both sides agree."""

        def register(sides: Callable[[], Sides]) -> Callable[[], Sides]:
            assert number not in self.holds
            self.holds[number] = sides
            return sides

        return register

    def as_printed(self, number: str) -> Callable[[Callable[[], Sides]], Callable[[], Sides]]:
        """The text at hand, whose sides do not agree."""

        def register(sides: Callable[[], Sides]) -> Callable[[], Sides]:
            assert number not in self.fails
            self.fails[number] = sides
            return sides

        return register

    def check(self, number: str, tolerance: float = 1e-40) -> None:
        """The sides of an equation agree."""
        for left, right in self.holds[number]():
            assert gap(left, right) < tolerance

    def check_as_printed(self, number: str) -> None:
        """The sides as printed do not."""
        for left, right in self.fails[number]():
            assert gap(left, right) > 1e-3


def gap(left: Any, right: Any) -> float:
    """How far two sides are apart, in the size of the right one or 1."""
    return float(abs(left - right) / max(1, abs(right)))
