"""The spinning top as a film: a cone on its pivot, and behind it the trace of its axis."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..motion.solve import Motion
from . import curves
from .page import Page, styled
from .sphere import draw_globe
from .style import scale
from .view import best_view, runs, seen_top

FRAMES, FRAMES_PER_SECOND = 144, 24
SIZE = 4.8, 5.0

Watch = Callable[[Iterable[range], int], Iterable[range]]
"""Hands on the frames as they are drawn; see `options.with_progress`."""


def film_bytes(page: Page, name: str, dpi: float, watch: Watch) -> bytes:
    """The film as a GIF or, if `name` ends in .mp4 and ffmpeg is there, as MP4.

    Raises LagtopError where ffmpeg is missing.
    """
    suffix = Path(name).suffix.lower()
    if suffix == ".mp4" and not shutil.which("ffmpeg"):
        raise LagtopError("--animate FILE.mp4 needs ffmpeg on the PATH (or write FILE.gif)")
    writer = {".mp4": FFMpegWriter, ".gif": PillowWriter}[suffix](fps=FRAMES_PER_SECOND)
    with styled(page.style), tempfile.TemporaryDirectory() as folder:
        film = Film(page)
        path = Path(folder) / f"film{suffix}"
        with writer.saving(film.figure, str(path), dpi):
            for some in watch((range(i, i + 1) for i in range(FRAMES)), FRAMES):
                for i in some:
                    film.show(i)
                    writer.grab_frame()
        return path.read_bytes()


def film_span(motion: Motion) -> float:
    """A turn of the precession, but no more than six nods: more would flicker."""
    return min(curves.turn_span(motion), curves.span(motion, 6))


class Film:
    """The figure and its moving parts."""

    def __init__(self, page: Page) -> None:
        motion, style = page.motion, page.style
        t_max = page.wish.t_max or film_span(motion)
        self.figure, self.style = Figure(figsize=page.size or SIZE), style
        self.path = curves.axis_path(motion, t_max)
        self.times = np.linspace(0.0, t_max, FRAMES)
        self.angles = motion.angles(self.times, wrap=True)
        self.view = best_view(self.path.axis)
        self.axes: Axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        draw_globe(self.axes, self.view, self.path, page.wish.radians, style)
        self.body = PolyCollection([], zorder=2, linewidths=0.3)
        self.axes.add_collection(self.body)
        (self.rim,) = self.axes.plot([], [], color=style.ink, lw=0.9, zorder=2.5)
        (self.far,) = self.axes.plot([], [], color=scale(style)(0.35), lw=1.2, alpha=0.45)
        (self.near,) = self.axes.plot([], [], color=scale(style)(0.35), lw=2.2, zorder=3)
        (self.axle,) = self.axes.plot([], [], "o-", color=style.ink, lw=1.4, ms=4, markevery=[-1])
        self.clock = self.axes.text(0.03, 0.95, "", transform=self.axes.transAxes)

    def show(self, i: int) -> None:
        """Bring the picture to frame i."""
        theta, phi, psi = (float(angle[i]) for angle in self.angles)
        top = seen_top(theta, phi, psi, self.view)
        white, blue, red = self.style.paper, *self.style.lines[:2]
        colours = [white if face.light else blue if face.on_lid else red for face in top.faces]
        self.body.set(
            verts=[face.corners for face in top.faces], facecolors=colours, edgecolors=colours
        )
        self.rim.set_data(*top.rim)
        self.axle.set_data(*top.axle)
        self.axle.set_zorder(4 if top.lid_in_sight else 1.5)
        passed = int(np.searchsorted(self.path.t, self.times[i], side="right"))
        self._trace(self.path.axis[:passed])
        self.clock.set_text(f"t = {self.times[i]:.4g}")

    def _trace(self, axis: Array) -> None:
        x, y = self.view.project(axis)
        near = self.view.faces(axis)
        for line, side in ((self.near, True), (self.far, False)):
            shown = np.full((axis.shape[0], 2), np.nan)
            for part, on_near in runs(near):
                if on_near is side:
                    shown[part] = np.stack([x[part], y[part]], axis=1)
            line.set_data(*shown.T)
