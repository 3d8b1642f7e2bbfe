"""Inputs from Python: numbers and arrays, also of pint and uncertainties, and tops of scenes."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from decimal import Decimal
from fractions import Fraction
from types import NoneType
from typing import Any

from ..arithmetic.numbers import Number
from ..arithmetic.text import quoted
from ..errors import LagtopError, check_type
from .given import gather
from .mixed_body import warn_of
from .top import Top
from .value import Value, parse_value


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


def read_scene(
    path: str | os.PathLike[str], given: Mapping[str, Number] | None = None, *, exact: bool = False
) -> Top:
    """Return the top of a scene file; `given` inputs override those of the file.

    Numbers are rounded to doubles, or kept as `exact` decimals.  Numbers with units are converted
    to SI.  A MixedBodyWarning names the defaults if only some of the body is given.  Raises
    SceneError for a bad file, LagtopError for a bad given input.

    >>> read_scene("hanging-top", {"r0": 20}).r0
    20.0
    """
    check_type("given", given, Mapping, NoneType)
    found = gather(values_of(given or {}), os.fsdecode(path))
    top = found.top(exact=exact)
    if found.missing:
        warn_of(found.missing, stacklevel=3)
    return top
