"""The summary of a motion in one sentence, from the numbers of its record."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

from ..solver.facts import Facts

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


def summary(record: Mapping[str, Any], facts: Facts, named: Callable[[str], str] = str) -> str:
    """Return the summary of a whole record of a motion with these facts.

    `named` gives the names of units of a system.  Raises TypeError if a number is missing.
    """
    angle = "rad" if "theta_min_rad" in record else "deg"
    low, high = (float(record[f"theta_{end}_{angle}"]) for end in ("min", "max"))
    turns = record["mean_precession_rate"]
    true = {
        "regime": facts.regime.value,
        "stable": facts.stable,
        "constant": low == high,
        "turns_over": facts.plane and facts.over_top,
        "plane": facts.plane,
        "spins": bool(facts.spin),
        "precesses": turns is None or float(turns) != 0,
        "path": record["path"],
        "unit": named("time"),
    }
    numbers = {"low": low, "high": high, "spin": record["r0"], "turns": turns}
    numbers["nutation"] = record["T_nutation"]
    ends = [(_figures(low, n), _figures(high, n)) for n in range(4, _MOST_DIGITS + 1)]
    least, most = next(((x, y) for x, y in ends if x != y), ends[0])
    words = {"least": least, "most": most, "angle": angle, "unit": named("time")}

    def part(match: re.Match[str] | str) -> str:
        name = match if isinstance(match, str) else match[1]
        if name in words:
            return words[name]
        if name in numbers:
            return _figures(float(numbers[name]))
        text = next(text for when, text in PHRASES[name] if when.items() <= true.items())
        return re.sub(r"\{(\w+)\}", part, text)

    return part("sentence")


def _figures(x: float, digits: int = 4) -> str:
    return f"{x:#.{digits}g}".removesuffix(".")
