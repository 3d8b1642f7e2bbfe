"""Every picture against a description that is stored: texts, colours, limits, and what is drawn.

After a change of a picture on purpose, look at it, then run this file to store its description.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from lagtop import Top, read_scene, solve

pytest.importorskip("matplotlib")
from matplotlib.collections import Collection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text

from lagrange_cli.plot.film import film_figure
from lagrange_cli.plot.pictures import Options, figure_of
from lagrange_cli.plot.reports import draw_errors, draw_fits
from lagrange_cli.plot.style import DARK, LIGHT, styled

STORED = Path(__file__).with_name("pictures.json")
R0 = "r0", np.linspace(20, 90, 6)
THETA0 = "theta0", np.linspace(20, 160, 5)
PSIDOT0 = "psidot0", np.linspace(-4, 4, 9)


def of_motion(kind: str, top: Top, **options: Any) -> Figure:
    return figure_of({"": solve(top)}, [kind], Options(**options))


def of_scenes() -> Figure:
    motions = {name: solve(SCENES[name]) for name in ("cusped-top", "steady-top")}
    return figure_of(motions, ["cubic", "phase"], Options(look=DARK))


def of_film() -> Figure:
    figure, show = film_figure(solve(Top()), Options(t_max=1.0), 10)
    show(6)
    return figure


def of_errors(steps: tuple[float | None, ...]) -> Figure:
    t = np.linspace(0, 1, 9)
    results = [SimpleNamespace(file=x, t=t, error=(x or 1) ** 4 * t, step=x) for x in steps]
    return draw_errors(results, 1e-3, [x and x**4 for x in steps])


def of_fit(count: int) -> Figure:
    t = np.linspace(0, 1, 9)
    curve = {"t": t, "data": t**2, "residual": t**3, "fine_t": t, "curve": 2 * t}
    curves = [SimpleNamespace(name=f"{x}: psi", **curve) for x in ("first", "second")]
    outcome: Any = SimpleNamespace(curves=lambda: curves, angle="deg", title="good")
    return draw_fits([outcome] * count)


NAMES = "looping-top cusped-top hanging-still plane-pendulum sleeping-top spherical-pendulum"
SCENES = {name: read_scene(name) for name in f"{NAMES} steady-top torque-free".split()}
SCENES["separatrix"] = Top(m=1, A=1, C=1, s=1, g=1, r0=1.5, theta0_deg=60, thetadot0=0.5, psidot0=1)
PICTURES: dict[str, Callable[[], Figure]] = {
    **{
        f"{kind} {name}": partial(of_motion, kind, top)
        for kind in ("sphere", "angles", "cubic", "phase")
        for name, top in SCENES.items()
    },
    "bands": partial(of_motion, "angles", Top(), stds=lambda t: [0.1 + t] * 3, radians=True),
    "dark": partial(of_motion, "sphere", Top(), look=DARK, camera=(0.3, -0.4), t_max=0.3),
    "map of numbers": partial(of_motion, "map", Top(), x=R0, y=THETA0),
    "map of words": partial(of_motion, "map", Top(), key="path", x=PSIDOT0, y=R0),
    "several scenes": of_scenes,
    "film": of_film,
    "errors": partial(of_errors, (None,)),
    "errors over steps": partial(of_errors, (0.1, 0.05, 0.025)),
    "fit": partial(of_fit, 1),
    "fits": partial(of_fit, 4),
}


def numbers(values: Any) -> str:
    """Return size, ends, mean and mean square of numbers, in four digits."""
    x = np.ma.masked_invalid(np.ravel(np.asarray(values, float))).compressed()
    if not x.size:
        return "none"
    shown = [x[0], x[-1], x.mean(), (x**2).mean()]
    return f"{x.size}: " + " ".join(f"{round(float(y), 7) + 0.0:.4g}" for y in shown)


def described(figure: Figure) -> Iterator[str]:
    """Yield a line for each thing drawn that can be seen."""
    figure.canvas.draw()
    yield f"size {numbers(figure.get_size_inches())} paper {to_hex(figure.get_facecolor())}"
    for axes in figure.axes:
        limits = [*axes.get_xlim(), *axes.get_ylim()]
        yield f"axes {axes.get_xscale()} {axes.get_yscale()} {numbers(limits)}"
    for artist in figure.findobj():
        kind = f"{type(artist).__name__} {artist.get_zorder():g}"
        match artist:
            case Text() if artist.get_text():
                place = numbers(artist.get_position()) if artist.axes else ""
                yield f"text {artist.get_text()!r} {to_hex(artist.get_color())} {place}"
            case Line2D() if artist.axes and np.size(artist.get_xdata()):
                style = artist.get_linestyle(), artist.get_linewidth(), artist.get_markersize()
                look = artist.get_color(), artist.get_marker(), artist.get_alpha()
                x, y = numbers(artist.get_xdata()), numbers(artist.get_ydata())
                yield f"{kind} {artist.get_label()!r} {style} {look} x {x} y {y}"
            case Collection():
                faces, edges = numbers(artist.get_facecolor()), numbers(artist.get_edgecolor())
                points = [path.vertices for path in artist.get_paths()]
                place = numbers(np.concatenate(points) if points else getattr(artist, "U", ()))
                yield f"{kind} {numbers(artist.get_linewidth())} {faces} {edges} {place}"


@pytest.mark.parametrize("name", PICTURES)
def test_the_picture_is_the_stored_one(name: str) -> None:
    """Nothing warns, since a warning is an error in these tests, and nothing is cut."""
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    with styled(LIGHT):
        figure = PICTURES[name]()
        assert sorted(described(figure)) == stored[name]
        assert figure.get_tightbbox().x0 >= -0.05


if __name__ == "__main__":
    with styled(LIGHT):
        every = {name: sorted(described(draw())) for name, draw in PICTURES.items()}
    STORED.write_text(json.dumps(every, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
