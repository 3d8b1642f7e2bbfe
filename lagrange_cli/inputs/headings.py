"""Headings of columns: names in ASCII or Greek, units, and misspelt inputs.

Write a unit in brackets, in parentheses or after a blank: `t [ms]`, `theta (deg)`, `r0 rpm`.
"""

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

_GREEK = {
    "\u03b8": "theta",
    "\u03d1": "theta",
    "\u03c6": "phi",
    "\u03d5": "phi",
    "\u03c8": "psi",
    "\u03c9": "omega",
    "\u0307": "dot",
    "\u2032": "'",
    "\u2080": "0",
}
"""ASCII spellings of the Greek letters, a dot above, a prime, and a subscript 0."""
_UNITS = {"\u00b0": "deg", "degree": "deg", "degrees": "deg", "radian": "rad", "radians": "rad"}
_UNITS |= {"sec": "s", "second": "s", "seconds": "s", "msec": "ms", "rev/min": "rpm"}
"""Other spellings of units."""
_AFTER_A_BLANK = re.compile(
    r"(.*\S)\s+((?:us|ms|s|sec|min|h|deg|\u00b0|rad|mrad|turn|rev|rpm|[mkg]?g|[cm]?m)"
    r"(?:\*[cm]?m(?:\^2)?)?(?:/(?:s|min|s\^2))?)"
)


def name_and_unit(heading: str) -> tuple[str, str]:
    """Return the name in a heading, in ASCII, and its unit, empty if it has none.

    Brackets around numbers belong to the name, as in `omega[0]`.
    """
    text = "".join(_GREEK.get(x, x) for x in heading.strip())
    text = re.sub(r"(theta|phi|psi)'", r"\1dot", text)
    match = re.fullmatch(r"(.*\S)\s*[\[(]([^\[\]()]*)[\])]", text)
    if match is None or re.fullmatch(r"[\d\s,]+", match[2]):
        match = _AFTER_A_BLANK.fullmatch(text)
    if match is None:
        return text, ""
    unit = match[2].strip()
    return match[1], _UNITS.get(unit, unit)


def column_of(heading: str) -> tuple[str, str]:
    """Return the name of a column in a file of tops and, for an input, its unit."""
    name, unit = name_and_unit(heading)
    return (name, unit) if name in {*INPUTS, TILT} else (heading, "")


_TILTS = ("theta", "tilt", "elevation")
"""Names of the tilt in trajectories, or of 90 degrees less the tilt, which no top is given by."""


def check_spelling(carried: Sequence[str], named: Collection[str], name: str) -> None:
    """Raise DataError for an unread column that looks like an input missing from `named`."""
    missing = [known for known in reversed(INPUTS) if known not in named]
    inputs = {_plain(known): known for known in missing}  # the first of similar names
    if not {"theta0_deg", "theta0_rad"} & set(named):
        inputs |= dict.fromkeys(_TILTS, "theta0_deg")
    for column in carried:
        if known := inputs.get(_plain(column)):
            raise DataError(f"{name}: the column {column} must be spelt {known}")


def _plain(column: str) -> str:
    """Return a name without easily mistaken parts: case, underscores, the 0 of theta0, the unit."""
    bare = name_and_unit(column)[0].lower()
    return re.sub("_|0|deg$|rad$", "", bare) or column


def check_header(columns: Sequence[str], known: Collection[str], name: str) -> None:
    """Raise DataError for a header that repeats a column, or names none of the `known` inputs."""
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
    """Return the value 1 in the unit of its heading, for each column of an input.

    Raises DataError for a unit that its input cannot have, UnavailableError if pint is missing.
    """
    found = {x: Value(Fraction(1), unit) for x, unit in headings if x in known}
    for column, one in found.items():
        if one.unit and column.startswith(f"{TILT}_"):
            raise DataError(f"{name}: the column {column} must be called {TILT} [{one.unit}]")
        if one.unit:
            from .units import converted  # for few files only

            try:
                converted({column: one}, None)
            except UnavailableError:
                raise
            except LagtopError as error:
                place = f"{name}, heading {column} [{one.unit}]"
                raise DataError(f"{place}: {error}") from None
    return found
