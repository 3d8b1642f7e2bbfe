"""The old name of `inputs.scenes`, and descriptions of results, until their users go."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from .names import ANGLES
from .scenes import is_scene_file, scene_names, scene_path, scene_remark
from .top import INPUTS, Top
from .units import System

__all__ = ["is_scene_file", "scene_names", "scene_path", "scene_remark"]

Description = Mapping[str, str]


def describe(
    version: str,
    scene: Mapping[str, str],
    system: System | None,
    *,
    radians: bool,
    is_whole: bool = True,
) -> Description:
    """Return the description of results for one top, or for tops that share some inputs."""
    inputs = ", ".join(f"{x} = {scene[x]}" for x in INPUTS if x in scene)
    frames = (
        f"{ANGLES[0]} is the tilt, {ANGLES[1]} the spin and {ANGLES[2]} the precession; "
        "a quaternion is w, x, y, z and turns the body to space; rates are in radians per unit of "
        "time"
    )
    return {
        "lagtop": version,
        "scene" if is_whole else "shared inputs": inputs,
        "units": f"{system.mass}, {system.length}, s" if system else "those of the scene",
        "conventions": f"angles are in {'radians' if radians else 'degrees'}; {frames}",
    }


def description_in(comments: Iterable[str]) -> Description:
    """Return nothing: files are not described any more."""
    return {}


def scene_in(description: Description, name: str) -> Top | None:
    """Return None: files are not described any more."""


def difference(found: Top, wanted: Top) -> str:
    """Return an empty text: files are not described any more."""
    return ""
