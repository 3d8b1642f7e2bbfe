"""Headings of files of tops: the inputs they name, their units, and slips in them."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from fractions import Fraction

from ..arithmetic.text import quoted
from ..errors import DataError, LagtopError, UnavailableError
from .input_keys import TILT
from .names import repeated
from .top import INPUTS
from .value import Value


def check_spelling(carried: Sequence[str], name: str) -> None:
    """Raise DataError for a column that is not read but looks like an input."""
    inputs = {_plain(known): known for known in reversed(INPUTS)}  # the first of those alike
    for column in carried:
        if known := inputs.get(_plain(column)):
            raise DataError(f"{name}: the column {column} must be spelt {known}")


def _plain(column: str) -> str:
    """Return a name without case, underscores, the 0 of theta0 and the unit: easily mistaken."""
    return re.sub("_|0|deg$|rad$", "", column.lower()) or column


def heading(cell: str) -> tuple[str, str]:
    """Return the name of a column and its unit, which a heading such as `m [g]` of an input has."""
    name, bracket, unit = cell.partition("[")
    if not bracket or not unit.endswith("]") or name.strip() not in {*INPUTS, TILT}:
        return cell, ""
    return name.strip(), unit[:-1].strip()


def check_header(columns: Sequence[str], known: Collection[str], name: str) -> None:
    """Raise DataError for a header that names a column twice, or none of the `known` inputs."""
    if (twice := repeated(columns)) is not None:
        raise DataError(f"{name} must name each column once, got {twice!r} twice")
    if not set(columns) & set(known):
        raise DataError(
            f"{name} must begin with a header that names inputs ({' '.join(INPUTS)}), "
            f"got {quoted(','.join(columns))}"
        )


def heading_units(
    headings: Sequence[tuple[str, str]], known: Collection[str], name: str
) -> dict[str, Value]:
    """Return 1 in each column of an input, in the unit of its heading.

    Raises DataError for a unit that is none of its input, UnavailableError where pint is missing.
    """
    found = {x: Value(Fraction(1), unit) for x, unit in headings if x in known}
    for column, one in found.items():
        if one.unit and column.startswith(f"{TILT}_"):
            raise DataError(f"{name}: the column {column} must be called {TILT} [{one.unit}]")
        if one.unit:
            _check_unit(column, one, name)
    return found


def _check_unit(column: str, one: Value, name: str) -> None:
    from .units import converted

    try:
        converted({column: one}, None)
    except UnavailableError:
        raise
    except LagtopError as error:
        place = f"{name}, heading {column} [{one.unit}]"
        raise DataError(f"{place}: {error}") from None
