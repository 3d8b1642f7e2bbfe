"""The view of the globe and of the top on it, and the film of the two."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
import pytest
from conftest import Lagtop
from lagtop import LagtopError, Top, solve
from matplotlib.figure import Figure
from pictures import sample_motion
from scenes import SAMPLES
from scipy.spatial.transform import Rotation

from lagrange_cli.arithmetic.types import Array
from lagrange_cli.inputs.units import SYSTEMS
from lagrange_cli.plot import film, globe
from lagrange_cli.plot.curves import turn_span
from lagrange_cli.plot.kinds import PlotRequest
from lagrange_cli.plot.page import Page
from lagrange_cli.plot.sphere import axis_path
from lagrange_cli.plot.style import LIGHT, WEDGES, styled


@pytest.mark.slow
def test_the_view_is_a_rotation_and_the_start_is_in_sight() -> None:
    for path in SAMPLES:
        scene = sample_motion(path)
        axis = axis_path(scene, turn_span(scene)).axis
        seen = globe.best_camera(axis)
        assert np.stack(seen) @ np.stack(seen).T == pytest.approx(np.eye(3), abs=1e-15)
        assert np.cross(seen.right, seen.up) == pytest.approx(seen.toward, abs=1e-15)
        assert seen.up[2] > 0
        assert seen.faces(axis)[0]


def attitude(theta: float, phi: float, psi: float) -> Array:
    """Return the quaternion of a top, by scipy."""
    turn = Rotation.from_euler("ZXZ", [psi, theta, phi])
    return np.asarray(turn.as_quat(scalar_first=True))


def test_the_top_of_the_film_stands_on_its_axis() -> None:
    seen = globe.camera_at(0.3, 0.4)
    top = globe.cone_at(attitude(0.5, 1.0, 2.0), seen)
    axis = np.array([math.sin(0.5) * math.sin(2), -math.sin(0.5) * math.cos(2), math.cos(0.5)])
    assert top.axle[:, 1] == pytest.approx(np.stack(seen.project(axis)))
    assert top.lid_in_sight
    assert (top.inks[-WEDGES:] == 2).sum() == WEDGES / 2
    assert (top.corners[-WEDGES:, 0] == top.axle[:, 0]).all()
    away = globe.cone_at(attitude(math.pi - 0.5, 1.0, 2.0), globe.camera_at(0.3, 1.4))
    assert not away.lid_in_sight


def _lid(phi: float) -> list[tuple[float, ...]]:
    """Return the corners of the light wedges of the lid at an angle of spin."""
    top = globe.cone_at(attitude(0.5, phi, 2.0), globe.camera_at(0.3, 0.4))
    light = top.corners[-WEDGES:][top.inks[-WEDGES:] == 0]
    return sorted(tuple(np.round(corners, 12).ravel().tolist()) for corners in light)


def test_the_spin_is_seen_on_the_lid() -> None:
    """A sixth of a turn swaps light and dark, a third brings the same picture again."""
    assert _lid(1.0) != _lid(1.0 + math.pi / 3)
    assert set(_lid(1.0)).isdisjoint(_lid(1.0 + math.pi / 3))
    assert np.array(_lid(1.0)) == pytest.approx(np.array(_lid(1.0 + 2 * math.pi / 3)), abs=1e-11)
    assert len(_lid(1.0)) == WEDGES / 2


def test_each_frame_shows_the_top_and_the_path_so_far() -> None:
    page = Page(solve(Top()), ["sphere"], PlotRequest(t_max=1.0))
    with styled(LIGHT):
        moving = film.Film(page, film.Pace(144, 1.0))
        for i in (0, 71, 143):
            moving.show(i)
            theta, _, psi = page.motion.angles(moving.times[i])
            axis = np.array(
                [np.sin(theta) * np.sin(psi), -np.sin(theta) * np.cos(psi), np.cos(theta)]
            )
            tip = [float(np.asarray(x)[1]) for x in moving.axle.get_data()]
            assert tip == pytest.approx([float(x) for x in moving.camera.project(axis)], abs=1e-12)
            drawn = [np.isfinite(np.asarray(x.get_xdata())) for x in (moving.near, moving.far)]
            passed = moving.path.t <= moving.times[i]
            assert (drawn[0] | drawn[1]).sum() == passed.sum()
            assert moving.clock.get_text() == f"t = {moving.times[i]:.4g}"
    assert moving.times[-1] == 1.0
    united = Page(solve(Top()), ["sphere"], PlotRequest(system=SYSTEMS["si"]))
    shown = film.Film(united, film.Pace(50, 1.0))
    shown.show(3)
    assert shown.clock.get_text().endswith(" s")
    assert any(text.get_text().startswith("1 second shows 0.5 s") for text in shown.axes.texts)


def test_a_frame_over_the_background_is_the_whole_picture() -> None:
    """Front parts are drawn by themselves and laid over it, which rounds colours once more."""
    page = Page(solve(Top()), ["sphere"], PlotRequest(t_max=1.3))
    with styled(LIGHT):
        moving = film.Film(page, film.Pace(144, 1.3))
        ends = []
        for i in (0, 57, 143):
            moving.show(i)
            frame = np.asarray(moving.figure.frame(50), dtype=int)
            ends.append(moving.axle.get_zorder())
            whole = io.BytesIO()
            Figure.savefig(moving.figure, whole, format="rgba", dpi=50)
            pixels = np.frombuffer(whole.getvalue(), np.uint8).reshape(*frame.shape[:2], 4)
            apart = np.abs(frame - pixels[..., :3]).max(axis=2)
            assert apart.max() <= 4
    assert len(set(ends)) == 2  # the axle is before the globe in some frames and behind in others


def test_a_gif_shows_every_frame_in_63_colours() -> None:
    """Pixels that do not change are transparent: a wrong one would stay in all frames after it."""
    from PIL import Image

    page, pace = Page(solve(Top()), ["sphere"]), film.Pace(12, 0.5)
    data = film.film_bytes(page, "x.gif", 40, pace)
    with styled(LIGHT), Image.open(io.BytesIO(data)) as shown:
        drawn = film.Film(page, pace)
        drawn.show(6)
        palette = drawn.figure.frame(40).quantize(63)
        for i in range(pace.frames):
            shown.seek(i)
            drawn.show(i)
            frame = (
                drawn.figure.frame(40)
                .quantize(palette=palette, dither=Image.Dither.NONE)
                .convert("RGB")
            )
            assert np.array_equal(np.asarray(shown.convert("RGB")), np.asarray(frame)), i


@pytest.mark.slow
def test_a_film(lagtop: Lagtop, tmp_path: Path) -> None:
    """Size and number of frames are those of the options; the test above judges the frames."""
    from PIL import Image

    files = [tmp_path / "a.gif", tmp_path / "b.gif"]
    for file in files:
        assert lagtop("plot", "--animate", file, "--dpi", 40, "--duration", 0.2).output == ""
    with Image.open(files[0]) as shown:
        assert (getattr(shown, "n_frames", 1), shown.size) == (5, (192, 200))
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("size", [(2.0, 2.0), (2.0, 50.0), (50.0, 2.0)])
def test_the_smallest_films(size: tuple[float, float]) -> None:
    page = Page(solve(Top()), ["sphere"], PlotRequest(), size)
    assert film.film_bytes(page, "x.gif", 20, film.Pace(2, 1.0)).startswith(b"GIF8")


def test_mp4_needs_ffmpeg(lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    result = lagtop("plot", "--animate", tmp_path / "x.mp4")
    assert result.exit_code == 69
    assert result.stderr == (
        "Error: --animate FILE.mp4 needs ffmpeg on the PATH (or write FILE.gif)\n"
    )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("asked", "frames"),
    [
        ({}, 150),
        ({"duration": 2.0}, 50),
        ({"t_max": 1.0, "speed": 0.25}, 100),
        ({"duration": 4.0, "speed": 0.25}, 100),
    ],
)
def test_the_pace_of_a_film(asked: dict[str, float], frames: int) -> None:
    motion = solve(Top())
    found = film.film_pace(motion, **asked)
    assert found.frames == frames
    if "speed" in asked:
        assert found.speed == pytest.approx(asked["speed"])
        assert found.t_max == pytest.approx(1.0)
    else:
        assert found.t_max == film.film_span(motion)


def test_a_film_shows_at_most_1000_nutations() -> None:
    motion = solve(Top())
    longest = 1000 * (motion.T_nutation or 0.0)
    assert film.film_pace(motion, duration=4.0, speed=longest / 4).t_max == longest
    with pytest.raises(LagtopError, match="speed must be at most 107"):
        film.film_pace(motion, duration=4.0, speed=math.nextafter(longest / 4, math.inf))
    assert film.film_pace(solve(Top(theta0_deg=0)), duration=4.0, speed=1e9).t_max == 4e9


@pytest.mark.parametrize("inputs", [{}, {"r0": 1000.0}, {"theta0_deg": 150.0}, {"theta0_deg": 0.0}])
def test_the_film_sees_the_cone_from_the_side(inputs: dict[str, float]) -> None:
    """The axis is long on the page in the mean, and the start is not straight at the eye."""
    motion = solve(Top(**inputs))
    axis = axis_path(motion, film.film_span(motion)).axis
    length = np.hypot(*globe.side_camera(axis).project(axis))
    assert length.mean() > 0.75


def test_a_film_says_what_a_second_shows_and_when_the_spin_is_too_fast() -> None:
    for r0, fast in ((50.0, False), (400.0, True)):
        page = Page(solve(Top(r0=r0)), ["sphere"])
        with styled(LIGHT):
            shown = film.Film(page, film.Pace(50, 1.0))
        (foot,) = [text.get_text() for text in shown.axes.texts if "second" in text.get_text()]
        assert foot.startswith("1 second shows 0.5 of time t")
        assert ("too fast" in foot) == fast
