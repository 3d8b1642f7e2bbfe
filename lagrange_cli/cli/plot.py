"""The commands `lagtop plot`, pictures of motions, and `lagtop view`, a page for the browser."""

from __future__ import annotations

from contextlib import ExitStack
from fractions import Fraction
from os.path import exists
from typing import Any

from ..errors import LagtopError, arg
from ..file_bytes import extension
from ..names import listed, suggestion
from ..output.destination import opened
from ..output.formats import FILMS, PICTURES
from ..output.terminal import is_screen
from ..plot import CAPTION, KINDS, SHEET
from ..plot.style import (
    DARK,
    LEAST_DPI,
    LIGHT,
    MOST_DPI,
    check_picture,
    drawing,
    figure_bytes,
    require_matplotlib,
)
from ..top.inputs import DECLARED
from ..top.scenes import scene_names
from ..top.units import Units
from ..top.values import Value, parse_range, parse_value
from . import shared as opt

PAGE_DPI, FILM_DPI = 150.0, 100.0


@opt.command(
    "plot",
    "plot looping-top sphere -o loops.svg",
    "plot sphere cusped-top looping-top wavy-top -o three.svg",
    "plot map --key path --x psidot0=-8:8:80 --theta0 60 -o map.png",
    "plot --r0 30 --animate top.gif --duration 2",
)
@opt.top("[KIND]... [SCENE]...", is_scene=None)
@opt.option("--t-max", type=opt.TIME, help="Last time.  [default: a few nutation periods]")
@opt.option("--key", metavar="KEY", help="Key of `map`.  [default: mean_precession_rate]")
@opt.option("--x", metavar="RANGE", help="Horizontal axis of `map`, INPUT=[log:]start:stop:count.")
@opt.option(
    "--y", metavar="RANGE", help="Vertical axis of `map`.  [default: theta0=1:179:100 in deg]"
)
@opt.option(
    "--camera",
    metavar="AZ,EL",
    help="Azimuth and elevation, in deg (rad with --rad).  [default: in front]",
)
@opt.option("--title", metavar="TEXT", help="Title of the picture, or '' for none.")
@opt.option(
    "--caption",
    metavar="KEY,...",
    help="Inputs and results below each scene, or '' for none.  "
    f"[default: {','.join(CAPTION)} for one scene]",
)
@opt.option("--dark", is_flag=True, help="Dark background.")
@opt.option("--dpi", type=opt.NUMBER, help="Pixels per inch, 20 to 1000.  [default: 150, film 100]")
@opt.option("--animate", metavar="FILE", help=f"Write a film of the top: FILE{listed(FILMS, '.')}.")
@opt.option("--duration", type=opt.NUMBER, help="Length of the film in seconds.  [default: 6]")
@opt.option("-o", "--output", metavar="FILE", help=f"Output file: FILE{listed(PICTURES, '.')}.")
def plot_command(
    top: opt.TopOptions,
    words: list[str],
    t_max: Value | None,
    key: str | None,
    x: str | None,
    y: str | None,
    camera: str | None,
    title: str | None,
    caption: str | None,
    dark: bool,
    dpi: Fraction | None,
    animate: str | None,
    duration: Fraction | None,
    output: str | None,
) -> None:
    """Draw pictures of motions.

    \b
    {kinds}

    Several scenes share one picture, at one scale.
    """
    expanded = {kind: (kind,) for kind in KINDS} | SHEET
    named = [word for word in words if word in expanded] or [*SHEET]
    kinds = list(dict.fromkeys(kind for word in named for kind in expanded[word]))
    scenes = [word for word in words if word not in expanded]
    for word in scenes:
        if not (opt.is_scene(word) or exists(word)):
            hint = suggestion(word, [*expanded, *scene_names()]) or f": draw {', '.join(expanded)}"
            raise LagtopError(f"{word!r} is neither a kind of picture nor a scene{hint}")
    if not (output or animate):
        raise LagtopError("nothing to do: give -o FILE.png or --animate FILE.gif")
    if duration is not None and animate is None:
        raise LagtopError("--duration needs --animate FILE.gif")
    if {key, x, y} != {None} and "map" not in kinds:
        raise LagtopError(f"--key, --x and --y need map, got {', '.join(kinds)}")
    if animate and len(scenes) > 1:
        raise LagtopError(f"--animate films one scene, got {', '.join(scenes)}")
    if dpi is not None and not LEAST_DPI <= dpi <= MOST_DPI:
        raise LagtopError(f"--dpi must be in [{LEAST_DPI:g}, {MOST_DPI:g}], got {float(dpi):g}")
    if output is not None and is_screen(output):
        raise LagtopError("a picture cannot be shown in a terminal: give -o FILE.png")
    if extension(output or "") in FILMS:
        raise LagtopError(f"a film needs --animate: write --animate {output} instead of -o")
    fmt = "svg" if output in (None, "-") else check_picture(output, PICTURES)
    film = "" if animate is None else check_picture(animate, FILMS)
    eye = None if camera is None else _camera(camera, Units(top.radians))
    require_matplotlib()  # also for standard output, which has no name to check
    from ..plot.film import SECONDS, film_bytes
    from ..plot.pictures import Options, angle_columns, figure_of
    from .uncertainty import column_stds, warn_if_nonlinear

    axes = {"x": _axis("--x", x, top), "y": _axis("--y", y, top)}
    others = {"t_max": t_max} | dict(filter(None, axes.values()))
    founds = [top._replace(scene=name or None).given(**others) for name in scenes or [""]]
    uses_stds = len(founds) == 1 and "angles" in kinds
    motions = [opt.motion_of(found, uses_stds=uses_stds) for found in founds]
    stds = column_stds(founds[0], motions[0], angle_columns(motions[0])) if uses_stds else None
    options = Options(
        t_max=t_max and t_max.number,
        units=founds[0].units(radians=top.radians),
        camera=eye,
        look=DARK if dark else LIGHT,
        key=key,
        stds=stds,
        x=_points(axes["x"]),
        y=_points(axes["y"]),
    )
    with ExitStack() as stack:
        if animate:
            stream, seconds = stack.enter_context(opened(animate)), float(duration or SECONDS)
            resolution = float(dpi or FILM_DPI)
            stream.write(film_bytes(motions[0], film, options, seconds, resolution))
        if output is not None:
            drawn = list(zip(scenes or [""], motions, strict=True))
            about = title or f"Lagrange top: {', '.join(kinds)}"
            text = "; ".join(
                f"{name or 'Lagrange top'}: {motion.regime.value}, {motion.top.as_text()}"
                for name, motion in drawn
            )
            with drawing(options.look):
                figure = figure_of(drawn, kinds, options, title, _caption(caption, len(motions)))
                picture = figure_bytes(figure, fmt, float(dpi or PAGE_DPI), about, text)
            stack.enter_context(opened(output)).write(picture)
    warn_if_nonlinear(stds)


def _kinds() -> str:
    """Return the lines of the help on the kinds of picture."""
    *others, last = SHEET["all"]
    kinds = KINDS | {"all": f"{', '.join(others)} and {last} on one sheet (default)"}
    return "\n    ".join(f"{kind:8}{meaning}" for kind, meaning in kinds.items())


plot_command.help = str(plot_command.help).format(kinds=_kinds())


def _caption(text: str | None, scenes: int) -> list[str]:
    """Return the keys of the caption; by default only one scene has one."""
    if text is None:
        return [*CAPTION] if scenes == 1 else []
    return text.split(",") if text else []


def _camera(text: str, units: Units) -> tuple[float, float]:
    """Return azimuth and elevation (radians) of a text such as `30,-15`."""
    try:
        azimuth, elevation = (x / units.radian for x in opt.parse_numbers(text))
    except ValueError:  # of a number, or of another count of numbers
        wanted = "AZIMUTH,ELEVATION such as 30,15"
        raise LagtopError(f"--camera must be {wanted}, got {text!r}") from None
    return azimuth, elevation


def _points(axis: tuple[str, Value] | None) -> tuple[str, Any] | None:
    """Return the input along an axis and the array of its values."""
    return axis and (axis[0], next(axis[1].number.blocks()))


def _axis(option: str, text: str | None, top: opt.TopOptions) -> tuple[str, Value] | None:
    """Return the input and the values of a text such as `r0=log:5:120:40` or `r0=60:600:40 rpm`."""
    if text is None:
        return None
    name, equals, grid = text.partition("=")
    if not equals:
        raise LagtopError(f"{option} must be INPUT=[log:]start:stop:count, got {text!r}")
    is_tilt = name in DECLARED and DECLARED[name].unit == "angle"
    angle = Units(top.radians).angle
    try:
        return name, parse_value(name, grid, parse_range, wanted=angle if is_tilt else None)
    except LagtopError as error:
        raise LagtopError(f"{option} {error.marked.removeprefix(f'{arg(name)} ')}") from None


@opt.command(
    "view",
    "view -o top.html",
    "view looping-top -o loops.html",
    "view --r0 60 --theta0 0 -o sleeping.html",
)
@opt.top()
@opt.option("--open", "opens", is_flag=True, help="Open the page in the browser.")
@opt.option(
    *("-o", "--output"),
    metavar="FILE",
    help="Output file: FILE.html (replaced only when complete).",
)
def view_command(top: opt.TopOptions, opens: bool, output: str | None) -> None:
    """Write an interactive page for the browser.

    The page shows the top in space, its angles and its record.  Sliders change every input, and the
    page computes the motion.  It works offline, as a single file.
    """
    if not (output or opens):
        raise LagtopError("nothing to do: give -o FILE.html or --open")
    if output == "-" and (opens or is_screen("-")):
        raise LagtopError("a page on standard output needs a pipe: give -o FILE.html")
    if extension(output or "") not in {"", "html", "htm"}:
        raise LagtopError(f"-o must be a file that ends in .html, got {output!r}: a page is HTML")
    from ..plot.browser.view import open_page, view

    found = top.given()
    page = view(opt.motion_of(found, uses_stds=False), found.units(radians=False).named)
    if output is not None:
        with opened(output) as stream:
            stream.write(page.encode())
    if opens:
        open_page(page, output)
