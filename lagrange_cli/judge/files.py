"""Trajectories in files, judged one after the other, a block of rows at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from ..errors import DataError, LagtopError
from ..inputs.files import shown_path, utf8_path
from ..inputs.seen import Conventions, Quantities
from ..inputs.trajectory import Trajectory, open_trajectory
from ..motion.solve import Motion
from .alignment import Alignment
from .compare import settled
from .convergence import Convergence, check_steps
from .judgement import Given, JudgedRun, Judgement, judge

Watch = Callable[[Iterable[Quantities]], Iterable[Quantities]]
"""Passes blocks on, and may show how many rows have passed."""
_OF_THE_FILE = {"t", "angle_rates"}
"""Arguments that a file gives, so that an error about them is one of its data."""


class Request(NamedTuple):
    """What is asked of trajectories in files."""

    columns: Sequence[str] | None = None
    """The names of all columns from the left; None for those that the files give."""
    conventions: Conventions = Conventions()
    align: Alignment = Alignment()
    limit: float | None = None
    steps: Sequence[float] | None = None


class Comparison(NamedTuple):
    """Trajectories that have been judged together."""

    judgements: Sequence[Judgement]
    convergence: Convergence | None


def compare_files(
    motion: Motion, paths: Sequence[str], request: Request, watch: Watch = iter
) -> Comparison:
    """Return the judgements of the trajectories in files, and how they converge.

    Raises LagtopError for a bad request, DataError for a file that cannot be read or is bad.
    """
    if paths.count("-") > 1:
        raise LagtopError("standard input can be read once, got - twice")
    if request.steps is not None:
        check_steps(request.steps, len(paths))
    cases = [_judged(motion, path, request, watch) for path in paths]
    judgements, found = settled(motion, cases, request.limit, request.steps)
    return Comparison(judgements, found)


def _judged(motion: Motion, path: str, request: Request, watch: Watch) -> tuple[JudgedRun, Given]:
    with open_trajectory(path, request.columns) as trajectory:
        said = {key: (found.says, found.unit) for key, found in trajectory.quantities.items()}
        given = Given(watch(_blocks(trajectory)), said, request.conventions, request.align)
        try:
            run = judge(motion, given)
        except DataError:
            raise
        except LagtopError as error:
            if error.key not in {None, *_OF_THE_FILE}:
                raise
            kind = DataError if error.key in _OF_THE_FILE else LagtopError
            raise kind(f"{shown_path(path)}: {error}") from None
    named = replace(run.judgement, file=utf8_path(path))
    return run._replace(judgement=named), given


def _blocks(trajectory: Trajectory) -> Iterator[Quantities]:
    for block, _ in trajectory.blocks():
        yield block
