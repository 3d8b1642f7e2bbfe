"""The film of the spinning top: a cone on its pivot, in front of the trace of its axis."""

from __future__ import annotations

import math
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import animation
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from ..arithmetic.types import Array
from ..errors import LagtopError, UnavailableError
from ..inputs.rotations import rotated
from ..motion.solve import Motion
from ..output.terminal import Progress, silent
from .curves import sampled, span, turn_span
from .options import Options
from .pictures import Camera, camera_of, draw_globe
from .style import Look, scale, styled

FILMS = "gif", "mp4"
PER_SECOND, SECONDS, MOST_SECONDS, DPI = 25, 6.0, 120.0, 100.0
HEIGHT, RADIUS, WEDGES = 0.62, 0.34, 36
"""Height and radius (in radii of the globe) and number of wedges of the cone."""


def check_film(path: str, seconds: float | None) -> float:
    """Return the length of a film in seconds.

    Raises LagtopError for another ending than .gif and .mp4 and for a length out of range, and
    UnavailableError for an MP4 without ffmpeg.
    """
    suffix = Path(path).suffix.lower()[1:]
    if suffix not in FILMS:
        raise LagtopError(f"animate must end in .gif or .mp4, got {path!r}", "animate")
    if suffix == "mp4" and not shutil.which("ffmpeg"):
        raise UnavailableError("animate FILE.mp4 needs ffmpeg (or write FILE.gif)", "animate")
    seconds = seconds or SECONDS
    if not 2 / PER_SECOND <= seconds <= MOST_SECONDS:
        least = 2 / PER_SECOND
        bounds = f"[{least:g}, {MOST_SECONDS:g}]"
        raise LagtopError(f"duration must be in {bounds} seconds, got {seconds:g}", "duration")
    return seconds


def film_bytes(
    motion: Motion,
    suffix: str,
    options: Options,
    *,
    seconds: float = SECONDS,
    dpi: float = DPI,
    progress: Progress = silent,
) -> bytes:
    """Return a film of the spinning top as `gif` or `mp4`.

    It shows `options.t_max`, or else one turn of the precession, at most six nutations.
    """
    with styled(options.look):
        figure, show, frames = film_figure(motion, options, seconds)
        numbers = progress(range(frames), "frames")
        film = animation.FuncAnimation(
            figure, show, iter(numbers), save_count=frames, cache_frame_data=False
        )
        writer = "pillow" if suffix == "gif" else "ffmpeg"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"film.{suffix}"
            film.save(path, writer=writer, fps=PER_SECOND, dpi=dpi)
            return path.read_bytes()


def film_figure(motion: Motion, options: Options, seconds: float) -> tuple[Figure, Any, int]:
    """Return the figure, the function that shows the frame with a number, and their count."""
    t_max = options.t_max or min(turn_span(motion), span(motion, 6))
    frames, look = round(PER_SECOND * seconds), options.look
    t, *columns = sampled(motion, t_max, ["axis"]).values()
    path = np.stack(columns, axis=1)
    times = np.linspace(0.0, t_max, frames)
    attitude = np.stack([*motion.table(times, ["quaternion"]).values()], axis=1)
    camera = camera_of(path, options, 15.0)
    figure = Figure(figsize=(4.8, 5.2))
    ax = figure.subplots()
    draw_globe(ax, motion, camera, options)
    body = ax.add_collection(PolyCollection([], zorder=2.5, linewidths=0.4))
    colour = scale(look)(0.35)
    (near,) = ax.plot([], [], color=colour, lw=2.2, zorder=3)
    (far,) = ax.plot([], [], color=colour, lw=1.2, alpha=0.45, zorder=2.3)
    (rim,) = ax.plot([], [], color=look.ink, lw=0.9, zorder=2.6)
    (axle,) = ax.plot([], [], "o-", color=look.ink, lw=1.4, ms=4, markevery=[-1])
    clock = ax.text(0.02, 0.97, "", transform=ax.transAxes)
    pace = t_max * PER_SECOND / frames
    turned = np.abs(np.diff(motion.angles(times).phi)).max(initial=0.0)
    foot = f"1 second shows {pace:.3g} {options.unit('time').replace('time', 'of t')}"
    foot += "\nthe spin is too fast for these frames" * bool(turned > math.pi / 3)
    ax.text(0.02, 0.0, foot, size="small", transform=ax.transAxes)

    def show(i: int) -> None:
        polygons, shades, end, edge, lid_in_sight = cone(attitude[i], camera, look)
        body.set(verts=polygons, facecolors=shades, edgecolors=shades)
        rim.set_data(*edge)
        axle.set_data(*end)
        axle.set_zorder(4 if lid_in_sight else 2.1)
        x, y, seen = camera.project(path[: np.searchsorted(t, times[i], side="right")])
        near.set_data(*np.where(seen, [x, y], np.nan))
        far.set_data(*np.where(seen, np.nan, [x, y]))
        clock.set_text(f"t = {times[i]:.4g}")

    return figure, show, frames


def cone(
    quaternion: Array, camera: Camera, look: Look
) -> tuple[list[Array], list[Any], Array, Array, bool]:
    """Return the visible triangles of the top, their colours, its axle, its rim, and if we see it
    from above.

    A third of the wedges is light, so that the spin is visible.  The lamp stands at the left of the
    camera.
    """
    around = 2 * math.pi / WEDGES * np.arange(WEDGES + 1)
    spokes = np.stack([np.cos(around), np.sin(around), 0 * around], axis=1)
    z = np.array([0.0, 0.0, 1.0])
    normals = HEIGHT * (spokes[1:] + spokes[:-1]) / 2 - RADIUS * z
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    points = np.concatenate([[0 * z, HEIGHT * z, z], RADIUS * spokes + HEIGHT * z, normals, [z]])
    right, up, toward = camera.rows @ rotated(quaternion, points).T
    tip, middle, axis, *rim = np.stack([right, up], axis=1)[: WEDGES + 4]
    facing = toward[WEDGES + 4 :]
    light = 0.5 + 0.5 * np.clip(0.8 * facing - 0.6 * right[WEDGES + 4 :], 0, 1)
    paint = [to_rgb("#f4f4f4" if 3 * k < WEDGES else look.lines[1]) for k in range(WEDGES)]
    seen = [(tip, k, light[k]) for k in range(WEDGES) if facing[k] > 0]
    seen += [(middle, k, light[-1]) for k in range(WEDGES) if facing[-1] > 0]
    triangles = [np.array([apex, rim[k], rim[k + 1]]) for apex, k, _ in seen]
    shades = [[lamp * channel for channel in paint[k]] for _, k, lamp in seen]
    return triangles, shades, np.array([middle, axis]).T, np.array(rim).T, bool(facing[-1] > 0)
