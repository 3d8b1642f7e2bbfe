"""The numbers that each picture shows, and that it shows them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ball_judge import Judge
from conftest import ROOT
from lagtop import LagtopError, Top, solve
from matplotlib.collections import LineCollection
from matplotlib.text import Annotation
from pictures import NUTATING, REGIMES, drawn, regime_motion, sample_motion
from scenes import SAMPLES

from lagrange_cli.errors import NothingToDrawError
from lagrange_cli.plot.cubic import cubic_curve, phase_portrait, separatrix_orbit
from lagrange_cli.plot.curves import sampled_columns, span, sphere_span, tilt_period, turn_span
from lagrange_cli.plot.globe import best_camera
from lagrange_cli.plot.kinds import KINDS, ON_THE_SHEET, PlotRequest, help_lines
from lagrange_cli.plot.map import colour_limits, jumps, key_map, parse_input_range
from lagrange_cli.plot.sphere import axis_path
from lagrange_cli.plot.style import number_text

TILTS = parse_input_range("y", "theta0=10:90:2")

# The registry.


def test_every_kind_has_a_function_that_draws_it() -> None:
    text = "".join(path.read_text() for path in (ROOT / "lagrange_cli" / "plot").glob("*.py"))
    assert set(re.findall(r"^def (\w+)_picture\(", text, re.MULTILINE)) == set(KINDS)
    for name, kind in KINDS.items():
        assert kind.name == name
        assert kind.help
        request = PlotRequest(x=parse_input_range("x", "r0=20:80:2"), y=TILTS)
        (panel,) = drawn(solve(Top()), [name], request).subfigs
        assert panel.get_suptitle()
        assert len(panel.axes) - (name in ("sphere", "map")) == kind.axes  # a bar of colours


def test_the_sheet_is_what_the_rows_say() -> None:
    assert ON_THE_SHEET == ("sphere", "angles", "remainders", "cubic")
    assert [line.split()[0] for line in help_lines()] == [*KINDS, "all"]
    assert "sphere, angles, remainders and cubic" in help_lines()[-1]


# The angles and what is left of them.


@pytest.mark.parametrize("radians", [False, True])
def test_the_angles_are_drawn_as_they_are(radians: bool) -> None:
    scene, factor = solve(Top()), 1.0 if radians else 180 / math.pi
    figure = drawn(scene, ["angles"], PlotRequest(radians=radians, t_max=1.0))
    for i, rate in enumerate((None, scene.mean_spin_rate, scene.mean_precession_rate)):
        axes = figure.axes[i]
        curve = next(line for line in axes.lines if line.get_linewidth() == 1.8)
        t, shown = (np.asarray(x) for x in curve.get_data())
        assert (t[0], t[-1]) == (0.0, 1.0)
        assert shown == pytest.approx(scene.angles(t)[i] * factor, rel=1e-15)
        means = [line for line in axes.lines if line.get_linestyle() == "--"]
        assert len(means) == (rate is not None)
        if rate is not None:
            end = np.asarray(means[0].get_ydata())[-1]
            assert end == pytest.approx(rate * factor, rel=1e-15)
        assert ("rad" if radians else "deg") in axes.get_ylabel()
    marks = figure.axes[0].child_axes[0].get_xticks()
    assert marks == pytest.approx([tilt_period(scene), 2 * (tilt_period(scene) or 0)])


def test_a_vertical_top_has_no_precession_to_draw() -> None:
    figure = drawn(regime_motion("sleeping"), ["angles"])
    assert len(figure.axes) == 2
    assert figure.axes[1].get_title("left") == "mean 50 rad/time; spin only: there is no precession"


@pytest.mark.parametrize("scene", [(50.0, 30.0), (-50.0, 30.0), (20.0, 120.0)])
def test_remainders_are_those_of_the_paper(scene: tuple[float, float]) -> None:
    """Compared with the judge, and with what is drawn."""
    r0, tilt = scene
    top = solve(Top(r0=r0, theta0_deg=tilt))
    course = sampled_columns(top, span(top, 2), ["dphi", "dpsi"])
    judge = Judge(top.top.as_dict())
    for i in range(0, course["t"].size, 37):
        t = float(course["t"][i])
        waves = float(course["dphi"][i]), float(course["dpsi"][i])
        assert max(judge.remainder_errors(t, waves)) < 1
    figure = drawn(top, ["remainders"])
    for axes, curve in zip(figure.axes, (course["dphi"], course["dpsi"]), strict=False):
        shown = next(line for line in axes.lines if line.get_linewidth() == 1.8)
        assert shown.get_ydata() == pytest.approx(np.degrees(curve), rel=1e-15)


def test_rounding_is_drawn_as_a_flat_line() -> None:
    (path,) = (path for path in SAMPLES if path.stem == "kinon-betsch-cone")
    noise = drawn(sample_motion(path), ["remainders"])
    for axes in noise.axes[:2]:
        assert axes.get_ylim()[1] == pytest.approx(1e-12 * 180 / math.pi)
    real = drawn(solve(Top(r0=1e5)), ["remainders"])
    assert real.axes[0].get_ylim()[1] > 1e-9


@pytest.mark.parametrize("name", REGIMES)
def test_remainders_need_a_period(name: str) -> None:
    scene = regime_motion(name)
    if tilt_period(scene):
        assert np.ptp(sampled_columns(scene, span(scene, 1), ["dphi"])["dphi"]) < 2 * math.pi
        return
    with pytest.raises(
        NothingToDrawError, match=r"^no remainders: the tilt (is constant|never returns) \("
    ):
        drawn(scene, ["remainders"], PlotRequest(t_max=1.0))


# The cubic.


CUBICS = {path.stem: sample_motion(path) for path in SAMPLES} | {
    "upright and unstable": solve(Top(theta0_deg=0)),
    "without torque": regime_motion("torque-free, nodding"),
}


@pytest.mark.parametrize("name", CUBICS)
def test_the_cubic_is_that_of_the_paper_and_the_roots_sit_on_its_zeros(name: str) -> None:
    """f(u) drawn from its product form, judged by (4,9) from the start; it is in sight."""
    scene = CUBICS[name]
    top, cubic = scene.top, cubic_curve(scene)
    u0 = math.cos(top.theta0_rad or math.radians(top.theta0_deg or 0))
    m, A, C, s, g, r0, rate = (
        float(x) for x in (top.m, top.A, top.C, top.s, top.g, top.r0, top.psidot0)
    )
    a, b, around = 2 * m * g * s / A, C * r0 / A, rate * (1 - u0 * u0)
    alpha, beta = around * rate + a * u0, around + b * u0

    def f(u: Any) -> Any:
        return (1 - u * u) * (alpha - a * u) - (beta - b * u) ** 2

    size = 1e-14 * (alpha + a + (abs(beta) + abs(b)) ** 2)
    assert np.abs(cubic.f - f(cubic.u)).max() < size * max(1, np.abs(cubic.u).max() ** 3)
    for root in (cubic.u1, cubic.u2):
        assert abs(f(root)) < size
    band = (cubic.u > cubic.u2) & (cubic.u < cubic.u1)
    assert band.sum() > 90 or cubic.u1 == cubic.u2
    assert (cubic.f[band] > 0).all()
    axes = drawn(scene, ["cubic"]).axes[0]
    dots = next(line for line in axes.lines if line.get_marker() == "o")
    low, high = axes.get_ylim()
    vertical = scene.top.theta0_deg in (0, 180)
    if vertical:
        assert low < cubic.f.min() <= 0 <= cubic.f.max() < high
    shown = list(dict.fromkeys([cubic.u1, cubic.u2]))
    assert (cubic.u3 is None) == (not scene.a or vertical)
    if cubic.u3 is not None and cubic.u3 <= cubic.u[-1]:
        shown.append(cubic.u3)
        assert abs(f(cubic.u3)) < 4 * size
    assert dots.get_xdata() == pytest.approx(shown)
    assert not np.any(dots.get_ydata())


# The phase plane.


@pytest.mark.parametrize("path", NUTATING, ids=lambda path: path.stem)
def test_the_orbit_in_the_phase_plane_keeps_the_energy(path: Path) -> None:
    scene = sample_motion(path)
    portrait = phase_portrait(scene)
    assert portrait.theta.min() == pytest.approx(math.radians(scene.theta_min_deg or 0), abs=1e-14)
    assert portrait.theta.max() == pytest.approx(math.radians(scene.theta_max_deg or 0), abs=1e-14)
    assert portrait.rate.max() == pytest.approx(-portrait.rate.min(), rel=1e-3)
    assert (portrait.rate[1] > 0) == bool(scene.a)  # it falls; without torque it starts lowest
    stable = scene.b**2 >= 2 * scene.a
    assert (portrait.separatrix[0].size == 0) == stable
    assert portrait.why.startswith("no separatrix: the upright top is stable") == stable
    u, top = np.cos(portrait.theta), scene.top
    around = float(top.psidot0) * math.sin(portrait.start[0]) ** 2
    beta = around + scene.b * u[0]
    turning = (beta - scene.b * u) / np.sin(portrait.theta)
    energy = portrait.rate**2 + turning**2 + scene.a * u
    rounding = 1e-15 * abs(turning) * (abs(beta) + abs(scene.b)) / np.sin(portrait.theta)
    assert (abs(energy - energy[0]) <= 1e-12 * (abs(energy[0]) + scene.a) + rounding).all()


def test_the_separatrix_is_where_upright_tops_go() -> None:
    """A top at rest 1e-7 degrees off the vertical follows it."""
    near = solve(Top(r0=30.0, theta0_deg=1e-7))
    theta, rate = separatrix_orbit(near.a, near.b)
    assert theta[0] == rate[0] == 0
    assert theta[-1] == pytest.approx(math.radians(near.theta_max_deg or 0), abs=1e-12)
    orbit = phase_portrait(near)
    lowest = int(np.argmax(orbit.theta))
    falling = np.interp(theta, orbit.theta[: lowest + 1], orbit.rate[: lowest + 1])
    inner = (theta > 0.01) & (theta < 0.99 * theta[-1])
    assert inner.sum() > 100
    assert rate[inner] == pytest.approx(falling[inner], rel=2e-3)


@pytest.mark.parametrize("name", REGIMES)
def test_the_phase_picture_shows_the_orbit_and_the_start(name: str) -> None:
    scene = regime_motion(name)
    portrait, lines = phase_portrait(scene), drawn(scene, ["phase"]).axes[0].lines
    shown = {str(line.get_label()): line for line in lines}
    orbit = np.asarray(shown["this motion"].get_data())
    assert orbit == pytest.approx(np.stack([np.degrees(portrait.theta), portrait.rate]))
    start = np.asarray(shown["start"].get_data()).ravel()
    assert start == pytest.approx([float(scene.top.theta0_deg or 0), float(scene.top.thetadot0)])
    assert bool(np.size(shown[portrait.why].get_xdata())) == bool(portrait.separatrix[0].size)


# The map.


def test_the_map_holds_what_solve_says() -> None:
    x, y = parse_input_range("x", "r0=20:100:5"), parse_input_range("y", "theta0=10:90:3")
    chart = key_map(solve(Top()), PlotRequest(key="T_nutation", x=x, y=y))
    assert chart.values.shape == (3, 5)
    exact = solve(Top(r0=40.0, theta0_deg=90.0)).T_nutation
    assert chart.values[2, 1] == pytest.approx(exact, rel=2**-51, abs=0)  # of a sweep: 10 eps
    threshold = math.sqrt(4 * 39032 * 1587 * 981 * 4) / 17458
    assert chart.sleeping[0] == pytest.approx(x.values / threshold, rel=1e-14)
    figure = drawn(solve(Top()), ["map"], PlotRequest(key="T_nutation", x=x, y=y))
    axes = figure.axes[0]
    contour = axes.collections[-1].get_paths()[0].vertices
    assert np.asarray(contour)[:, 0] == pytest.approx(threshold, rel=1e-6)
    values = np.asarray(axes.collections[0].get_array())
    assert np.array_equal(values.reshape(3, 5), chart.values)
    ring = next(line for line in axes.lines if line.get_label() == "this scene")
    assert [*np.ravel(ring.get_xdata()), *np.ravel(ring.get_ydata())] == [50.0, 30.0]


def test_the_map_of_a_scene_in_radians() -> None:
    top = solve(Top(theta0_rad=0.05))
    x, y = parse_input_range("x", "r0=20:100:2"), parse_input_range("y", "theta0=10:90:2")
    chart = key_map(top, PlotRequest(key="theta_min_deg", x=x, y=y))
    assert chart.values.tolist() == [[10, 10], [90, 90]]


def test_a_map_over_equal_factors() -> None:
    """The axes are logarithmic, and each value is in the middle of its cell there."""
    x, y = parse_input_range("x", "r0=log:1:10000:3"), parse_input_range("y", "theta0=10:90:2")
    assert x.values == pytest.approx([1, 100, 10000], rel=1e-15)
    axes = drawn(solve(Top()), ["map"], PlotRequest(x=x, y=y)).axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "linear")
    mesh: Any = axes.collections[0]
    edges = np.asarray(mesh.get_coordinates())
    assert edges[0, :, 0] == pytest.approx([0.1, 10, 1000, 100000])
    assert edges[:, 0, 1] == pytest.approx([-30, 50, 130])


def test_the_progress_of_a_map_is_told_in_tops() -> None:
    seen: list[int] = []

    def progress(
        parts: Iterable[Any], label: str, total: int | None = None, size: Any = len
    ) -> Iterator[Any]:
        assert (label, total) == ("tops", 6000)
        for part in parts:
            seen.append(size(part))
            yield part

    x, y = parse_input_range("x", "r0=20:100:2000"), parse_input_range("y", "theta0=10:90:3")
    key_map(solve(Top()), PlotRequest(key="K", x=x, y=y, progress=progress))
    assert seen == [4000, 2000]  # whole rows of at most 4096 tops


def test_maps_that_cannot_be() -> None:
    """The messages of ranges are tested with the command."""
    for key, x, y, message in (
        ("K", "r0=1:2:1001", "theta0=1:2:1000", "x must have at most 1e6 cells together with y"),
        ("regime", "r0=1:2:3", "g=1:2:3", "key must be among [0-9]+ names, got 'regime'"),
        ("K", "r0=1:2:3", "theta0=100:200:3", r"theta0_deg must be in \[0, 180\]"),
    ):
        ranges = parse_input_range("x", x), parse_input_range("y", y)
        with pytest.raises(LagtopError, match=message):
            key_map(solve(Top()), PlotRequest(key=key, x=ranges[0], y=ranges[1]))


@pytest.mark.parametrize(
    ("key", "title"),
    [
        ("T_precession", "Tψ: mean precession period (§8), in time"),
        ("mean_precession_rate", "ψ' mean: mean precession rate (7,3), in rad/time"),
        ("precession_rate_half", "ψ'(T/2): precession rate at T/2 (4,7), in rad/time"),
        ("K_prime", "K': integral, first kind, k' (2,4)"),
        ("theta_max_deg", "ϑ max: greatest tilt (4,9), in deg"),
    ],
)
def test_the_title_of_a_map_names_quantity_and_unit(key: str, title: str) -> None:
    request = PlotRequest(x=parse_input_range("x", "r0=20:80:2"), y=TILTS, key=key)
    (panel,) = drawn(solve(Top()), ["map"], request).subfigs
    assert panel.get_suptitle() == title.replace("(§8)", "§8")


# The sphere.


def test_the_drawn_path_is_the_path() -> None:
    """Every piece lies on the page where the axis is; the far side is drawn paler."""
    scene = solve(Top())
    path = axis_path(scene, turn_span(scene))
    camera = best_camera(path.axis)
    lines = drawn(scene, ["sphere"]).axes[0].collections
    far, near = (x for x in lines if isinstance(x, LineCollection))
    assert far.get_alpha() == 0.35
    points = np.stack(camera.project(path.axis), axis=1)
    shown = np.concatenate(
        [np.asarray(x.get_segments()[i]) for x in (far, near) for i in range(len(x.get_segments()))]
    )
    assert {tuple(p) for p in shown.tolist()} == {tuple(p) for p in points.tolist()}
    assert np.hypot(*points.T).max() <= 1 + 1e-15


def test_a_narrow_path_is_magnified() -> None:
    """The inset shows the first nutations in the angles themselves."""
    assert len(drawn(solve(Top()), ["sphere"]).axes) == 2  # the globe and the bar of colours
    scene = solve(Top(r0=1000.0))
    T = tilt_period(scene)
    assert T
    _, inset, _ = drawn(scene, ["sphere"]).axes
    (lines,) = (x for x in inset.collections if isinstance(x, LineCollection))
    psi, theta = np.concatenate([np.asarray(piece) for piece in lines.get_segments()]).T
    assert theta[0] == pytest.approx(30)
    assert theta.max() == pytest.approx(scene.theta_max_deg, abs=1e-12)
    assert psi[-1] == pytest.approx(np.degrees(scene.angles(3 * T).psi), rel=1e-12)
    start = [float(np.asarray(x)[0]) for x in inset.lines[0].get_data()]
    assert start == [psi[0], theta[0]]


def test_the_eye_is_where_it_was_asked_to_be() -> None:
    """From above, x points down the page and y to the right, and z at the eye."""
    figure = drawn(solve(Top()), ["sphere"], PlotRequest(camera=(0.0, math.pi / 2)))
    texts = [text for text in figure.axes[0].texts if text.get_text()]
    names = {text.get_text(): text.get_position() for text in texts}
    assert names["x"] == pytest.approx((0, -1.34), abs=1e-12)
    assert names["y"] == pytest.approx((1.34, 0), abs=1e-12)
    assert math.hypot(*names["z"]) < 0.2


@pytest.mark.parametrize(("tilt", "above"), [(30, True), (90, True), (150, False)])
def test_the_camera_is_above_unless_the_top_hangs(tilt: float, above: bool) -> None:
    motion = solve(Top(r0=200.0, theta0_deg=tilt))
    assert (best_camera(axis_path(motion, turn_span(motion)).axis).toward[2] > 0) == above


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("r0", [50.0, 1000.0])
def test_arrows_run_with_the_motion(sign: int, r0: float) -> None:
    """Each points the way the axis turns about the vertical, which is that of the spin."""
    motion = solve(Top(r0=sign * r0))
    above = PlotRequest(camera=(0.0, math.pi / 2))
    axes = drawn(motion, ["sphere"], above).axes[0]
    arrows = [x for x in axes.texts if isinstance(x, Annotation) and x.arrow_patch is not None]
    assert arrows
    for arrow in arrows:
        (x0, y0), (x1, y1) = arrow.xyann, arrow.xy
        assert (x0 * y1 - y0 * x1) * sign > 0


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({}, "cusped path"),
        ({"theta0_deg": 0}, "sleeping, unstable"),
        ({"theta0_deg": 0, "r0": 80}, "sleeping, stable"),
        ({"theta0_deg": 180}, "hanging, stable"),
    ],
)
def test_the_globe_says_how_the_top_moves(inputs: dict[str, float], words: str) -> None:
    panel = drawn(solve(Top(**inputs)), ["sphere"]).subfigs[0]
    assert panel.get_suptitle() == f"Figure axis on the unit sphere: {words}"


def test_a_swing_in_a_plane_is_shown_once() -> None:
    motion = solve(Top(r0=0))
    assert sphere_span(motion) == tilt_period(motion)
    assert sphere_span(solve(Top())) == turn_span(solve(Top()))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.25, "0.25"),
        (1.0, "1"),
        (1 - 2**-40, "1 − 9.1e−13"),
        (-1 + 2**-40, "−1 + 9.1e−13"),
        (1 + 2**-40, "1 + 9.1e−13"),
        (-1 - 2**-40, "−1 − 9.1e−13"),
    ],
)
def test_numbers_beside_one_say_by_how_much(value: float, text: str) -> None:
    assert number_text(value) == text


def test_a_peak_does_not_take_all_the_colours() -> None:
    values = np.append(np.linspace(1.0, 2.0, 999), 1e6)
    low, high = colour_limits(values)
    assert (low, high) == pytest.approx((1.01, 1.99), abs=0.01)
    assert colour_limits(np.full(9, 3.0)) == (1.5, 4.5)


def test_contours_stop_at_a_jump_and_not_on_a_slope() -> None:
    x, y = np.meshgrid(np.linspace(0, 1, 40), np.linspace(0, 1, 30))
    assert not jumps(x + y**2, 2.0).any()
    beside = jumps(x + 3 * (x > y), 4.0)
    assert beside.any()
    assert (abs(x - y)[beside] < 0.07).all()
    assert beside[np.abs(x - y) < 0.01].all()
    assert not jumps(np.where(x < 0.5, np.nan, y), 1.0).any()


def test_a_map_in_radians_with_its_own_colours() -> None:
    x, y = parse_input_range("x", "r0=20:100:4"), parse_input_range("y", "theta0=0.2:1.5:3")
    asked = PlotRequest(x=x, y=y, radians=True, key="theta_max_rad", colour_limits=(0.5, 2.0))
    figure = drawn(solve(Top()), ["map"], asked)
    axes, bar = figure.axes
    mesh: Any = axes.collections[0]
    exact = np.radians(solve(Top(r0=20.0, theta0_rad=0.2)).theta_max_deg or 0)
    assert np.asarray(mesh.get_array()).reshape(3, 4)[0, 0] == pytest.approx(exact, rel=1e-14)
    assert mesh.get_clim() == (0.5, 2.0)
    assert (axes.get_ylabel(), bar.get_ylabel()) == (
        "tilt at the start ϑ0 (rad)",
        "theta_max_rad (rad)",
    )
