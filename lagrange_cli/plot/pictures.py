"""The pictures of a motion, each a plain function that draws on axes of matplotlib.

A new picture is one function and one row in PICTURES.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ..arithmetic.types import Array, Mask
from ..errors import NothingToDrawError
from ..motion.regime import Regime
from ..motion.solve import Motion
from .curves import sampled, span, tilt_period, turn_span
from .map import draw_map
from .options import Options, mark_start
from .style import Look, number_text, plain, scale

FAR: dict[str, Any] = {"alpha": 0.45, "ls": (0, (3, 3)), "zorder": 1}
"""Style of lines on the far side of the globe."""
PIECES = 160
"""Number of colour steps along a path."""
ARROWS = 0.1, 0.28, 0.46, 0.64, 0.82
"""Places of the arrowheads that show the direction of a path, as shares of its length."""
USUAL_PERIODS = 6
"""Nutation periods up to which a path has its full width; longer paths have finer lines."""


class Camera(NamedTuple):
    """An orthographic camera: rows right, up and towards the camera, shape (3, 3)."""

    rows: Array

    def project(self, points: Array) -> tuple[Array, Array, Mask]:
        """Return x and y on the page of points of shape (n, 3), and whether they face us."""
        x, y, depth = self.rows @ points.T
        return x, y, depth >= 0


def camera_at(azimuth: float, elevation: float) -> Camera:
    """Return the camera in a direction (radians), with z upwards on the page."""
    sa, ca, se, ce = (f(x) for x in (azimuth, elevation) for f in (math.sin, math.cos))
    return Camera(np.array([[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]]))


def camera_of(path: Array, options: Options, elevation: float = 20.0) -> Camera:
    """Return the camera of the options, or the one that faces the middle of a path.

    It is above the horizon unless the path hangs well below it.
    """
    if options.camera:
        return camera_at(*options.camera)
    x, y, z = path.mean(axis=0)
    if math.hypot(x, y) < 0.3:  # the path goes around: face its start, a little from the side
        x, y = path[0, :2]
        x, y = x * math.cos(0.5) - y * math.sin(0.5), x * math.sin(0.5) + y * math.cos(0.5)
    return camera_at(math.atan2(y, x), math.radians(math.copysign(elevation, z + 0.5)))


def motion_words(motion: Motion) -> str:
    """Return a word or two on a motion: its path, or else its regime."""
    stable = {Regime.SLEEPING: ", stable" if motion.exact.facts.stable else ", unstable"}
    return (
        f"{motion.path} path"
        if motion.path
        else motion.regime.value + stable.get(motion.regime, "")
    )


# --- sphere


def sphere(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """the path of the figure axis on the unit sphere, coloured by time"""
    (ax,), look = axes, options.look
    t_max = options.t_max or min(turn_span(motion), span(motion, 40))
    t, *columns = sampled(motion, t_max, ["axis"]).values()
    path = np.stack(columns, axis=1)
    camera = camera_of(path, options)
    draw_globe(ax, motion, camera, options)
    lines = draw_path(ax, camera, t, path, look=look, period=tilt_period(motion))
    moves = np.ptp(path, axis=0).max() > 1e-12
    x, y, _ = camera.project(path[:1])
    mark_start(ax, x, y, look, "start" if moves else "the axis stays here")
    if moves:
        draw_direction(ax, camera, path, look)
        bar = ax.figure.colorbar(lines, ax=ax, shrink=0.6, pad=0.02, aspect=28)
        bar.outline.set_visible(False)
        bar.set_label(options.time_label)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3)
    return f"Figure axis on the unit sphere: {motion_words(motion)}"


def draw_globe(ax: Axes, motion: Motion, camera: Camera, options: Options) -> None:
    """Draw the outline, the equator, the axes of space and the limits of the tilt."""
    look, limits = options.look, (motion.theta_min_deg or 0.0, motion.theta_max_deg or 0.0)
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.add_patch(Circle((0, 0), 1, fc=look.faint, ec=look.quiet, alpha=0.6, zorder=0))
    draw_circle(ax, camera, math.pi / 2, color=look.quiet, lw=0.6)
    for name, direction in zip("xyz", np.eye(3), strict=True):
        x, y, near = camera.project(1.24 * direction[None])
        fade = 1.0 if near[0] else 0.5
        arrow = {"arrowstyle": "-|>", "color": look.quiet, "alpha": fade, "lw": 0.8}
        end = float(x[0]), float(y[0])
        start = (end[0] / 1.24, end[1] / 1.24) if near[0] else (0.0, 0.0)
        if math.hypot(*end) > 0.15:
            ax.annotate("", end, start, arrowprops=arrow, zorder=4 if near[0] else 0.5)
        ax.text(1.08 * end[0], 1.08 * end[1], name, color=look.quiet, ha="center", va="center")
    ax.set(xlim=(-1.35, 1.35), ylim=(-1.35, 1.35))
    low, high = (math.radians(x) for x in limits)
    texts = [
        number_text(x * options.factor, 4) + (" rad" if options.radians else "°")
        for x in (low, high)
    ]
    if high - low < math.radians(0.8):
        text = f"ϑ = {texts[0]}" if low == high else f"ϑ {texts[0]} to {texts[1]}"
        draw_circle(ax, camera, high, color=look.lines[0], lw=1.2, label=text)
        return
    draw_circle(ax, camera, low, color=look.lines[0], lw=1.2, label=f"ϑ min {texts[0]}")
    dash_dotted = {"ls": (0, (7, 2, 1, 2)), "label": f"ϑ max {texts[1]}"}
    draw_circle(ax, camera, high, color=look.lines[0], lw=1.2, **dash_dotted)


def draw_circle(ax: Axes, camera: Camera, tilt: float, **line: Any) -> None:
    """Draw the circle of a tilt, with its far side dashed and paler; at a pole it is a dot."""
    around, sine = np.linspace(0.0, 2 * math.pi, 241), math.sin(tilt)
    flat = np.full(around.size, math.cos(tilt))
    x, y, near = camera.project(np.stack([sine * np.cos(around), sine * np.sin(around), flat], 1))
    if sine < 1e-3:
        ax.plot(x[0], y[0], "o", ms=5, zorder=2, **line | {"ls": "none"})
        return
    ax.plot(*np.where(near, [x, y], np.nan), zorder=2, **line)
    ax.plot(*np.where(near, np.nan, [x, y]), **line | FAR | {"label": None})


def draw_path(
    ax: Axes, camera: Camera, t: Array, path: Array, *, look: Look, period: float | None
) -> LineCollection:
    """Draw a path, coloured by time, paler on the far side; return the lines of the near side."""
    x, y, near = camera.project(path)
    places = np.stack([x, y], axis=1)
    step = np.floor((t - t[0]) / max(t[-1] - t[0], 1e-300) * PIECES)
    ends = np.flatnonzero((np.diff(step) != 0) | (near[1:] != near[:-1])) + 1
    pieces = [slice(first, last + 1) for first, last in pairwise([0, *ends.tolist(), t.size - 1])]
    fine = max(0.35, math.sqrt(min(1.0, USUAL_PERIODS * period / t[-1]))) if period else 1.0
    for side, alpha, width in ((False, 0.35, 1.2), (True, 1.0, 2.2)):
        mine = [part for part in pieces if near[part.start] == side]
        lines = LineCollection(
            [places[part] for part in mine],
            array=[t[part].mean() for part in mine],
            cmap=scale(look),
            alpha=alpha,
            linewidths=width * fine,
            capstyle="round",
            zorder=3 if side else 1,
        )
        lines.set_clim(t[0], t[-1])
        ax.add_collection(lines)
    lines.set_alpha(None)
    return lines


def draw_direction(ax: Axes, camera: Camera, path: Array, look: Look) -> None:
    """Draw arrowheads along the near side of a path."""
    x, y, near = camera.project(path)
    along = np.append(0.0, np.cumsum(np.hypot(np.diff(x), np.diff(y))))
    step = 0.02 if along[-1] > 0.3 else 0.2 * along[-1]
    arrow = {"arrowstyle": "-|>,head_length=0.5,head_width=0.28", "mutation_scale": 13}
    for part in ARROWS if along[-1] > 0.3 else ARROWS[-1:]:
        last = int(np.searchsorted(along, part * along[-1]))
        first = int(np.searchsorted(along, part * along[-1] - step))
        if first < last and near[first : last + 1].all():
            how = arrow | {"color": look.ink, "linewidth": 0, "shrinkA": 0, "shrinkB": 0}
            ax.annotate("", (x[last], y[last]), (x[first], y[first]), arrowprops=how, zorder=5)


# --- angles


def angles(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """tilt, precession, and the deviation of the spin from its mean rate, over time"""
    vertical = motion.regime in (Regime.SLEEPING, Regime.HANGING)
    t_max = options.t_max or span(motion, 3)
    t, theta, phi, psi = sampled(motion, t_max, ["theta", "phi", "psi"]).values()
    stds = [None] * 3 if options.stds is None else options.stds(t)
    spin, turn = motion.mean_spin_rate, motion.mean_precession_rate
    away = phi - (0.0 if spin is None else spin) * t
    for number, angle in enumerate((theta, away, psi)):
        draw_angle(axes[number], number, t, angle, stds[number], options=options)
    say(axes[1], "spin less its mean rate", spin, options)
    if vertical:
        axes[2].clear()
        axes[2].set_yticks([])
        axes[2].text(
            0.5,
            0.5,
            "spin only: there is no precession",
            ha="center",
            va="center",
            transform=axes[2].transAxes,
            color=options.look.quiet,
        )
    elif turn is not None:
        axes[2].plot(t, turn * t * options.factor, color=options.look.ink, lw=0.9, ls=(0, (4, 3)))
        say(axes[2], "dashed: mean rate", turn, options)
    axes[-1].set_xlabel(options.time_label)
    for ax in axes:
        ax.set_xlim(t[0], t[-1])
    mark_periods(axes, tilt_period(motion), t[-1])
    return "Tilt ϑ, spin φ, precession ψ" + "; bands: ±1σ" * (options.stds is not None)


def draw_angle(
    ax: Axes, number: int, t: Array, angle: Array, std: Array | None, *, options: Options
) -> None:
    """Draw tilt (0), spin or precession over time, with a band of one standard deviation."""
    colour = options.look.lines[number]
    if np.abs(angle).max() < 1e-13:  # rounding errors of an angle that is 0
        ax.set_ylim(-1, 1)
    ax.plot(t, angle * options.factor, color=colour)
    if std is not None:
        low, high = ((angle + side * std) * options.factor for side in (-1, 1))
        ax.fill_between(t, low, high, color=colour, alpha=0.3, linewidth=0)
    ax.set_ylabel(f"{('ϑ', 'Δφ', 'ψ')[number]} ({options.angle})")


def say(ax: Axes, name: str, rate: float | None, options: Options) -> None:
    """Write a mean rate above a panel."""
    if rate is not None:
        text = f"{name} {number_text(rate, 4)} {options.unit('rad/time')}"
        ax.set_title(text, fontsize="small", color=options.look.quiet, loc="right")


def mark_periods(axes: Sequence[Axes], period: float | None, end: float) -> None:
    """Mark nutation periods T above the first panel, and by thin lines in all panels."""
    if not period or end < period * (1 - 1e-9):
        return
    count = int(end / period * (1 + 1e-9))
    step = math.ceil(count / 8)
    whole = range(step, count + 1, step)
    for ax in axes:
        for n in whole:
            ax.axvline(n * period, color="0.5", lw=0.6, alpha=0.5, zorder=0)
    above = axes[0].secondary_xaxis("top")
    above.set_xticks([n * period for n in whole], [f"{n} T".removeprefix("1 ") for n in whole])
    above.tick_params(labelsize="small", length=3, pad=1)
    above.spines["top"].set_visible(False)


# --- cubic and phase


def cubic(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """f(u), its roots, and the band of the motion"""
    (ax,), look = axes, options.look
    u1, u2, u3 = float(motion.u1 or 0), float(motion.u2 or 0), motion.u3
    band = u1 - u2
    near = u3 is not None and u3 - u1 <= (1.5 * band if band else 2.0)
    right = float(u3 or 0) if near else u1
    width = max(right - u2, 1e-9) if right > u2 else 0.4
    u = np.linspace(u2 - 0.4 * width, right + 0.4 * width, 801)
    f = (u - u1) * (u - u2)
    if u3 is None:  # no torque, or a vertical axis: the roots add up to (alpha + b^2)/a
        f *= float(motion.a) * (u + u1 + u2) - (motion.energy_constant + float(motion.b) ** 2)
    else:
        f *= float(motion.a) * (u - u3)
    inside = (u >= u2) & (u <= u1)
    ax.axhline(0.0, color=look.quiet, lw=0.9)
    ax.axvspan(u2, u1, color=look.faint, zorder=0)
    ax.fill_between(u, 0.0, f, where=inside.tolist(), color=look.lines[0], alpha=0.3, linewidth=0)
    ax.plot(u, f, color=look.lines[0])
    hump, most = float(f[inside].max(initial=0.0)), float(np.abs(f).max()) or 1.0
    flat = hump < 1e-3 * most
    ax.set(
        xlim=(u[0], u[-1]), ylim=(-0.6 * most, 1.1 * most) if flat else (-1.3 * hump, 1.3 * hump)
    )
    for pole, name in ((1, "upright"), (-1, "hanging")):
        if u[0] <= pole <= u[-1]:
            ax.axvline(pole, color=look.quiet, lw=1.0, ls=(0, (4, 3)), zorder=0.5)
            ax.annotate(
                name,
                (pole, 1.0),
                (0, 2),
                xycoords=ax.get_xaxis_transform(),
                textcoords="offset points",
                ha="center",
                size="small",
                color=look.quiet,
            )
    roots = {"u₁ = u₂": u1} if u1 == u2 else {"u₂": u2, "u₁": u1}
    if near:
        roots["u₃"] = right
    for name, root in roots.items():
        ax.plot(root, 0.0, "o", ms=7, color=look.ink)
        below = {"u₁": (-7, -8, "right", "top"), "u₃": (7, -8, "left", "top")}
        x, y, ha, va = below.get(name, (-7, 8, "right", "bottom"))
        ax.annotate(name, (root, 0.0), (x, y), textcoords="offset points", ha=ha, va=va)
    known = roots | ({} if u3 is None or near else {"u₃": float(u3)})
    values = [f"{name} = {number_text(root, 7)}" for name, root in known.items()]
    ax.set_xlabel(f"u = cos ϑ;   {',   '.join(values)}", fontsize="small")
    ax.set_ylabel(f"f(u) ({options.unit('1/time²')})")
    ax.locator_params(axis="x", nbins=5 if width > 1e-4 else 2)
    return "The cubic f(u) = u̇² (4,9), the motion shaded"


def phase(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """tilt rate against tilt, and the separatrix"""
    (ax,), look, factor = axes, options.look, options.factor
    _, theta, rate = sampled(motion, span(motion, 1), ["theta", "thetadot"]).values()
    ax.axhline(0.0, color=look.quiet, lw=0.9)
    ax.plot(theta * factor, rate, color=look.lines[0], label="this motion")
    mark_start(ax, theta[0] * factor, float(motion.top.thetadot0), look)
    a, b = float(motion.a), float(motion.b)
    if b * b < 2 * a:
        tilt, speed = separatrix(a, b)
        both = np.append(tilt, tilt[::-1]) * factor, np.append(speed, -speed[::-1])
        ax.plot(
            *both,
            color=look.ink,
            lw=1.4,
            ls=(0, (5, 2)),
            label="separatrix of a top that starts upright with this spin",
        )
    else:
        why = "without torque" if a == 0 else "the upright top is stable with this spin"
        ax.plot([], [], ls="none", label=f"no separatrix: {why}")
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    ax.set_xlabel(f"tilt ϑ ({options.angle})")
    ax.set_ylabel(f"tilt rate ϑ̇ ({options.unit('rad/time')})")
    ax.margins(0.06)
    ax.locator_params(axis="x", nbins=5)
    return "Nutation in the phase plane"


def separatrix(a: float, b: float) -> tuple[Array, Array]:
    """Return tilt and rate on the orbit that leaves the upright position and returns to it.

    The orbit exists for b^2 < 2a.  With alpha = a and beta = b, (4,9) becomes

        theta'^2 = 2 a sin^2(theta/2) - b^2 tan^2(theta/2).
    """
    tilt = math.acos(b * b / a - 1) * np.sin(np.linspace(0.0, math.pi / 2, 193))
    square = 2 * a * np.sin(tilt / 2) ** 2 - (b * np.tan(tilt / 2)) ** 2
    return tilt, np.sqrt(np.maximum(square, 0.0))


def map(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """a key of the record over two inputs"""
    return draw_map(motion, axes[0], options)


# --- pages


class Picture(NamedTuple):
    """A kind of picture."""

    draw: Callable[[Motion, Sequence[Axes], Options], str]
    """Draws on axes, and returns a title."""
    size: tuple[float, float]
    """Width and height (inches) of one picture."""
    axes: int = 1
    """Number of axes, one below the other, with the same time axis."""

    @property
    def help(self) -> str:
        """One line on the picture, for the help of the command."""
        return str(self.draw.__doc__)


PICTURES = {
    "sphere": Picture(sphere, (6.0, 5.6)),
    "angles": Picture(angles, (6.8, 6.0), 3),
    "cubic": Picture(cubic, (6.4, 4.8)),
    "phase": Picture(phase, (6.4, 4.8)),
    "map": Picture(map, (6.8, 5.0)),
}
"""The kinds of picture by name."""
SHEET = ("sphere", "angles", "cubic", "phase")
"""The kinds that `all` stands for."""


def figure_of(motions: Mapping[str, Motion], kinds: Sequence[str], options: Options) -> Figure:
    """Return a figure with a panel for each kind of each motion, by the name of its scene.

    Several scenes stand side by side; several kinds of one scene fill a square.  Raises
    NothingToDrawError if a single picture has nothing to show; in a sheet the panel says so.
    """
    if len(motions) > 1:
        rows, columns = len(kinds), len(motions)
        panels = [(name, kind) for kind in kinds for name in motions]
    else:
        columns = math.ceil(math.sqrt(len(kinds)))
        rows = -(-len(kinds) // columns)
        panels = [(name, kind) for name in motions for kind in kinds]
    sizes = [PICTURES[kind].size for kind in kinds]
    width, height = (max(size[i] for size in sizes) for i in (0, 1))
    figure = Figure(figsize=(width * columns, height * rows))
    places = figure.subfigures(rows, columns, squeeze=False).flat
    for place, (name, kind) in zip(places, panels, strict=False):
        axes = place.subplots(PICTURES[kind].axes, sharex=True, squeeze=False).ravel()
        try:
            title = PICTURES[kind].draw(motions[name], axes, options)
        except NothingToDrawError as nothing:
            if len(panels) == 1:
                raise
            title = str(nothing)
            for ax in axes:
                ax.set_axis_off()
        if name and (len(motions) > 1 or kind == kinds[0]):
            title = f"{plain(name)}: {title[:1].lower()}{title[1:]}"
        place.suptitle(title, x=0.012, ha="left")
    return figure
