"""Uncertain inputs of `lagtop solve`: values with uncertainties, and the budget of a key."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Mapping
from typing import Any

from ..arithmetic.text import NumberText
from ..errors import AbsentError, LagtopError, joined
from ..names import check_names
from ..output.destination import Output
from ..output.report import Field, Report, uncertain_text, with_unit
from ..solver.derivatives import DIFFERENTIABLE, NO_DERIVATIVE
from ..solver.keys import degree_name, shown_keys, unit_name
from ..solver.solve import Motion
from ..solver.uncertainty import Contribution, FirstOrder, stds_of
from ..top.given import Given
from ..top.inputs import STANDS_FOR
from .app import complain
from .shared import write_report


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

    A warning names the numbers that have none.
    """
    uncertain = FirstOrder(motion, found.stds)
    stds, beyond = stds_of(record, uncertain)
    lost = [x for x in record if record[x] is not None and stds.get(f"{x}_std", 0) is None]
    if beyond:
        complain(f"Warning: {joined(beyond).marked}")
    elif lost:
        known = any(degree_name(key) in DIFFERENTIABLE for key in lost)
        reason = NO_DERIVATIVE if known else "keys outside the record have none"
        complain(f"Warning: no uncertainty of {', '.join(lost)}: {reason}")
    misled = [
        x
        for x in record
        if (std := stds.get(f"{x}_std")) is not None and uncertain.misleads(x, std)
    ]
    if misled:
        complain(
            f"Warning: uncertainties of {', '.join(misled)} are not reliable: linear propagation "
            "disagrees with motions one and two standard deviations away"
        )
    texts = {
        name: NumberText(uncertain_text(_to_the_last_digit(motion, name, float(value), std), std))
        for name, value in record.items()
        if value is not None and (std := stds.get(f"{name}_std"))
    }
    return dict(record) | stds, texts


def _to_the_last_digit(motion: Motion, key: str, value: float, std: float) -> float | str:
    """Return a number of a motion with as many digits as its uncertainty has."""
    digits = math.ceil(math.log10(abs(value) / std)) + 3 if value and std else 0
    if digits <= sys.float_info.dig:
        return value
    found = motion.number(key, digits)
    return found.value if found is not None else value


def write_budget(found: Given, motion: Motion, key: str, radians: bool, out: Output) -> None:
    """Write the budget of a key: the contribution of each uncertain input, and the key itself.

    Raises AbsentError if the motion has no such key, or it has no derivative.
    """
    check_names("budget", [key], [unit_name(name, radians=radians) for name in DIFFERENTIABLE])
    value = motion.record(radians=radians, keys=[key])[key]
    if value is None:
        raise AbsentError(f"{key} is {motion.absence(key)}")
    uncertain = FirstOrder(motion, found.stds)
    whole = uncertain.std(key)
    if whole is None:
        raise AbsentError(f"{key} has no uncertainty of first order: {NO_DERIVATIVE}")
    given = {x: float(found.inputs[x]) for x in found.stds}
    units, four_digits = _units(found, [key, *given]), "{:.4g}".format
    fields = [
        Field("quantity", "quantity", lambda x: with_unit(x, units.get(x)), is_text=True),
        Field("value", "value", lambda x: f"{x:.6g}"),
        Field("std", "uncertainty", four_digits),
        Field("sensitivity", "sensitivity", four_digits),
        Field("contribution", with_unit("contribution", units.get(key)), four_digits),
        Field("elasticity", "elasticity", four_digits),
        Field("share", "share", lambda x: f"{100 * x:.1f} %"),
    ]
    rows = [*uncertain.budget(key, given), Contribution(key, value, whole)]  # last, as in EA-4/02
    text = uncertain_text(_to_the_last_digit(motion, key, value, whole), whole)
    shown = f"{key} = {text} {units.get(key, '')}".rstrip()
    conclusion = f"{shown}, to first order; inputs are taken as independent."
    write_report(out, lambda: Report({"key": key}, fields, rows, [conclusion], units))


def _units(found: Given, keys: Iterable[str]) -> dict[str, str]:
    """Return the units of inputs and of keys of the record, if inputs have units."""
    if not found.si:
        return {}
    named = found.named
    shown = shown_keys(named=named) | shown_keys(named=named, radians=True)
    solved = {key: shown.get(STANDS_FOR.get(key, key)) for key in keys}
    return {key: x.unit for key, x in solved.items() if x is not None and x.unit}
