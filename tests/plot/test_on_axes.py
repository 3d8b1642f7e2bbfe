"""Pictures on axes of one's own: the same as on a page, and nothing but the axes is touched."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from lagtop import LagtopError, Top, solve
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pictures import drawn

import lagrange_cli.plot
from lagrange_cli.errors import NothingToDrawError
from lagrange_cli.plot import draw_angles, draw_map, draw_remainders, draw_sphere
from lagrange_cli.plot.kinds import KINDS, PlotRequest

MAP = {"x": "r0=10:80:3", "y": "theta0=10:170:3"}


def draw(kind: str, **options: Any) -> list[Axes]:
    """Return the axes of a kind on a figure of our own."""
    figure, count = Figure(), KINDS[kind].axes
    places = [figure.add_subplot(count, 1, i + 1) for i in range(count)]
    function = getattr(lagrange_cli.plot, f"draw_{kind}")
    assert function(solve(Top()), places if count > 1 else places[0], **options) == places
    return places


def lines(axes: Axes) -> list[Any]:
    """Return the data of all lines of an axes."""
    return [np.asarray(line.get_xydata()) for line in axes.get_lines()]


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "map"])
def test_the_lines_are_those_of_the_page(kind: str) -> None:
    own = draw(kind)
    page = drawn(solve(Top()), [kind], PlotRequest()).axes[: len(own)]
    for mine, others in zip(own, page, strict=True):
        assert mine.get_title(loc="left") or mine.get_title() or mine is not own[0]
        assert len(lines(mine)) == len(lines(others)) > 0
        for line, other in zip(lines(mine), lines(others), strict=True):
            np.testing.assert_array_equal(line, other)


def test_every_kind_has_its_function() -> None:
    functions = {name for name in vars(lagrange_cli.plot) if name.startswith("draw_")}
    assert {f"draw_{kind}" for kind in KINDS} == functions


def test_a_map_draws_its_own_axes_and_colour_bar() -> None:
    (axes,) = draw("map", key="T_nutation", **MAP)
    assert axes.get_title() == "T: nutation period (5,1), in time"
    figure = axes.get_figure()
    assert figure is not None
    assert len(figure.axes) == 2  # the bar


def test_settings_of_the_user_hold() -> None:
    with pyplot.rc_context({"lines.linewidth": 7.0}):
        axes = draw("angles", t_max=1.0, radians=True)
    assert axes[0].get_lines()[0].get_linewidth() == 7.0
    assert axes[0].get_ylabel() == "ϑ (rad)"
    assert axes[0].get_xlim() == (0.0, 1.0)


def test_a_new_figure_where_no_axes_are_given() -> None:
    with pyplot.rc_context({"backend": "agg"}):
        axes = draw_remainders(solve(Top()), dark=True)
    assert len(axes) == 2
    pyplot.close("all")


def test_impossible_drawings_are_refused() -> None:
    ax = Figure().add_subplot()
    with pytest.raises(LagtopError, match="ax must be 3 axes, got 1"):
        draw_angles(solve(Top()), ax)
    with pytest.raises(LagtopError, match="t_max must be > 0, got -1"):
        draw_sphere(solve(Top()), ax, t_max=-1.0)
    with pytest.raises(LagtopError, match="x must be a range"):
        draw_map(solve(Top()), ax, x="r0=1:2")
    for option in ({"t_max": 1.0}, {"key": "nome"}):
        with pytest.raises(TypeError, match=r"draw_cubic\(\) got an unexpected keyword argument"):
            lagrange_cli.draw(solve(Top()), "cubic", ax, **option)
    with pytest.raises(NothingToDrawError, match="no remainders"):
        draw_remainders(solve(Top(theta0_deg=0)), [ax, ax])
