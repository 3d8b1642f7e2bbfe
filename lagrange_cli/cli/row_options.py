"""Options of the commands that make or read many rows: ranges, processes, meanings of columns."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING

import click

from ..arithmetic.text import quoted
from ..errors import LagtopError
from .options import NAMES, F, Parsed, exclude, late

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.tables import TableOfFunctions
    from ..inputs.text_lines import Dialect

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


_DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "blank": " "}
_DECIMALS = {"point": ".", "comma": ","}
_MEANINGS = {"delimiter": "delimiter of cells", "decimal": "decimal mark"}


def _mark(marks: dict[str, str]) -> Callable[[str], str]:
    """Return a parser of the name of a mark, or of the mark itself."""

    def parse(text: str) -> str:
        if text not in {*marks, *marks.values()}:
            raise LagtopError(f"must be {', '.join(marks)} or the character, got {quoted(text)}")
        return marks.get(text, text)

    return parse


def text_options(command: F) -> F:
    """Add --delimiter and --decimal, of which `dialect` makes one."""
    for name, marks in (("decimal", _DECIMALS), ("delimiter", _DELIMITERS)):
        command = click.option(
            f"--{name}",
            type=Parsed("mark", _mark(marks)),
            expose_value=False,
            callback=_keep,
            metavar="|".join(marks),
            help=f"The {_MEANINGS[name]} of text files.  [default: found in each file]",
        )(command)
    return command


def header_comments_option(command: F) -> F:
    """Add --header-comments, which `is_described` looks up."""
    return click.option(
        "--header-comments",
        is_flag=True,
        expose_value=False,
        callback=_keep,
        help="Describe scene, version, units and conventions above the CSV, in # lines.",
    )(command)


def is_described(fmt: str) -> bool:
    """Return whether the output has a description: Parquet always, CSV with --header-comments.

    Raises LagtopError for --header-comments with a format that has no place for it.
    """
    asked = bool(click.get_current_context().meta["lagtop.header_comments"])
    if asked and fmt not in {"csv", "parquet"}:
        raise LagtopError(f"--header-comments describes CSV and Parquet, got --format {fmt}")
    return asked or fmt == "parquet"


def _keep(ctx: click.Context, param: click.Parameter, mark: str | bool | None) -> None:
    ctx.meta[f"lagtop.{param.name}"] = mark or ""


def dialect() -> Dialect:
    """Return how the command reads text files.  Raises LagtopError for a comma in both places."""
    from ..inputs.text_lines import Dialect

    meta = click.get_current_context().meta
    asked = Dialect(meta["lagtop.delimiter"], meta["lagtop.decimal"])
    if asked.delimiter == asked.decimal == ",":
        raise LagtopError("--delimiter comma and --decimal comma exclude each other: leave one out")
    return asked


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
