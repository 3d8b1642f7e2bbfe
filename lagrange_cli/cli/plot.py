"""The commands `lagtop plot`, pictures of one motion, and `lagtop view`, a page for the browser."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from fractions import Fraction
from os.path import splitext
from typing import TYPE_CHECKING, Any

from ..arithmetic.numbers import unit_in_radians
from ..arithmetic.text import parse_number
from ..errors import LagtopError
from ..inputs.input_keys import TILT
from ..inputs.names import check_names
from ..output.destination import opened
from ..output.terminal import is_screen, with_progress
from ..plot.kinds import (
    FILM_OPTIONS,
    KINDS,
    MAP_KEY,
    ON_THE_SHEET,
    SHEET,
    InputRange,
    PlotRequest,
    flag_of,
    help_lines,
)
from ..plot.style import DARK, LIGHT, require_matplotlib
from . import shared as opt

if TYPE_CHECKING:
    from ..inputs.given import Given
    from ..inputs.value import Value

_FORMATS = ("png", "svg", "pdf")
PAGE_DPI, FILM_DPI = 150.0, 100.0
HELP = "Draw pictures of one motion.\n\n\b\n{kinds}\n"


@opt.command(
    "plot",
    "plot looping-top sphere -o loops.svg",
    "plot map --x r0=5:120:40 --y theta0=2:178:9 -o map.png",
    "plot --r0 30 --animate top.gif --duration 2",
    help=HELP.format(kinds="\n".join(help_lines())),
)
@opt.top("[SCENE] [KIND]...")
@opt.option("--t-max", type=opt.TIME, help="Last time.  [default: a few nutation periods]")
@opt.option("--key", metavar="KEY", help=f"Key of `map`.  [default: {MAP_KEY}]")
@opt.option("--x", metavar="RANGE", help="Horizontal axis of `map`, INPUT=[log:]start:stop:count.")
@opt.option("--y", metavar="RANGE", help="Vertical axis of `map`.  [default: theta0]")
@opt.option("--camera", metavar="AZ,EL", help="Azimuth and elevation of the camera.")
@opt.option("--dark", is_flag=True, help="Dark background.")
@opt.option("--dpi", type=opt.NUMBER, help="Pixels per inch, 20 to 1000.  [default: 150, film 100]")
@opt.option("--animate", metavar="FILE", help="Write a film of the top: FILE.gif or FILE.mp4.")
@opt.option("--duration", type=opt.NUMBER, help="Length of the film in seconds.  [default: 6]")
@opt.option("--format", "fmt", metavar="FORMAT", type=opt.Choice(_FORMATS), help="png, svg, pdf.")
@opt.option(
    *("-o", "--output"), metavar="FILE", help="FILE.png, .svg or .pdf (replaced only on success)."
)
def plot_command(
    top: opt.TopOptions,
    words: list[str],
    t_max: Value | None,
    key: str | None,
    x: str | None,
    y: str | None,
    camera: str | None,
    dark: bool,
    dpi: Fraction | None,
    animate: str | None,
    duration: Fraction | None,
    fmt: str | None,
    output: str | None,
) -> None:
    """Write and film the pictures that the options request."""
    names = check_names("KIND", words or [SHEET], [*KINDS, SHEET])
    kinds = [kind for name in names for kind in (ON_THE_SHEET if name == SHEET else [name])]
    kinds = list(dict.fromkeys(kinds))
    written = _format_of(fmt, output)
    eye = None if camera is None else _camera(camera, top.radians)
    if duration is not None and animate is None:
        raise LagtopError("--duration needs --animate FILE.gif")
    _check_kinds({"t_max": t_max, "key": key, "x": x, "y": y, "camera": eye}, kinds, bool(animate))
    if not (output or animate):
        raise LagtopError("nothing to do: give -o FILE.png or --animate FILE.gif")
    require_matplotlib()
    from ..motion.uncertainty import FirstOrder
    from ..plot.curves import checked_span
    from ..plot.page import Page, page_bytes
    from .table import angle_stds

    found, axes = _given(top, t_max, {"x": x, "y": y})
    motion = opt.motion_of(found)
    request = PlotRequest(
        t_max=checked_span(motion, found.others.get("t_max")),
        radians=top.radians,
        system=found.system,
        key=key or MAP_KEY,
        x=axes.get("x"),
        y=axes.get("y"),
        camera=eye,
        progress=with_progress,
        stds=angle_stds(found, motion),
        uncertain=FirstOrder(motion, found.stds, found.inputs.keys()) if found.stds else None,
        look=DARK if dark else LIGHT,
    )
    page = Page(motion, tuple(kinds), request, None)
    page_dpi, film_dpi = (float(dpi or usual) for usual in (PAGE_DPI, FILM_DPI))
    if output is not None:
        page.check_dpi(page_dpi, written)
    if animate is not None:
        from ..plot.film import check_film, film_bytes, film_pace

        check_film(page, animate, film_dpi)
        pace = film_pace(
            motion, t_max=request.t_max, duration=None if duration is None else float(duration)
        )
    with ExitStack() as stack:
        film = stack.enter_context(opened(animate)) if animate is not None else None
        if output is not None:
            stack.enter_context(opened(output)).write(page_bytes(page, written, page_dpi))
        if film and animate:
            film.write(film_bytes(page, animate, film_dpi, pace))


def _check_kinds(options: Mapping[str, Any], kinds: Sequence[str], films: bool) -> None:
    """Raise LagtopError for an option that none of the pictures has, and no film."""
    for name, value in options.items():
        having = [kind.name for kind in KINDS.values() if name in kind.options]
        films_too = name in FILM_OPTIONS
        if value is None or set(having) & set(kinds) or (films_too and films):
            continue
        needed = " or ".join([*having, *["--animate FILE.gif"] * films_too])
        raise LagtopError(f"{flag_of(name)} needs {needed}, got {', '.join(kinds)}")


def _format_of(fmt: str | None, output: str | None) -> str:
    """Return `png`, `svg` or `pdf`: --format, or the extension of the file."""
    if output is not None and is_screen(output):
        raise LagtopError("a picture does not go to a terminal: give -o FILE.png")
    if fmt is not None and output is None:
        raise LagtopError(f"--format needs -o FILE.{fmt}")
    if fmt or output in (None, "-"):
        return fmt or "png"
    suffix = splitext(output)[1][1:].lower()
    if suffix not in _FORMATS:
        raise LagtopError(f"-o must be a file that ends in .png, .svg or .pdf, got {output!r}")
    return suffix


def _camera(text: str, radians: bool) -> tuple[float, float]:
    """Return azimuth and elevation (radians) of a text such as `30,-15`."""
    unit = unit_in_radians(radians=radians)
    try:
        azimuth, elevation = (float(parse_number(part)) * unit for part in text.split(","))
    except ValueError:  # of a number, or of another count of numbers
        azimuth, elevation = math.inf, math.inf
    if abs(azimuth) > 2 * math.pi or abs(elevation) > math.pi / 2:
        turn, quarter, name = ("2π", "π/2", "rad") if radians else ("360", "90", "deg")
        raise LagtopError(
            f"--camera must be AZIMUTH,ELEVATION in [-{turn}, {turn}] and [-{quarter}, {quarter}]"
            f" {name}, got {text!r}"
        )
    return azimuth, elevation


def _given(
    top: opt.TopOptions, t_max: Value | None, axes: Mapping[str, str | None]
) -> tuple[Given, dict[str, InputRange]]:
    """Return the inputs of the top and the axes of a map, in the same units."""
    others = {} if t_max is None else {"t_max": t_max}
    texts = {name: text for name, text in axes.items() if text is not None}
    if not texts:
        return top.given(others), {}
    from ..plot.map import input_range, parse_axis

    parsed = {name: parse_axis(name, text, radians=top.radians) for name, text in texts.items()}
    ranges = {key: value for key, value in parsed.values() if key != TILT}
    try:
        found = top.given(others | ranges)
    except LagtopError as error:
        name = next((name for name, (key, _) in parsed.items() if key == error.key), None)
        raise LagtopError(f"--{name}: {error}") if name else error from None
    return found, {
        name: input_range(name, key, found.others.get(key, value.number))
        for name, (key, value) in parsed.items()
    }


@opt.command(
    "view",
    "view -o top.html",
    "view looping-top -o loops.html",
    "view --r0 60 --theta0 0 -o sleeping.html",
)
@opt.top()
@opt.option("--open", "opens", is_flag=True, help="Open the page in the browser.")
@opt.option(*("-o", "--output"), metavar="FILE", help="FILE.html (replaced only on success).")
def view_command(top: opt.TopOptions, opens: bool, output: str | None) -> None:
    """Write an interactive page for the browser.

    The page shows the top in space, its angles and its record.  Sliders change every input, and the
    page computes the motion.  It works offline, as a single file.
    """
    if not (output or opens):
        raise LagtopError("nothing to do: give -o FILE.html or --open")
    if output == "-" and (opens or is_screen("-")):
        why = "to open" if opens else "for a terminal"
        raise LagtopError(f"a page on standard output is not {why}: give -o FILE.html")
    if splitext(output or "")[1].lower() not in {"", ".html", ".htm"}:
        raise LagtopError(f"-o must be a file that ends in .html, got {output!r}: a page is HTML")
    from ..plot.browser import open_page, view

    found = top.given()
    opt.warn_unused(found)
    page = view(opt.motion_of(found), found.system.named if found.system else str)
    if output:
        with opened(output) as stream:
            stream.write(page.encode())
    if opens:
        open_page(page, output)
