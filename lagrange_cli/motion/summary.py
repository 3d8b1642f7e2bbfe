"""A one-sentence summary of a motion, from the numbers of its record."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from .regime import Regime

_PATHS = {
    "cusped": "its path has cusps",
    "looping": "its path has loops",
    "wavy": "its path is wavy",
}
_MOST_DIGITS = 17


def summary(record: Mapping[str, Any], named: Callable[[str], str] = str) -> str:
    """Return the summary of a whole record; `named` gives the names of units of a system."""
    unit = "rad" if "theta_min_rad" in record else "deg"
    time = " time units" if named("time") == "time" else f" {named('time')}"
    rate = " rad per time unit" if named("time") == "time" else f" rad/{named('time')}"
    low, high = (float(record[f"theta_{end}_{unit}"]) for end in ("min", "max"))
    spin, turns = record["r0"], record["mean_precession_rate"]
    rotates = f"spins at {_figures(float(spin))}{rate}" if float(spin) else "does not spin"
    still = {
        Regime.SLEEPING: f"stays upright, which is {_stability(record)}, and the top {rotates}",
        Regime.HANGING: f"hangs straight down and the top {rotates}",
        Regime.SEPARATRIX: "rises to the vertical in infinite time; its tilt is at most "
        f"{_figures(high)} {unit}",
    }
    if (regime := Regime(record["regime"])) in still:
        return f"The axis {still[regime]}."
    if low == high:
        moves = f"precesses at {_figures(float(turns))}{rate}" if turns else "does not precess"
        return f"The axis keeps a tilt of {_figures(low)} {unit} and {moves}."
    least, most = _apart(low, high)
    period = f"every {_figures(float(record['T_nutation']))}{time}"
    swing = f"The axis nutates between {least} and {most} {unit} {period}"
    if regime == Regime.NO_SPIN and record["path"] is None:
        return swing.replace("nutates", "swings in a vertical plane") + "."
    if not turns:
        return f"{swing} and does not precess on average."
    path = f"; {_PATHS[record['path']]}" if record["path"] in _PATHS else ""
    mean = _figures(float(turns))
    return f"{swing} and precesses at {mean}{rate} on average{path}."


def _stability(record: Mapping[str, Any]) -> str:
    return "unstable" if "unstable" in (record["remark"] or "") else "stable"


def _figures(x: float, digits: int = 4) -> str:
    return f"{x:#.{digits}g}".removesuffix(".")


def _apart(low: float, high: float) -> tuple[str, str]:
    """Return two numbers with four digits, or with as many as distinguish them."""
    texts = ((_figures(low, n), _figures(high, n)) for n in range(4, _MOST_DIGITS + 1))
    return next(((a, b) for a, b in texts if a != b), (_figures(low), _figures(high)))
