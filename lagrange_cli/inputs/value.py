"""Input values as users write them: numbers, units, standard uncertainties, correlations.

`1587(2)`, `1587+/-2`, `1587+-2`, `1587±2` and `1587 +/- 0.1 %` are uncertain numbers.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

from ..arithmetic.text import is_decimal, parse_number, quoted
from ..arithmetic.values import Values
from ..errors import LagtopError

_UNIT = r"(?s)(?:(?:(?<=\s)1\s*)?/\s*)?(?![eE][+-]?\d)(?:[^\W\d_]|°).*"
"""Pattern of a unit: any text from its first letter, which begins no exponent; `1/` may precede."""
_LOG = "log:"
"""Prefix of a range with equal ratios."""
_DECIMAL = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_PLUS_MINUS = rf"(?P<number>{_DECIMAL})\s*(?:\+/?-|±)\s*(?P<std>{_DECIMAL})\s*(?P<percent>%?)"
_FORMS = (
    r"(?P<number>[+-]?(?:\d+\.?\d*|\.\d+))\((?P<last>\d+\.?\d*)\)(?P<exponent>[eE].*)?",
    _PLUS_MINUS,
    rf"\(\s*{_PLUS_MINUS}\s*\)(?P<exponent>[eE].*)?",
)


STEADY_WORDS = ("steady", "steady-fast")
"""Words accepted as a precession rate: the steady rate of smaller or of larger size."""


def steady_refused(word: str) -> str:
    """Return the message about a word for the rates of many tops, without the name of the input."""
    keys = "steady_rate_slow and steady_rate_fast"
    return f"must be a number unless one top is solved, got {word}: see the keys {keys}"


class Value(Values):
    """An input as it was given, without any conversion."""

    number: Any
    """A real number or one of `STEADY_WORDS`; the `Points` of a sweep or the `Span` of a search."""
    unit: str = ""
    std: Fraction | None = None
    """Standard uncertainty, in the same unit; None if there is none."""

    def scaled(self, factor: Fraction) -> Value:
        """Return the value multiplied by the size of its unit, without the unit."""
        scaled: Any = getattr(self.number, "scaled", None)
        if scaled is not None:
            number = scaled(factor)
        else:  # arrays have doubles
            number = self.number * (factor if isinstance(self.number, Fraction) else float(factor))
        return Value(number, "", None if self.std is None else self.std * abs(factor))


InputPair = frozenset[str]
"""The keys of two inputs."""
_ROUNDING = Fraction(1, 10**14)
"""A variance up to this size, of variables with variance 1, counts as 0."""
_TOLERANCE = 1e-6
"""Largest error of a correlation, because files have rounded ones."""


class Stds(dict[str, float]):
    """Standard uncertainties of inputs by key, and the correlations of some pairs of them.

    Other pairs are not correlated.  Correlations of inputs without an uncertainty are left out.
    """

    def __init__(
        self, stds: Mapping[str, float], correlations: Mapping[InputPair, Fraction] | None = None
    ) -> None:
        super().__init__(stds)
        pairs = correlations or {}
        self.correlations = {pair: r for pair, r in pairs.items() if pair <= self.keys() and r}

    def only(self, names: Collection[str]) -> Stds:
        """Return the uncertainties of some inputs."""
        return Stds({x: std for x, std in self.items() if x in names}, self.correlations)

    @cached_property
    def sources(self) -> Sequence[tuple[Fraction, Mapping[str, Fraction]]]:
        """The independent sources of all uncertainties: their variances and shares by input.

        A source changes each input by its share of the standard uncertainty.  The shares are the
        columns of L in the factors L D L^T of the matrix of correlations, the variances are D.
        """
        left = {(x, y): self._correlation(x, y) for x in self for y in self}
        sources: list[tuple[Fraction, dict[str, Fraction]]] = []
        names = list(self)
        for i, name in enumerate(names):
            if (variance := left[name, name]) > _ROUNDING:
                shares = {x: left[name, x] / variance for x in names[i:] if left[name, x]}
                sources.append((variance, shares))
                for x, y in product(shares, repeat=2):
                    left[x, y] -= shares[x] * shares[y] * variance
        return sources

    def _correlation(self, x: str, y: str) -> Fraction:
        return Fraction(x == y) or self.correlations.get(InputPair((x, y)), Fraction(0))

    def are_possible(self) -> bool:
        """Return whether the matrix of correlations is positive semidefinite, up to rounding."""
        made: dict[tuple[str, str], Fraction] = defaultdict(Fraction)
        for variance, shares in self.sources:
            for x, y in product(shares, repeat=2):
                made[x, y] += variance * shares[x] * shares[y]
        return all(
            abs(made[x, y] - self._correlation(x, y)) < _TOLERANCE for x in self for y in self
        )


def value_of(name: str, given: Any) -> Value:
    """Return a number or an array as a value; both may be of pint, and numbers of uncertainties.

    A single number with a unit, and an uncertainty, become fractions.  Raises LagtopError if they
    are not finite.
    """
    if isinstance(given, Value):
        return given
    unit = ""
    if hasattr(given, "magnitude"):  # xarray has `units` too
        unit, given = f"{given.units:C}", given.magnitude
    number, std = getattr(given, "nominal_value", given), getattr(given, "std_dev", None)
    if unit and not isinstance(number, list | tuple) and not getattr(number, "shape", ()):
        number = exact_number(name, number)
    spread = None if std is None else exact_number(name, std, "the uncertainty of ")
    return Value(number, unit, spread)


def exact_number(name: str, number: Any, what: str = "") -> Fraction:
    """Return a real number as a fraction.  Raises LagtopError for anything else."""
    number = number.item() if getattr(number, "shape", None) == () else number  # NumPy's overflow
    try:
        if isinstance(number, int | float | Fraction | Decimal) and not isinstance(number, bool):
            float(number)
            return Fraction(number)
    except (ValueError, OverflowError):
        pass
    raise LagtopError(f"{what}{name} must be a finite number, got {quoted(number)}", name)


def parse_value(
    text: str,
    parse: Callable[[str], Any] = parse_number,
    *,
    uncertain: bool = False,
    steady: bool = False,
) -> Value:
    """Parse an input; `parse` reads its number.

    `uncertain` allows an uncertainty, and `steady` allows `STEADY_WORDS`.  Raises LagtopError if
    `parse` does, with the whole text in place of the number, and for a bad uncertainty.
    """
    number, unit = split_unit(text)
    if steady and number in STEADY_WORDS:
        return Value(number)
    try:
        if uncertain and not is_decimal(number) and re.search(r"[(±%]|\+/?-", number):
            return _uncertain(number, parse).replace(unit=unit)
        return Value(parse(number), unit)
    except LagtopError as error:
        got = f"got {quoted(text.strip())}"
        whole = str(error).replace(f"got {quoted(number)}", got)
        if number in STEADY_WORDS:
            whole = steady_refused(number)
        elif steady and not re.search(r"\d", number):
            whole = f"must be a number, {' or '.join(STEADY_WORDS)}, {got}"
        elif not uncertain and any(re.fullmatch(form, number) for form in _FORMS):
            whole = f"must have no uncertainty in this command, {got}: leave out {_spread(number)}"
        raise LagtopError(whole, error.key) from None


def _spread(text: str) -> str:
    """Return the uncertainty of an uncertain number as it is written, such as `(2)`."""
    found = re.search(r"\([\d.]+\)|(\+/?-|±)\s*[^\s)%]+(\s*%)?", text)
    return found[0] if found else "the uncertainty"


def split_unit(text: str) -> tuple[str, str]:
    """Return the number part of an input text and its unit, empty if it has none.

    The unit begins at the first letter that is not the e of an exponent.  The number part may hold
    an uncertainty, such as `1587(2)` or `1587 +/- 0.1 %`.  A text without a digit before its first
    letter, such as `nan`, has no unit.  A range or a list has its unit at the end, after a number:
    no colon and no comma follows or precedes it.
    """
    text = text.strip()
    found = re.compile(_UNIT).search(text, len(_LOG) if text.startswith(_LOG) else 0)
    if found is None:
        return text, ""
    number, unit = text[: found.start()].rstrip(), found[0]
    if set(unit) & {":", ","} or number.endswith((":", ",")) or not re.search(r"\d", number):
        return text, ""
    return number, unit


def _uncertain(text: str, parse: Callable[[str], Any]) -> Value:
    """Return an uncertain number.

    Raises LagtopError for any other text, and for a negative uncertainty.
    """
    found = next((match for form in _FORMS if (match := re.fullmatch(form, text))), None)
    if found is None:
        forms = "1587(2), 1587+/-2 or 1587+/-0.1%"
        raise LagtopError(f"must be a number, or an uncertain one as {forms}, got {quoted(text)}")
    parts = found.groupdict(default="")
    exponent = parts.get("exponent", "")
    number, power = parts["number"] + exponent, parse_number(f"1{exponent}")
    if "last" in parts:
        last = parts["last"]
        decimals = 0 if "." in last else len(parts["number"].partition(".")[2])
        std = parse_number(f"{last}e-{decimals}") * power
    else:
        std = parse_number(parts["std"]) * power
        std = abs(parse_number(number)) * std / 100 if parts["percent"] else std
    if std < 0:
        raise LagtopError(f"must have an uncertainty >= 0, got {quoted(text)}")
    return Value(parse(number), "", std)
