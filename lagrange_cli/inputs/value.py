"""Input values: numbers, units and standard uncertainties, as texts or as Python objects."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import Any

from ..arithmetic.text import is_decimal, parse_number, quoted
from ..arithmetic.values import Values
from ..errors import LagtopError

_UNIT = r"(?s)(?:(?:(?<=\s)1\s*)?/\s*)?(?![eE][+-]?\d)(?:[^\W\d_]|°).*"
"""Pattern of a unit: any text from its first letter, which begins no exponent; `1/` may precede."""
LOG = "log:"
"""Prefix of a range with equal ratios."""
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
        """The independent sources of all uncertainties: their variances and shares by input."""
        from .uncertain import independent_sources  # for few tops only

        return independent_sources(self.matrix())

    def matrix(self) -> dict[tuple[str, str], Fraction]:
        """Return the matrix of correlations by pair of inputs, in both orders."""
        one, none = Fraction(1), Fraction(0)
        return {
            (x, y): one if x == y else self.correlations.get(InputPair((x, y)), none)
            for x in self
            for y in self
        }


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
            from .uncertain import split_uncertainty  # for few inputs only

            plain, std = split_uncertainty(number)
            return Value(parse(plain), unit, std)
        return Value(parse(number), unit)
    except LagtopError as error:
        got = f"got {quoted(text.strip())}"
        whole = str(error).replace(f"got {quoted(number)}", got)
        if number in STEADY_WORDS:
            whole = steady_refused(number)
        elif steady and not re.search(r"\d", number):
            whole = f"must be a number, {' or '.join(STEADY_WORDS)}, {got}"
        elif not uncertain:
            from .uncertain import uncertainty_in  # start-up

            if spread := uncertainty_in(number):
                whole = f"must have no uncertainty in this command, {got}: leave out {spread}"
        raise LagtopError(whole, error.key) from None


def split_unit(text: str) -> tuple[str, str]:
    """Return the number part of an input text and its unit, empty if it has none.

    The unit begins at the first letter that is not the e of an exponent.  The number part may hold
    an uncertainty, such as `1587(2)` or `1587 +/- 0.1 %`.  A text without a digit before its first
    letter, such as `nan`, has no unit.  A range or a list has its unit at the end, after a number:
    no colon and no comma follows or precedes it.
    """
    text = text.strip()
    found = re.compile(_UNIT).search(text, len(LOG) if text.startswith(LOG) else 0)
    if found is None:
        return text, ""
    number, unit = text[: found.start()].rstrip(), found[0]
    if set(unit) & {":", ","} or number.endswith((":", ",")) or not re.search(r"\d", number):
        return text, ""
    return number, unit


def value_of(name: str, given: Any, parse: Callable[[str], Any] | None = None) -> Value:
    """Return a number or an array as a value; both may be of pint, and numbers of uncertainties.

    A single number with a unit, and an uncertainty, become fractions.  `parse` reads the number of
    a text, which may be uncertain.  Raises LagtopError if it does, or for numbers that are not
    finite.
    """
    if parse is not None and isinstance(given, str):
        try:
            return parse_value(given, parse, uncertain=True)
        except LagtopError as error:
            raise LagtopError(f"{name} {error}", name) from None
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


def values_of(inputs: Mapping[str, Any]) -> dict[str, Value]:
    """Return the values of inputs by key.  Raises LagtopError."""
    return {name: value_of(name, x) for name, x in inputs.items()}


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
