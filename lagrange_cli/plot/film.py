"""The film of the spinning top: a cone on its pivot, and behind it the trace of its axis."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter, PillowWriter
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..motion.solve import Motion
from .curves import span, turn_span
from .page import Page, check_pixels
from .request import Progress, no_progress
from .sphere import axis_path, draw_globe
from .style import scale, styled
from .view import best_view, runs, seen_top

WRITERS = {".gif": PillowWriter, ".mp4": FFMpegWriter}
"""What writes each kind of file, by the ending of its name."""

FRAMES, FRAMES_PER_SECOND = 144, 24
USUAL_SIZE = 4.8, 5.0
"""Width and height in inches."""


def check_film(page: Page, name: str, dpi: float) -> None:
    """Raise LagtopError where a film cannot be made.

    The reasons are a name that ends neither in .gif nor in .mp4, an .mp4 without ffmpeg, and pixels
    per inch that do not suit the size.
    """
    suffix = Path(name).suffix.lower()
    if suffix not in WRITERS:
        wanted = " or ".join(WRITERS)
        raise LagtopError(f"animate must be a file that ends in {wanted}, got {name!r}", "animate")
    if suffix == ".mp4" and not shutil.which("ffmpeg"):
        raise LagtopError(
            "animate FILE.mp4 needs ffmpeg on the PATH (or write FILE.gif)", "animate"
        )
    check_pixels(dpi, page.size or USUAL_SIZE)


def film_bytes(page: Page, name: str, dpi: float, progress: Progress = no_progress) -> bytes:
    """Return the film as a GIF or an MP4, as `name` ends.  Raises LagtopError as `check_film`."""
    check_film(page, name, dpi)
    suffix = Path(name).suffix.lower()
    writer = WRITERS[suffix](fps=FRAMES_PER_SECOND)
    with styled(page.look), tempfile.TemporaryDirectory() as folder:
        film = Film(page)
        path = Path(folder) / f"film{suffix}"
        with writer.saving(film.figure, str(path), dpi):
            for frames in progress((range(i, i + 1) for i in range(FRAMES)), FRAMES):
                for i in frames:
                    film.show(i)
                    writer.grab_frame()
        return path.read_bytes()


def film_span(motion: Motion) -> float:
    """Return the time of a turn of the precession, but of six nods at most: more would flicker."""
    return min(turn_span(motion), span(motion, 6))


class Film:
    """The figure of a film and its moving parts."""

    def __init__(self, page: Page) -> None:
        motion, look, request = page.motion, page.look, page.request
        t_max = request.t_max or film_span(motion)
        self.figure, self.look = Figure(figsize=page.size or USUAL_SIZE), look
        self.path = axis_path(motion, t_max)
        self.times = np.linspace(0.0, t_max, FRAMES)
        self.angles = motion.angles(self.times, wrap=True)
        self.view = best_view(self.path.axis)
        self.axes: Axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        draw_globe(self.axes, self.view, self.path, request, look)
        self.body = PolyCollection([], zorder=2, linewidths=0.3)
        self.axes.add_collection(self.body)
        (self.rim,) = self.axes.plot([], [], color=look.ink, lw=0.9, zorder=2.5)
        (self.far,) = self.axes.plot([], [], color=scale(look)(0.35), lw=1.2, alpha=0.45)
        (self.near,) = self.axes.plot([], [], color=scale(look)(0.35), lw=2.2, zorder=3)
        (self.axle,) = self.axes.plot([], [], "o-", color=look.ink, lw=1.4, ms=4, markevery=[-1])
        self.clock = self.axes.text(0.03, 0.95, "", transform=self.axes.transAxes)

    def show(self, i: int) -> None:
        """Bring the figure to frame i."""
        theta, phi, psi = (float(angle[i]) for angle in self.angles)
        top = seen_top(theta, phi, psi, self.view)
        white, blue, red = self.look.paper, *self.look.lines[:2]
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
        """Draw the path of the axis so far, paler on the far side."""
        x, y = self.view.project(axis)
        near = self.view.faces(axis)
        for line, side in ((self.near, True), (self.far, False)):
            shown = np.full((axis.shape[0], 2), np.nan)
            for part, on_near in runs(near):
                if on_near is side:
                    shown[part] = np.stack([x[part], y[part]], axis=1)
            line.set_data(*shown.T)
