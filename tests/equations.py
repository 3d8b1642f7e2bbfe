"""A register of the sources' equations: each becomes a test, and a test that the test can fail."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar, NamedTuple

import pytest
from ours import ManyDigits, ar

from lagrange_cli.top.inputs import declared

Cases = Callable[[], Iterable[Any]]
"""Cases, such as a top at a time: objects whose attributes are names of the equation."""


def once() -> list[Any]:
    """Return the one case of an equation without parameters."""
    return [SimpleNamespace()]


PLACE = re.compile(
    r"(line before )?\((\d|\d\.\d)[,.]\d+\)"  # the number in the source
    r"|section \d(\.\d| [a-z]+)?: .|sections \d and \d: ."  # or the section, and a name
)
"""How the number of an equation begins: with its place."""


def page(name: str) -> str:
    """Return a page of equations without its title and its empty lines."""
    text = (Path(__file__).parent / "register" / f"{name}.txt").read_text(encoding="utf-8")
    return re.sub(r"^(## .*)?\n", "", text, flags=re.MULTILINE)


class Scope(dict[str, Any]):
    """The names of an equation: attributes of the case, of the module, and of a context."""

    def __init__(self, *places: Any) -> None:
        super().__init__()
        self.places = places

    def __missing__(self, name: str) -> Any:
        """Look a name up, once."""
        for place in self.places:
            if (found := getattr(place, name, None)) is not None:
                return self.setdefault(name, found)
        raise KeyError(name)


class Equation(NamedTuple):
    """An equation, or several, with its cases."""

    texts: Sequence[str]
    cases: Cases
    places: tuple[Any, ...]

    def gaps(self) -> list[float]:
        """Return how far the sides are apart, in each case; sides that are rows, by pairs."""
        found = []
        for case in self.cases():
            names = Scope(case, *self.places)
            for equation in self.texts:
                left, right = (eval(side, names) for side in equation.split(" = "))
                rows = (
                    zip(left, right, strict=True) if hasattr(left, "__iter__") else [(left, right)]
                )
                found += [gap(*pair) for pair in rows]
        assert found, "the equation compares nothing"
        return found


class Register:
    """Equations as they hold, and as they are printed where that is wrong.

    One side is by our functions, the other independent of them.  Names are those of the case, of
    the module and of a context of mpmath.  `test_sources.py` says which numbers must be in some
    register.
    """

    def __init__(self, module: str, context: ManyDigits = ar) -> None:
        self.places = sys.modules[module], context
        self.holds: dict[str, Equation] = {}
        self.fails: dict[str, Equation] = {}
        self.misread: dict[str, Equation] = {}

    def enter(self, table: str) -> None:
        """Register a table: a line for each equation, by its number or the section where it stands.

        Several equations of one line hold together, and an indented line continues the line before.
        A line `# cases` names the function, such as `once`, of the cases of the lines below.
        They hold, unless it ends with `: as printed`, or with `: misread` for other readings of
        blurred signs.  If one equation has several errors, its number is followed by ", ..." after
        " as printed".
        """
        kinds = {"": self.holds, "as printed": self.fails, "misread": self.misread}
        known, cases = self.holds, once
        for number, *equations in declared(table):
            if number.startswith("# "):
                name, _, kind = number[2:].partition(": ")
                known, cases = kinds[kind], Scope(self.places[0], sys.modules[__name__])[name]
                continue
            assert PLACE.match(number), f"{number} does not begin with a place in the source"
            assert number not in known, f"{number} is registered twice"
            known[number] = Equation(equations, cases, self.places)


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
