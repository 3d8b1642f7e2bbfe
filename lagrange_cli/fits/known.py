"""The inputs that a fit takes for known: nothing is taken from the worked example."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..errors import LagtopError
from ..inputs.measured import moment
from ..inputs.names import check_names
from ..inputs.top import Top

_INSTEAD = ("A_cm", "phidot0")
_NOT_ZERO = ("s", "g", "r0")
"""Inputs that stand in a product, of which nothing else could be told."""


def known_inputs(given: Mapping[str, Any]) -> dict[str, float]:
    """Return inputs that are known, by key of `Top`, with A for A_cm and theta0 in radians.

    Raises LagtopError for one that no top has, that a fit cannot use, or that needs others.
    """
    check_names("known", [*given] or ["m"], [*Top.fields, *_INSTEAD])
    known = {name: float(x) for name, x in given.items()}
    if "phidot0" in known:
        raise LagtopError("phidot0 is no input of a fit: give r0", "phidot0")
    if "A_cm" in known and not {"m", "s"} <= known.keys():
        raise LagtopError("A_cm must be given with m and s, as A = A_cm + m s^2", "A_cm")
    for name in _NOT_ZERO:
        if known.get(name) == 0:
            raise LagtopError(f"{name} must not be 0 in a fit: leave it out", name)
    _guard(known)
    if "A_cm" in known:
        known["A"] = float(moment(known))
        del known["A_cm"]
    for key, unit in (("theta0_deg", math.pi / 180), ("theta0_rad", 1.0)):
        if key in known:
            known["theta0"] = known.pop(key) * unit
    return known


def _guard(known: Mapping[str, float]) -> None:
    """Raise LagtopError for inputs that no top has."""
    moment = known.get("A", known.get("A_cm", known.get("C", 1.0)))
    others = {"m": 1.0, "s": 1.0, "g": 1.0, "C": moment}
    others |= {} if "A_cm" in known else {"A": moment}
    Top(**others | dict(known))
