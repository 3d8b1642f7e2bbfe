"""A one-sentence summary of a motion, from the numbers of its record."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from .regime import Facts, Regime

_PATHS = {
    "cusped": "its path has cusps",
    "looping": "its path has loops",
    "wavy": "its path is wavy",
}
_MOST_DIGITS = 17


def summary(record: Mapping[str, Any], facts: Facts, named: Callable[[str], str] = str) -> str:
    """Return the summary of a whole record of a motion with these facts.

    `named` gives the names of units of a system.  Raises TypeError if a number is missing.
    """
    unit = "rad" if "theta_min_rad" in record else "deg"
    time = " time units" if named("time") == "time" else f" {named('time')}"
    rate = " rad per time unit" if named("time") == "time" else f" rad/{named('time')}"
    low, high = (float(record[f"theta_{end}_{unit}"]) for end in ("min", "max"))
    spin = float(record["r0"])
    rotates = f"spins at {_figures(spin)}{rate}" if spin else "does not spin"
    stability = "stable" if facts.stable else "unstable"
    still = {
        Regime.SLEEPING: f"stays upright, which is {stability}, and the top {rotates}",
        Regime.HANGING: f"hangs straight down and the top {rotates}",
        Regime.SEPARATRIX: "rises to the vertical in infinite time; its tilt is at most "
        f"{_figures(high)} {unit}",
    }
    if facts.regime in still:
        return f"The axis {still[facts.regime]}."
    turns = float(record["mean_precession_rate"])
    if low == high:
        moves = f"precesses at {_figures(turns)}{rate}" if turns else "does not precess"
        return f"The axis keeps a tilt of {_figures(low)} {unit} and {moves}."
    least, most = _apart(low, high)
    ends = f"between {least} and {most} {unit}"
    period = f"every {_figures(float(record['T_nutation']))}{time}"
    if facts.plane:
        moves = "turns over" if facts.upper_root == 1 else f"swings {ends}"
        return f"The axis {moves} in a vertical plane {period}."
    swing = f"The axis nutates {ends} {period}"
    if not turns:
        return f"{swing} and does not precess on average."
    path = f"; {_PATHS[record['path']]}" if record["path"] in _PATHS else ""
    return f"{swing} and precesses at {_figures(turns)}{rate} on average{path}."


def _figures(x: float, digits: int = 4) -> str:
    return f"{x:#.{digits}g}".removesuffix(".")


def _apart(low: float, high: float) -> tuple[str, str]:
    """Return two different numbers with four digits, or with as many as distinguish them."""
    texts = ((_figures(low, n), _figures(high, n)) for n in range(4, _MOST_DIGITS + 1))
    return next((a, b) for a, b in texts if a != b)
