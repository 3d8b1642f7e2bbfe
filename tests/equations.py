"""A register of the sources' equations: each becomes a test, and a test that the test can fail."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import chain, starmap
from typing import Any, ClassVar

import pytest
from ours import ar

Sides = Iterator[tuple[Any, Any]]
"""Pairs of a left and a right side: one by our functions, the other independent of them."""

Equation = Callable[[], Sides]
Pair = Callable[..., Any]
"""Both sides of an equation in one case, or a list of such pairs."""
Cases = Callable[[], Iterable[tuple[Any, ...]]]


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

    def equation(self, number: str) -> Callable[[Equation], Equation]:
        """Register an equation whose sides agree, by the number or the section where it stands."""
        return _entry(self.holds, number)

    def as_printed(self, number: str) -> Callable[[Equation], Equation]:
        """Register an equation as the text at hand prints it, whose sides do not agree.

        If one equation has several errors, its number is followed by ", ..." after " as printed".
        """
        return _entry(self.fails, number)

    def each(self, cases: Cases, holds: Mapping[str, Pair]) -> None:
        """Register equations with pairs of sides in each case, such as a top and a time."""
        for number, sides in holds.items():
            self.equation(number)(partial(_pairs, sides, cases))

    def table(self, cases: Cases, holds: Mapping[str, Callable[..., Iterable[Any]]]) -> None:
        """Register equations with several pairs of sides in each case."""
        for number, pairs in holds.items():
            self.equation(number)(partial(_all_pairs, pairs, cases))

    def each_as_printed(self, cases: Cases, fails: Mapping[str, Pair]) -> None:
        """Register misprints with pairs of sides in each case."""
        for number, sides in fails.items():
            self.as_printed(number)(partial(_pairs, sides, cases))

    def misreading(self, number: str) -> Callable[[Equation], Equation]:
        """Register another reading of a blurred sign, whose sides do not agree."""
        return _entry(self.misread, number)


def _pairs(sides: Pair, cases: Cases) -> Sides:
    """Yield the pairs of sides of each case."""
    for case in cases():
        found = sides(*case)
        yield from found if isinstance(found, list) else [found]


def _all_pairs(pairs: Callable[..., Iterable[Any]], cases: Cases) -> Sides:
    """Yield all pairs of sides of each case."""
    return chain.from_iterable(starmap(pairs, cases()))


def _entry(equations: dict[str, Equation], number: str) -> Callable[[Equation], Equation]:
    """Return a decorator that registers an equation under a number that is not taken yet."""

    def register(sides: Equation) -> Equation:
        assert PLACE.match(number), f"{number} does not begin with a place in the source"
        assert number not in equations, f"{number} is registered twice"
        equations[number] = sides
        return sides

    return register


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
        assert max(gaps(self.register.holds[number])) < self.tolerances.get(number, 1e-40)

    @pytest.mark.slow
    def test_equation_can_fail(self, number: str, monkeypatch: pytest.MonkeyPatch) -> None:
        self.spoil(monkeypatch)
        assert max(gaps(self.register.holds[number])) > 1e-6

    def test_as_printed_it_fails(self, misprint: str) -> None:
        wrong = self.register.fails | self.register.misread
        assert min(gaps(wrong[misprint])) > 1e-3

    def test_every_misprint_is_put_right(self) -> None:
        wrong = {*self.register.fails, *self.register.misread}
        assert {number.partition(" as printed")[0] for number in wrong} <= set(self.register.holds)

    def test_the_errata_are_the_misprints(self) -> None:
        assert set(self.register.fails) == self.errata


def gaps(equation: Equation) -> list[float]:
    """Return how far the sides of each pair are apart; an equation without pairs is an error."""
    found = [gap(left, right) for left, right in equation()]
    assert found, "the equation compares nothing"
    return found


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
