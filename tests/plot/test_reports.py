"""The picture of trajectories that were judged."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lagrange_cli.fits.report import FittedCurve
from lagrange_cli.plot.reports import ErrorCurve, draw_error_panels, draw_fit_panels
from lagrange_cli.plot.style import LIGHT, styled

T = np.linspace(0, 1, 11)
CURVES = [ErrorCurve(f"h = {h}", T, h**2 * T, h, h**2) for h in (0.1, 0.05, 0.025)]


def data(line: Line2D) -> tuple[Any, Any]:
    """Return x and y of a line."""
    x, y = np.array(line.get_xydata(), dtype=float).T
    return x, y


def drawn(curves: list[ErrorCurve]) -> Figure:
    with styled(LIGHT):
        figure = Figure(layout="constrained")
        draw_error_panels(figure, curves, 1e-3)
    return figure


def test_errors_over_time_are_drawn_as_they_are() -> None:
    (axes,) = drawn([curve._replace(step=None) for curve in CURVES]).axes
    for line, curve in zip(axes.lines, CURVES, strict=False):
        x, y = data(line)
        assert np.array_equal(x, T)
        assert np.array_equal(y[1:], curve.error[1:])
        assert math.isnan(y[0])
    assert data(axes.lines[-1])[1].tolist() == [1e-3, 1e-3]
    assert axes.get_yscale() == "log"
    assert len({(str(x.get_color()), x.get_linestyle()) for x in axes.lines[:3]}) == 3


def test_errors_over_steps_stand_beside_slopes() -> None:
    axes = drawn(CURVES).axes[1]
    points = [tuple(np.ravel(data(line)).tolist()) for line in axes.lines[:3]]
    assert points == [(curve.step, curve.compared) for curve in CURVES]
    for line, order in zip(axes.lines[3:], (1, 2, 4), strict=True):
        (coarse, fine), (most, least) = data(line)
        assert math.log(most / least) / math.log(coarse / fine) == pytest.approx(order)
    assert data(axes.lines[4])[1][1] == pytest.approx(CURVES[-1].compared)


@pytest.mark.parametrize("error", [None, 0.0, math.inf])
def test_what_has_no_logarithm_is_left_out(error: float | None) -> None:
    curves = [curve._replace(compared=error) for curve in CURVES]
    assert len(drawn(curves).axes) == 1
    assert len(drawn([*curves[1:], CURVES[0]]).axes[1].lines) == 1 + 3


def test_angles_of_a_fit_have_their_own_colours_and_symbols() -> None:
    names = {
        "psi": ("ψ (deg)", 2),
        "one.csv: theta": ("ϑ (deg)", 0),
        "two.csv: phi": ("φ (deg)", 1),
    }
    with styled(LIGHT):
        figure = Figure()
        draw_fit_panels(figure, [FittedCurve(name, T, T, T, T, 0 * T) for name in names], "deg")
    for axes, (name, (label, colour)) in zip(figure.axes[::2], names.items(), strict=True):
        assert axes.get_ylabel() == label
        assert axes.lines[0].get_color() == LIGHT.lines[colour]
        assert axes.get_title("left") == name.rpartition(": ")[0]
    assert {axes.get_ylabel() for axes in figure.axes[1::2]} == {"residual"}
