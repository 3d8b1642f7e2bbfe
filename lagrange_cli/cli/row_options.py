"""Options of the commands that make many rows: ranges and lists of numbers, and processes."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

import click

from .options import Parsed, exclude

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.tables import TableOfFunctions

F = TypeVar("F", bound=Callable[..., Any])


def _parse_range(text: str) -> Points:
    from ..inputs.ranges import parse_range

    return parse_range(text)


RANGE = Parsed("range", _parse_range)


def listed(name: str, single: tuple[Fraction, ...], grid: Points | None) -> Points | None:
    """Return the numbers of --NAME or of --NAME-range, if any.  Raises LagtopError for both."""
    from ..arithmetic.points import ListedPoints

    exclude({f"--{name}": single or None, f"--{name}-range": grid})
    return grid or (ListedPoints(list(single)) if single else None)


def write_functions(table: TableOfFunctions, digits: int | None, fmt: str, output: str) -> None:
    """Write a table of functions, with its progress."""
    from ..output.write import write_table
    from .progress import with_progress

    header, blocks = table.rows(digits)
    long = table.long[digits is not None]
    write_table(header, with_progress(blocks, table.count, long), fmt, output)


def _parse_jobs(text: str) -> int:
    from ..sweeps.jobs import parse_jobs

    return parse_jobs(text)


def jobs_option(command: F) -> F:
    """Add the option --jobs."""
    return click.option(
        "--jobs",
        type=Parsed("N|auto", _parse_jobs),
        metavar="N|auto",
        help="Processes that share the work; auto: one per core.  [default: 1]",
    )(command)
