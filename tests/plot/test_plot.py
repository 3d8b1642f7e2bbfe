"""Pictures: what they show (data, not pixels), the files, and the command."""

from __future__ import annotations

import io
import math
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import oracle
import pytest
from conftest import ROOT, Lagtop, process
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from lagrange_cli import LagtopError, Motion, Regime, Top, solve
from lagrange_cli.arithmetic.types import Array
from lagrange_cli.cli.options import solved as motion_of
from lagrange_cli.cli.plot import KINDS as NAMES
from lagrange_cli.plot import curves
from lagrange_cli.plot import film as animation
from lagrange_cli.plot import key_map as keymap
from lagrange_cli.plot import view as globe
from lagrange_cli.plot.kinds import KINDS, Wish
from lagrange_cli.plot.page import Page, draw_page, page_bytes, styled
from lagrange_cli.plot.phase import cubic_curve, phase_portrait, separatrix
from lagrange_cli.plot.style import DARK, LIGHT, Look

SAMPLES = sorted((ROOT / "sample_inputs").glob("*.toml"))
UNIT: dict[str, float] = {"m": 1, "A": 1, "C": 1, "s": 1, "g": 1}
REGIMES: dict[str, dict[str, float]] = {
    "sleeping": {"theta0_deg": 0},
    "hanging": {"theta0_deg": 180},
    "torque-free": {"g": 0},
    "torque-free, nodding": {"g": 0, "psidot0": 3},
    "plane pendulum": {"r0": 0},
    "spherical pendulum": {"r0": 0, "psidot0": 3},
    "over the upper pole": {"theta0_deg": 0, "thetadot0": 2, "r0": 20},
    "separatrix": {**UNIT, "A": 2, "theta0_deg": 90, "thetadot0": 1, "r0": 0},
    "steady precession": {**UNIT, "theta0_deg": 90, "r0": 1, "psidot0": 1},
    "nothing but noise": {"r0": 1e9},
}


def motion(path: Path) -> Motion:
    return motion_of(str(path), False, False, {})


def drawn(scene: Motion, kinds: Sequence[str], wish: Wish | None = None) -> Figure:
    """The figure with its artists."""
    with styled(LIGHT):
        figure = Figure(layout="constrained")
        draw_page(figure, Page(scene, kinds, wish or Wish(), LIGHT))
    return figure


# The curves.


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_the_path_is_on_the_sphere_and_touches_both_circles(path: Path) -> None:
    scene = motion(path)
    course = curves.axis_path(scene, curves.turn_span(scene))
    tilt = np.arctan2(np.hypot(course.axis[:, 0], course.axis[:, 1]), course.axis[:, 2])
    assert np.abs(np.linalg.norm(course.axis, axis=1) - 1).max() < 1e-15 * 4
    assert tilt.min() == pytest.approx(course.least, abs=1e-14)
    assert tilt.max() == pytest.approx(course.greatest, abs=1e-14)
    assert (np.diff(course.t) > 0).all()


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_the_path_is_smooth(path: Path) -> None:
    """No corner of the polygon is sharp but the cusps: what is drawn is the curve."""
    scene = motion(path)
    course = curves.axis_path(scene, curves.span(scene, 2))
    steps = np.diff(course.axis, axis=0)
    size = np.linalg.norm(steps, axis=1)
    assert size.max() < 0.06
    turn = np.sum(steps[1:] * steps[:-1], axis=1) / (size[1:] * size[:-1])
    T = curves.period(scene)
    assert T
    away = np.abs(course.t[1:-1] / T - np.round(course.t[1:-1] / T)) > 0.02
    seen = np.minimum(size[1:], size[:-1]) > 2e-3  # smaller ones are not visible
    assert turn[away & seen].min(initial=1.0) > math.cos(math.radians(15))


@pytest.mark.parametrize("sign", [1, -1])
def test_cusps_point_up_and_loops_turn_back(sign: int) -> None:
    cusped = solve(Top(r0=sign * 50.0))
    T = curves.period(cusped)
    assert T
    times = curves.highest_times(cusped, 2 * T)
    assert times.tolist() == pytest.approx([0, T, 2 * T], abs=1e-15)
    course = curves.axis_path(cusped, 2 * T)
    i = int(np.argmin(np.abs(course.t - T)))
    assert course.t[i] == pytest.approx(T, abs=1e-15)
    before, cusp, after = course.axis[i - 1 : i + 2]
    assert before[2] < cusp[2] > after[2]
    into, out = cusp - before, after - cusp
    assert into @ out / np.linalg.norm(into) / np.linalg.norm(out) < -0.99  # it turns on the spot
    looping = solve(Top(r0=sign * 50.0, psidot0=sign * -4.0))
    psi = curves.angle_curves(looping, T).psi * sign
    assert np.diff(psi).min() < 0 < np.diff(psi).max()


def test_samples_are_even_in_the_amplitude_and_hold_the_turning_points() -> None:
    scene = solve(Top(r0=0.5, theta0_deg=20.0))
    T = curves.period(scene)
    assert T
    t = curves.phase_times(scene, 2 * T)
    for turning in (0.0, T / 2, T, 1.5 * T, 2 * T):
        assert np.abs(t - turning).min() < 1e-15
    u = curves.sample(scene, t).u
    assert np.abs(np.diff(u)).max() < 0.08  # evenly spaced times would leave gaps of 0.09 and more
    even = curves.sample(scene, np.linspace(0, 2 * T, t.size)).u
    assert np.abs(np.diff(even)).max() > np.abs(np.diff(u)).max()


def test_a_start_between_the_turning_points_is_allowed_for() -> None:
    scene = solve(Top(thetadot0=2.0, psidot0=1.0))
    T = curves.period(scene)
    assert T
    times = curves.highest_times(scene, 3 * T)
    assert times.size == 3
    assert np.degrees(scene.angles(times).theta) == pytest.approx(scene.theta_min_deg, abs=1e-12)


@pytest.mark.parametrize("scene", [(50.0, 30.0), (-50.0, 30.0), (20.0, 120.0)])
def test_remainders_are_those_of_the_paper(scene: tuple[float, float]) -> None:
    """Against (6,4) and (7,4) in 50 digits."""
    r0, tilt = scene
    top = solve(Top(r0=r0, theta0_deg=tilt))
    course = curves.remainder_curves(top, curves.span(top, 2))
    spin, precession = course.remainders()
    judge = oracle.Scene(r0=r0, theta0_deg=tilt)
    constants = oracle.constants(judge)
    for i in range(0, course.t.size, 37):
        t = float(course.t[i])
        _, phi, psi = oracle.angles(judge, t)
        assert spin[i] == pytest.approx(float(phi - constants["mean_spin_rate"] * t), abs=1e-13)
        exact = float(psi - constants["mean_precession_rate"] * t)
        assert precession[i] == pytest.approx(exact, abs=1e-13)


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_the_cubic_is_that_of_the_paper_and_the_roots_sit_on_its_zeros(path: Path) -> None:
    """f(u) drawn from its product form, judged by (4,9) from the start."""
    scene = motion(path)
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
    assert band.sum() > 100
    assert (cubic.f[band] > 0).all()
    axes = drawn(scene, ["cubic"]).axes[0]
    dots = next(line for line in axes.lines if line.get_marker() == "o")
    shown = [cubic.u1, cubic.u2]
    assert cubic.u3
    if cubic.u3 <= cubic.u[-1]:
        shown.append(cubic.u3)
        assert abs(f(cubic.u3)) < 4 * size
    assert dots.get_xdata() == pytest.approx(shown)
    assert not np.any(dots.get_ydata())


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.stem)
def test_the_orbit_in_the_phase_plane_keeps_the_energy(path: Path) -> None:
    scene = motion(path)
    portrait = phase_portrait(scene)
    assert portrait.theta.min() == pytest.approx(math.radians(scene.theta_min_deg or 0), abs=1e-14)
    assert portrait.theta.max() == pytest.approx(math.radians(scene.theta_max_deg or 0), abs=1e-14)
    assert portrait.rate.max() == pytest.approx(-portrait.rate.min(), rel=1e-3)
    assert portrait.rate[1] > 0  # released from rest it falls
    stable = (scene.b**2) / (2 * scene.a) >= 1
    assert (portrait.separatrix is None) == stable
    assert ("≥ 1" in portrait.why) == stable


def test_the_separatrix_is_where_upright_tops_go() -> None:
    """A top at rest 1e-7 degrees off the vertical follows it."""
    near = solve(Top(r0=30.0, theta0_deg=1e-7))
    theta, rate = separatrix(near.a, near.b)
    assert theta[0] == rate[0] == 0
    assert theta[-1] == pytest.approx(math.radians(near.theta_max_deg or 0), abs=1e-12)
    orbit = phase_portrait(near)
    lowest = int(np.argmax(orbit.theta))
    falling = np.interp(theta, orbit.theta[: lowest + 1], orbit.rate[: lowest + 1])
    inner = (theta > 0.01) & (theta < 0.99 * theta[-1])
    assert inner.sum() > 100
    assert rate[inner] == pytest.approx(falling[inner], rel=2e-3)


def test_the_map_holds_what_solve_says() -> None:
    x, y = keymap.parse_axis("--x", "r0=20:100:5"), keymap.parse_axis("--y", "theta0=10:90:3")
    chart = keymap.key_map(solve(Top()), "T_nutation", x, y)
    assert chart.values.shape == (3, 5)
    assert chart.values[2, 1] == solve(Top(r0=40.0, theta0_deg=90.0)).T_nutation
    threshold = math.sqrt(4 * 39032 * 1587 * 981 * 4) / 17458
    assert chart.sleeping[0] == pytest.approx(x.values / threshold, rel=1e-14)
    figure = drawn(solve(Top()), ["map"], Wish(key="T_nutation", x=x, y=y))
    axes = figure.axes[0]
    contour = axes.collections[-1].get_paths()[0].vertices
    assert np.asarray(contour)[:, 0] == pytest.approx(threshold, rel=1e-6)
    values = np.asarray(axes.collections[0].get_array())
    assert np.array_equal(values.reshape(3, 5), chart.values)


def test_the_map_of_a_scene_in_radians() -> None:
    top = solve(Top(theta0_rad=0.05))
    x, y = keymap.parse_axis("--x", "r0=20:100:2"), keymap.parse_axis("--y", "theta0=10:90:2")
    chart = keymap.key_map(top, "theta_min_deg", x, y)
    assert chart.values.tolist() == [[10, 10], [90, 90]]


# The globe.


def test_the_view_is_a_rotation_and_the_start_is_in_sight() -> None:
    for path in SAMPLES:
        scene = motion(path)
        axis = curves.axis_path(scene, curves.turn_span(scene)).axis
        view = globe.best_view(axis)
        assert np.stack(view) @ np.stack(view).T == pytest.approx(np.eye(3), abs=1e-15)
        assert np.cross(view.right, view.up) == pytest.approx(view.toward, abs=1e-15)
        assert view.up[2] > 0
        assert view.faces(axis)[0]


def test_the_drawn_path_is_the_path() -> None:
    """Every piece lies on the page where the axis is; the far side is drawn paler."""
    scene = solve(Top())
    path = curves.axis_path(scene, curves.turn_span(scene))
    view = globe.best_view(path.axis)
    lines = drawn(scene, ["sphere"]).axes[0].collections
    far, near = (x for x in lines if isinstance(x, LineCollection))
    assert far.get_alpha() == 0.35
    points = np.stack(view.project(path.axis), axis=1)
    shown = np.concatenate(
        [np.asarray(x.get_segments()[i]) for x in (far, near) for i in range(len(x.get_segments()))]
    )
    assert {tuple(p) for p in shown.tolist()} == {tuple(p) for p in points.tolist()}
    assert np.hypot(*points.T).max() <= 1 + 1e-15


def test_the_top_of_the_film_stands_on_its_axis() -> None:
    view = globe.view_from(0.3, 0.4)
    top = globe.seen_top(0.5, 1.0, 2.0, view)
    axis = np.array([math.sin(0.5) * math.sin(2), -math.sin(0.5) * math.cos(2), math.cos(0.5)])
    assert np.stack(top.axle, axis=1)[1] == pytest.approx(np.stack(view.project(axis)))
    assert top.lid_in_sight
    assert sum(face.on_lid for face in top.faces) == globe.WEDGES
    away = globe.seen_top(math.pi - 0.5, 1.0, 2.0, globe.view_from(0.3, 1.4))
    assert not away.lid_in_sight
    spun = globe.seen_top(0.5, 1.0 + math.pi / 3, 2.0, view)
    lid = [[f.light for f in x.faces if f.on_lid] for x in (top, spun)]
    assert len(lid[0]) == len(lid[1])


# The page and its files.


@pytest.mark.parametrize(
    ("path", "style"), [*((path, LIGHT) for path in SAMPLES), (SAMPLES[0], DARK)]
)
def test_every_kind_of_every_sample(path: Path, style: Look) -> None:
    """Warnings are errors, those of missing glyphs and of failed layouts too."""
    x, y = keymap.parse_axis("--x", "r0=20:100:4"), keymap.parse_axis("--y", "theta0=10:90:3")
    page = Page(motion(path), list(KINDS), Wish(x=x, y=y, radians=style is DARK), style)
    assert page_bytes(page, "png", 40).startswith(b"\x89PNG")


@pytest.mark.parametrize("name", REGIMES)
def test_every_regime(name: str) -> None:
    scene = solve(Top(**REGIMES[name]))
    assert name == scene.regime.value or name not in {regime.value for regime in Regime}
    page = Page(scene, ["sphere", "angles", "remainders", "cubic", "phase"], Wish(), LIGHT)
    assert page_bytes(page, "png", 40).startswith(b"\x89PNG")
    if not curves.period(scene):
        with pytest.raises(LagtopError, match=r"no remainders: .* has no nutation period"):
            page_bytes(page._replace(kinds=["remainders"]), "png", 40)


@pytest.mark.parametrize(
    ("style", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_files_are_the_same_every_time(style: str, start: bytes) -> None:
    page = Page(solve(Top()), ["sphere", "cubic"], Wish(), LIGHT)
    first, second = (page_bytes(page, style, 50) for _ in range(2))
    assert first == second
    assert first.startswith(start)
    assert not re.search(rb"20\d\d-\d\d|CreationDate|matplotlib v", first)


def test_letters_shrink_with_the_page_and_fit_it() -> None:
    page = Page(solve(Top()), ["sphere", "phase"], Wish(), LIGHT, (7.35, 2.5))
    assert page.lettering() == pytest.approx(0.5)
    with styled(LIGHT, page.lettering()):
        figure = Figure(figsize=page.inches(), layout="constrained")
        draw_page(figure, page)
        figure.savefig(io.BytesIO(), format="png")
        boxes = [text.get_window_extent() for text in figure.subfigs[0].texts[1:]]
    keys, values = boxes[::2], boxes[1::2]
    assert all(key.x1 < value.x0 for key, value in zip(keys, values, strict=True))
    assert all(upper.y0 > lower.y0 for upper, lower in pairwise(keys))


def test_the_numbers_of_the_sheet(lagtop: Lagtop) -> None:
    figure = drawn(solve(Top()), ["sphere", "angles"])
    texts = {text.get_text() for text in figure.subfigs[0].texts}
    assert {"T_nutation", "0.4292501", "mean_precession_rate", "7.991055", "cusped"} <= texts


def _seen(colour: str, matrix: Sequence[Sequence[float]]) -> Array:
    """CIELAB of a colour as it is seen through a simulation in linear RGB."""
    rgb = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    linear = np.clip(np.array(matrix) @ linear, 0, 1)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = np.cbrt(np.maximum(np.array(to_xyz) @ linear / [0.9505, 1, 1.089], 1e-6))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


VISIONS: dict[str, list[list[float]]] = {  # Machado, Oliveira and Fernandes (2009), severity 1
    "normal": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "protan": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deutan": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritan": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("style", [LIGHT, DARK], ids=["light", "dark"])
def test_the_colours_differ_for_everybody(style: Look, vision: str) -> None:
    seen = [_seen(colour, VISIONS[vision]) for colour in (*style.lines, style.paper)]
    distances = [float(np.linalg.norm(p - q)) for i, p in enumerate(seen) for q in seen[i + 1 :]]
    assert min(distances) > 15


# The command.


def test_the_command_knows_the_kinds() -> None:
    assert tuple(KINDS) == NAMES


def test_kinds_and_scene_in_any_order(lagtop: Lagtop, tmp_path: Path) -> None:
    scene = str(ROOT / "sample_inputs" / "looping-top.toml")
    files = [tmp_path / "a.svg", tmp_path / "b.svg"]
    for words, file in (([scene, "cubic"], files[0]), (["cubic", scene], files[1])):
        result = lagtop("plot", *words, "-o", file)
        assert (result.exit_code, result.output) == (0, "")
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize(
    ("line", "code", "message"),
    [
        ("", 2, "nothing to do: give -o FILE.png, --show or --animate FILE.gif"),
        ("spere -o x.png", 2, "KIND must be among sphere angles"),
        ("nowhere.toml -o x.png", 65, "nowhere.toml: No such file"),
        ("-o x.jpg", 2, "-o must be a file that ends in .png or .svg or .pdf, got 'x.jpg'"),
        ("-o x.png --size 8", 2, "--size must be WIDTHxHEIGHT, each in [2, 50] inches, got '8'"),
        ("-o x.png --size 1x900", 2, "--size must be WIDTHxHEIGHT"),
        ("-o x.png --dpi 1e9", 2, "--dpi must be in [20, 1000], got 1e+09"),
        ("-o x.png --dpi 1000 --size 50x50", 2, "--dpi must be at most 141 at this --size"),
        ("-o x.png --t-max 0", 2, "--t-max must be > 0, got 0"),
        ("-o x.png --t-max 1e6", 2, "--t-max must be at most 1000 nutation periods = 429.25"),
        ("-o no/where.png cubic", 74, "cannot write no/where.png: No such file"),
        ("remainders --theta0 0 -o x.png", 2, "no remainders: sleeping has no nutation period"),
        ("map --key colour -o x.png", 2, "--key must be among"),
        ("map --x r0=1:2 -o x.png", 2, "--x must be a range [log:]start:stop:count, got '1:2'"),
        ("map --x q=1:2:3 -o x.png", 2, "--x must begin with one of m A C s g r0"),
        ("map --x r0=2:1:3 -o x.png", 2, "--x must have start < stop"),
        ("map --x r0=1:2:1 -o x.png", 2, "--x must have a count of 2 or more between"),
        ("map --x r0=1:z:9 -o x.png", 2, "--x must be a finite decimal number, got 'z'"),
        ("map --x theta0=1:2:3 -o x.png", 2, "--x and --y must be different inputs"),
        ("--animate x.avi", 2, "--animate must be a file that ends in .gif or .mp4, got 'x.avi'"),
    ],
)
def test_bad_input(  # noqa: PLR0917
    lagtop: Lagtop,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    line: str,
    code: int,
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    result = lagtop("plot", *line.split())
    assert result.exit_code == code
    assert result.stdout == ""
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_the_help_needs_no_matplotlib_and_a_picture_says_how_to_get_it(tmp_path: Path) -> None:
    code = "import sys; sys.modules['matplotlib'] = None; from lagrange_cli.cli import main; main()"
    line = [sys.executable, "-c", code, "plot"]
    helped = subprocess.run([*line, "--help"], capture_output=True, check=True)
    assert helped.stdout.startswith(b"Examples:")
    target = tmp_path / "x.png"
    target.write_text("old")
    failed = subprocess.run([*line, "-o", str(target)], capture_output=True, check=False)
    assert failed.returncode == 2
    assert failed.stderr == b"Error: pictures need matplotlib: pip install 'lagtop[plot]'\n"
    assert target.read_text() == "old"


def test_no_window_without_a_display() -> None:
    bare = {key: x for key, x in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    for backend in ({}, {"MPLBACKEND": "tkagg"}):
        result = process("plot", "--show", check=False, env=bare | backend)
        assert result.returncode == 2
        assert result.stderr.startswith(b"Error: --show")
        assert result.stderr.count(b"\n") == 1


def test_a_film(lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from PIL import Image

    monkeypatch.setattr(animation, "FRAMES", 5)
    files = [tmp_path / "a.gif", tmp_path / "b.gif"]
    for file in files:
        assert lagtop("plot", "--animate", file, "--dpi", "40").output == ""
    with Image.open(files[0]) as film:
        assert getattr(film, "n_frames", 1) == 5
        assert film.size == (192, 200)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_mp4_needs_ffmpeg(lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    result = lagtop("plot", "--animate", tmp_path / "x.mp4")
    assert result.exit_code == 2
    assert result.stderr == (
        "Error: --animate FILE.mp4 needs ffmpeg on the PATH (or write FILE.gif)\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_the_pictures_of_the_readme(lagtop: Lagtop, tmp_path: Path) -> None:
    """Each is what the command beside it makes, and small."""
    lines = re.findall(
        r"^lagtop (plot .*-o (sample_inputs/images/\S+))$",
        (ROOT / "README.md").read_text(),
        re.MULTILINE,
    )
    assert len(lines) == 3
    for line, name in lines:
        words = shlex.split(line)
        words[-1] = str(tmp_path / Path(name).name)
        words = [str(ROOT / word) if word.endswith(".toml") else word for word in words]
        assert lagtop(*words).exit_code == 0
        assert (ROOT / name).stat().st_size < 150_000
        assert f"({name})" in (ROOT / "README.md").read_text()
        assert Path(words[-1]).stat().st_size == pytest.approx(
            (ROOT / name).stat().st_size, rel=0.3
        )
