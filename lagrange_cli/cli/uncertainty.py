"""Uncertain inputs of `lagtop solve`: values with uncertainties, and the budget of a key."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from ..account.spread import ColumnSpread, Uncertainty
from ..account.uncertain import NO_SPREAD, spread_of, uncertain_record
from ..errors import LagtopError
from ..solver.solve import Motion
from ..top.given import Given
from .app import complain

_ROUNDING = 1e-13
"""Largest error of a number of a sweep over its size."""


def check(found: Given, **options: object) -> None:
    """Raise LagtopError if no input is uncertain, or for options that exclude uncertainties."""
    if not found.stds:
        raise LagtopError("no input is uncertain: give one as in --m '1587(2)'")
    for name, value in options.items():
        if value:
            raise LagtopError(f"use --{name} or uncertain inputs, not both")


def with_stds(
    found: Given, motion: Motion, record: Mapping[str, Any], samples: int | None = None
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return a record with the keys KEY_std, and the values as `value(uncertainty)` for people.

    They are the spread of neighbouring motions or, with `samples`, of random tops.  A warning
    names the numbers that have none, and those with a doubtful one.
    """
    drawn = _of_random_tops(found, motion, [*record], samples) if samples else None
    uncertainty = drawn.get if drawn is not None else spread_of(found, motion).number
    record, texts, lost, nonlinear = uncertain_record(motion, record, uncertainty)
    if lost:
        why = "all random tops lack it" if samples else NO_SPREAD
        complain(f"Warning: no uncertainty of {', '.join(lost)}: {why}")
    warn_of_nonlinear(nonlinear, "use --samples 10000")
    return record, texts


def _of_random_tops(
    found: Given, motion: Motion, keys: Sequence[str], samples: int
) -> dict[str, Uncertainty]:
    """Return the standard deviations of the numbers of random tops with normal inputs.

    A warning says how many tops lack a number.
    """
    import numpy as np  # start-up

    from ..sweeps.records import TEXTS, sweep

    rng, numbers = np.random.default_rng(0), [key for key in keys if key not in TEXTS]
    given: dict[str, Any] = {
        x: y if isinstance(y, str) else float(y) for x, y in motion.top.given.items()
    }
    given |= {x: given[x] + std * rng.standard_normal(samples) for x, std in found.stds.items()}
    radians = any(key.endswith("_rad") for key in keys)
    results = sweep(keys=[*numbers, "error"], radians=radians, **given)
    possible = np.array([error is None for error in results["error"]])
    there = {x: y[possible & np.isfinite(y)] for x, y in results.items() if x in numbers}
    tops = int(possible.sum())
    few = [f"{tops - y.size} lack {x}" for x, y in there.items() if 0 < y.size < tops]
    if lost := [f"{samples - tops} are impossible"] * (tops < samples) + few:
        complain(f"Warning: of {samples} random tops {', '.join(lost)}")
    found_stds = {x: (float(y.std()), float(np.abs(y).max())) for x, y in there.items() if y.size}
    return {
        x: Uncertainty(std if std > _ROUNDING * size else 0.0, {}, linear=True)
        for x, (std, size) in found_stds.items()
    }


def warn_of_nonlinear(names: Collection[str], remedy: str, ending: str = "") -> None:
    """Warn of results that do not change in proportion to the inputs."""
    if names:
        complain(
            f"Warning: uncertainties of {', '.join(names)} are rough{ending}: motions two standard "
            f"deviations away are not spread twice as far as those at one; {remedy}"
        )


def column_stds(found: Given, motion: Motion, names: Sequence[str]) -> ColumnSpread | None:
    """Return the uncertainties of columns but the time as a function of times, if there are any."""
    if not found.stds:
        return None
    from ..solver.columns import chosen_columns

    chosen = [name for name in chosen_columns(names) if name != "t"]
    return ColumnSpread(spread_of(found, motion), chosen)


def warn_if_nonlinear(stds: ColumnSpread | None) -> None:
    """Warn of columns that do not change in proportion to the inputs, after the last row."""
    if stds and stds.nonlinear:
        since = f" from t = {min(stds.nonlinear.values(), key=abs):g}"
        warn_of_nonlinear(stds.nonlinear, "draw random tops in Python", since)
