"""Options of the commands that read attitudes: what the columns of a file mean."""

from __future__ import annotations

from collections.abc import Callable

import click

from .options import NAMES, F, Parsed


def _parse_sequence(text: str) -> str:
    from ..inputs.seen import euler_sequence

    return euler_sequence(text)


def reading_options(quaternion: str | None) -> Callable[[F], F]:
    """Add --columns, --quaternion and --euler, with the order of a quaternion unless it is told.

    None is the order that the first row proves.
    """
    order = quaternion or "what the first row proves"

    def decorate(command: F) -> F:
        command = click.option(
            "--euler",
            type=Parsed("sequence", _parse_sequence),
            default="xyz",
            show_default=True,
            metavar="SEQUENCE",
            help="Axes of `euler`, as scipy writes them: xyz about those of space, XYZ of the "
            "body.",
        )(command)
        command = click.option(
            "--quaternion",
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
