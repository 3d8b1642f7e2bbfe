"""Uncertain inputs of `lagtop solve`: values with uncertainties, and the budget of a key."""

from __future__ import annotations

import math
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from ..account.spread import ColumnSpread, Spread
from ..arithmetic.text import NumberText, uncertain_text
from ..errors import AbsentError, LagtopError
from ..names import check_names
from ..output.destination import Output
from ..output.report import Field, Report, with_unit
from ..solver.keys import NUMBERS, TEXT_KEYS, shown_keys
from ..solver.solve import Motion
from ..top.given import Given
from ..top.inputs import DECLARED
from ..top.units import Units
from .app import complain
from .shared import write_report

NO_SPREAD = "motions a standard deviation away lack it, or it is beyond the doubles"


def check(found: Given, **options: object) -> None:
    """Raise LagtopError if no input is uncertain, or for options that exclude uncertainties."""
    if not found.stds:
        raise LagtopError("no input is uncertain: give one as in --m '1587(2)'")
    for name, value in options.items():
        if value:
            raise LagtopError(f"use --{name} or uncertain inputs, not both")


def with_stds(
    found: Given, motion: Motion, record: Mapping[str, Any]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return a record with the keys KEY_std, and the values as `value(uncertainty)` for people.

    A warning names the numbers that have none, and those with a doubtful one.
    """
    spread = _spread_of(found, motion)
    numbers = [x for x, y in record.items() if x not in TEXT_KEYS and not isinstance(y, str)]
    present = [x for x in numbers if record[x] is not None]
    known = {x: y for x in present if (y := spread.number(x)) and math.isfinite(y.std)}
    if lost := [x for x in present if x not in known]:
        complain(f"Warning: no uncertainty of {', '.join(lost)}: {NO_SPREAD}")
    warn_of_unfair([x for x, y in known.items() if not y.fair])
    stds = {x: y.std for x, y in known.items()}
    texts = {
        name: NumberText(uncertain_text(_to_the_last_digit(motion, name, record[name], std), std))
        for name, std in stds.items()
        if std
    }
    return dict(record) | {f"{name}_std": stds.get(name) for name in numbers}, texts


def _spread_of(found: Given, motion: Motion) -> Spread:
    """Return the spread of a motion; raise LagtopError for an input that cannot change so much."""
    spread = Spread(motion, found.stds)
    for name, std in found.stds.items():
        if std and not spread.beside(name, 1):
            raise LagtopError(f"{name} has no possible value {std:g} away: change it", name)
    return spread


def warn_of_unfair(names: Collection[str], ending: str = "") -> None:
    """Warn of results that do not change in proportion to the inputs."""
    if names:
        complain(
            f"Warning: uncertainties of {', '.join(names)} are rough{ending}: motions two standard "
            "deviations away are not spread twice as far as those at one; use random tops"
        )


def column_stds(found: Given, motion: Motion, names: Sequence[str]) -> ColumnSpread | None:
    """Return the uncertainties of columns but the time as a function of times, if there are any."""
    if not found.stds:
        return None
    from ..solver.columns import chosen_columns

    chosen = [name for name in chosen_columns(names) if name != "t"]
    return ColumnSpread(_spread_of(found, motion), chosen)


def warn_if_unfair(stds: ColumnSpread | None) -> None:
    """Warn of columns that do not change in proportion to the inputs, after the last row."""
    if stds and stds.unfair:
        warn_of_unfair(stds.unfair, f" from t = {min(stds.unfair.values(), key=abs):g}")


def _to_the_last_digit(motion: Motion, key: str, value: float, std: float) -> float | str:
    """Return a number of a motion with as many digits as its uncertainty has."""
    digits = math.ceil(math.log10(abs(value) / std)) + 3 if value and std else 0
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


def write_budget(found: Given, motion: Motion, key: str, units: Units, out: Output) -> None:
    """Write the budget of a key: the contribution of each uncertain input, and the key itself.

    Raises AbsentError if the motion, or one beside it, has no such key.
    """
    check_names("budget", [key], units.keys(NUMBERS))
    value = motion.record(radians=units.radians, keys=[key])[key]
    if value is None:
        raise AbsentError(f"{key} is {motion.absence(key)}")
    whole = _spread_of(found, motion).number(key)
    if whole is None or not math.isfinite(whole.std):
        raise AbsentError(f"{key} has no uncertainty: {NO_SPREAD}")
    given = {x: float(found.inputs[x]) for x in found.stds}
    shown, four_digits = _units(found, [key, *given]), "{:.4g}".format
    fields = [
        Field("quantity", "quantity", lambda x: with_unit(x, shown.get(x)), is_text=True),
        Field("value", "value", lambda x: f"{x:.6g}"),
        Field("std", "uncertainty", four_digits),
        Field("sensitivity", "sensitivity", four_digits),
        Field("contribution", with_unit("contribution", shown.get(key)), four_digits),
        Field("elasticity", "elasticity", four_digits),
        Field("share", "share", lambda x: f"{100 * x:.1f} %"),
    ]
    sum_of_squares = math.fsum(x * x for x in whole.contributions.values())
    lines = [
        BudgetLine(
            *(name, given[name], std, part / std, part),
            elasticity=part / std * given[name] / value if value else None,
            share=part * part / sum_of_squares if sum_of_squares else None,
        )
        for name, part in whole.contributions.items()
        for std in [found.stds[name]]
    ]
    lines.sort(key=lambda line: -abs(line.contribution or 0.0))
    warn_of_unfair([] if whole.fair else [key])
    text = uncertain_text(_to_the_last_digit(motion, key, value, whole.std), whole.std)
    value_and_unit = f"{key} = {text} {shown.get(key, '')}".rstrip()
    conclusion = f"{value_and_unit}; inputs are taken as independent."
    rows = [*lines, BudgetLine(key, value, whole.std)]  # last, as in EA-4/02
    write_report(out, lambda: Report({"key": key}, fields, rows, [conclusion], shown))


def _units(found: Given, keys: Iterable[str]) -> dict[str, str]:
    """Return the units of inputs and of keys of the record, if inputs have units."""
    if not found.si:
        return {}
    shown = {key: found.units(radians=False).named(x.unit) for key, x in DECLARED.items()}
    for radians in (False, True):
        shown |= {key: x.unit for key, x in shown_keys(found.units(radians=radians)).items()}
    return {key: unit for key in keys if (unit := shown.get(key))}
