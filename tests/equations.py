"""A register of the sources' equations: each becomes a test, and a test that the test can fail."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, ClassVar, NamedTuple

import pytest
from ours import ar

Pairs = list[tuple[Any, Any]]
"""Left and right sides: one by our functions, the other independent of them."""
Sides = Callable[..., Iterable[tuple[Any, Any]] | tuple[Any, Any]]
"""The sides of an equation in one case: a pair, or several pairs that are not a tuple."""
Cases = Callable[[], Iterable[tuple[Any, ...]]]
"""Cases, such as a top and a time."""


def once() -> list[tuple[()]]:
    """Return the one case of an equation without parameters."""
    return [()]


def pairs(left: Iterable[Any], right: Iterable[Any]) -> Pairs:
    """Return pairs of sides from two rows of numbers."""
    return list(zip(left, right, strict=True))


PLACE = re.compile(
    r"(line before )?\((\d|\d\.\d)[,.]\d+\)"  # the number in the source
    r"|section \d(\.\d| [a-z]+)?: .|sections \d and \d: ."  # or the section, and a name
)
"""How the number of an equation begins: with its place."""


class Register:
    """Equations as they hold, and as they are printed where that is wrong.

    `test_sources.py` says which numbers must be in some register.
    """

    def __init__(self) -> None:
        self.holds: dict[str, Equation] = {}
        self.fails: dict[str, Equation] = {}
        self.misread: dict[str, Equation] = {}

    def each(self, cases: Cases, holds: Mapping[str, Sides]) -> None:
        """Register equations, by the number or the section where they stand, with their cases."""
        _enter(self.holds, holds, cases)

    def each_as_printed(self, cases: Cases, fails: Mapping[str, Sides]) -> None:
        """Register equations as the text at hand prints them, whose sides do not agree.

        If one equation has several errors, its number is followed by ", ..." after " as printed".
        """
        _enter(self.fails, fails, cases)

    def misreadings(self, misread: Mapping[str, Sides]) -> None:
        """Register other readings of blurred signs, whose sides do not agree."""
        _enter(self.misread, misread, once)


class Equation(NamedTuple):
    """An equation with its cases."""

    sides: Sides
    cases: Cases

    def gaps(self) -> list[float]:
        """Return how far the sides of each pair are apart; one without pairs is an error."""
        found = []
        for case in self.cases():
            sides = self.sides(*case)
            found += [gap(*pair) for pair in ([sides] if isinstance(sides, tuple) else sides)]
        assert found, "the equation compares nothing"
        return found


def _enter(register: dict[str, Equation], equations: Mapping[str, Sides], cases: Cases) -> None:
    """Register equations under numbers that are not taken yet."""
    for number, sides in equations.items():
        assert PLACE.match(number), f"{number} does not begin with a place in the source"
        assert number not in register, f"{number} is registered twice"
        register[number] = Equation(sides, cases)


class EquationTests:
    """Tests of a register: a module derives its test class and names its register.

    `spoil` replaces every function of ours that the equations call by one that is slightly wrong;
    an equation that still holds then says nothing, and fails.
    """

    register: ClassVar[Register]
    errata: ClassVar[set[str]]
    """Equations that the table of errata lists for these sections."""
    tolerances: ClassVar[dict[str, float]] = {}
    """Greatest gap allowed where it is not 1e-40."""

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Replace our functions in the module by wrong ones."""
        raise NotImplementedError

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Make one test of every equation."""
        if "number" in metafunc.fixturenames:
            metafunc.parametrize("number", list(self.register.holds))
        if "misprint" in metafunc.fixturenames:
            metafunc.parametrize("misprint", [*self.register.fails, *self.register.misread])

    def test_equation(self, number: str) -> None:
        assert max(self.register.holds[number].gaps()) < self.tolerances.get(number, 1e-40)

    @pytest.mark.slow
    def test_equation_can_fail(self, number: str, monkeypatch: pytest.MonkeyPatch) -> None:
        self.spoil(monkeypatch)
        assert max(self.register.holds[number].gaps()) > 1e-6

    def test_as_printed_it_fails(self, misprint: str) -> None:
        wrong = self.register.fails | self.register.misread
        assert min(wrong[misprint].gaps()) > 1e-3

    def test_every_misprint_is_put_right(self) -> None:
        wrong = {*self.register.fails, *self.register.misread}
        assert {number.partition(" as printed")[0] for number in wrong} <= set(self.register.holds)

    def test_the_errata_are_the_misprints(self) -> None:
        assert set(self.register.fails) == self.errata


def gap(left: Any, right: Any) -> float:
    """Return the distance of two sides, in units of the right one or of 1; NaN counts as far."""
    distance = float(abs(left - right) / max(1, abs(right)))
    return float("inf") if math.isnan(distance) else distance


def slightly_wrong(function: Callable[..., Any], factor: float = 1.01) -> Callable[..., Any]:
    """Return a function whose numbers are off by a factor and by a multiple of its arguments."""

    def spoiled(*args: Any, **options: Any) -> Any:
        shift = sum(x for x in args if isinstance(x, ar.mpf | ar.mpc)) / 100
        return _spoiled(function(*args, **options), ar.mpf(factor), shift)

    return spoiled


def _spoiled(value: Any, factor: Any, shift: Any) -> Any:
    """Return a number, or all the numbers of a tuple or an iterator, times a factor and shifted."""
    if isinstance(value, tuple):
        numbers = [_spoiled(part, factor, shift) for part in value]
        return type(value)(*numbers) if hasattr(value, "_fields") else tuple(numbers)
    if isinstance(value, Iterator):
        return (_spoiled(part, factor, shift) for part in value)
    return value if value is None else value * factor + shift
