"""The film of the spinning top: a cone on its pivot, in front of the trace of its axis."""

from __future__ import annotations

import io
import math
import shutil
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from PIL import Image

from ..errors import LagtopError, UnavailableError
from ..motion.solve import Motion
from .curves import MOST_PERIODS, span, tilt_period, turn_span
from .globe import camera_at, cone_at, draw_globe, on_one_side, side_camera
from .page import Page, check_pixels
from .sphere import axis_path
from .style import points, scale, styled

SUFFIXES = ".gif", ".mp4"
"""The file types, by the extension of the file name."""
COLOURS = 63
"""Number of colours of a GIF; they are chosen for its middle frame, which contains them all.

One more index is transparent.
"""
FRAMES_PER_SECOND, SECONDS = 25, 6.0
"""Frames per second (a GIF counts hundredths of a second), and the default duration."""
MOST_FRAMES = 3000
ALIASED = math.pi / 3
"""Greatest visible spin per frame: half of the 120 degrees after which the lid repeats."""
FOOT = 0.16
"""Distance below the globe, in its radii, of the line that states the time scale."""
BACKGROUND, BEHIND, BODY, FAR, RIM, NEAR, BEFORE = 2.0, 2.1, 2.2, 2.3, 2.5, 3.0, 4.0
"""Drawing layers, from back to front.

They are the part of the globe that the top hides, the axle on its far side and the top.  In front
are the far part of the trace, the rim, the near part of the trace and the axle on the near side.
"""
USUAL_SIZE = 4.8, 5.0
"""Width and height in inches."""


class Pace(NamedTuple):
    """The time scale of a film."""

    frames: int
    t_max: float
    """Time of the motion shown in the whole film."""

    @property
    def speed(self) -> float:
        """Time of the motion shown per second of film."""
        return self.t_max * FRAMES_PER_SECOND / self.frames


def film_pace(
    motion: Motion,
    *,
    t_max: float | None = None,
    duration: float | None = None,
    speed: float | None = None,
) -> Pace:
    """Return the pace of a film of `duration` seconds that shows `speed` units of time per second.

    Raises LagtopError if t_max, duration and speed are all given, and for a number out of its
    range. It also refuses a time so long that the path would be a blot.
    """
    if t_max and duration and speed:
        raise LagtopError("speed must be omitted if t_max and duration are given", "speed")
    if speed is not None and not speed > 0:
        raise LagtopError(f"speed must be > 0, got {speed:g}", "speed")
    if duration is None:
        duration = t_max / speed if t_max and speed else SECONDS
    least, most = 2 / FRAMES_PER_SECOND, MOST_FRAMES / FRAMES_PER_SECOND
    if not least <= duration <= most:
        bounds = f"[{least:g}, {most:g}] seconds"
        raise LagtopError(f"duration must be in {bounds}, got {duration:g}", "duration")
    if t_max is None:
        t_max = film_span(motion) if speed is None else speed * duration
    longest = MOST_PERIODS * (tilt_period(motion) or math.inf)
    if speed is not None and t_max > longest:
        fastest = f"{longest / duration:.6g} ({MOST_PERIODS} nutation periods)"
        raise LagtopError(f"speed must be at most {fastest}, got {speed:g}", "speed")
    return Pace(round(FRAMES_PER_SECOND * duration), t_max)


def check_film(page: Page, name: str, dpi: float) -> None:
    """Raise LagtopError if a film cannot be made.

    The name must end in .gif or .mp4, and the pixels per inch must suit the size.  An .mp4 without
    ffmpeg raises UnavailableError.
    """
    suffix = Path(name).suffix.lower()
    if suffix not in SUFFIXES:
        wanted = " or ".join(SUFFIXES)
        raise LagtopError(f"animate must be a file that ends in {wanted}, got {name!r}", "animate")
    if suffix == ".mp4" and not shutil.which("ffmpeg"):
        raise UnavailableError(
            "animate FILE.mp4 needs ffmpeg on the PATH (or write FILE.gif)", "animate"
        )
    check_pixels(dpi, page.size or USUAL_SIZE)


def film_bytes(page: Page, name: str, dpi: float, pace: Pace) -> bytes:
    """Return the film as a GIF or an MP4, by the ending of `name`; `check_film` has accepted it."""
    writer = _gif if Path(name).suffix.lower() == ".gif" else _mp4
    with styled(page.request.look):
        film = Film(page, pace)
        return writer(film, dpi, page.request.progress(range(pace.frames), "frames"))


def _gif(film: Film, dpi: float, numbers: Iterable[int]) -> bytes:
    """Return a GIF whose frames share one palette, and store only the pixels that change."""
    film.show(film.times.size // 2)
    palette = film.figure.frame(dpi).quantize(COLOURS)
    frames: list[Image.Image] = []
    last = None
    for i in numbers:
        film.show(i)
        frame = film.figure.frame(dpi).quantize(palette=palette, dither=Image.Dither.NONE)
        pixels = np.asarray(frame)
        if last is not None:
            frame.frombytes(np.where(pixels == last, np.uint8(COLOURS), pixels).tobytes())
            frame.info["transparency"] = COLOURS
        last = pixels
        frames.append(frame)
    file = io.BytesIO()
    options = {"duration": 1000 // FRAMES_PER_SECOND, "loop": 0, "save_all": True}
    # Pillow's own search for equal pixels (`optimize`) would take twice the time
    frames[0].save(file, "gif", append_images=frames[1:], optimize=False, **options)
    return file.getvalue()


def _mp4(film: Film, dpi: float, numbers: Iterable[int]) -> bytes:
    """Return an MP4, which ffmpeg writes."""
    writer = FFMpegWriter(fps=FRAMES_PER_SECOND)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.mp4"
        with writer.saving(film.figure, str(path), dpi):
            for i in numbers:
                film.show(i)
                writer.grab_frame()
        return path.read_bytes()


def film_span(motion: Motion) -> float:
    """Return the time of one turn of the precession, at most six nutations: more would flicker."""
    return min(turn_span(motion), span(motion, 6))


class Frames(Figure):
    """A figure whose frames are drawn between a fixed background and a fixed foreground."""

    moving: Sequence[Artist]
    """The artists of each frame, from the back to the front."""
    front: Sequence[Artist]
    """The fixed artists in front of the moving ones."""
    _still: Any = None

    def frame(self, dpi: float) -> Image.Image:
        """Return the pixels of a frame; the fixed parts are drawn for the first frame only."""
        if self._still is None:
            self._still = self._drawn_once(dpi)
        canvas, background, (place, foreground) = self._still
        canvas.restore_region(background)
        for artist in self.moving:
            artist.draw(canvas.get_renderer())
        shown = canvas.buffer_rgba()
        pixels = Image.frombuffer("RGBA", shown.shape[1::-1], shown, "raw", "RGBA", 0, 1)
        frame = pixels.convert("RGB")
        frame.paste(foreground, place, foreground)
        return frame

    def _drawn_once(self, dpi: float) -> tuple[Any, Any, tuple[Any, Image.Image]]:
        """Return a canvas, the pixels of the background, and the foreground with its place."""
        self.dpi = dpi
        for artist in (*self.moving, *self.front):
            artist.set_animated(True)
        canvas: Any = FigureCanvasAgg(self)
        canvas.draw()
        background = canvas.copy_from_bbox(self.bbox)
        canvas.get_renderer().clear()
        for artist in self.front:
            artist.draw(canvas.get_renderer())
        foreground = Image.fromarray(np.array(canvas.buffer_rgba()))
        place = foreground.getbbox() or (0, 0, 1, 1)
        return canvas, background, (place, foreground.crop(place))

    def savefig(self, file: Any, *, dpi: Any, **_: Any) -> None:  # type: ignore[override]
        """Write the pixels of a frame; writers of films use nothing else."""
        file.write(self.frame(dpi).convert("RGBA").tobytes())


class Film:
    """The figure of a film and its moving parts."""

    def __init__(self, page: Page, pace: Pace) -> None:
        motion, request = page.motion, page.request
        look = request.look
        self.figure = Frames(figsize=page.size or USUAL_SIZE)
        self.path = axis_path(motion, pace.t_max)
        self.times = np.linspace(0.0, pace.t_max, pace.frames)
        columns = motion.table(self.times, ["quaternion"])
        self.attitude = np.stack([*columns.values()], axis=1)
        self.camera = camera_at(*request.camera) if request.camera else side_camera(self.path.axis)
        self.axes: Axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        draw_globe(self.axes, self.camera, (self.path.least, self.path.greatest), request)
        low, high = self.axes.get_ylim()
        self.axes.set_ylim(low - FOOT, high)
        self.body = PolyCollection([], zorder=BODY, linewidths=0.3, edgecolors="face")
        self.axes.add_collection(self.body)
        self.inks = np.array([to_rgba(ink) for ink in (look.paper, look.lines[1], look.lines[0])])
        past = scale(look)(0.35)
        (self.rim,) = self.axes.plot([], [], color=look.ink, lw=points(0.9), zorder=RIM)
        (self.far,) = self.axes.plot([], [], color=past, lw=1.2, alpha=0.45, zorder=FAR)
        (self.near,) = self.axes.plot([], [], color=past, lw=2.2, zorder=NEAR)
        self.trace = {
            line: on_one_side(self.camera, self.path.axis, line is self.near)
            for line in (self.near, self.far)
        }
        (self.axle,) = self.axes.plot([], [], "o-", color=look.ink, lw=1.4, ms=4, markevery=[-1])
        self.clock = self.axes.text(0.03, 0.95, "", transform=self.axes.transAxes)
        turned = np.abs(np.diff(motion.angles(self.times).phi)).max(initial=0.0)
        self.unit = f" {request.unit('time')}" if request.system else ""
        foot = f"1 second shows {pace.speed:.3g}{self.unit or ' of time t'}"
        foot += "; the spin is too fast for these frames" * bool(turned > ALIASED)
        self.axes.text(0.03, 0.02, foot, size="small", transform=self.axes.transAxes, zorder=0)
        self.moving = self.body, self.axle, self.far, self.rim, self.near, self.clock
        others = {*self.axes.lines, *self.axes.texts}.difference(self.moving)
        self.figure.front = [x for x in others if x.get_zorder() > BACKGROUND]

    def show(self, i: int) -> None:
        """Set the moving parts to frame i."""
        top = cone_at(self.attitude[i], self.camera)
        self.body.set(verts=top.corners, facecolors=self.inks[top.inks])
        self.rim.set_data(*top.rim)
        self.axle.set_data(*top.axle)
        self.axle.set_zorder(BEFORE if top.lid_in_sight else BEHIND)
        passed = np.searchsorted(self.path.t, self.times[i], side="right")
        for line, places in self.trace.items():
            line.set_data(*places[:, :passed])
        self.clock.set_text(f"t = {self.times[i]:.4g}{self.unit}")
        self.figure.moving = sorted(self.moving, key=Artist.get_zorder)
