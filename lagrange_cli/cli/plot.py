"""The command `lagtop plot`: pictures of one motion."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from ..arithmetic.numbers import unit_in_radians
from ..arithmetic.text import parse_number
from ..errors import LagtopError
from ..inputs.names import check_names
from ..output.terminal import is_terminal
from ..output.write import write_bytes
from ..plot.files import require_matplotlib
from ..plot.kinds import KINDS, MAP_KEY, ON_THE_SHEET, SHEET, PlotRequest, help_lines
from ..plot.style import chosen_look
from .command import ExamplesFirst
from .options import FILE, NUMBER, PICTURES
from .progress import with_progress
from .top_options import (
    TIME,
    UNCERTAIN,
    angle_stds,
    in_seconds,
    input_options,
    inputs_of,
    is_scene,
    motion_of,
)

if TYPE_CHECKING:
    from ..inputs.given import Given
    from ..inputs.value import Value
    from ..motion.sensitivity.uncertainty import FirstOrder
    from ..motion.solve import Motion
    from ..plot.map import InputRange

FORMATS = ("png", "svg", "pdf")
PAGE_DPI, FILM_DPI = 150.0, 100.0
HELP = """Pictures of a top; several kinds come on one page.

\b
{kinds}

Needs matplotlib: pip install 'lagtop[plot]'.
"""


@click.command(
    "plot",
    cls=ExamplesFirst,
    help=HELP.format(kinds="\n".join(help_lines())),
    examples="""
        lagtop plot -o top.png
        lagtop plot sample_inputs/looping-top.toml sphere -o loops.svg
        lagtop plot angles phase --r0 20 --dark -o page.pdf
        lagtop plot angles --theta0 '30(1)' --r0 '50.0(5)' -o bands.svg
        lagtop plot map --x r0=5:120:80 --y theta0=2:178:60 --key T_nutation -o map.png
        lagtop plot sphere --camera 40,15 -o from-the-side.pdf
        lagtop plot --r0 30 --animate top.gif --duration 10 --speed 0.1
    """,
)
@click.argument("words", nargs=-1, type=PICTURES, metavar="[SCENE.toml|-] [KIND]...")
@input_options(UNCERTAIN)
@click.option("--t-max", type=TIME, help="Last time.  [default: some nutation periods]")
@click.option("--key", default=MAP_KEY, show_default=True, help="Key of the record for `map`.")
@click.option(
    "--x",
    metavar="RANGE",
    help="Horizontal axis of `map`: INPUT=[log:]start:stop:count.  [default: over r0]",
)
@click.option("--y", metavar="RANGE", help="Vertical axis of `map`.  [default: over theta0]")
@click.option(
    "--colour-limits",
    "limits",
    metavar="LOW:HIGH",
    help="Ends of the colours of `map`.  [default: all but the outermost 1 % of the values]",
)
@click.option(
    "--camera",
    metavar="AZ,EL",
    help="Azimuth and elevation of the eye.  [default: whence most of the path is seen]",
)
@click.option("--no-numbers", is_flag=True, help="Leave out the numbers beside several pictures.")
@click.option("--dark", is_flag=True, help="Light on dark.")
@click.option("--size", metavar="WxH", help="Width and height of the page in inches, as 8x6.")
@click.option(
    "--dpi",
    type=NUMBER,
    help="Pixels per inch, 20 to 1000; small letters need more than 20.  [default: 150, film 100]",
)
@click.option("--animate", metavar="FILE", help="A film of the top: FILE.gif or FILE.mp4.")
@click.option("--fps", type=NUMBER, help="Frames per second of the film, 1 to 60.  [default: 25]")
@click.option("--duration", type=NUMBER, help="Seconds that the film lasts.  [default: 6]")
@click.option(
    "--speed",
    type=NUMBER,
    help="Time of the motion in a second of the film.  [default: as --t-max needs]",
)
@click.option("--show", is_flag=True, help="Open a window.")
@click.option("--format", "fmt", type=click.Choice(FORMATS), help="[default: as FILE ends]")
@click.option(
    "-o",
    "--output",
    type=FILE,
    metavar="FILE|-",
    help="FILE.png, .svg or .pdf, replaced when all is written.",
)
def command(
    words: tuple[str, ...],
    rad: bool,
    t_max: Value | None,
    key: str,
    x: str | None,
    y: str | None,
    limits: str | None,
    camera: str | None,
    no_numbers: bool,
    dark: bool,
    size: str | None,
    dpi: Fraction | None,
    animate: str | None,
    fps: Fraction | None,
    duration: Fraction | None,
    speed: Fraction | None,
    show: bool,
    fmt: str | None,
    output: str | None,
    **options: Any,
) -> None:
    """Write, film and show the pictures that the options ask for."""
    if not (output or show or animate):
        raise LagtopError("nothing to do: give -o FILE.png, --show or --animate FILE.gif")
    scene, chosen = _scene_and_kinds(words)
    written = _format_of(fmt, output)
    inches = _inches(size)
    eye, ends = _camera(camera, rad), _ends(limits)
    pacing = {"fps": fps, "duration": duration, "speed": speed}
    for name, value in pacing.items():
        if value is not None and animate is None:
            raise LagtopError(f"--{name} needs --animate FILE.gif")
    require_matplotlib()
    from ..plot.curves import checked_span
    from ..plot.page import Page, page_bytes, show_page

    options, times = in_seconds(options, t_max=t_max)
    found = inputs_of(scene, rad, options)
    motion = motion_of(found, False)
    request = PlotRequest(
        t_max=checked_span(motion, times["t_max"]),
        radians=rad,
        system=found.system,
        key=key,
        x=_input_range("x", x),
        y=_input_range("y", y),
        camera=eye,
        limits=ends,
        numbers=not no_numbers,
        progress=with_progress,
        stds=angle_stds(found, motion),
        uncertain=_first_order(found, motion),
    )
    page = Page(motion, chosen, request, chosen_look(dark), inches)
    page_dpi, film_dpi = (float(dpi or usual) for usual in (PAGE_DPI, FILM_DPI))
    if output is not None:
        page.check_dpi(page_dpi, written)
    if animate is not None:
        from ..plot.film import check_film, film_bytes, film_pace

        check_film(page, animate, film_dpi)
        paced = {name: None if x is None else float(x) for name, x in pacing.items()}
        pace = film_pace(motion, animate, t_max=request.t_max, **paced)
    if output is not None:
        write_bytes(output, lambda: page_bytes(page, written, page_dpi))
    if animate is not None:
        write_bytes(animate, lambda: film_bytes(page, animate, film_dpi, pace, with_progress))
    if show:
        show_page(page)


def _scene_and_kinds(words: Sequence[str]) -> tuple[str | None, tuple[str, ...]]:
    """Return the scene file among the words, if any, and the kinds of picture."""
    known = (*KINDS, SHEET)
    scenes = [word for word in words if word not in known]
    for word in scenes[1:] or [word for word in scenes if not is_scene(word)]:
        check_names("KIND", [word], known)
    kinds = [kind for word in words for kind in (ON_THE_SHEET if word == SHEET else [word])]
    chosen = tuple(dict.fromkeys(kind for kind in kinds if kind in KINDS))
    return scenes[0] if scenes else None, chosen or ON_THE_SHEET


def _format_of(fmt: str | None, output: str | None) -> str:
    """Return `png`, `svg` or `pdf`, as it was asked for or as the file's name ends."""
    if output == "-" and is_terminal(sys.stdout):
        raise LagtopError("a picture does not go to a terminal: give -o FILE.png")
    if fmt or output in (None, "-"):
        return fmt or "png"
    suffix = output.rpartition(".")[2].lower()
    if suffix not in FORMATS:
        wanted = " or ".join(f".{ending}" for ending in FORMATS)
        raise LagtopError(f"-o must be a file that ends in {wanted}, got {output!r}")
    return suffix


def _inches(size: str | None) -> tuple[float, float] | None:
    """Return the width and height that a text such as `8x6` stands for."""
    if size is None:
        return None
    parts = re.fullmatch(r"(\d+\.?\d*)[x×](\d+\.?\d*)", size)
    width, height = map(float, parts.groups()) if parts else (0.0, 0.0)
    if not (2 <= width <= 50 and 2 <= height <= 50):
        raise LagtopError(f"--size must be WIDTHxHEIGHT, each in [2, 50] inches, got {size!r}")
    return width, height


def _camera(text: str | None, radians: bool) -> tuple[float, float] | None:
    """Return azimuth and elevation (radians) of a text such as `30,-15`."""
    if text is None:
        return None
    unit = unit_in_radians(radians=radians)
    try:
        azimuth, elevation = (float(parse_number(part)) * unit for part in text.split(","))
    except (LagtopError, ValueError):
        azimuth = elevation = math.inf
    if abs(azimuth) > 2 * math.pi or abs(elevation) > math.pi / 2:
        turn, quarter, name = ("2π", "π/2", "rad") if radians else ("360", "90", "deg")
        raise LagtopError(
            f"--camera must be AZIMUTH,ELEVATION in [-{turn}, {turn}] and [-{quarter}, {quarter}]"
            f" {name}, got {text!r}"
        )
    return azimuth, elevation


def _first_order(found: Given, motion: Motion) -> FirstOrder | None:
    """Return the uncertainties of the record, if inputs have any."""
    if not found.stds:
        return None
    from .uncertainty import first_order  # for few pictures only

    return first_order(found, motion)


def _input_range(name: str, text: str | None) -> InputRange | None:
    """Return an axis of a map."""
    if text is None:
        return None
    from ..plot.map import parse_input_range  # with the colour bars, which others do without

    return parse_input_range(name, text)


def _ends(text: str | None) -> tuple[float, float] | None:
    """Return the two numbers of a text such as `0:12.5`, the lower one first."""
    if text is None:
        return None
    try:
        low, high = (float(parse_number(part)) for part in text.split(":"))
    except (LagtopError, ValueError):
        low = high = 0.0
    if not low < high:
        raise LagtopError(f"--colour-limits must be LOW:HIGH with LOW < HIGH, got {text!r}")
    return low, high
