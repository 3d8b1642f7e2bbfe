"""Options of the commands that make or read many rows: ranges, processes, meanings of columns."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from .options import NAMES, F, Parsed, exclude, late

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.tables import TableOfFunctions

RANGE = Parsed("range", late("inputs.ranges", "parse_range"))


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
    write_table(header, with_progress(blocks, "rows", table.count, len), fmt, output)


def jobs_option(command: F) -> F:
    """Add the option --jobs."""
    return click.option(
        "--jobs",
        type=Parsed("N|auto", late("sweeps.jobs", "parse_jobs")),
        metavar="N|auto",
        help="Processes that share the work; auto: one per core.  [default: 1]",
    )(command)


def reading_options(quaternion: str | None) -> Callable[[F], F]:
    """Add the options for the columns of a trajectory.

    None is the order that the first row proves.
    """
    order = quaternion or "what the first row proves"

    def decorate(command: F) -> F:
        command = click.option(
            "--euler-sequence",
            type=Parsed("sequence", late("inputs.seen", "euler_sequence")),
            default="xyz",
            show_default=True,
            metavar="SEQUENCE",
            help="Axes of `euler`, as scipy writes them: xyz about those of space, XYZ of the "
            "body.",
        )(command)
        command = click.option(
            "--quaternion-order",
            type=click.Choice(["wxyz", "xyzw"]),
            default=quaternion,
            help=f"Order of a quaternion whose names do not tell.  [default: {order}]",
        )(command)
        return click.option(
            "--columns",
            type=NAMES,
            help="Names of all columns from the left, whatever the file says; quaternion, matrix, "
            "axis and the like stand for all of their parts, and _ leaves a column out.",
        )(command)

    return decorate
