"""The film of the spinning top: a cone on its pivot, in front of the trace of its axis."""

from __future__ import annotations

import math
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib import animation
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from ..arithmetic.types import Array
from ..errors import LagtopError, UnavailableError
from ..files.rotations import rotated
from ..solver.solve import Motion
from .pictures import Options, camera_of, draw_globe, last_time, project, sampled, usual_span
from .style import Look, scale, styled

PER_SECOND, SECONDS, MOST_SECONDS = 25, 6.0, 120.0
HEIGHT, RADIUS, WEDGES = 0.62, 0.34, 36
"""Height and radius (in radii of the globe) and number of wedges of the cone."""


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
    with styled(options.look), tempfile.TemporaryDirectory() as folder:
        figure, show = film_figure(motion, options, frames)
        numbers = options.progress(range(frames), "frames")
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
    look, t_max = options.look, last_time(motion, options, usual_span(motion, 3, 6))
    t, *columns = sampled(motion, t_max, ["axis"])
    path, times = np.stack(columns, axis=1), np.linspace(0.0, t_max, frames)
    axis = motion.axis(times)
    attitude = np.stack([*motion.table(times, ["quaternion"]).values()], axis=1)
    camera = camera_of(path, options, 15.0)
    figure = Figure(figsize=(4.8, 5.2))
    ax = figure.subplots()
    draw_globe(ax, motion, camera, options)
    sides, colour = project(camera, path), scale(look)(0.35)
    body = ax.add_collection(PolyCollection([], zorder=2.5, linewidths=0.4))
    (near,) = ax.plot([], [], color=colour, lw=2.2, zorder=3)
    (far,) = ax.plot([], [], color=colour, lw=1.2, zorder=2.3, alpha=0.45)
    (rim,) = ax.plot([], [], color=look.ink, lw=0.9, zorder=2.6)
    (axle,) = ax.plot([], [], "o-", color=look.ink, lw=1.4, ms=4, markevery=[-1])
    clock = ax.text(0.02, 0.97, "", transform=ax.transAxes)
    unit = options.unit("time").replace("time", "")
    decimals = max(0, 2 - math.floor(math.log10(t_max)))
    foot = pace_of(t_max * PER_SECOND / frames, unit)
    if np.abs(np.diff(motion.angles(times).phi)).max(initial=0.0) > math.pi / 3:
        foot += "\nthe spin is too fast for these frames"
    ax.text(0.02, 0.0, foot, size="small", transform=ax.transAxes)

    def show(i: int) -> None:
        triangles, shades, edge = cone(attitude[i], camera, look)
        body.set(verts=triangles, facecolors=shades, edgecolors=shades)
        rim.set_data(*edge.T)
        right, up, toward = camera @ axis[i]
        axle.set_data([HEIGHT * right, right], [HEIGHT * up, up])
        axle.set_zorder(4 if toward > 0 else 2.1)
        for line, side in ((near, sides[0]), (far, sides[1])):
            line.set_data(*side[t <= times[i]].T)
        clock.set_text(f"t = {times[i]:.{decimals}f} {unit}")

    return figure, show


def pace_of(pace: float, unit: str) -> str:
    """Return what one second of a film shows, in words: `pace` units of time."""
    if unit != "s":
        return f"1 second shows t = {pace:.2g}"
    factor, word = (pace, "faster") if pace > 1 else (1 / pace, "slower")
    return "as fast as in life" if factor < 1.05 else f"{factor:.2g} times {word} than life"


def cone(quaternion: Array, camera: Array, look: Look) -> tuple[list[Array], list[Array], Array]:
    """Return the visible triangles of the top, their colours, and its rim.

    A third of the wedges is light, so that the spin is visible.  The lamp is at the camera: the
    more a triangle is turned away, the smaller it looks, and the darker it is.
    """
    step = 2 * math.pi / WEDGES
    around = step * np.arange(WEDGES + 1)
    circle = np.stack([RADIUS * np.cos(around), RADIUS * np.sin(around), 0 * around + HEIGHT], 1)
    rim = rotated(np.broadcast_to(quaternion, (WEDGES + 1, 4)), circle) @ camera[:2].T
    side = 0 * rim[0], -step * RADIUS * math.hypot(RADIUS, HEIGHT)
    lid = rim[1:].mean(axis=0), step * RADIUS**2
    triangles, shades = [], []
    for apex, area in (side, lid):
        for k in range(WEDGES):
            paint = np.array(to_rgb("#f4f4f4" if 3 * k < WEDGES else look.lines[1]))
            corners = np.stack([apex, rim[k], rim[k + 1]])
            facing = np.linalg.det(corners[1:] - apex) / area
            if facing > 0:
                triangles.append(corners)
                shades.append((0.5 + 0.5 * min(facing, 1.0)) * paint)
    return triangles, shades, rim
