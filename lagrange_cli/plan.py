"""What a sweep is to do: from a scene, from ranges of inputs, and from a file of tops."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from .grid import Axis, Grid
from .parts import Block, Sweep
from .rowfile import open_rows
from .sweep import BLOCK_ROWS, check_keys, record_keys
from .top import LagtopError, Top, build_top


class Plan(NamedTuple):
    """A sweep, and the blocks it is made of."""

    sweep: Sweep
    blocks: Iterator[Block]
    size: int
    """How many tops there are; 0 where only the end of the file can tell."""


def plan(
    files: Sequence[str],
    axes: Mapping[str, Axis],
    *,
    keys: Sequence[str] | None = None,
    radians: bool = False,
    style: str = "csv",
) -> Plan:
    """The plan for a scene (a `.toml` file) and a grid, or for a scene and a file of tops.

    Inputs go by option (`theta0` in the unit that `radians` says); the last axis is the fastest.
    Raises LagtopError.
    """
    scenes = [file for file in files if file.endswith(".toml")]
    tables = [file for file in files if file not in scenes]
    if len(scenes) > 1 or len(tables) > 1:
        raise LagtopError(f"a sweep has one scene and one file of tops, got {' '.join(files)}")
    unit = "theta0_rad" if radians else "theta0_deg"
    axes = {unit if name == "theta0" else name: axis for name, axis in axes.items()}
    given = scene_inputs(scenes[0] if scenes else None, axes)
    known = record_keys(radians=radians)
    chosen = list(check_keys(known if keys is None else keys, radians=radians))
    if not tables:
        grid = Grid(axes)
        grid.check()
        _check_shared(given, axes)
        sweep = Sweep(grid, given, chosen, radians, style)
        return Plan(sweep, enumerate(grid.blocks(BLOCK_ROWS)), grid.size)
    for name, axis in axes.items():
        if axis.size > 1:
            raise LagtopError(f"a range of {name} and a file of tops exclude each other")
        given[name] = axis.values([0]).item()
    source, lines = open_rows(tables[0], {*known, *record_keys(radians=not radians)}, BLOCK_ROWS)
    _check_shared(given, given if source.columns is None else source.columns)
    if "error" not in chosen:
        chosen.append("error")
    return Plan(Sweep(source, given, chosen, radians, style), enumerate(lines), 0)


def scene_inputs(scene: str | None, overridden: Mapping[str, object]) -> dict[str, float]:
    """The inputs of a scene file, and the worked example for what it leaves out."""
    if scene is None:
        top = Top()
    else:
        from .scene import SceneFile

        file = SceneFile(scene)
        try:
            top = build_top(file.inputs)
        except LagtopError as error:
            raise file.error(error) from None
    inputs = {name: float(x) for name, x in top._asdict().items() if x is not None}
    tilt_given = any(name.startswith("theta0_") for name in overridden)
    return {name: x for name, x in inputs.items() if not (tilt_given and name.startswith("theta0"))}


def _check_shared(
    given: Mapping[str, float], varying: Sequence[str] | Mapping[str, object]
) -> None:
    """Raise LagtopError for an input that no top could have."""
    shared = {name: x for name, x in given.items() if name not in varying}
    if {"A", "C"} & set(varying):
        shared = {name: x for name, x in shared.items() if name not in ("A", "C")}
    Top(**shared)
