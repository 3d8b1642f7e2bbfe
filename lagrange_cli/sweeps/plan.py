"""What a sweep is to do: from a scene, from ranges of inputs, and from a file of tops."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from hashlib import file_digest
from io import BufferedIOBase
from typing import Any, NamedTuple, cast

from .. import __version__
from ..arithmetic.points import Points
from ..errors import LagtopError
from ..inputs.files import reading, shown_path, temporary_copy
from ..inputs.given import Given, checked_double, gather
from ..inputs.input_keys import overridden
from ..inputs.ranges import Product
from ..inputs.text_tables import NumberedLines
from ..inputs.top import INPUTS
from ..inputs.tops_file import open_tops
from ..inputs.value import Value, as_value
from .parts import NumberedBlock, Sweep
from .records import BLOCK_ROWS, check_keys, record_keys


class Plan(NamedTuple):
    """A sweep, and the blocks it is made of."""

    sweep: Sweep
    blocks: Iterator[NumberedBlock]
    size: int
    """The number of tops; 0 where only the end of the file can tell."""
    description: Mapping[str, Any]
    """What decides about the bytes of the parts, for the folder they are written to."""
    given: Given
    """What all tops share, and what of it nobody gave."""
    file: str | None = None
    """The file of tops, if there is one."""


def plan(
    files: Sequence[str],
    axes: Mapping[str, Value | Points],
    *,
    keys: Sequence[str] | None = None,
    radians: bool = False,
    system: str | None = None,
    fmt: str = "csv",
    until_error: bool = False,
    described: bool = False,
) -> Plan:
    """Return the plan for a scene (a `.toml` file) and a grid, or for a scene and a file of tops.

    The last axis varies fastest.  Where the plan is to be `described`, the file is read twice, for
    its digest, and standard input is kept on disk meanwhile.  Raises LagtopError.
    """
    scenes = [file for file in files if file.endswith(".toml")]
    tables = [file for file in files if file not in scenes]
    if len(scenes) > 1 or len(tables) > 1:
        raise LagtopError(f"a sweep has one scene and one file of tops, got {' '.join(files)}")
    scene = scenes[0] if scenes else None
    chosen = list(
        check_keys(record_keys(radians=radians) if keys is None else keys, radians=radians)
    )
    wanted = Sweep((), {}, chosen, radians, fmt, until_error)
    if not tables:
        return _of_grid(wanted, axes, scene, system)
    if ranges := ranges_of({name: as_value(x).number for name, x in axes.items()}):
        raise LagtopError(f"a range of {min(ranges)} and a file of tops exclude each other")
    return _of_file(wanted, tables[0], axes, scene, system, described=described)


def _of_grid(
    wanted: Sweep, axes: Mapping[str, Value | Points], scene: str | None, system: str | None
) -> Plan:
    """Return the plan for all tops of a grid."""
    found = gather(axes, scene, system=system)
    points = {name: x for name, x in found.inputs.items() if isinstance(x, Points)}
    grid = Product(points)
    grid.check()
    ranges = ranges_of(points)
    shared = shared_inputs(found, varying=ranges)
    sweep = _with_inputs(wanted, found, shared, found.stds)
    inputs = shared | {name: str(axis) for name, axis in ranges.items()}
    told = _told_of(sweep, inputs, file=None, parts=-(-grid.size // BLOCK_ROWS))
    return Plan(sweep, enumerate(grid.blocks(BLOCK_ROWS)), grid.size, told, found)


def _of_file(
    wanted: Sweep,
    path: str,
    axes: Mapping[str, Value | Points],
    scene: str | None,
    system: str | None,
    *,
    described: bool,
) -> Plan:
    """Return the plan for the tops of a file; a column tells the errors of its rows."""
    stream, digest = _digested(path) if described else (None, "")
    computed = {*record_keys(), *record_keys(radians=True), *wanted.keys}
    file, lines = open_tops(path, computed, BLOCK_ROWS, stream)
    found, source = file.among(axes, scene, system)
    shared = shared_inputs(found, varying=INPUTS if source.columns is None else source.columns)
    stds = {name: std for name, std in found.stds.items() if name not in file.named}
    wanted = wanted._replace(keys=list(dict.fromkeys([*wanted.keys, "error"])))
    sweep = _with_inputs(wanted, found, shared, stds, source.carried)
    told = _told_of(sweep, shared, file=digest, parts=None)
    blocks = (block._replace(file=source) for block in lines)
    return Plan(sweep, enumerate(blocks), 0, told, found, path)


def _with_inputs(
    wanted: Sweep,
    found: Given,
    shared: Mapping[str, float],
    stds: Mapping[str, float],
    carried: Sequence[str] = (),
) -> Sweep:
    """Return a sweep with the inputs that all tops share, and the columns it carries through."""
    sweep = wanted._replace(shared=shared, stds=tuple(stds.items()), system=found.system)
    return sweep._replace(header=[*carried, *sweep.computed_keys])


def _told_of(
    sweep: Sweep, inputs: Mapping[str, Any], *, file: str | None, parts: int | None
) -> dict[str, Any]:
    """Return what decides about the bytes of the parts; some of it only where it is there."""
    told: dict[str, Any] = {"lagtop": __version__, "format": sweep.fmt, "radians": sweep.radians}
    told |= {"keys": sweep.keys, "inputs": inputs, "file": file, "parts": parts}
    told |= {"uncertainties": dict(sweep.stds)} if sweep.stds else {}
    return told | ({"units": [sweep.system.mass, sweep.system.length]} if sweep.system else {})


def ranges_of(axes: Mapping[str, Points]) -> dict[str, Points]:
    """Return the axes that have more than one value."""
    return {name: axis for name, axis in axes.items() if axis.count > 1}


def shared_inputs(found: Given, *, varying: Collection[str] = ()) -> dict[str, float]:
    """Return inputs by key as doubles: those given, over those of the worked example.

    Raises LagtopError for one that no top could have; the `varying` ones are not looked at.
    """
    loose = set(varying)
    if loose & {"A", "A_cm", "C"} or ("A_cm" in found.inputs and loose & {"m", "s"}):
        loose |= {"A", "A_cm", "C"}  # C <= 2A
    numbers = {
        name: x.bounds()[0] if isinstance(x, Points) else x for name, x in found.inputs.items()
    }
    top = found.replace(inputs=numbers).top(without=loose)
    inputs = {name: float(x) for name, x in top.as_dict().items() if x is not None}
    return overridden(inputs, {name: checked_double(name, x) for name, x in numbers.items()})


def _digested(path: str) -> tuple[BufferedIOBase | None, str]:
    """Return the digest of a file, and a copy of it on disk if it can be read only once."""
    with reading(path) as file:
        if file.seekable():
            next(iter(NumberedLines(file, shown_path(path))), None)  # /dev/zero has no digest
            return None, _digest(file)
        with temporary_copy(file) as copy:
            return os.fdopen(os.dup(copy.fileno()), "rb"), _digest(cast(BufferedIOBase, copy))


def _digest(stream: BufferedIOBase) -> str:
    stream.seek(0)
    digest = file_digest(stream, "sha256").hexdigest()
    stream.seek(0)
    return f"sha256:{digest}"
