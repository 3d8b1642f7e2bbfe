"""Uncertain inputs of `lagtop solve`: values with uncertainties, and the budget of a key."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from ..account.spread import ColumnSpread
from ..account.uncertain import NO_SPREAD, budget, spread_of, uncertain_record
from ..errors import LagtopError
from ..output.destination import Output
from ..solver.solve import Motion
from ..top.given import Given
from ..top.units import Units
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

    A warning names the numbers that have none, and those with a doubtful one.
    """
    record, texts, lost, unfair = uncertain_record(found, motion, record)
    if lost:
        complain(f"Warning: no uncertainty of {', '.join(lost)}: {NO_SPREAD}")
    warn_of_unfair(unfair)
    return record, texts


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
    return ColumnSpread(spread_of(found, motion), chosen)


def warn_if_unfair(stds: ColumnSpread | None) -> None:
    """Warn of columns that do not change in proportion to the inputs, after the last row."""
    if stds and stds.unfair:
        warn_of_unfair(stds.unfair, f" from t = {min(stds.unfair.values(), key=abs):g}")


def write_budget(found: Given, motion: Motion, key: str, units: Units, out: Output) -> None:
    """Write the budget of a key.  Raises AbsentError."""
    report, is_fair = budget(found, motion, key, units)
    warn_of_unfair([] if is_fair else [key])
    write_report(out, lambda: report)
