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
from .inputs import STEADY_WORDS, TILT
from .ranges import MOST_POINTS, EvenPoints, ListedPoints, LogPoints, Points
from .units import conversion

LOG = "log:"
"""Prefix of a range with equal ratios."""
_UNIT = re.compile(r"(?:(?:(?<=\s)1\s*)?/\s*)?(?![eE][+-]?\d)(?:[^\W\d_]|°).*", re.DOTALL)
"""Any text from its first letter, which begins no exponent; `1/` may precede."""
_DECIMAL = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)"
_EXPONENT = r"(?:[eE][+-]?\d+)"
_SPREAD = (
    rf"(?P<number>{_DECIMAL}{_EXPONENT}?)\s*(?:\+/?-|±)"
    rf"\s*(?P<std>{_DECIMAL}{_EXPONENT}?)\s*(?P<percent>%?)"
)
_UNCERTAIN = (
    rf"(?P<number>{_DECIMAL})\((?P<last>\d+(?:\.\d*)?)\)(?P<exponent>{_EXPONENT}?)",
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


Read = Callable[[str], Fraction]
"""Returns the number in a text, or raises LagtopError without the name of an input."""


def tilt_key(name: str, value: Value, *, radians: bool = False) -> str:
    """Return the key of an input: that of a tilt names its unit, which is degrees by default."""
    if not name.startswith(TILT) or (name != TILT and not value.unit):
        return name
    return f"{TILT}_{value.unit or ('rad' if radians else 'deg')}"


def parse_value(
    key: str,
    text: str,
    parse: Callable[..., Any] | None = None,
    *,
    uncertain: bool = False,
    steady: bool = False,
    wanted: str | None = None,
) -> Value:
    """Read the input or quantity `key`: a number, or what `parse` makes of the text.

    `uncertain` allows an uncertainty, `steady` allows `STEADY_WORDS`, and `wanted` is the unit of
    the result.  Raises LagtopError, also if `parse` does.
    """
    number, unit = split_unit(text)
    if steady and number in STEADY_WORDS:
        return Value(number)
    got = f"got {quoted(text.strip())}"
    if re.search(r"±|\+/?-", unit):
        wrong = f"must have its unit once, at the end, as in '24.0 ± 0.2 cm', {got}"
        raise LagtopError(f"{key} {wrong}", key)
    factor = Fraction(1)
    if unit:
        factor, unit = conversion(key, unit, wanted)

    def read(text: str) -> Fraction:
        return parse_number(text) * factor

    try:
        plain, std = _split_uncertainty(number)
        if std is not None and not uncertain:
            raise LagtopError(f"must have no uncertainty in this command, {got}: leave that out")
        found = parse(plain, read) if parse else read(plain)
    except LagtopError as error:
        whole = error.marked.replace(f"got {quoted(number)}", got)
        if number in STEADY_WORDS:
            keys = "steady_rate_slow and steady_rate_fast"
            whole = f"must be a number unless one top is solved, got {number}: see the keys {keys}"
        elif steady and not re.search(r"\d", number):
            whole = f"must be a number, {' or '.join(STEADY_WORDS)}, {got}"
        raise LagtopError(f"{key} {whole}", key) from None
    return Value(found, unit, None if std is None else std * factor)


def _split_uncertainty(text: str) -> tuple[str, Fraction | None]:
    """Return the number in a text, as text, and its standard uncertainty, or None."""
    if not re.search(r"[(±%]|\+/?-", text) or re.fullmatch(f"{_DECIMAL}{_EXPONENT}?", text):
        return text, None
    found = next((x for form in _UNCERTAIN if (x := re.fullmatch(form, text))), None)
    if found is None:
        forms = "1587(2), 1587+/-2 or 1587+/-0.1%"
        hint = " (write a decimal point, not a comma)" if "," in text else ""
        wanted = f"must be a number, or an uncertain number such as {forms}"
        raise LagtopError(f"{wanted}, got {quoted(text)}{hint}")
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

    The unit begins at the first letter after a digit that is not the e of an exponent.  That of a
    range or a list is at its end: no colon and no comma follows or precedes it.
    """
    text = text.strip()
    found = _UNIT.search(text, len(LOG) if text.startswith(LOG) else 0)
    if found is None:
        return text, ""
    number, unit = text[: found.start()].rstrip(), found[0]
    if set(unit) & {":", ","} or number.endswith((":", ",")) or not re.search(r"\d", number):
        return text, ""
    return number, unit


def value_of(name: str, given: Any) -> Value:
    """Return a number, also of the package uncertainties, or an array of Python as a value.

    Raises LagtopError.
    """
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

    def __str__(self) -> str:
        return f"{float(self.first):g} to {float(self.last):g}"


def _ends(text: str, parts: Sequence[str], read: Read) -> Span:
    """Return the span of two ends.  Raises LagtopError if a logarithmic one contains 0."""
    span = Span(read(parts[0]), read(parts[1]), text.startswith(LOG))
    if span.logarithmic and not span.first * span.last > 0:
        wanted = "must have two ends of one sign, not 0, in a log: range"
        raise LagtopError(f"{wanted}, got {quoted(text)}")
    return span


def parse_number_or_span(text: str, read: Read = parse_number) -> Fraction | Span:
    """Return a number, or an interval `[log:]from:to` that ascends.  Raises LagtopError."""
    _check_range(text, "60:80 rpm")
    if ":" not in text:
        return read(text)
    ends = text.removeprefix(LOG).split(":")
    if len(ends) != 2:
        raise LagtopError(f"must be a number or a range [log:]from:to, got {quoted(text)}")
    span = _ends(text, ends, read)
    if not span.first < span.last:
        raise LagtopError(f"must be a range from a smaller to a larger value, got {quoted(text)}")
    return span


def parse_range(text: str, read: Read = parse_number) -> Points:
    """Return the points of `start:stop:count` or, with equal ratios, of `log:start:stop:count`.

    Raises LagtopError, also for one point between different ends, and a logarithmic range over 0.
    """
    parts = text.removeprefix(LOG).split(":")
    if len(parts) != 3:
        raise LagtopError(f"must be a range [log:]start:stop:count, got {quoted(text)}")
    (first, last, logarithmic), count = _ends(text, parts, read), parse_number(parts[2])
    if count.denominator != 1 or not 1 <= count <= MOST_POINTS:
        raise LagtopError(f"must have a whole count of 1 to 1e9 in its range, got {quoted(text)}")
    if (size := int(count)) == 1 and first != last:
        wanted = "must have a count of 2 or more between different ends"
        raise LagtopError(f"{wanted}, got {quoted(text)}")
    if logarithmic:
        return LogPoints(first, last, size)
    return EvenPoints(first, (last - first) / max(size - 1, 1), size)


def parse_values(text: str, read: Read = parse_number) -> Points:
    """Return the points of a number, a list `1,2,3` or a range.  Raises LagtopError."""
    _check_range(text, "60:80:3 rpm")
    if ":" in text:
        return parse_range(text, read)
    return ListedPoints([read(part) for part in text.split(",")])


def _check_range(text: str, example: str) -> None:
    """Raise LagtopError for a range without colons, or with a unit in front of its last number."""
    lacks_colons = re.fullmatch(rf"\s*{_DECIMAL}\s*(?:-|\.\.+|…)\s*{_DECIMAL}\s*", text)
    before_last = text[: max(map(text.rfind, "0123456789")) + 1].replace(",", ":")
    before_last = before_last.rpartition(":")[0]
    if lacks_colons or re.search(r"\d\s*(?!e[+-]?\d)(?:[^\W\d_]|°)", before_last):
        wanted = f"must be a number or a range with its unit once, at the end, as in '{example}'"
        raise LagtopError(f"{wanted}, got {quoted(text)}")
