"""What a sweep is to do: from a scene, from ranges of inputs, and from a file of tops."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from ..arithmetic.generic import Number
from ..arithmetic.points import Points
from ..errors import LagtopError
from ..inputs.ranges import Product
from ..inputs.top import Top, build_top, overridden
from ..inputs.tops_file import open_rows
from .parts import Block, Sweep
from .records import BLOCK_ROWS, check_keys, record_keys


class Plan(NamedTuple):
    """A sweep, and the blocks it is made of."""

    sweep: Sweep
    blocks: Iterator[Block]
    size: int
    """How many tops there are; 0 where only the end of the file can tell."""


def plan(
    files: Sequence[str],
    axes: Mapping[str, Points],
    *,
    keys: Sequence[str] | None = None,
    radians: bool = False,
    style: str = "csv",
) -> Plan:
    """The plan for a scene (a `.toml` file) and a grid, or for a scene and a file of tops.

    The last axis is the fastest.  Raises LagtopError.
    """
    scenes = [file for file in files if file.endswith(".toml")]
    tables = [file for file in files if file not in scenes]
    if len(scenes) > 1 or len(tables) > 1:
        raise LagtopError(f"a sweep has one scene and one file of tops, got {' '.join(files)}")
    first = {name: axis.bounds()[0] for name, axis in axes.items()}
    given = shared_inputs(scenes[0] if scenes else None, first)
    known = record_keys(radians=radians)
    chosen = list(check_keys(known if keys is None else keys, radians=radians))
    if not tables:
        grid = Product(axes)
        grid.check()
        _check_shared(given, [name for name, axis in axes.items() if axis.count > 1])
        sweep = Sweep(grid, given, chosen, radians, style)
        return Plan(sweep, enumerate(grid.blocks(BLOCK_ROWS)), grid.size)
    if ranges := [name for name, axis in axes.items() if axis.count > 1]:
        raise LagtopError(f"a range of {ranges[0]} and a file of tops exclude each other")
    source, lines = open_rows(tables[0], {*known, *record_keys(radians=not radians)}, BLOCK_ROWS)
    _check_shared(given, given if source.columns is None else source.columns)
    if "error" not in chosen:
        chosen.append("error")
    return Plan(Sweep(source, given, chosen, radians, style), enumerate(lines), 0)


def shared_inputs(scene: str | None, given: Mapping[str, Number]) -> dict[str, float]:
    """Inputs by key: those given, over those of a scene file, over the worked example."""
    top = Top()
    if scene is not None:
        from ..inputs.scene_file import SceneFile

        file = SceneFile(scene)
        try:
            top = build_top(file.inputs)
        except LagtopError as error:
            raise file.error(error) from None
    inputs = {name: float(x) for name, x in top._asdict().items() if x is not None}
    return overridden(inputs, {name: float(x) for name, x in given.items()})


def _check_shared(
    given: Mapping[str, float], varying: Sequence[str] | Mapping[str, object]
) -> None:
    """Raise LagtopError for an input that no top could have."""
    shared = {name: x for name, x in given.items() if name not in varying}
    if {"A", "C"} & set(varying):
        shared = {name: x for name, x in shared.items() if name not in ("A", "C")}
    Top(**shared)
