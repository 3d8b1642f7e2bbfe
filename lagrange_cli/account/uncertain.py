"""Records with uncertainties, and the budget of a key: the contribution of each uncertain input."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from ..arithmetic.text import NumberText, uncertain_text
from ..errors import AbsentError, LagtopError
from ..names import check_names
from ..output.report import Field, Report, with_unit
from ..solver.keys import NUMBERS, TEXT_KEYS
from ..solver.solve import Motion
from ..top.given import Given
from ..top.inputs import DECLARED
from ..top.units import Units, bare_name
from .spread import Spread, Uncertainty

NO_SPREAD = "motions one standard deviation away lack it, or it is beyond the range of doubles"


def spread_of(found: Given, motion: Motion) -> Spread:
    """Return the spread of a motion.

    Raises LagtopError for an input that has no possible value one standard deviation away.
    """
    spread = Spread(motion, found.stds)
    for name, std in found.stds.items():
        if std and not spread.neighbours(name, 1):
            wrong = f"{name} has no possible value {std:g} away"
            raise LagtopError(f"{wrong}: reduce its uncertainty, or leave it out", name)
    return spread


class UncertainRecord(NamedTuple):
    """A record with the uncertainties of its numbers."""

    record: dict[str, Any]
    """The record and the keys KEY_std."""
    texts: dict[str, Any]
    """Values as `value(uncertainty)`, for people."""
    lost: list[str]
    """The numbers without an uncertainty."""
    nonlinear: list[str]
    """The numbers that do not change in proportion to the inputs."""


def uncertain_record(
    motion: Motion, record: Mapping[str, Any], uncertainty: Callable[[str], Uncertainty | None]
) -> UncertainRecord:
    """Return a record with the uncertainties of its numbers, which a function returns by key."""
    numbers = [x for x, y in record.items() if x not in TEXT_KEYS and not isinstance(y, str)]
    present = [x for x in numbers if record[x] is not None]
    known = {x: y for x in present if (y := uncertainty(x)) and math.isfinite(y.std)}
    stds = {x: y.std for x, y in known.items()}
    texts = {
        name: NumberText(uncertain_text(_to_the_last_digit(motion, name, record[name], std), std))
        for name, std in stds.items()
        if std
    }
    return UncertainRecord(
        dict(record) | {f"{name}_std": stds.get(name) for name in numbers},
        texts,
        [x for x in present if x not in known],
        [x for x, y in known.items() if not y.linear],
    )


def _to_the_last_digit(motion: Motion, key: str, value: float, std: float) -> float | str:
    """Return a number of a motion with as many digits as its uncertainty has."""
    digits = math.ceil(math.log10(abs(value)) - math.log10(std)) + 3 if value and std else 0
    if digits <= sys.float_info.dig:
        return value
    found = motion.number(key, digits)
    return found.value if found is not None else value


class BudgetLine(NamedTuple):
    """The contribution of an input to the uncertainty of a number.

    The number itself has a line that ends with its uncertainty.
    """

    quantity: str
    value: float
    std: float
    sensitivity: float | None = None
    """The contribution over the uncertainty of the input."""
    contribution: float | None = None
    elasticity: float | None = None
    """The relative change of the number over the relative change of the input, or None."""
    share: float | None = None
    """The share of the variance, or None."""


def budget(found: Given, motion: Motion, key: str, units: Units) -> tuple[Report, bool]:
    """Return the budget of a key, and whether it changes in proportion to the inputs.

    The last row is the key itself.  Raises AbsentError if the motion, or a neighbouring one, has no
    such key.
    """
    check_names("budget", [key], units.keys(NUMBERS))
    value = motion.record(radians=units.radians, keys=[key])[key]
    if value is None:
        raise AbsentError(f"{key} is {motion.absence(key)}")
    uncertainty = spread_of(found, motion).number(key)
    if uncertainty is None or not math.isfinite(uncertainty.std):
        raise AbsentError(f"{key} has no uncertainty: {NO_SPREAD}")
    given = {x: float(found.inputs[x]) for x in found.stds}
    shown, four_digits = _units([key, *given]) if units.si else {}, "{:.4g}".format
    fields = [
        Field("quantity", "quantity", lambda x: with_unit(x, shown.get(x)), is_text=True),
        Field("value", "value", lambda x: f"{x:.6g}"),
        Field("std", "uncertainty", four_digits),
        Field("sensitivity", "sensitivity", four_digits),
        Field("contribution", with_unit("contribution", shown.get(key)), four_digits),
        Field("elasticity", "elasticity", four_digits),
        Field("share", "share", lambda x: f"{100 * x:.1f} %"),
    ]
    sum_of_squares = math.fsum(x * x for x in uncertainty.contributions.values())
    lines = [
        BudgetLine(
            *(name, given[name], std, part / std, part),
            elasticity=part / std * given[name] / value if value else None,
            share=part * part / sum_of_squares if sum_of_squares else None,
        )
        for name, part in uncertainty.contributions.items()
        for std in [found.stds[name]]
    ]
    lines.sort(key=lambda line: -abs(line.contribution or 0.0))
    text = uncertain_text(_to_the_last_digit(motion, key, value, uncertainty.std), uncertainty.std)
    value_and_unit = f"{key} = {text} {shown.get(key, '')}".rstrip()
    conclusion = f"{value_and_unit}; inputs are taken as independent."
    rows = [*lines, BudgetLine(key, value, uncertainty.std)]  # last, as in EA-4/02
    return Report({"key": key}, fields, rows, [conclusion], shown), uncertainty.linear


def _units(names: Iterable[str]) -> dict[str, str]:
    """Return the SI units of inputs and of keys of the record."""
    units = {bare_name(x): key.unit for x, key in (DECLARED | NUMBERS).items()}
    named = {x: Units(x.endswith("_rad"), si=True).named(units[bare_name(x)]) for x in names}
    return {x: unit for x, unit in named.items() if unit}
