"""Pictures: what is drawn is the motion, nothing warns, and bad requests end in one line."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import Lagtop
from lagtop import LagtopError, Motion, Top, draw, read_scene, solve

pytest.importorskip("matplotlib")
from matplotlib.figure import Figure
from PIL import Image

from lagrange_cli.plot.film import cone
from lagrange_cli.plot.pictures import (
    PICTURES,
    Options,
    camera_of,
    figure_of,
    project,
    sampled,
    usual_span,
)
from lagrange_cli.plot.reports import draw_errors
from lagrange_cli.plot.style import LIGHT, figure_bytes, plain, styled


def drawn(kind: str, motion: Motion, **options: Any) -> Figure:
    """Return the figure of one picture."""
    with styled(LIGHT):
        return figure_of({"": motion}, [kind], Options(**options))


def test_the_path_is_that_of_the_axis() -> None:
    motion = solve(Top())
    with styled(LIGHT):
        figure = figure_of({"": motion}, ["sphere"], Options(camera=(0.3, 0.5), t_max=1.0))
    sides: Any = figure.axes[0].collections[:2]
    found = np.concatenate([x for side in sides for x in side.get_segments() if len(x)])
    axis = motion.axis(np.linspace(0, 1, 8000))
    exact = axis @ camera_of(axis, Options(camera=(0.3, 0.5)))[:2].T
    distance = np.abs(found[:, None] - exact[None]).sum(axis=2).min(axis=1)
    assert distance.max() < 2e-3
    assert len(found) > 100


def test_the_camera_is_in_front_of_the_path() -> None:
    motion = solve(read_scene("wavy-top"))
    path = motion.axis(np.linspace(0, 0.3, 50))
    (x, y), far = (side.T for side in project(camera_of(path, Options()), path))
    assert np.isnan(far).all()
    assert np.abs(x).mean() < 0.3
    assert y.min() > 0


def test_spin_is_drawn_as_its_deviation_from_the_mean_rate() -> None:
    motion = solve(Top())
    tilt, spin, precession = drawn("angles", motion).axes[:3]
    t, deviation = (np.asarray(x) for x in spin.get_lines()[0].get_data())
    exact = motion.angles(t)
    assert deviation == pytest.approx(
        np.degrees(exact.phi - (motion.mean_spin_rate or 0) * t), abs=1e-9
    )
    assert tilt.get_lines()[0].get_ydata() == pytest.approx(np.degrees(exact.theta))
    assert precession.get_lines()[1].get_ydata() == pytest.approx(np.degrees(exact.psi))
    assert spin.get_ylabel() == "Δφ (deg)"


def test_bands_are_one_standard_deviation_wide() -> None:
    figure = drawn("angles", solve(Top()), stds=lambda t: [0.01 + 0 * t] * 3)
    band = figure.axes[0].collections[0].get_paths()[0].vertices
    assert np.ptp(np.asarray(band)[:, 1]) > 43.9
    first = np.asarray(band)[np.asarray(band)[:, 0] == 0.0, 1]
    assert np.ptp(first) == pytest.approx(np.degrees(0.02), rel=1e-6)


def test_the_cubic_is_f_of_u() -> None:
    motion = solve(Top(psidot0=1, thetadot0=2))
    axes = drawn("cubic", motion).axes[0]
    u, f = (np.asarray(x) for x in axes.get_lines()[1].get_data())
    theta0, a, b = math.radians(30), motion.a or 0, motion.b or 0
    beta = math.sin(theta0) ** 2 + b * math.cos(theta0)
    alpha = 4 + math.sin(theta0) ** 2 + a * math.cos(theta0)
    exact = (alpha - a * u) * (1 - u * u) - (beta - b * u) ** 2  # (4,9)
    assert f == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    assert "u₁ = 0.8" in axes.get_xlabel()


def test_the_phase_plane_holds_the_separatrix() -> None:
    axes = drawn("phase", solve(Top())).axes[0]
    tilt, rate = (np.asarray(x) for x in axes.get_lines()[3].get_data())
    top = solve(Top(theta0_deg=0.001, thetadot0=0))
    largest = np.degrees(max(top.angles(np.linspace(0, top.T_nutation or 1, 2000)).theta))
    assert tilt.max() == pytest.approx(largest, rel=1e-4)
    assert rate[0] == 0


def test_sampled_curves_are_smooth() -> None:
    motion = solve(read_scene("slow-top"))
    _, *axis = sampled(motion, usual_span(motion, 3, 40), ["axis"])
    steps = np.diff(np.stack(axis, axis=1), axis=0)
    size = np.linalg.norm(steps, axis=1)
    turn = np.sum(steps[1:] * steps[:-1], axis=1) / (size[1:] * size[:-1])
    assert np.degrees(np.arccos(np.clip(turn, -1, 1)))[size[1:] > 1e-2].max() < 20
    assert usual_span(motion, 2, 2) == 2 * (motion.T_nutation or 0)


def test_a_map_shows_the_number_of_each_top() -> None:
    r0, tilt = np.geomspace(20, 50, 20), np.linspace(0.5, 2.5, 20)
    figure = drawn(
        "map", solve(Top()), key="theta_max_deg", radians=True, x=("r0", r0), y=("theta0", tilt)
    )
    axes = figure.axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "linear")
    assert axes.get_ylabel().endswith("(rad)")
    legend: Any = axes.get_legend()
    assert [x.get_text() for x in legend.get_texts()] == ["this scene"]  # all below the border
    lines: Any = axes.collections[1]
    found = [(x, path.vertices) for x, path in zip(lines.levels, lines.get_paths(), strict=True)]
    exact = {x: solve(Top(r0=at[0][0], theta0_rad=at[0][1])) for x, at in found if len(at)}
    assert len(exact) > 4
    assert [math.radians(top.theta_max_deg) for top in exact.values()] == pytest.approx(
        [*exact], rel=2e-3
    )


def test_names_from_outside_are_plain_text() -> None:
    assert plain("a$b\x1b[31m\n") == r"a\$b [31m "
    error = np.array([1e-3, 1e-2, np.nan])
    result = SimpleNamespace(file="$x_1$", t=np.arange(3.0), error=error, step=None)
    figure = draw_errors([result], 1e-3)
    legend = figure.axes[0].get_legend()
    assert legend
    assert legend.get_texts()[0].get_text() == r"\$x_1\$"


def test_the_axle_of_the_film_is_the_figure_axis() -> None:
    motion = solve(Top())
    axis = motion.axis([0.3])
    camera = camera_of(axis, Options())
    attitude = np.array([*motion.table(0.3, ["quaternion"]).values()])
    triangles, shades, rim = cone(attitude, camera, LIGHT)
    assert len(triangles) == len(shades) > 30
    assert rim[1:].mean(axis=0) == pytest.approx(0.62 * (camera[:2] @ axis[0]))


@pytest.mark.slow
def test_a_film_has_the_frames_of_its_duration(lagtop: Lagtop, tmp_path: Path) -> None:
    path = tmp_path / "top.gif"
    assert lagtop("plot", "--animate", path, "--duration", "0.4", "--dpi", 40).exit_code == 0
    with Image.open(path) as film:
        assert getattr(film, "n_frames", 0) == 10
        assert film.size == (192, 208)


@pytest.mark.parametrize("fmt", ["png", "svg", "pdf"])
def test_files_hold_a_title_and_a_description(fmt: str) -> None:
    figure = drawn("phase", solve(Top()))
    with styled(LIGHT):
        data = figure_bytes(figure, fmt, 40, "a title", "two < three")
    assert data[:4] in {b"\x89PNG", b"<?xm", b"%PDF"}
    if fmt == "svg":
        assert b"two &lt; three" in data
        assert b"<text" in data
    if fmt == "png":
        with pytest.raises(LagtopError, match="dpi must be at most"):
            figure_bytes(figure, fmt, 5000, "a title", "")


def test_pictures_are_drawn_on_axes_of_the_user() -> None:
    figure = Figure()
    (axes,) = draw(solve(Top()), "phase", figure.subplots(), t_max=None, radians=True)
    assert axes.get_xlabel() == "tilt ϑ (rad)"
    with pytest.raises(LagtopError, match="ax must be 3 axes, got 1"):
        draw(solve(Top()), "angles", figure.subplots())
    with pytest.raises(LagtopError, match="kind must be among sphere"):
        draw(solve(Top()), "spheer")
    with pytest.raises(LagtopError, match="need the kind map"):
        draw(solve(Top()), "phase", key="a")
    assert set(PICTURES) == {"sphere", "angles", "cubic", "phase", "map"}


def test_axes_with_units_convert_the_body(lagtop: Lagtop, monkeypatch: Any) -> None:
    shown: list[Any] = []

    def figure_of(motions: Any, _: object, options: Any) -> None:
        shown.extend([motions[""].top, options.x, options.y])
        raise LagtopError("enough")

    monkeypatch.setattr("lagrange_cli.plot.pictures.figure_of", figure_of)
    lagtop("plot", "map", "--x", "m=1000:2000:3 g", "--y", "theta0=0.5:1:2 rad", "-o", "x.png")
    top, (x, masses), (_, tilts) = shown
    assert (top.m, top.s, x, masses.tolist()) == (1.587, 0.04, "m", [1.0, 1.5, 2.0])
    assert tilts.tolist() == pytest.approx([28.64788975654116, 57.29577951308232], rel=1e-15)


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["sphere"], "nothing to do"),
        (["-o", "x.bmp"], "must end in .png, .svg or .pdf"),
        (["-o", "none/x.png"], "no such directory"),
        (["sphere", "nosuch", "-o", "x.png"], "nosuch"),
        (["sphere", "-o", "x.png", "--key", "a"], "need map"),
        (["map", "-o", "x.png", "--key", "nosuch"], "nosuch"),
        (["map", "-o", "x.png", "--x", "r0=1:2"], "--x"),
        (["map", "-o", "x.png", "--x", "m=1:2:3 kg", "--r0", "50"], "--r0 must have a unit"),
        (["map", "-o", "x.png", "--x", "m=1:2:3 s"], "--x must have a unit such as kg or g"),
        (["map", "-o", "x.png", "--x", "q0=1:2:3"], "--x must be among"),
        (["map", "-o", "x.png", "--x", "r0=9:2:3"], "start < stop"),
        (["map", "-o", "x.png", "--x", "theta0=1:9:3"], "two inputs"),
        (["map", "-o", "x.png", "--g", "0", "--key", "u3"], "undefined"),
        (["sphere", "-o", "x.png", "--camera", "1,95"], "--camera must be"),
        (["sphere", "-o", "x.png", "--t-max", "-1"], "t-max"),
        (["sphere", "-o", "x.png", "--t-max", "1e9"], "nutation periods"),
        (["sphere", "-o", "x.png", "--dpi", "5"], "--dpi must be in [20, 1000]"),
        (["sphere", "-o", "x.png", "--duration", "5"], "--duration needs --animate"),
        (["sphere", "--animate", "x.avi"], "must end in .gif or .mp4"),
        (["sphere", "--animate", "x.gif", "--duration", "500"], "duration must be in"),
        (["sphere", "looping-top", "wavy-top", "--animate", "x.gif"], "films one scene"),
        (["view"], "nothing to do"),
        (["view", "-o", "top.pdf"], "must be a file that ends in .html"),
        (["view", "-o", "top.html", "--r0", "1e40"], "r0 must be from 1e-30 to 1e30"),
    ],
)
def test_bad_requests_end_in_one_line(
    lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, args: list[str], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    done = lagtop(*args) if args[0] == "view" else lagtop("plot", *args)
    assert done.exit_code in {1, 2, 65, 74}
    assert said in done.stderr
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_the_command_writes_the_sheet_and_three_scenes(lagtop: Lagtop, tmp_path: Path) -> None:
    sheet, three = tmp_path / "sheet.png", tmp_path / "three.svg"
    assert lagtop("plot", "-o", sheet, "--dpi", 40).exit_code == 0
    scenes = ("cusped-top", "looping-top", "wavy-top")
    assert lagtop("plot", "sphere", *scenes, "-o", three).exit_code == 0
    text = three.read_text()
    assert [text.index(f"{name}: Figure axis") for name in scenes] == sorted(
        text.index(f"{name}: Figure axis") for name in scenes
    )
    for name, path in zip(scenes, ("cusped", "looping", "wavy"), strict=True):
        assert solve(read_scene(name)).path == path
