"""The command `lagtop view`: a page for the browser, in which a top can be turned and changed."""

from __future__ import annotations

import sys
from fractions import Fraction
from pathlib import PurePath

import click

from ..errors import LagtopError
from ..output.terminal import is_terminal
from .command import ExamplesFirst
from .options import FILE
from .top_options import inputs_of, motion_of, say_unused, scene_options


@click.command(
    "view",
    cls=ExamplesFirst,
    examples="""
        lagtop view -o top.html
        lagtop view sample_inputs/looping-top.toml -o loops.html --open
        lagtop view --r0 60 --theta0 0 -o sleeping.html
    """,
)
@scene_options
@click.option("--open", "opens", is_flag=True, help="Open the page in the browser.")
@click.option(
    "-o", "--output", type=FILE, metavar="FILE|-", help="FILE.html, replaced when all is written."
)
def command(
    scene: str | None, rad: bool, opens: bool, output: str | None, **options: Fraction | None
) -> None:
    """One page for the browser: the top in space, its angles, its cubic, its record.

    Sliders change every input, and the motion is computed in the page, in closed form, at any time.
    The file needs no network and no other file.
    """
    if not (output or opens):
        raise LagtopError("nothing to do: give -o FILE.html or --open")
    if output == "-" and (opens or is_terminal(sys.stdout)):
        why = "to open" if opens else "for a terminal"
        raise LagtopError(f"a page on standard output is not {why}: give -o FILE.html")
    suffix = PurePath(output or "").suffix
    if suffix.lower() not in {"", ".html", ".htm"}:
        raise LagtopError(f"-o must be a file that ends in .html, got {output!r}: a page is HTML")
    from ..plot.browser import open_page, view

    found = inputs_of(scene, rad, options)
    say_unused(found.stds)
    page = view(motion_of(found, False), found.system.named if found.system else str)
    if output:
        from ..output.write import write_bytes

        write_bytes(output, page.encode)
    if opens:
        open_page(page, output)
