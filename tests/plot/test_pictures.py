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
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image

from lagrange_cli.plot import SHEET
from lagrange_cli.plot.film import film_figure, pace_of
from lagrange_cli.plot.pictures import (
    PICTURES,
    Options,
    camera_of,
    columns_on_slide,
    figure_of,
    last_time,
    sampled,
)
from lagrange_cli.plot.reports import draw_errors, draw_fit
from lagrange_cli.plot.style import DARK, LIGHT, Look, figure_bytes, styled
from lagrange_cli.top.units import Units


def drawn(kind: str, *motions: Motion, title: str | None = None, **options: Any) -> Any:
    """Return the figure of one kind of picture."""
    chosen = Options(**options)
    with styled(chosen.look):
        return figure_of(
            [(f"dir/{i}.toml", x) for i, x in enumerate(motions)], [kind], chosen, title
        )


def data(line: Any) -> tuple[Any, Any]:
    """Return x and y of a line."""
    x, y = (np.asarray(each, float) for each in line.get_data())
    return x, y


def labelled(axes: Any) -> dict[str, Any]:
    """Return the lines of some axes with a label, by label, and the texts by their words."""
    lines = {str(x.get_label()): x for x in axes.get_lines()}
    return lines | {x.get_text(): x for x in axes.texts}


# --- sphere


def test_the_path_is_that_of_the_axis() -> None:
    motion, options = solve(Top()), Options(camera=(0.3, 0.5), t_max=1.0)
    (axes, bar) = drawn("sphere", motion, **options._asdict()).axes
    far, near = (x for x in axes.collections[:2])
    camera = camera_of(motion.axis([0.0]), options)
    times = np.linspace(0, 1, 8000)
    right, up, toward = camera @ motion.axis(times).T
    for side, is_side in ((near, toward >= -0.01), (far, toward <= 0.01)):
        found = np.concatenate([x for x in side.get_segments() if len(x)])
        exact = np.stack([right, up], axis=1)[is_side]
        assert np.abs(found[:, None] - exact[None]).sum(axis=2).min(axis=1).max() < 2e-3
        whole = max(len(x) for x in side.get_segments())
        for piece, t in zip(side.get_segments(), side.get_array(), strict=True):
            if len(piece) == whole:  # others begin where the path comes to this side
                assert piece[0, 0] == pytest.approx(np.interp(t, times, right), abs=2e-3)
    assert bar.get_ylabel() == "t (input units)"
    arrows = [x for x in axes.get_lines() if isinstance(x.get_marker(), tuple)]
    assert len(arrows) == len({data(arrow)[0].item() for arrow in arrows}) == 5
    for arrow in arrows:
        (x,), (y,) = data(arrow)
        turn: Any = arrow.get_marker()
        if np.isfinite(x):
            i = np.argmin(np.abs(right - x) + np.abs(up - y))
            step = complex(right[i + 1] - right[i], up[i + 1] - up[i])
            assert (step / 1j / np.exp(1j * math.radians(turn[2]))).real > 0.9 * abs(step)


def test_the_globe_shows_axes_limits_and_the_start() -> None:
    motion = solve(Top())
    axes = drawn("sphere", motion, camera=(0.3, 0.5)).axes[0]
    camera, shown = camera_of(motion.axis([0.0]), Options(camera=(0.3, 0.5))), labelled(axes)
    assert np.linalg.det(camera) == pytest.approx(1)
    toward = math.cos(0.5) * math.cos(0.3), math.cos(0.5) * math.sin(0.3), math.sin(0.5)
    assert camera[2] == pytest.approx(toward)
    assert camera[0] == pytest.approx([-math.sin(0.3), math.cos(0.3), 0])  # x, y, z turn right
    assert data(shown["start"])[1] == pytest.approx(camera[1] @ motion.axis([0.0])[0])
    for name, tilt in (("ϑ min 30°", motion.theta_min_deg), ("ϑ max 73.92°", motion.theta_max_deg)):
        x, _ = data(shown[name])
        assert np.nanmax(x) == pytest.approx(math.sin(math.radians(tilt)), abs=1e-4)
    assert shown["z"].get_position() == pytest.approx((0.0, 1.24 * math.cos(0.5)))
    assert [*shown["z"].xy] == [0, 0]  # where its arrow begins
    assert "ϑ max 1.29 rad" in labelled(drawn("sphere", motion, units=Units(radians=True)).axes[0])
    still = drawn("sphere", solve(read_scene("sleeping-top")))
    shown, eye = labelled(still.axes[0]), camera_of(np.array([[0.0, 0.0, 1.0]]), Options())
    assert "the axis stays here" in shown
    assert [shown[x].get_position() for x in "xyz"] == [pytest.approx(x) for x in 1.24 * eye[:2].T]
    assert still.axes[0].get_title("left") == "sleeping, stable"


@pytest.mark.parametrize("names", [["looping-top"], ["cusped-top", "looping-top", "wavy-top"]])
def test_spheres_fill_the_picture_with_one_colour_bar(names: list[str]) -> None:
    motions = [solve(read_scene(name)) for name in names]
    figure = drawn("sphere", *motions)
    *axes, bar = figure.axes
    assert len(axes) == len(names)
    last = max(x.collections[1].get_clim()[1] for x in axes)
    for each, motion in zip(axes, motions, strict=True):
        assert each.collections[1].get_clim()[1] == last
        points = np.concatenate([x for x in each.collections[1].get_segments() if len(x)])
        filled = np.nanmax(points[:, 0]) - np.nanmin(points[:, 0]) > 0.7 * np.diff(each.get_xlim())
        assert filled if len(names) == 1 else each.get_xlim() == (-1.35, 1.35)
        assert each.get_title("left").endswith(str(motion.path))
        inside = [each.get_window_extent().contains(*x.get_window_extent().min) for x in each.texts]
        assert all(inside)
    assert bar.get_ylim()[1] == pytest.approx(last)


def test_titles_are_short_and_replaced() -> None:
    motions = [solve(Top()), solve(Top(psidot0=1))]
    titles = [x.get_title("left") for x in drawn("cubic", *motions).axes]
    assert titles == [f"{i}: The cubic f(u) = u̇² (4,9), the motion shaded" for i in (0, 1)]
    for title, names in (("$x_1$", ["0", "1"]), ("", ["", ""])):
        figure = drawn("phase", *motions, title=title)
        assert [x.get_title("left") for x in figure.axes] == names
        assert figure.get_suptitle() == title.replace("$", r"\$")


@pytest.mark.parametrize(
    ("count", "columns"), [(1, 1), (2, 2), (3, 3), (4, 2), (6, 3), (8, 4), (9, 5)]
)
def test_panels_fill_a_slide(count: int, columns: int) -> None:
    assert columns_on_slide(count, 1.0) == columns


def test_captions_are_below_the_panels() -> None:
    motions = [solve(Top()), solve(read_scene("sleeping-top"))]
    keys = "r0", "T_nutation", "theta0_deg", "regime"
    words = ["r0 = 50,  T = 0.4293,  ϑ0 = 30 deg,  regime = regular"]
    words.append("r0 = 60,  ϑ0 = 0 deg,  regime = sleeping")
    with styled(LIGHT):
        below = [
            figure_of([("", x) for x in motions], [kind], Options(), None, keys).axes
            for kind in ("sphere", "cubic")
        ]
        one = figure_of([("", motions[0])], ["cubic", "phase"], Options(), None, keys)
    legends: list[Any] = [x.get_legend() for x in below[0][:2]]
    assert [x.get_title().get_text() for x in legends] == words
    assert [x.get_xlabel().partition("\n")[2] for x in below[1]] == words
    assert one.get_supxlabel() == words[0]


# --- angles, cubic and phase


def test_angles_are_drawn_with_mean_rates_and_periods() -> None:
    motion = solve(Top())
    tilt, spin, precession = drawn("angles", motion).axes[:3]
    t, deviation = data(spin.get_lines()[0])
    exact = motion.angles(t)
    mean = motion.mean_spin_rate, motion.mean_precession_rate
    assert deviation == pytest.approx(np.degrees(exact.phi - mean[0] * t), abs=1e-9)
    assert data(tilt.get_lines()[0])[1] == pytest.approx(np.degrees(exact.theta))
    assert data(precession.get_lines()[0])[1] == pytest.approx(np.degrees(mean[1] * t))
    assert data(precession.get_lines()[1])[1] == pytest.approx(np.degrees(exact.psi))
    assert [x.get_ylabel() for x in (tilt, spin, precession)] == ["ϑ (deg)", "Δφ (deg)", "ψ (deg)"]
    notes = ["", f"periodic part; mean rate {mean[0]:.4g} rad/time"]
    notes += [f"dashed: mean rate {mean[1]:.4g} rad/time"]
    assert [x.get_title("right") for x in (tilt, spin, precession)] == notes
    above: Any = tilt.child_axes[0]
    assert [x.get_text() for x in above.get_xticklabels()] == ["T", "2 T", "3 T"]
    assert above.get_xticks()[1] == pytest.approx(2 * motion.T_nutation)
    swing = drawn("angles", solve(read_scene("whittaker-71"))).axes[1]
    assert (swing.get_ylabel(), swing.get_title("right")) == ("φ (deg)", "")


def test_bands_are_one_standard_deviation_wide() -> None:
    stds = [[0.01], [0.02], [0.0]]  # of theta, dphi, psi
    figure = drawn("angles", solve(Top()), stds=lambda t: np.array(stds) + 0 * t)
    for axes, std in zip(figure.axes[:2], (0.01, 0.02), strict=False):
        band = np.asarray(axes.collections[0].get_paths()[0].vertices)
        assert np.ptp(band[band[:, 0] == 0.0, 1]) == pytest.approx(np.degrees(2 * std), rel=1e-6)
    assert figure.axes[0].get_title("left").endswith("bands: ±1σ")


def test_the_cubic_is_f_of_u() -> None:
    motion = solve(Top(psidot0=1, thetadot0=2))
    axes = drawn("cubic", motion).axes[0]
    u, f = data(axes.get_lines()[1])
    theta0, a, b = math.radians(30), motion.a or 0, motion.b or 0
    beta = math.sin(theta0) ** 2 + b * math.cos(theta0)
    alpha = 4 + math.sin(theta0) ** 2 + a * math.cos(theta0)
    exact = (alpha - a * u) * (1 - u * u) - (beta - b * u) ** 2  # (4,9)
    assert f == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    assert "u₁ = 0.8" in axes.get_xlabel()
    shaded = np.asarray(axes.collections[0].get_paths()[0].vertices)[:, 0]
    assert (shaded.min(), shaded.max()) == pytest.approx((motion.u2, motion.u1), abs=4e-3)
    roots = {name: labelled(axes)[name].xy[0] for name in ("u₂", "u₁", "u₃")}
    assert roots == pytest.approx({"u₂": motion.u2, "u₁": motion.u1, "u₃": motion.u3})
    far = labelled(drawn("cubic", solve(Top(r0=500))).axes[0])
    assert ("u₁" in far, "u₃" in far) == (True, False)
    sides = np.array([motion.u2 - u[0], u[-1] - motion.u3]) / (motion.u3 - motion.u2)
    assert sides == pytest.approx([0.4, 0.4])
    above: Any = axes.child_axes[0]
    names = dict(zip(above.get_xticks(), above.get_xticklabels(), strict=True))
    assert {x: y.get_text() for x, y in names.items()} == {-1: "hanging", 1: "upright"}
    assert "u₁ = u₂" in labelled(drawn("cubic", solve(read_scene("steady-top"))).axes[0])


def test_the_phase_plane_holds_the_separatrix() -> None:
    axes = drawn("phase", solve(Top(thetadot0=2))).axes[0]
    shown = labelled(axes)
    assert [x.item() for x in data(shown["start"])] == pytest.approx([30, 2])
    tilt, rate = data(shown["upright top with this spin, for comparison"])
    top = solve(Top(theta0_deg=0.001, thetadot0=0))
    times = np.linspace(0, top.T_nutation or 1, 2000)
    exact = top.table(times, ["theta", "thetadot"])
    assert rate[:193] == pytest.approx(-rate[:191:-1], abs=1e-9)
    assert tilt.max() == pytest.approx(np.degrees(exact["theta"].max()), rel=1e-4)
    assert rate.max() == pytest.approx(exact["thetadot"].max(), rel=1e-3)
    why = "no separatrix: the upright top is stable with this spin"
    assert why in labelled(drawn("phase", solve(Top(r0=60))).axes[0])


def test_sampled_curves_are_smooth() -> None:
    motion = solve(read_scene("slow-top"))
    _, *axis = sampled(motion, last_time(motion, None, 3, 40), ["axis"])
    steps = np.diff(np.stack(axis, axis=1), axis=0)
    size = np.linalg.norm(steps, axis=1)
    turn = np.sum(steps[1:] * steps[:-1], axis=1) / (size[1:] * size[:-1])
    assert np.degrees(np.arccos(np.clip(turn, -1, 1)))[size[1:] > 1e-2].max() < 20
    assert size.max() < 0.05
    assert last_time(motion, None, 2, 2) == 2 * (motion.T_nutation or 0)


# --- map


def test_a_map_shows_the_number_of_each_top() -> None:
    r0, tilt = np.geomspace(20, 90, 20), np.geomspace(0.5, 2.5, 9)
    given: Any = {
        "x": ("r0", r0),
        "y": ("theta0", tilt),
        "key": "theta_max_deg",
        "units": Units(radians=True),
    }
    axes, bar = drawn("map", solve(Top()), **given).axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert axes.get_ylabel().endswith("(rad)")
    assert bar.get_ylabel().endswith("(rad)")
    cells = np.asarray(axes.collections[0].get_array()).reshape(9, 20)
    for i, j in ((0, 0), (3, 17), (8, 5)):
        top = solve(Top(r0=r0[j], theta0_rad=tilt[i]))
        assert cells[i, j] == pytest.approx(math.radians(top.theta_max_deg))
    low, high = axes.collections[0].get_clim()
    assert low < np.percentile(cells, 3)
    assert high > np.percentile(cells, 97)
    shown = labelled(axes)
    assert [float(x.item()) for x in data(shown["this scene"])] == [50, math.radians(30)]
    border = np.concatenate([x.vertices for x in axes.collections[1].get_paths()])
    threshold = math.sqrt(4 * 39032 * 1587 * 981 * 4) / 17458
    assert border[:, 0] == pytest.approx(np.full(len(border), threshold), rel=1e-2)
    assert "border of stability (upright top)" in shown
    low_spins = given | {"x": ("r0", np.linspace(0, 30, 5))}
    axes = drawn("map", solve(Top()), **low_spins).axes[0]
    assert "border of stability (upright top)" not in labelled(axes)
    assert axes.get_xscale() == "linear"


def test_a_map_of_paths_shows_cusps_at_the_border() -> None:
    rates, spins = np.linspace(-4, 4, 10), np.linspace(2, 120, 12)
    given: Any = {"x": ("psidot0", rates), "y": ("r0", spins), "key": "path"}
    (axes,) = drawn("map", solve(Top(theta0_deg=60)), **given).axes
    cells: Any = np.reshape(axes.collections[0].get_array(), (12, 10))
    texts = [x.get_text() for x in axes.get_legend().get_texts()]
    assert {"looping", "wavy", "cusped", "through the vertical"} <= {*texts}
    colours = {str(x.get_label()): to_hex(x.get_color()) for x in axes.get_lines()}
    for i, j in ((0, 0), (11, 0), (5, 9), (11, 9)):
        path = str(solve(Top(theta0_deg=60, psidot0=rates[j], r0=spins[i])).path)
        assert to_hex(axes.collections[0].to_rgba(cells[i, j])) == colours[path]
    lines = [np.concatenate([x.vertices for x in y.get_paths()]) for y in axes.collections[1:]]
    assert np.abs(lines[1][:, 0]).max() < 1e-9  # released from rest: cusps
    (steady,) = drawn("map", solve(Top(r0=60, psidot0="steady")), key="path").axes
    assert "wavy" not in {x.get_text() for x in steady.get_legend().get_texts()}


# --- film and reports


def test_a_film_shows_the_top_its_trace_and_the_time() -> None:
    motion, options = solve(Top()), Options(t_max=1.0, units=Units(si=True))
    figure, show = film_figure(motion, options, 11)
    show(6)
    (axes,) = figure.axes
    lines, texts = axes.get_lines(), [x.get_text() for x in axes.texts]
    assert "t = 0.60 s" in texts
    assert "2.3 times faster than life" in "".join(texts)
    paces = [pace_of(0.221, "s"), pace_of(1.01, "s"), pace_of(0.221, "")]
    assert paces == ["4.5 times slower than life", "as fast as in life", "1 second shows t = 0.22"]
    camera = camera_of(np.stack(sampled(motion, 1.0, ["axis"])[1:], axis=1), options, 15.0)
    right, up, toward = camera @ motion.axis([0.6])[0]
    shaft, tip = lines[-2:]
    assert [x[1] for x in data(tip)] == pytest.approx([right, up])
    assert tip.get_markevery() == [-1]
    assert (tip.get_zorder() > 3) == (toward > 0) == (shaft.get_zorder() < 3)
    patches: Any = axes.patches[-2:]
    wheel, sector = (np.asarray(x.get_xy()) for x in patches)
    middle = [0.62 * right, 0.62 * up]
    assert wheel[1:-1].mean(axis=0) == pytest.approx(middle)
    assert sector[0] == pytest.approx(middle)
    body_x = motion.rotation(0.6).apply([0.34, 0, 0.62])
    assert sector[1] == pytest.approx(camera[:2] @ body_x)  # the sector shows the spin
    near, far = (np.stack(data(x)) for x in lines[-4:-2])
    last = [x[:, np.isfinite(x[0])][:, -1] for x in (near, far)]
    assert min(np.abs(x - [right, up]).max() for x in last) < 0.05  # the trace ends at the axle


def test_errors_are_drawn_over_time_and_step() -> None:
    t = np.linspace(0, 1, 9)
    steps = (0.1, 0.05, 0.025)
    results = [SimpleNamespace(file="$x_1$", t=t, error=x**4 * t, step=x) for x in steps]
    with styled(LIGHT):
        figure = draw_errors(results, 1e-3, [x**4 for x in steps])
        over_time, over_step = figure.axes
        assert data(over_time.get_lines()[0])[1][1:] == pytest.approx(1e-4 * t[1:])
        assert data(labelled(over_time)["limit"])[1] == pytest.approx([1e-3, 1e-3])
        legend: Any = over_time.get_legend()
        assert legend.get_texts()[0].get_text() == r"\$x_1\$"
        points, *slopes = over_step.get_lines()
        assert [*data(points)[1]] == pytest.approx([x**4 for x in sorted(steps)])
        ends = [float(data(x)[1][1]) for x in slopes]
        assert sorted(ends) == pytest.approx([1e-4 / 4**n for n in (4, 2, 1)])
        single = SimpleNamespace(**vars(results[0]) | {"step": None})
        single.error[1] = 1e-20  # the rounding error of one row
        (axes,) = draw_errors([single], 1e-3).axes
        assert axes.get_ylim()[0] > 1e-8


@pytest.mark.parametrize("fails", [False, True])
def test_a_fit_is_drawn_with_its_residuals(fails: bool) -> None:
    t = np.linspace(0, 1, 9)
    curve = {"t": t, "data": t**2, "residual": t**3, "fine_t": t, "curve": 2 * t}
    curves = [SimpleNamespace(name=x, **curve) for x in ("theta", "psi")]
    outcome: Any = SimpleNamespace(curves=lambda: curves, units=Units(si=True), title="Fit: good")
    outcome.recording = SimpleNamespace(time_unit="units of the recording")
    outcome.numbers = {"a": "1.0(1)", "A": "2.0(1)", "C": "3.0(1)", "r0": "4.0(1)"}
    outcome.failures = lambda: ["too noisy"] * fails
    with styled(LIGHT):
        figure = draw_fit(outcome)
        above, below, psi, last = figure.axes
    said = "Fit: good,  A = 2.0(1) kg m²,  C = 3.0(1) kg m²,  r0 = 4.0(1) rad/s"
    assert figure.get_suptitle() == said
    if fails:
        assert labelled(above)["failed fit"].get_linestyle() == "--"
        return
    assert data(labelled(above)["data"])[1] == pytest.approx(t**2)
    assert data(labelled(above)["fit"])[1] == pytest.approx(2 * t)
    assert data(below.get_lines()[1])[1] == pytest.approx(t**3)
    assert [above.get_ylabel(), psi.get_ylabel()] == ["ϑ (deg)", "ψ (deg)"]
    assert last.get_xlabel() == "t (s)"
    shown = [to_hex(labelled(x)["fit"].get_color()) for x in (above, psi)]
    assert shown == [LIGHT.lines[0], LIGHT.lines[2]]


@pytest.mark.parametrize("look", [LIGHT, DARK])
def test_colours_stand_out_from_the_paper(look: Look) -> None:
    def lightness(colour: str) -> float:
        parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        return float(np.dot([0.2126, 0.7152, 0.0722], linear)) + 0.05

    for colour in (look.ink, look.quiet, *look.lines):
        pair = sorted([lightness(colour), lightness(look.paper)])
        assert pair[1] / pair[0] >= 4.5
    figure = drawn("phase", solve(Top()), look=look)
    assert to_hex(figure.get_facecolor()) == to_hex(figure.axes[0].get_facecolor()) == look.paper


@pytest.mark.slow
def test_angles_of_an_uncertain_top_have_bands(lagtop: Lagtop, tmp_path: Path) -> None:
    path = tmp_path / "angles.svg"
    assert lagtop("plot", "angles", "--theta0", "30(1)", "-o", path).exit_code == 0
    assert "bands: ±1σ" in path.read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_film_has_the_frames_of_its_duration(lagtop: Lagtop, tmp_path: Path) -> None:
    path = tmp_path / "top.gif"
    assert lagtop("plot", "--animate", path, "--duration", "0.4", "--dpi", 40).exit_code == 0
    with Image.open(path) as film:
        assert getattr(film, "n_frames", 0) == 10
        assert film.size == (192, 208)


SAVED = [([*SHEET["all"]], "svg"), (["map"], "svg"), (["phase"], "png"), (["phase"], "pdf")]


@pytest.mark.parametrize(("kinds", "fmt"), SAVED)
def test_every_picture_is_saved_whole(kinds: list[str], fmt: str) -> None:
    """No artist warns, nothing is cut, and the file holds a title and a description."""
    assert {*PICTURES} == {*SHEET["all"], "map"}
    spins: Any = {"key": "K", "x": ("r0", [40, 60]), "y": ("theta0", [0.5, 1])}
    with styled(LIGHT):
        options = Options(**spins if "map" in kinds else {})
        figure = figure_of([("", solve(Top()))], kinds, options, None)
        data = figure_bytes(figure, fmt, 40, "a title", "two < three")
    assert data[:4] in {b"\x89PNG", b"<?xm", b"%PDF"}
    assert fmt != "svg" or b"two &lt; three" in data
    assert fmt != "svg" or b"<text" in data
    assert figure.get_tightbbox().x0 >= -0.05
    if fmt == "png":
        with pytest.raises(LagtopError, match="dpi"):
            figure_bytes(figure, fmt, 5000, "a title", "")


def test_pictures_are_drawn_on_axes_of_the_user() -> None:
    figure = Figure()
    (axes,) = draw(solve(Top()), "phase", figure.subplots(), t_max=None, radians=True)
    assert axes.get_xlabel() == "tilt ϑ (rad)"
    (axes,) = draw(solve(Top()), "sphere", (other := Figure()).subplots(), t_max=1)
    assert [*other.axes[:1]] == [axes]
    assert len(other.axes) == 2  # with its colour bar
    with pytest.raises(LagtopError, match="ax must be 3 axes, got 1"):
        draw(solve(Top()), "angles", figure.subplots())


def test_axes_with_units_convert_the_body(lagtop: Lagtop, monkeypatch: Any) -> None:
    shown: list[Any] = []

    def figure_of(scenes: Any, _: object, options: Any, *__: object) -> None:
        shown.extend([scenes[0][1].top, options.x, options.y])
        raise LagtopError("enough")

    monkeypatch.setattr("lagrange_cli.plot.pictures.figure_of", figure_of)
    lagtop("plot", "map", "--x", "m=1000:2000:3 g", "--y", "theta0=0.5:1:2 rad", "-o", "x.png")
    top, (x, masses), (_, tilts) = shown
    assert (top.m, top.s, x, masses.tolist()) == (1.587, 0.04, "m", [1.0, 1.5, 2.0])
    assert tilts.tolist() == pytest.approx([28.64788975654116, 57.29577951308232], rel=1e-15)
