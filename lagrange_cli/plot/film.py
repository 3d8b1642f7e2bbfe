"""The film of the spinning top: a wheel on its axle, and the trace of the axis."""

from __future__ import annotations

import math
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib import animation
from matplotlib.figure import Figure

from ..arithmetic.rotations import rotated
from ..arithmetic.types import Array
from ..errors import LagtopError, UnavailableError
from ..output.terminal import with_progress
from ..solver.solve import Motion
from .pictures import Options, camera_of, draw_globe, last_time, project, sampled, scale
from .style import drawing

PER_SECOND, SECONDS, MOST_SECONDS = 25, 6.0, 120.0
HEIGHT, RADIUS, SECTORS = 0.62, 0.34, 72
"""Height and radius (in radii of the globe) of the wheel, and its number of sectors."""


def film_bytes(motion: Motion, suffix: str, options: Options, seconds: float, dpi: float) -> bytes:
    """Return a film of the spinning top as `gif` or `mp4`.

    It shows `options.t_max`, or else one turn of the precession, at most six nutations.  Raises
    LagtopError for a length out of range, and UnavailableError for an MP4 without ffmpeg.
    """
    if suffix == "mp4" and not shutil.which("ffmpeg"):
        raise UnavailableError("animate FILE.mp4 needs ffmpeg (or write FILE.gif)", "animate")
    if not 2 / PER_SECOND <= seconds <= MOST_SECONDS:
        bounds = f"[{2 / PER_SECOND:g}, {MOST_SECONDS:g}]"
        raise LagtopError(f"duration must be in {bounds} seconds, got {seconds:g}", "duration")
    frames = round(PER_SECOND * seconds)
    with drawing(options.look), tempfile.TemporaryDirectory() as folder:
        figure, show = film_figure(motion, options, frames)
        numbers = with_progress(range(frames), "frames")
        film = animation.FuncAnimation(
            figure, show, numbers, save_count=frames, cache_frame_data=False
        )
        path = Path(folder) / f"film.{suffix}"
        writer = "pillow" if suffix == "gif" else "ffmpeg"
        film.save(path, writer=writer, fps=PER_SECOND, dpi=dpi)
        return path.read_bytes()


def film_figure(
    motion: Motion, options: Options, frames: int
) -> tuple[Figure, Callable[[int], None]]:
    """Return the figure and the function that shows the frame with a number."""
    look, t_max = options.look, last_time(motion, options.t_max, 3, 6)
    t, *columns = sampled(motion, t_max, ["axis"])
    path, times = np.stack(columns, axis=1), np.linspace(0.0, t_max, frames)
    axis = motion.axis(times)
    attitude = np.stack([*motion.table(times, ["quaternion"]).values()], axis=1)
    camera = camera_of(path, options, 15.0)
    figure = Figure(figsize=(4.8, 5.2))
    ax = figure.subplots()
    draw_globe(ax, motion, camera, options)
    sides, colour = project(camera, path), scale(look)(0.35)
    (near,) = ax.plot([], [], color=colour, lw=2.2, zorder=3)
    (far,) = ax.plot([], [], color=colour, lw=1.2, zorder=2.3, alpha=0.45)
    (wheel,) = ax.fill([], [], fc=look.paper, ec=look.ink, lw=0.9, zorder=2.5)
    (sector,) = ax.fill([], [], fc=look.lines[1], zorder=2.6)
    (shaft,) = ax.plot([], [], color=look.ink, lw=1.4)
    (tip,) = ax.plot([], [], "o-", color=look.ink, lw=1.4, ms=4, markevery=[-1])
    clock = ax.text(0.02, 0.97, "", transform=ax.transAxes)
    unit = options.units.named("time").replace("time", "")
    decimals = max(0, 2 - math.floor(math.log10(t_max)))
    foot = pace_of(t_max * PER_SECOND / frames, unit)
    if np.abs(np.diff(motion.angles(times).phi)).max(initial=0.0) > math.pi / 3:
        foot += "\nthe spin is too fast for these frames"
    ax.text(0.02, 0.0, foot, size="small", transform=ax.transAxes)

    def show(i: int) -> None:
        (right, up, toward), rim = camera @ axis[i], rim_of(attitude[i], camera)
        wheel.set_xy(rim)
        sector.set_xy([[HEIGHT * right, HEIGHT * up], *rim[: SECTORS // 6 + 1]])
        shaft.set_data([0, HEIGHT * right], [0, HEIGHT * up])
        tip.set_data([HEIGHT * right, right], [HEIGHT * up, up])
        for part, is_in_front in ((shaft, toward <= 0), (tip, toward > 0)):
            part.set_zorder(4 if is_in_front else 2.4)
        for line, side in ((near, sides[0]), (far, sides[1])):
            line.set_data(*side[t <= times[i]].T)
        clock.set_text(f"t = {times[i]:.{decimals}f} {unit}")

    return figure, show


def rim_of(quaternion: Array, camera: Array) -> Array:
    """Return x and y of the rim of the wheel in the picture, from the body's x axis around."""
    around = np.linspace(0.0, 2 * math.pi, SECTORS + 1)
    circle = np.stack([RADIUS * np.cos(around), RADIUS * np.sin(around), 0 * around + HEIGHT], 1)
    return rotated(np.broadcast_to(quaternion, (SECTORS + 1, 4)), circle) @ camera[:2].T


def pace_of(pace: float, unit: str) -> str:
    """Return what one second of a film shows, in words: `pace` units of time."""
    if unit != "s":
        return f"1 second shows t = {pace:.2g}"
    factor, word = (pace, "faster") if pace > 1 else (1 / pace, "slower")
    return "as fast as in life" if factor < 1.05 else f"{factor:.2g} times {word} than life"
