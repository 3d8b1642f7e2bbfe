"""Values of inputs, read from texts or Python; a number with a unit becomes SI when it is read.

number       `30`, `-1.5`, `2e-3`
uncertain    `1587(2)`, `1587+/-2`, `1587 ± 0.1 %`, `(1.5+-0.2)e3`
points       `1,2,3`, `start:stop:count`, `log:start:stop:count`
unknown      `from:to`, `log:from:to`
unit         at the end of any of them: `480 rpm`, `477(2) rpm`, `60:80:3 rpm`

A tilt with a unit becomes degrees or radians.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError
from .inputs import TILT
from .ranges import MOST_POINTS, EvenPoints, ListedPoints, LogPoints, Points

LOG = "log:"
"""Prefix of a range with equal ratios."""
STEADY_WORDS = ("steady", "steady-fast")
"""Words accepted as a precession rate: the steady rate of smaller or of larger size."""
_UNIT = re.compile(r"(?:(?:(?<=\s)1\s*)?/\s*)?(?![eE][+-]?\d)(?:[^\W\d_]|°).*", re.DOTALL)
"""Any text from its first letter, which begins no exponent; `1/` may precede."""
_DECIMAL = r"[+-]?(?:\d+\.?\d*|\.\d+)"
_EXPONENT = r"(?:[eE][+-]?\d+)"
_SPREAD = (
    rf"(?P<number>{_DECIMAL}{_EXPONENT}?)\s*(?:\+/?-|±)"
    rf"\s*(?P<std>{_DECIMAL}{_EXPONENT}?)\s*(?P<percent>%?)"
)
_UNCERTAIN = (
    rf"(?P<number>{_DECIMAL})\((?P<last>\d+\.?\d*)\)(?P<exponent>{_EXPONENT}?)",
    _SPREAD,
    rf"\(\s*{_SPREAD}\s*\)(?P<exponent>{_EXPONENT}?)",
)


class Value(NamedTuple):
    """An input; one that was given with a unit is in SI, a tilt in degrees or radians."""

    number: Any
    """A real number or one of `STEADY_WORDS`; the `Points` of a sweep or the `Span` of a search."""
    unit: str = ""
    """The unit of the number after conversion, such as `len`, `rad/time` or `deg`; or empty."""
    std: Fraction | None = None
    """Standard uncertainty, in the same unit; None if there is none."""

    def given_in(self, unit: str, key: str, wanted: str | None = None) -> Value:
        """Return the number as one in a unit, converted to SI, or to `wanted` (see `factor_of`).

        `key` is the input or the quantity.  Raises LagtopError for a unit of other dimensions.
        """
        if not unit:
            return self
        from .units import factor_of, unit_to_keep  # start-up

        wanted = unit_to_keep(key, unit) if wanted is None else wanted
        factor = factor_of(key, unit, wanted)
        is_number = isinstance(self.number, Fraction)
        number = self.number * factor if is_number else self.number.scaled(factor)
        return Value(number, wanted, None if self.std is None else self.std * factor)


def tilt_key(name: str, value: Value, *, radians: bool = False) -> str:
    """Return the key of an input: that of a tilt names its unit, which is degrees by default."""
    if not name.startswith(TILT) or (name != TILT and not value.unit):
        return name
    return f"{TILT}_{value.unit or ('rad' if radians else 'deg')}"


def parse_value(
    key: str,
    text: str,
    parse: Callable[[str], Any] = parse_number,
    *,
    uncertain: bool = False,
    steady: bool = False,
    wanted: str | None = None,
) -> Value:
    """Read the input or quantity `key`; `parse` reads its number.

    `uncertain` allows an uncertainty, `steady` allows `STEADY_WORDS`, and `wanted` is the unit of
    the result.  Raises LagtopError if `parse` does, with the whole text in place of the number, for
    a bad uncertainty, and for a unit of other dimensions.
    """
    number, unit = split_unit(text)
    if steady and number in STEADY_WORDS:
        return Value(number)
    got = f"got {quoted(text.strip())}"
    try:
        if re.search(r"±|\+/?-", unit):
            raise LagtopError(f"must have its unit once, at the end, as in '24.0 ± 0.2 cm', {got}")
        plain, std = _split_uncertainty(number)
        if std is not None and not uncertain:
            raise LagtopError(f"must have no uncertainty in this command, {got}: leave it out")
        found = Value(parse(plain), "", std)
    except LagtopError as error:
        whole = str(error).replace(f"got {quoted(number)}", got)
        if number in STEADY_WORDS:
            whole = steady_refused(number)
        elif steady and not re.search(r"\d", number):
            whole = f"must be a number, {' or '.join(STEADY_WORDS)}, {got}"
        raise LagtopError(f"{key} {whole}", key) from None
    return found.given_in(unit, key, wanted)


def _split_uncertainty(text: str) -> tuple[str, Fraction | None]:
    """Return the number in a text, as text, and its standard uncertainty, or None."""
    if not re.search(r"[(±%]|\+/?-", text) or re.fullmatch(f"{_DECIMAL}{_EXPONENT}?", text):
        return text, None
    found = next((x for form in _UNCERTAIN if (x := re.fullmatch(form, text))), None)
    if found is None:
        forms = "1587(2), 1587+/-2 or 1587+/-0.1%"
        hint = " (write a decimal point, not a comma)" if "," in text else ""
        wrong = f"must be a number, or an uncertain one as {forms}, got {quoted(text)}{hint}"
        raise LagtopError(wrong)
    parts = {"exponent": "", **found.groupdict(default="")}
    number, last = parts["number"], parts.get("last")
    if last is not None:  # in units of the last digit
        decimals = 0 if "." in last else len(number.partition(".")[2])
        parts |= {"std": f"{last}e-{decimals}", "percent": ""}
    std = parse_number(parts["std"]) * parse_number(f"1{parts['exponent']}")
    if std < 0:
        raise LagtopError(f"must have an uncertainty >= 0, got {quoted(text)}")
    if parts["percent"]:
        std *= abs(parse_number(number)) / 100
    return number + parts["exponent"], std


def split_unit(text: str) -> tuple[str, str]:
    """Return the number part of an input text and its unit, empty if it has none.

    The unit begins at the first letter that is not the e of an exponent.  A text without a digit
    before its first letter, such as `nan`, has no unit.  A range or a list has its unit at the end,
    after a number: no colon and no comma follows or precedes it.
    """
    text = text.strip()
    found = _UNIT.search(text, len(LOG) if text.startswith(LOG) else 0)
    if found is None:
        return text, ""
    number, unit = text[: found.start()].rstrip(), found[0]
    if set(unit) & {":", ","} or number.endswith((":", ",")) or not re.search(r"\d", number):
        return text, ""
    return number, unit


def steady_refused(word: str) -> str:
    """Return the message about a word for the rates of many tops, without the name of the input."""
    keys = "steady_rate_slow and steady_rate_fast"
    return f"must be a number unless one top is solved, got {word}: see the keys {keys}"


def value_of(name: str, given: Any, parse: Callable[[str], Any] | None = None) -> Value:
    """Return a number or an array of Python as a value.

    Numbers of the package uncertainties are accepted, and texts if `parse` reads their numbers.
    Raises LagtopError for an uncertainty that is not finite, and if `parse` does.
    """
    if parse is not None and isinstance(given, str):
        return parse_value(name, given, parse, uncertain=True)
    if isinstance(given, Value):
        return given
    if hasattr(given, "magnitude"):  # NumPy would drop the unit of a quantity of pint
        wrong = "must be a number without a unit object, such as its magnitude"
        raise LagtopError(f"{name} {wrong}, got {quoted(given)}", name)
    number, std = getattr(given, "nominal_value", given), getattr(given, "std_dev", None)
    spread = None if std is None else exact_number(name, std, "the uncertainty of ")
    return Value(number, "", spread)


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


class Span(NamedTuple):
    """The interval in which an unknown input is searched for, or the ends of a range."""

    first: Fraction
    last: Fraction
    logarithmic: bool = False
    """Whether the interval is divided into equal ratios instead of equal steps."""

    def scaled(self, factor: Fraction) -> Span:
        """Return the interval multiplied by a factor > 0."""
        return self._replace(first=self.first * factor, last=self.last * factor)

    def __str__(self) -> str:
        return f"{float(self.first):g} to {float(self.last):g}"


def _ends(text: str, parts: Sequence[str], parse: Callable[[str], Fraction]) -> Span:
    """Return the span of two ends.  Raises LagtopError if a logarithmic one contains 0."""
    span = Span(parse(parts[0]), parse(parts[1]), text.startswith(LOG))
    if span.logarithmic and not span.first * span.last > 0:
        wanted = "must have two ends of one sign, not 0, in a log: range"
        raise LagtopError(f"{wanted}, got {quoted(text)}")
    return span


def parse_span(text: str) -> Span:
    """Parse an interval, `from:to` or `log:from:to`.

    Raises LagtopError for anything else, and unless the second end is the larger one.
    """
    _refuse_units_inside(text)
    ends = text.removeprefix(LOG).split(":")
    if len(ends) != 2:
        raise LagtopError(f"must be a number or a range [log:]from:to, got {quoted(text)}")
    span = _ends(text, ends, parse_number)
    if not span.first < span.last:
        raise LagtopError(f"must be a range whose first end is the smaller one, got {quoted(text)}")
    return span


def parse_number_or_span(text: str) -> Fraction | Span:
    """Parse a number, or an interval `[log:]from:to`.  Raises LagtopError."""
    return parse_span(text) if ":" in text else parse_number(text)


def parse_range(text: str, parse: Callable[[str], Fraction] = parse_number) -> Points:
    """Return the points of `start:stop:count` or, with equal ratios, of `log:start:stop:count`.

    `parse` reads the two ends.  Raises LagtopError for anything else, for a count of 1 between
    different ends, and for a logarithmic range over 0.
    """
    parts = text.removeprefix(LOG).split(":")
    if len(parts) != 3:
        raise LagtopError(f"must be a range [log:]start:stop:count, got {quoted(text)}")
    (first, last, logarithmic), count = _ends(text, parts, parse), parse_number(parts[2])
    if count.denominator != 1 or not 1 <= count <= MOST_POINTS:
        raise LagtopError(f"must have a whole count of 1 to 1e9 in its range, got {quoted(text)}")
    if count == 1 and first != last:
        wanted = "must have a count of 2 or more between different ends"
        raise LagtopError(f"{wanted}, got {quoted(text)}")
    size = int(count)
    if logarithmic:
        return LogPoints(first, last, size)
    return EvenPoints(first, (last - first) / max(size - 1, 1), size)


def parse_values(text: str) -> Points:
    """Return the points of a number, a list `1,2,3` or a range.  Raises LagtopError."""
    _refuse_units_inside(text)
    if ":" in text:
        return parse_range(text)
    if re.fullmatch(rf"\s*{_DECIMAL}\s*-\s*{_DECIMAL}\s*", text):
        raise LagtopError(f"must be a range start:stop:count, got {quoted(text)}")
    return ListedPoints([parse_number(part) for part in text.split(",")])


def _refuse_units_inside(text: str) -> None:
    """Raise LagtopError for a range or a list with a unit in front of its last number."""
    if re.search(r"\d\s*(?!e[+-]?\d)(?:[^\W\d_]|°)[^:,]*[:,].*\d", text):
        wanted = "must have its unit once, at the end, as in '60:80:3 rpm'"
        raise LagtopError(f"{wanted}, got {quoted(text)}")
