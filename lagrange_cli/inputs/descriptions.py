"""Descriptions in files: the scene, the version, the units and the conventions of their numbers.

A description is stored in the metadata of a Parquet schema, or in comments above a text table.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import parse_number
from ..errors import DataError, LagtopError
from .names import ANGLES
from .top import INPUTS, Top
from .value import STEADY_WORDS

if TYPE_CHECKING:
    from .units import System

Description = Mapping[str, str]
"""Texts by the keys `lagtop`, `scene`, `units` and `conventions`; may be empty."""
_KEYS = ("lagtop", "scene", "shared inputs", "units", "conventions")
_FRAMES = (
    f"{ANGLES[0]} is the tilt, {ANGLES[1]} the spin and {ANGLES[2]} the precession; "
    "a quaternion is w, x, y, z and turns the body to space; rates are in radians per unit of time"
)


def describe(
    version: str,
    scene: Mapping[str, str],
    system: System | None,
    *,
    radians: bool,
    is_whole: bool = True,
) -> Description:
    """Return the description of results for one top, or for tops that share some inputs."""
    angles = "radians" if radians else "degrees"
    return {
        "lagtop": version,
        "scene" if is_whole else "shared inputs": ", ".join(
            f"{x} = {scene[x]}" for x in INPUTS if x in scene
        ),
        "units": f"{system.mass}, {system.length}, s" if system else "those of the scene",
        "conventions": f"angles are in {angles}; {_FRAMES}",
    }


def description_in(comments: Iterable[str]) -> Description:
    """Return the description in comments, which may be empty."""
    pairs = (re.fullmatch(r"([a-z ]+): (.*)", x.strip()) for x in comments)
    found = {x[1]: x[2] for x in pairs if x and x[1] in _KEYS}
    return found if "lagtop" in found else {}


def scene_in(description: Description, name: str) -> Top | None:
    """Return the top that a file describes, if any.  Raises DataError for an impossible top."""
    if "scene" not in description:
        return None
    pairs = dict(x.split(" = ", 1) for x in description["scene"].split(", ") if " = " in x)
    try:
        if not pairs or not pairs.keys() <= {*INPUTS}:
            raise LagtopError("it must have inputs by key")
        inputs: dict[str, Any] = {
            key: text if text in STEADY_WORDS else float(parse_number(text))
            for key, text in pairs.items()
        }
        return Top(**inputs)
    except LagtopError as error:
        raise DataError(f"{name}: the scene in its description is invalid: {error}") from None


def difference(found: Top, wanted: Top) -> str:
    """Return the inputs that differ, as in `r0 = -50.0, not 50.0`; empty if the tops are equal."""
    other = wanted.inputs()
    return "; ".join(
        f"{key} = {float(x)}, not {float(other[key])}"
        for key, x in found.inputs().items()
        if not math.isclose(x, other[key], rel_tol=1e-12)
    )
