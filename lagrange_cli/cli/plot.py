"""`lagtop plot`: pictures of one motion."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from fractions import Fraction
from functools import partial
from typing import Any

import click

from ..errors import LagtopError
from ..output.write import write_bytes
from ..plot.style import look, require_matplotlib
from .options import NUMBER, ExamplesFirst, scene_options, solved, with_progress

KINDS = ("sphere", "angles", "remainders", "cubic", "phase", "map")
ON_THE_SHEET = KINDS[:4]
MOST_PIXELS = 5e7


@click.command(
    "plot",
    cls=ExamplesFirst,
    examples="""
        lagtop plot -o top.png
        lagtop plot sample_inputs/looping-top.toml sphere -o loops.svg
        lagtop plot angles phase --r0 20 --dark -o page.pdf
        lagtop plot map --x r0=5:120:80 --y theta0=2:178:60 --key T_nutation -o map.png
        lagtop plot --r0 30 --animate top.gif
    """,
)
@scene_options
@click.argument("kinds", nargs=-1, metavar="[KIND]...")
@click.option("--t-max", type=NUMBER, help="Last time.  [default: some nutation periods]")
@click.option("--key", default="mean_precession_rate", show_default=True, help="What map shows.")
@click.option("--x", metavar="GRID", help="Of map: INPUT=[log:]start:stop:count.  [default: r0]")
@click.option("--y", metavar="GRID", help="Of map.  [default: over theta0]")
@click.option("--dark", is_flag=True, help="Light on dark.")
@click.option("--size", metavar="WxH", help="Of the page in inches, as 8x6.")
@click.option("--dpi", type=NUMBER, help="Pixels an inch, 20 to 1000.  [default: 150, film 100]")
@click.option("--animate", metavar="FILE", help="A film of the top: FILE.gif or FILE.mp4.")
@click.option("--show", is_flag=True, help="Open a window.")
@click.option(
    "--format", "style", type=click.Choice(["png", "svg", "pdf"]), help="[default: as FILE ends]"
)
@click.option(
    "-o",
    "--output",
    type=click.Path(allow_dash=True),
    metavar="FILE|-",
    help="FILE.png, .svg or .pdf, replaced when all is written.",
)
def command(  # noqa: PLR0917 - click passes them by name
    scene: str | None,
    rad: bool,
    kinds: tuple[str, ...],
    t_max: Fraction | None,
    key: str,
    x: str | None,
    y: str | None,
    dark: bool,
    size: str | None,
    dpi: Fraction | None,
    animate: str | None,
    show: bool,
    style: str | None,
    output: str | None,
    **options: Any,
) -> None:
    """Pictures of a top; several kinds come on one page.

    \b
    sphere      the path of the figure axis on the unit sphere
    angles      tilt, spin and precession over time
    remainders  spin and precession less their mean growth
    cubic       f(u), its roots, and the band of the motion
    phase       tilt rate against tilt, and the separatrix
    map         a key of the record over two inputs
    all         the first four, and the numbers of the scene (the default)

    Needs matplotlib: pip install 'lagtop[plot]'.
    """
    if not (output or show or animate):
        raise LagtopError("nothing to do: give -o FILE.png, --show or --animate FILE.gif")
    path, chosen = _scene_and_kinds([word for word in (scene, *kinds) if word is not None])
    written = _file_style(style, output)
    if animate is not None:
        _require_suffix("--animate", animate, ("gif", "mp4"))
    inches = _inches(size)
    dots = _dots(dpi, inches)
    require_matplotlib()
    from ..plot.curves import checked_span
    from ..plot.key_map import parse_axis
    from ..plot.kinds import Wish
    from ..plot.page import Page, page_bytes, show_page

    motion = solved(path, rad, False, options)
    wish = Wish(
        t_max=checked_span(motion, t_max),
        radians=rad,
        key=key,
        x=parse_axis("--x", x) if x else None,
        y=parse_axis("--y", y) if y else None,
        watch=partial(with_progress, long=1000, label="tops"),
    )
    page = Page(motion, chosen, wish, look(dark), inches)
    if output is not None:
        write_bytes(output, lambda: page_bytes(page, written, dots or 150))
    if animate is not None:
        from ..plot.film import film_bytes

        watch = partial(with_progress, long=1, label="frames")
        write_bytes(animate, lambda: film_bytes(page, animate, dots or 100, watch))
    if show:
        show_page(page)


def _scene_and_kinds(words: Sequence[str]) -> tuple[str | None, tuple[str, ...]]:
    """The scene file among the words, if any, and the kinds of picture."""
    known = (*KINDS, "all")
    scenes = [word for word in words if word not in known]
    for word in scenes[1:] or [word for word in scenes if not re.search(r"[./]", word)]:
        raise LagtopError(f"KIND must be among {' '.join(known)}, got {word!r}")
    kinds = [kind for word in words for kind in (ON_THE_SHEET if word == "all" else [word])]
    chosen = tuple(dict.fromkeys(kind for kind in kinds if kind in KINDS))
    return scenes[0] if scenes else None, chosen or ON_THE_SHEET


def _file_style(style: str | None, output: str | None) -> str:
    """`png`, `svg` or `pdf`, as it was given or as the file's name ends."""
    if output == "-" and sys.stdout.isatty():
        raise LagtopError("a picture does not go to a terminal: give -o FILE.png")
    if style or output in (None, "-"):
        return style or "png"
    return _require_suffix("-o", output, ("png", "svg", "pdf"))


def _require_suffix(option: str, path: str, allowed: Sequence[str]) -> str:
    suffix = path.rpartition(".")[2].lower()
    if suffix not in allowed:
        wanted = " or ".join(f".{ending}" for ending in allowed)
        raise LagtopError(f"{option} must be a file that ends in {wanted}, got {path!r}")
    return suffix


def _inches(size: str | None) -> tuple[float, float] | None:
    if size is None:
        return None
    found = re.fullmatch(r"(\d+\.?\d*)[x×](\d+\.?\d*)", size)
    width, height = map(float, found.groups()) if found else (0.0, 0.0)
    if not (2 <= width <= 50 and 2 <= height <= 50):
        raise LagtopError(f"--size must be WIDTHxHEIGHT, each in [2, 50] inches, got {size!r}")
    return width, height


def _dots(dpi: Fraction | None, inches: tuple[float, float] | None) -> float | None:
    if dpi is None:
        return None
    if not 20 <= dpi <= 1000:
        raise LagtopError(f"--dpi must be in [20, 1000], got {float(dpi):g}")
    width, height = inches or (1.0, 1.0)
    if width * height * dpi**2 > MOST_PIXELS:
        most = (MOST_PIXELS / (width * height)) ** 0.5
        raise LagtopError(f"--dpi must be at most {most:.0f} at this --size, got {float(dpi):g}")
    return float(dpi)
