"""Headings of files of tops: the inputs they name, their units, and slips in them."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from fractions import Fraction
from typing import Any

from ..arithmetic.text import quoted
from ..errors import DataError, LagtopError, UnavailableError
from .names import repeated
from .quantity_text import TILT, Quantity
from .top import INPUTS


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
    if name.strip().startswith(f"{TILT}_"):
        raise LagtopError(f"the column {cell} must be called {TILT} [{unit}")
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


def units_of(
    headings: Sequence[tuple[str, str]], known: Collection[str], name: str
) -> dict[str, Any]:
    """Return what 1 means in each column of an input: a `Quantity` where its heading has a unit.

    Raises DataError for a unit that is none of its input, UnavailableError where pint is missing.
    """
    found: dict[str, Any] = {}
    for column, unit in headings:
        if column in known:
            found[column] = Quantity(Fraction(1), unit) if unit else Fraction(1)
            _check_unit(column, found[column], name)
    return found


def _check_unit(column: str, meaning: Any, name: str) -> None:
    if not isinstance(meaning, Quantity):
        return
    from .units import converted

    try:
        converted({column: meaning}, None)
    except UnavailableError:
        raise
    except LagtopError as error:
        place = f"{name}, heading {column} [{meaning.unit}]"
        raise DataError(f"{place}: {error}") from None
