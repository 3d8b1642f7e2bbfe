"""The commands `lagtop plot`, pictures of one motion, and `lagtop view`, a page for the browser."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from ..arithmetic.numbers import unit_in_radians
from ..arithmetic.text import parse_number
from ..errors import LagtopError
from ..inputs.input_keys import TILT
from ..inputs.names import check_names
from ..output.destination import write_bytes
from ..output.terminal import is_terminal, with_progress
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
from . import options as opt
from .tables import angle_stds
from .top import INPUT, TIME, UNCERTAIN, TopOptions, motion_of, top_options, warn_unused, words

if TYPE_CHECKING:
    from ..inputs.given import Given
    from ..inputs.value import Value
    from ..motion.solve import Motion
    from ..motion.uncertainty import FirstOrder

_FORMATS = ("png", "svg", "pdf")
PAGE_DPI, FILM_DPI = 150.0, 100.0
HELP = "Draw pictures of one motion.\n\n\b\n{kinds}\n"


def _kinds_and_scenes() -> list[str]:
    from ..inputs.scene_file import scene_names

    return [*KINDS, SHEET, *scene_names()]


def _axis_names() -> list[str]:
    from ..inputs.input_keys import NINE

    return [f"{name}=" for name in NINE]


AXIS = opt.Parsed("RANGE", str, _axis_names)
KIND = opt.Parsed("KIND", str, _kinds_and_scenes)


def _pair(text: str, separator: str, fallback: tuple[float, float]) -> tuple[float, float]:
    """Return the two numbers of a text, or the fallback if it is no pair."""
    try:
        first, second = (float(parse_number(part)) for part in text.split(separator))
    except (LagtopError, ValueError):
        return fallback
    return first, second


def _parse_size(text: str) -> tuple[float, float]:
    """Return the width and height of a text such as `8x6`."""
    parts = re.fullmatch(r"(\d+\.?\d*)[x×](\d+\.?\d*)", text)
    width, height = map(float, parts.groups()) if parts else (0.0, 0.0)
    if not (2 <= width <= 50 and 2 <= height <= 50):
        raise LagtopError(f"must be WIDTHxHEIGHT, each in [2, 50] inches, got {text!r}")
    return width, height


def _parse_limits(text: str) -> tuple[float, float]:
    """Return the two numbers of a text such as `0:12.5`, the lower one first."""
    low, high = _pair(text, ":", (0.0, 0.0))
    if not low < high:
        raise LagtopError(f"must be LOW:HIGH with LOW < HIGH, got {text!r}")
    return low, high


@opt.command(
    "plot",
    """
    lagtop plot looping-top sphere -o loops.svg
    lagtop plot map --x r0=5:120:40 --y theta0=2:178:9 -o map.png
    lagtop plot --r0 30 --animate top.gif --duration 2
    """,
    text=HELP.format(kinds="\n".join(help_lines())),
)
def plot_command(
    top: TopOptions = top_options(UNCERTAIN, words("[SCENE] [KIND]...", KIND)),
    t_max: Value | None = opt.option(TIME, "Last time.  [default: a few nutation periods]"),
    key: str | None = opt.option(opt.KEY, f"Key of `map`.  [default: {MAP_KEY}]"),
    x: str | None = opt.option(AXIS, "Horizontal axis of `map`, INPUT=[log:]start:stop:count."),
    y: str | None = opt.option(AXIS, "Vertical axis of `map`.  [default: theta0]"),
    colour_limits: tuple[float, float] | None = opt.option(
        opt.Parsed("LOW:HIGH", _parse_limits),
        "Colour limits of `map`.  [default: 1st and 99th percentile]",
    ),
    camera: str | None = opt.option(
        opt.Parsed("AZ,EL", str), "Azimuth and elevation of the camera."
    ),
    dark: bool = opt.flag("Dark background."),
    size: tuple[float, float] | None = opt.option(
        opt.Parsed("", _parse_size), "Size of the page in inches, such as 8x6.", metavar="WxH"
    ),
    dpi: Fraction | None = opt.number("Pixels per inch, 20 to 1000.  [default: 150, film 100]"),
    animate: str | None = opt.file("Write a film of the top: FILE.gif or FILE.mp4."),
    duration: Fraction | None = opt.number("Length of the film in seconds.  [default: 6]"),
    speed: Fraction | None = opt.number("Simulated time per second of film."),
    show: bool = opt.flag("Open a window."),
    fmt: str | None = opt.choice(_FORMATS, "png, svg or pdf.", "FORMAT", flag="--format"),
    output: str | None = opt.file(
        "FILE.png, .svg or .pdf (replaced only on success).", "-o --output"
    ),
) -> None:
    """Write, film and show the pictures that the options request."""
    chosen = _kinds(top.words)
    written = _format_of(fmt, output)
    eye = None if camera is None else _camera(camera, top.radians)
    pacing = {"duration": duration, "speed": speed}
    for name, value in pacing.items():
        if value is not None and animate is None:
            raise LagtopError(f"--{name} needs --animate FILE.gif")
    of_kinds = {"t_max": t_max, "key": key, "x": x, "y": y, "camera": eye}
    _check_kinds(of_kinds | {"colour_limits": colour_limits}, chosen, animate is not None)
    if not output and fmt is not None:
        raise LagtopError(f"--format needs -o FILE.{fmt}")
    if not (output or animate) and dpi is not None:
        raise LagtopError("--dpi needs -o FILE.png or --animate FILE.gif")
    require_matplotlib()
    from ..plot.curves import checked_span
    from ..plot.page import Page, empty_window, page_bytes, show_page

    top, times = top.in_seconds(t_max=t_max)
    found, axes = _given(top, x=x, y=y)
    motion = motion_of(found)
    request = PlotRequest(
        t_max=checked_span(motion, times["t_max"]),
        radians=top.radians,
        system=found.system,
        key=key or MAP_KEY,
        x=axes.get("x"),
        y=axes.get("y"),
        camera=eye,
        colour_limits=colour_limits,
        progress=with_progress,
        stds=angle_stds(found, motion),
        uncertain=_first_order(found, motion),
        look=DARK if dark else LIGHT,
    )
    if not (output or show or animate):
        raise LagtopError("nothing to do: give -o FILE.png, --show or --animate FILE.gif")
    page = Page(motion, chosen, request, size)
    page_dpi, film_dpi = (float(dpi or usual) for usual in (PAGE_DPI, FILM_DPI))
    if output is not None:
        page.check_dpi(page_dpi, written)
    if animate is not None:
        from ..plot.film import check_film, film_bytes, film_pace

        check_film(page, animate, film_dpi)
        paced = {name: None if x is None else float(x) for name, x in pacing.items()}
        pace = film_pace(motion, t_max=request.t_max, **paced)
    window = empty_window(page) if show else None
    if output is not None:
        write_bytes(output, lambda: page_bytes(page, written, page_dpi))
    if animate is not None:
        write_bytes(animate, lambda: film_bytes(page, animate, film_dpi, pace))
    if window:
        show_page(page, window)


def _check_kinds(options: Mapping[str, Any], kinds: Sequence[str], films: bool) -> None:
    """Raise LagtopError for an option that none of the pictures has, and no film."""
    for name, value in options.items():
        having = [kind.name for kind in KINDS.values() if name in kind.options]
        films_too = name in FILM_OPTIONS
        if value is None or set(having) & set(kinds) or (films_too and films):
            continue
        needed = " or ".join([*having, *["--animate FILE.gif"] * films_too])
        raise LagtopError(f"{flag_of(name)} needs {needed}, got {', '.join(kinds)}")


def _kinds(names: Sequence[str]) -> tuple[str, ...]:
    """Return the kinds of picture, each once; `all` stands for several, and is the default."""
    names = check_names("KIND", names or [SHEET], [*KINDS, SHEET])
    kinds = [kind for name in names for kind in (ON_THE_SHEET if name == SHEET else [name])]
    return tuple(dict.fromkeys(kinds))


def _format_of(fmt: str | None, output: str | None) -> str:
    """Return `png`, `svg` or `pdf`: --format, or the extension of the file."""
    if output == "-" and is_terminal(sys.stdout):
        raise LagtopError("a picture does not go to a terminal: give -o FILE.png")
    if fmt or output in (None, "-"):
        return fmt or "png"
    suffix = output.rpartition(".")[2].lower()
    if suffix not in _FORMATS:
        wanted = " or ".join(f".{ending}" for ending in _FORMATS)
        raise LagtopError(f"-o must be a file that ends in {wanted}, got {output!r}")
    return suffix


def _camera(text: str, radians: bool) -> tuple[float, float]:
    """Return azimuth and elevation (radians) of a text such as `30,-15`."""
    unit = unit_in_radians(radians=radians)
    azimuth, elevation = (x * unit for x in _pair(text, ",", (math.inf, math.inf)))
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
    from .uncertainty import first_order  # few pictures need it

    return first_order(found, motion)


def _given(top: TopOptions, **axes: str | None) -> tuple[Given, dict[str, InputRange]]:
    """Return the inputs of the top and the axes of a map, in the same units."""
    texts = {name: text for name, text in axes.items() if text is not None}
    if not texts:
        return top.given(), {}
    from ..plot.map import input_range, parse_axis  # start-up: loads NumPy

    parsed = {name: parse_axis(name, text, radians=top.radians) for name, text in texts.items()}
    try:
        found = top.given({key: value for key, value in parsed.values() if key != TILT})
    except LagtopError as error:
        name = next((name for name, (key, _) in parsed.items() if key == error.key), None)
        raise LagtopError(f"--{name}: {error}") if name else error from None
    return found, {
        name: input_range(name, key, found.others.get(key, value.number))
        for name, (key, value) in parsed.items()
    }


@opt.command(
    "view",
    """
    lagtop view -o top.html
    lagtop view looping-top -o loops.html
    lagtop view --r0 60 --theta0 0 -o sleeping.html
    """,
)
def view_command(
    top: TopOptions = top_options(INPUT),
    opens: bool = opt.flag("Open the page in the browser.", "--open"),
    output: str | None = opt.file("FILE.html (replaced only on success).", "-o --output"),
) -> None:
    """Write an interactive page for the browser.

    The page shows the top in space, its angles and its record.  Sliders change every input, and the
    page computes the motion in closed form.  It works offline, as a single file.
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

    found = top.given()
    warn_unused(found.stds)
    page = view(motion_of(found), found.system.named if found.system else str)
    if output:
        write_bytes(output, page.encode)
    if opens:
        open_page(page, output)
