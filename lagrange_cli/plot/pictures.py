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

FAR: dict[str, Any] = {"alpha": 0.45, "ls": (0, (3, 3)), "zorder": 1, "label": None}
"""Style of lines on the far side of the globe."""
ARROWS = 0.1, 0.28, 0.46, 0.64, 0.82
"""Places of the arrowheads that show the direction of a path, as shares of its samples."""


# --- sphere


def camera_at(azimuth: float, elevation: float) -> Array:
    """Return an orthographic camera (angles in radians): its axes right, up and towards us."""
    sa, ca, se, ce = (f(x) for x in (azimuth, elevation) for f in (math.sin, math.cos))
    return np.array([[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])


def camera_of(path: Array, options: Options, elevation: float = 20.0) -> Array:
    """Return the camera of the options, or the one in front of the middle of a path.

    It is above the horizon unless the path hangs well below it.
    """
    if options.camera:
        return camera_at(*options.camera)
    x, y, z = path.mean(axis=0)
    azimuth = math.atan2(y, x)
    if math.hypot(x, y) < 0.3:  # the path goes around: face its start, a little from the side
        azimuth = math.atan2(path[0, 1], path[0, 0]) + 0.5
    return camera_at(azimuth, math.radians(math.copysign(elevation, z + 0.5)))


def project(camera: Array, points: Array) -> tuple[Array, Mask]:
    """Return x and y, shape (2, n), of points of shape (n, 3), and whether they face us."""
    seen = camera @ points.T
    return seen[:2], seen[2] >= 0


def sphere(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """the path of the figure axis on the unit sphere, coloured by time"""
    (ax,), look = axes, options.look
    t_max = options.t_max or min(turn_span(motion), span(motion, 40))
    t, *columns = sampled(motion, t_max, ["axis"]).values()
    path = np.stack(columns, axis=1)
    camera = camera_of(path, options)
    draw_globe(ax, motion, camera, options)
    lines = draw_path(ax, t, *project(camera, path), look=look, period=tilt_period(motion) or t_max)
    moves = np.ptp(path, axis=0).max() > 1e-12
    x, y = project(camera, path[:1])[0]
    mark_start(ax, x, y, look, "start" if moves else "the axis stays here")
    if moves:
        bar = ax.figure.colorbar(lines, ax=ax, shrink=0.6, pad=0.02, aspect=28)
        bar.outline.set_visible(False)
        bar.set_label(options.time_label)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3)
    words = f"{motion.path} path" if motion.path else motion.regime.value
    if motion.regime is Regime.SLEEPING:
        words += ", stable" if motion.exact.facts.stable else ", unstable"
    return f"Figure axis on the unit sphere: {words}"


def draw_globe(ax: Axes, motion: Motion, camera: Array, options: Options) -> None:
    """Draw the outline, the equator, the axes of space and the limits of the tilt."""
    look = options.look
    ax.set_axis_off()
    ax.set(aspect="equal", xlim=(-1.35, 1.35), ylim=(-1.35, 1.35))
    ax.add_patch(Circle((0, 0), 1, fc=look.faint, ec=look.quiet, alpha=0.6, zorder=0))
    draw_circle(ax, camera, math.pi / 2, color=look.quiet, lw=0.6)
    for name, end, depth in zip("xyz", 1.24 * camera[:2].T, camera[2], strict=True):
        start, fade, order = (end / 1.24, 1.0, 4.0) if depth >= 0 else (0 * end, 0.5, 0.5)
        arrow = {"arrowstyle": "-|>", "color": look.quiet, "alpha": fade, "lw": 0.8}
        if np.hypot(*end) > 0.15:
            ax.annotate("", end, start, arrowprops=arrow, zorder=order)
        ax.text(1.08 * end[0], 1.08 * end[1], name, color=look.quiet, ha="center", va="center")
    limits = [math.radians(x or 0.0) for x in (motion.theta_min_deg, motion.theta_max_deg)]
    unit = " rad" if options.radians else "°"
    low, high = (number_text(x * options.factor, 4) + unit for x in limits)
    line: dict[str, Any] = {"color": look.lines[0], "lw": 1.2}
    if limits[1] - limits[0] < math.radians(0.8):
        text = f"ϑ = {low}" if limits[0] == limits[1] else f"ϑ {low} to {high}"
        draw_circle(ax, camera, limits[1], label=text, **line)
    else:
        draw_circle(ax, camera, limits[0], label=f"ϑ min {low}", **line)
        draw_circle(ax, camera, limits[1], label=f"ϑ max {high}", ls=(0, (7, 2, 1, 2)), **line)


def draw_circle(ax: Axes, camera: Array, tilt: float, **line: Any) -> None:
    """Draw the circle of a tilt, with its far side dashed and paler; at a pole it is a dot."""
    around, sine = np.linspace(0.0, 2 * math.pi, 241), math.sin(tilt)
    rim = [sine * np.cos(around), sine * np.sin(around), 0 * around + math.cos(tilt)]
    xy, near = project(camera, np.stack(rim, axis=1))
    if sine < 1e-3:
        ax.plot(*xy[:, 0], "o", ms=5, zorder=2, **line | {"ls": "none"})
        return
    ax.plot(*np.where(near, xy, np.nan), zorder=2, **line)
    ax.plot(*np.where(near, np.nan, xy), **line | FAR)


def draw_path(
    ax: Axes, t: Array, xy: Array, near: Mask, *, look: Look, period: float
) -> LineCollection:
    """Draw a path, coloured by time in 160 steps, with arrowheads; paler on the far side.

    Return the lines of the near side.  Above six nutation periods the lines are finer.
    """
    step = np.floor(t / t[-1] * 160)
    cuts = np.flatnonzero((np.diff(step) != 0) | (near[1:] != near[:-1])) + 1
    pieces = [slice(i, j + 1) for i, j in pairwise([0, *cuts.tolist(), t.size - 1])]
    fine = max(0.35, math.sqrt(min(1.0, 6 * period / t[-1])))
    for side, width in ((False, 1.2), (True, 2.2)):
        mine = [piece for piece in pieces if near[piece.start] == side]
        lines = LineCollection(
            [xy.T[piece] for piece in mine],
            array=[t[piece].mean() for piece in mine],
            cmap=scale(look),
            alpha=None if side else 0.35,
            linewidths=width * fine,
            capstyle="round",
            zorder=3 if side else 1,
        )
        lines.set_clim(t[0], t[-1])
        ax.add_collection(lines)
    head: dict[str, Any] = {"arrowstyle": "-|>,head_length=0.5,head_width=0.28"}
    head |= {"mutation_scale": 13, "color": look.ink, "linewidth": 0, "shrinkA": 0, "shrinkB": 0}
    extent = np.ptp(xy, axis=1).max()
    for part in ARROWS if extent > 0.15 else ARROWS[-1:] if extent > 1e-12 else ():
        i = int(part * t.size)
        if near[i]:
            ax.annotate("", tuple(xy[:, i + 1]), tuple(xy[:, i]), arrowprops=head, zorder=5)
    return lines


# --- angles


def angles(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """tilt, precession, and the deviation of the spin from its mean rate, over time"""
    look, factor = options.look, options.factor
    t_max = options.t_max or span(motion, 3)
    t, theta, phi, psi = sampled(motion, t_max, ["theta", "phi", "psi"]).values()
    stds = [0 * t] * 3 if options.stds is None else options.stds(t)
    spin, turn = motion.mean_spin_rate or 0.0, motion.mean_precession_rate
    rows = ("ϑ", theta), ("Δφ", phi - spin * t), ("ψ", psi)
    for ax, (name, angle), std, colour in zip(axes, rows, stds, look.lines, strict=True):
        if np.abs(angle).max() < 1e-13:  # rounding errors of an angle that is 0
            ax.set_ylim(-1, 1)
        ax.plot(t, angle * factor, color=colour)
        if np.any(std):
            ends = (angle - std) * factor, (angle + std) * factor
            ax.fill_between(t, *ends, color=colour, alpha=0.3, linewidth=0)
        ax.set(ylabel=f"{name} ({options.angle})", xlim=(t[0], t[-1]))
    notes = {1: f"spin less its mean rate {number_text(spin, 4)} {options.unit('rad/time')}"}
    if motion.regime in (Regime.SLEEPING, Regime.HANGING):
        notes[2] = "spin only: there is no precession"
    elif turn is not None:
        axes[2].plot(t, turn * t * factor, color=look.ink, lw=0.9, ls=(0, (4, 3)))
        notes[2] = f"dashed: mean rate {number_text(turn, 4)} {options.unit('rad/time')}"
    for row, text in notes.items():
        axes[row].set_title(text, fontsize="small", color=look.quiet, loc="right")
    axes[-1].set_xlabel(options.time_label)
    mark_periods(axes, tilt_period(motion) or math.inf, t[-1])
    return "Tilt ϑ, spin φ, precession ψ" + "; bands: ±1σ" * (options.stds is not None)


def mark_periods(axes: Sequence[Axes], period: float, end: float) -> None:
    """Mark nutation periods T above the first panel, and by thin lines in all panels."""
    count = int(end / period * (1 + 1e-9))
    whole = range(step := math.ceil(count / 8) or 1, count + 1, step)
    for ax in axes:
        ax.vlines(
            [n * period for n in whole], 0, 1, "0.5", transform=ax.get_xaxis_transform(), lw=0.4
        )
    if whole:
        above = axes[0].secondary_xaxis("top")
        above.set_xticks([n * period for n in whole], [f"{n} T".removeprefix("1 ") for n in whole])
        above.tick_params(labelsize="small", length=3, pad=1)
        above.spines["top"].set_visible(False)


# --- cubic and phase


def cubic(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """f(u), its roots, and the band of the motion"""
    (ax,), look = axes, options.look
    u1, u2, u3 = float(motion.u1 or 0), float(motion.u2 or 0), motion.u3
    near = u3 is not None and u3 - u1 <= (1.5 * (u1 - u2) or 2.0)
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
    ax.set_xlim(u[0], u[-1])
    ax.set_ylim(*((-0.6 * most, 1.1 * most) if hump < 1e-3 * most else (-1.3 * hump, 1.3 * hump)))
    above: dict[str, Any] = {"textcoords": "offset points", "color": look.quiet, "size": "small"}
    for pole, name in ((1, "upright"), (-1, "hanging")):
        if u[0] <= pole <= u[-1]:
            ax.axvline(pole, color=look.quiet, lw=1.0, ls=(0, (4, 3)), zorder=0.5)
            top = ax.get_xaxis_transform()
            ax.annotate(name, (pole, 1.0), (0, 2), xycoords=top, ha="center", **above)
    roots = {"u₁ = u₂": u1} if u1 == u2 else {"u₂": u2, "u₁": u1}
    known = roots | ({} if u3 is None else {"u₃": float(u3)})
    for name, root in known.items() if near else roots.items():
        x, y, ha, va = {
            "u₁": (-7, -8, "right", "top"),
            "u₃": (7, -8, "left", "top"),
        }.get(name, (-7, 8, "right", "bottom"))
        ax.plot(root, 0.0, "o", ms=7, color=look.ink)
        ax.annotate(name, (root, 0.0), (x, y), textcoords="offset points", ha=ha, va=va)
    values = ",   ".join(f"{name} = {number_text(root, 7)}" for name, root in known.items())
    ax.set_xlabel(f"u = cos ϑ;   {values}", fontsize="small")
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
        name = "separatrix of a top that starts upright with this spin"
        ax.plot(tilt * factor, speed, color=look.ink, lw=1.4, ls=(0, (5, 2)), label=name)
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
    along = np.sin(np.linspace(0.0, math.pi, 385))
    tilt = math.acos(b * b / a - 1) * along
    square = 2 * a * np.sin(tilt / 2) ** 2 - (b * np.tan(tilt / 2)) ** 2
    rate = np.sqrt(np.maximum(square, 0.0))
    return tilt, np.where(np.arange(385) < 192, rate, -rate)


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


PICTURES = {
    "sphere": Picture(sphere, (6.0, 5.6)),
    "angles": Picture(angles, (6.8, 6.0), 3),
    "cubic": Picture(cubic, (6.4, 4.8)),
    "phase": Picture(phase, (6.4, 4.8)),
    "map": Picture(map, (6.8, 5.0)),
}
"""The kinds of picture by name."""


def figure_of(motions: Mapping[str, Motion], kinds: Sequence[str], options: Options) -> Figure:
    """Return a figure with a panel for each kind of each motion, by the name of its scene.

    Several scenes stand side by side; several kinds of one scene fill a square.  Raises
    NothingToDrawError if a single picture has nothing to show; in a sheet the panel says so.
    """
    panels = [(name, kind) for kind in kinds for name in motions]
    columns = len(motions) if len(motions) > 1 else math.ceil(math.sqrt(len(kinds)))
    rows = -(-len(panels) // columns)
    width, height = (max(PICTURES[kind].size[i] for kind in kinds) for i in (0, 1))
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
