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
from .pictures import camera_of, draw_globe, project
from .style import Look, scale, styled

PER_SECOND, SECONDS, MOST_SECONDS, DPI = 25, 6.0, 120.0, 100.0
HEIGHT, RADIUS, WEDGES = 0.62, 0.34, 36
"""Height and radius (in radii of the globe) and number of wedges of the cone."""


def check_film(path: str, seconds: float | None) -> float:
    """Return the length of a film in seconds.

    Raises LagtopError for another ending than .gif and .mp4 and for a length out of range, and
    UnavailableError for an MP4 without ffmpeg.
    """
    suffix, least = Path(path).suffix.lower(), 2 / PER_SECOND
    if suffix not in {".gif", ".mp4"}:
        raise LagtopError(f"animate must end in .gif or .mp4, got {path!r}", "animate")
    if suffix == ".mp4" and not shutil.which("ffmpeg"):
        raise UnavailableError("animate FILE.mp4 needs ffmpeg (or write FILE.gif)", "animate")
    seconds = seconds or SECONDS
    if not least <= seconds <= MOST_SECONDS:
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
    frames = round(PER_SECOND * seconds)
    with styled(options.look), tempfile.TemporaryDirectory() as folder:
        figure, show = film_figure(motion, options, frames)
        numbers = iter(progress(range(frames), "frames"))
        path = Path(folder) / f"film.{suffix}"
        animation.FuncAnimation(
            figure, show, numbers, save_count=frames, cache_frame_data=False
        ).save(path, writer="pillow" if suffix == "gif" else "ffmpeg", fps=PER_SECOND, dpi=dpi)
        return path.read_bytes()


def film_figure(motion: Motion, options: Options, frames: int) -> tuple[Figure, Any]:
    """Return the figure and the function that shows the frame with a number."""
    look, t_max = options.look, options.t_max or min(turn_span(motion), span(motion, 6))
    t, *columns = sampled(motion, t_max, ["axis"]).values()
    path, times = np.stack(columns, axis=1), np.linspace(0.0, t_max, frames)
    attitude = np.stack([*motion.table(times, ["quaternion"]).values()], axis=1)
    camera = camera_of(path, options, 15.0)
    figure = Figure(figsize=(4.8, 5.2))
    ax = figure.subplots()
    draw_globe(ax, motion, camera, options)
    body = ax.add_collection(PolyCollection([], zorder=2.5, linewidths=0.4))
    colour, trace = scale(look)(0.35), project(camera, path)
    (near,) = ax.plot([], [], color=colour, lw=2.2, zorder=3)
    (far,) = ax.plot([], [], color=colour, lw=1.2, alpha=0.45, zorder=2.3)
    (rim,) = ax.plot([], [], color=look.ink, lw=0.9, zorder=2.6)
    (axle,) = ax.plot([], [], "o-", color=look.ink, lw=1.4, ms=4, markevery=[-1])
    clock = ax.text(0.02, 0.97, "", transform=ax.transAxes)
    pace, unit = t_max * PER_SECOND / frames, options.unit("time").replace("time", "of t")
    foot = f"1 second shows {pace:.3g} {unit}"
    if np.abs(np.diff(motion.angles(times).phi)).max(initial=0.0) > math.pi / 3:
        foot += "\nthe spin is too fast for these frames"
    ax.text(0.02, 0.0, foot, size="small", transform=ax.transAxes)

    def show(i: int) -> None:
        polygons, shades, end, edge, from_above = cone(attitude[i], camera, look)
        body.set(verts=polygons, facecolors=shades, edgecolors=shades)
        rim.set_data(*edge)
        axle.set_data(*end)
        axle.set_zorder(4 if from_above else 2.1)
        past = t <= times[i]
        near.set_data(*np.where(past & trace[1], trace[0], np.nan))
        far.set_data(*np.where(past & ~trace[1], trace[0], np.nan))
        clock.set_text(f"t = {times[i]:.4g}")

    return figure, show


def cone(
    quaternion: Array, camera: Array, look: Look
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
    right, up, toward = camera @ rotated(quaternion, points).T
    tip, middle, axis, *rim = np.stack([right, up], axis=1)[: WEDGES + 4]
    facing = toward[WEDGES + 4 :]
    light = 0.5 + 0.5 * np.clip(0.8 * facing - 0.6 * right[WEDGES + 4 :], 0, 1)
    lid = facing[-1] > 0
    triangles, shades = [], []
    for k in range(WEDGES):
        paint = np.array(to_rgb("#f4f4f4" if 3 * k < WEDGES else look.lines[1]))
        for apex, lamp, seen in ((tip, light[k], facing[k] > 0), (middle, light[-1], lid)):
            if seen:
                triangles.append(np.array([apex, rim[k], rim[k + 1]]))
                shades.append(lamp * paint)
    return triangles, shades, np.array([middle, axis]).T, np.array(rim).T, bool(lid)
