"""The summary of a motion in one sentence."""

from __future__ import annotations

import re
from typing import Any

from ..solver.solve import Motion
from ..top.units import DEGREES, Units

_ENDS = "between {least} and {most} {angle}"

PHRASES: dict[str, list[tuple[dict[str, Any], str]]] = {
    "sentence": [
        (
            {"regime": "sleeping"},
            "The axis stays upright, and this is {stability}. The top {rotates}.",
        ),
        ({"regime": "hanging"}, "The axis hangs straight down. The top {rotates}."),
        (
            {"regime": "separatrix"},
            "The axis rises to the vertical in infinite time; its tilt is at most {high} {angle}.",
        ),
        ({"constant": True}, "The axis keeps a tilt of {low} {angle} and {moves}."),
        ({"turns_over": True}, "The axis turns over in a vertical plane {period}."),
        ({"plane": True}, f"The axis swings {_ENDS} in a vertical plane {{period}}."),
        ({}, f"The axis nutates {_ENDS} {{period}} and {{moves}} on average{{path}}."),
    ],
    "stability": [({"stable": True}, "stable"), ({}, "unstable")],
    "rotates": [({"spins": True}, "spins at {spin}{rate}"), ({}, "does not spin")],
    "moves": [({"precesses": True}, "precesses at {turns}{rate}"), ({}, "does not precess")],
    "period": [({}, "every {nutation}{time}")],
    "path": [
        ({"precesses": False}, ""),
        ({"path": "cusped"}, "; its path has cusps"),
        ({"path": "looping"}, "; its path has loops"),
        ({"path": "wavy"}, "; its path is wavy"),
        ({}, ""),
    ],
    "time": [({"unit": "time"}, " time units"), ({}, " {unit}")],
    "rate": [({"unit": "time"}, " rad per time unit"), ({}, " rad/{unit}")],
}
"""The sentence and its parts, by name.

The first text whose facts are all true is chosen.  Names in braces are other parts or values.  The
browser page receives this table and fills it in the same way.
"""

_MOST_DIGITS = 17
"""Digits that distinguish the ends of a nutation, at most; four are enough for most tops."""


def summary(motion: Motion, units: Units = DEGREES) -> str:
    """Return the summary of a motion, its numbers from doubles.

    Raises OutOfRangeError for a number that no double holds.
    """
    facts = motion.facts

    def number(key: str) -> Any:
        found = motion.number(units.key(key))
        return found and found.value

    low, high = number("theta_min_deg"), number("theta_max_deg")
    true = {
        "regime": facts.regime.value,
        "stable": facts.stable,
        "constant": low == high,
        "turns_over": facts.plane and facts.over_top,
        "plane": facts.plane,
        "spins": bool(facts.spin),
        "precesses": number("mean_precession_rate") != 0,
        "path": motion.path,
        "unit": units.named("time"),
    }
    keys = {"low": "theta_min_deg", "high": "theta_max_deg", "spin": "r0"}
    keys |= {"turns": "mean_precession_rate", "nutation": "T_nutation"}
    ends = [(_figures(low, n), _figures(high, n)) for n in range(4, _MOST_DIGITS + 1)]
    least, most = next(((x, y) for x, y in ends if x != y), ends[0])
    words = {"least": least, "most": most, "angle": units.angle, "unit": units.named("time")}

    def part(match: re.Match[str] | str) -> str:
        name = match if isinstance(match, str) else match[1]
        if name in words:
            return words[name]
        if name in keys:
            return _figures(number(keys[name]))
        text = next(text for when, text in PHRASES[name] if when.items() <= true.items())
        return re.sub(r"\{(\w+)\}", part, text)

    return part("sentence")


def _figures(x: float, digits: int = 4) -> str:
    return f"{x:#.{digits}g}".removesuffix(".")
