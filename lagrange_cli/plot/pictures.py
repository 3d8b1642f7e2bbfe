"""The pictures of a motion, each a plain function that draws on axes of matplotlib.

A new picture is one function and one row in PICTURES.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import PurePath
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import ArrayLike

from ..arithmetic.numbers import Real
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..names import check_names
from ..solver.facts import Regime
from ..solver.keys import KEYS, NUMBERS, all_keys, shown_keys
from ..solver.solve import Motion
from ..sweeps.conditions import WORDS
from ..sweeps.records import sweep
from ..top.inputs import DECLARED, NINE
from ..top.units import DEGREES, Units
from .style import LIGHT, Look, plain

MOST_PERIODS, SAMPLES_PER_PERIOD = 1000, 200
"""Of the nutation; more periods would be a blot and not a curve."""
COLOURS_OF_WORDS = "#9cc9ec #f3c69a #a9dcc3 #d9c3ea #f0e08c #e8a9a4 #c9ced4 #c8e6a0".split()
MOST_MAP_VALUES = 1000
WINDOW = np.array([1.35, 1.0])
"""Proportions of the part of a sphere that is shown."""


class Options(NamedTuple):
    """What a picture shows, and how; by default a picture chooses its own times, camera and map."""

    t_max: Real | None = None
    units: Units = DEGREES
    camera: tuple[float, float] | None = None
    """Azimuth and elevation (radians)."""
    look: Look = LIGHT
    stds: Callable[[Array], Any] | None = None
    """Standard deviations (radians) of `angle_columns` at given times: bands."""
    key: str | None = None
    """Key of the record that a map shows."""
    x: tuple[str, ArrayLike] | None = None
    """Input along the horizontal axis of a map, and its values."""
    y: tuple[str, ArrayLike] | None = None
    whole: bool = False
    """Show whole spheres, which have the same scale, instead of the parts around the paths."""

    @property
    def time_label(self) -> str:
        """The label of an axis of time."""
        return f"t ({self.units.named('time').replace('time', 'input units')})"


def scale(look: Look) -> ListedColormap:
    """Return the colour scale for the size of a quantity."""
    return ListedColormap(colormaps["viridis"](np.linspace(*look.scale, 256)), name="lagtop")


# --- times


def tilt_period(motion: Motion) -> float | None:
    """Return the period of the tilt, or None for a tilt that is constant or never returns."""
    return None if motion.theta_min_deg == motion.theta_max_deg else motion.T_nutation


def last_time(motion: Motion, t_max: Real | None, least: float, most: float) -> float:
    """Return the last time of a picture: t_max, or else one turn of the precession.

    The turn counts as `least` to `most` nutation periods.  On the separatrix it is the time of the
    swing.  Raises LagtopError unless t_max is above 0 and the curve up to it is legible.
    """
    nutation, swing = tilt_period(motion), motion.swing
    longest = MOST_PERIODS * (nutation or math.inf)
    if t_max is not None and not 0 < t_max <= longest:
        bounds = f"> 0 and at most {MOST_PERIODS} nutation periods = {longest:.6g}"
        raise LagtopError(f"t_max must be {bounds}, got {float(t_max):g}", "t_max")
    if t_max is not None:
        return float(t_max)
    if swing:
        return max(6.0 / swing.rate, 2.0 * swing.lowest)
    if nutation:
        return min(max(motion.T_precession or 0.0, least * nutation), most * nutation)
    return motion.T_precession or motion.T_spin or 1.0


def sampled(motion: Motion, t_max: float, names: Sequence[str]) -> list[Array]:
    """Return times from 0 to t_max, and columns of `lagtop table` in radians.

    The samples are even in the sum of time and length of the curve, each as a share of the whole:
    so they are dense where the curve is steep.
    """
    count = round(SAMPLES_PER_PERIOD * max(t_max / (tilt_period(motion) or t_max), 2.0))
    t = np.linspace(0.0, t_max, count + 1)
    for _ in range(2):
        points = np.stack([*motion.table(t, names).values()])
        extent = np.ptp(points, axis=1, keepdims=True)
        steps = np.diff(points) / np.where(extent > 0, extent, np.inf)
        length = np.append(0.0, np.cumsum(np.hypot.reduce(steps)))
        even = t / t_max + length / (length[-1] or 1.0)
        t = np.interp(np.linspace(0.0, even[-1], count + 1), even, t)
    return [*motion.table(t, ["t", *names]).values()]


# --- sphere


def camera_of(path: Array, options: Options, elevation: float | None = None) -> Array:
    """Return an orthographic camera: its axes right, up and towards us.

    By default it is in front of the middle of a path and its start, a little to the side, and looks
    down on the band of the path (up, if the path hangs well below the horizon).
    """
    x, y, _ = path.mean(axis=0) + 0.2 * path[0]  # a path that goes around has its middle at 0
    height = (path[:, 2].min() + path[:, 2].max()) / 2
    if elevation is None:
        elevation = min(max(math.degrees(math.asin(min(abs(height), 1.0))), 20.0), 60.0)
    in_front = math.atan2(y, x) + 0.3, math.radians(math.copysign(elevation, height + 0.5))
    sa, ca, se, ce = (f(x) for x in options.camera or in_front for f in (math.sin, math.cos))
    return np.array([[-sa, ca, 0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])


def project(camera: Array, points: Array) -> tuple[Array, Array]:
    """Return x and y of points, shape (n, 2), on the near side and on the far side.

    Points of the other side are NaN.
    """
    *xy, depth = camera @ points.T
    near = depth >= 0
    return np.where(near, xy, np.nan).T, np.where(near, np.nan, xy).T


def sphere(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """Draw the path of the figure axis on the unit sphere, with the direction, coloured by time.

    The path fills the picture, which may cut the sphere, unless whole spheres are shown.  Above six
    nutation periods the line is finer.  `add_time_bar` draws the scale of the colours.
    """
    (ax,), look = axes, options.look
    t, *columns = sampled(motion, last_time(motion, options.t_max, 3, 40), ["axis"])
    path = np.stack(columns, axis=1)
    camera = camera_of(path, options)
    moves = np.ptp(path, axis=0).max() > 1e-12
    draw_globe(ax, motion, camera, options, path if moves and not options.whole else None)
    near, far = project(camera, path)
    mark_start(ax, camera[:2] @ path[0], look, "start" if moves else "the axis stays here")
    if moves:
        cuts = np.linspace(0, t.size - 1, 161).astype(int)
        fine = math.sqrt(min(1.0, 6 * (tilt_period(motion) or t[-1]) / t[-1]))
        for side, width, alpha, order in ((far, 1.2, 0.35, 1), (near, 2.2, None, 3)):
            pieces = [side[i : j + 1] for i, j in pairwise(cuts)]
            lines = LineCollection(pieces, array=t[cuts[:-1]], clim=(0, t[-1]), cmap=scale(look))
            lines.set(lw=width * max(fine, 0.35), capstyle="round", alpha=alpha, zorder=order)
            ax.add_collection(lines, autolim=False)
        for share in (0.1, 0.28, 0.46, 0.64, 0.82) if fine > 0.5 else (0.82,):
            (x, y), step = near[(i := int(share * t.size))], near[i + 1] - near[i]
            turn = math.degrees(math.atan2(step[1], step[0])) - 90.0
            ax.plot(x, y, marker=(3, 0, turn), ms=8.0, color=look.ink, mew=0.0, zorder=5)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), ncols=3)
    if motion.regime is Regime.SLEEPING:
        return f"sleeping, {'stable' if motion.facts.stable else 'unstable'}"
    return motion.path or motion.regime.value


def mark_start(ax: Axes, point: Iterable[float], look: Look, label: str = "start") -> None:
    """Draw a ring with a label at one point."""
    ax.plot(*point, "o", label=label, mfc=look.paper, mec=look.ink, mew=1.6, ms=7, zorder=6)


def draw_globe(
    ax: Axes, motion: Motion, camera: Array, options: Options, path: Array | None = None
) -> None:
    """Draw the outline, the equator, the axes of space that fit, and the limits of the tilt.

    The picture shows the whole sphere, or the part around a path with the z axis, if the latter
    does not make it much larger.
    """
    look, tips = options.look, 1.24 * camera[:2]
    low, high = np.full(2, -1.35), np.full(2, 1.35)
    if path is not None:
        ends = camera[:2] @ path.T
        low, high = ends.min(axis=1), ends.max(axis=1)
        if tips[1, 2] - low[1] < 1.3 * max(high - low):
            high[1] = max(high[1], tips[1, 2])
        size = 1.14 * max((high - low) / WINDOW) * WINDOW + 0.01
        low, high = (low + high - size) / 2, (low + high + size) / 2
    ax.set_axis_off()
    ax.set_aspect("equal")
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    ax.add_patch(Circle((0, 0), 1, fc=look.faint, ec=look.quiet, alpha=0.6, zorder=0))
    draw_circle(ax, camera, math.pi / 2, color=look.quiet, lw=0.6)
    has_origin = np.all((low < 0) & (high > 0))
    for name, tip, depth in zip("xyz", tips.T, camera[2], strict=True):
        is_hidden = depth < 0 and np.linalg.norm(tip) < 1.1
        if not is_hidden and np.all((low < tip) & (tip < high)):
            shade: dict[str, Any] = {"color": look.quiet, "alpha": 1.0 if depth >= 0 else 0.6}
            arrow = {"arrowstyle": "<|-", "lw": 0.8, "shrinkA": 7, "shrinkB": 0, **shade}
            foot = (0.0 if has_origin else 0.8) * tip
            ax.annotate(name, foot, tip, ha="center", va="center", arrowprops=arrow, **shade)
    least, most = (math.radians(x or 0.0) for x in (motion.theta_min_deg, motion.theta_max_deg))
    limits = {"ϑ min": least, "ϑ max": most} if least < most else {"ϑ =": least}
    for (name, tilt), dashes in zip(limits.items(), ("-", (0, (7, 2, 1, 2))), strict=False):
        text = f"{name} {tilt * options.units.radian:.4g}{' rad' if options.units.radians else '°'}"
        draw_circle(ax, camera, tilt, color=look.lines[0], lw=1.2, ls=dashes, label=text)


def draw_circle(ax: Axes, camera: Array, tilt: float, **line: Any) -> None:
    """Draw the circle of a tilt, with its far side dashed and paler."""
    around = np.linspace(0.0, 2 * math.pi, 721)
    x, y, z = math.sin(tilt) * np.cos(around), math.sin(tilt) * np.sin(around), math.cos(tilt)
    near, far = project(camera, np.stack([x, y, 0 * x + z], axis=1))
    ax.plot(*near.T, zorder=2, **line)
    ax.plot(*far.T, zorder=1, **line | {"alpha": 0.45, "ls": (0, (3, 3)), "label": None})


def add_time_bar(axes: Sequence[Axes], label: str) -> None:
    """Draw one colour bar for the times of spheres side by side."""
    lines = [x for ax in axes for x in ax.collections if isinstance(x, LineCollection)]
    if lines:
        last = max(x.get_clim()[1] for x in lines)
        for x in lines:
            x.set_clim(0, last)
        form: dict[str, Any] = {"shrink": 0.7, "pad": 0.02, "aspect": 28}
        bar = axes[0].figure.colorbar(lines[-1], ax=axes, label=label, **form)
        bar.outline.set_visible(False)


# --- angles


def angle_columns(motion: Motion) -> list[str]:
    """Return the columns that `angles` draws; on the separatrix there is no mean rate."""
    return ["theta", "phi" if motion.mean_spin_rate is None else "dphi", "psi"]


def angles(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """Draw tilt, precession, and the periodic part of the spin, over time."""
    look, factor, unit = options.look, options.units.radian, options.units.angle
    t_max = last_time(motion, options.t_max, 3, 3)
    t, theta, phi, psi = sampled(motion, t_max, ["theta", "phi", "psi"])
    spin, turn = motion.mean_spin_rate, motion.mean_precession_rate
    name, about, note = "φ", "", ""
    if spin is not None:
        phi, name = phi - spin * t, "Δφ"
        about = f"periodic part; mean rate {spin:.4g} {options.units.named('rad/time')}"
    stds = [0 * t] * 3 if options.stds is None else options.stds(t)
    if motion.regime in (Regime.SLEEPING, Regime.HANGING):
        note = "spin only: there is no precession"
    elif turn is not None:
        axes[2].plot(t, turn * t * factor, color=look.ink, lw=0.9, ls=(0, (4, 3)), zorder=3)
        note = f"dashed: mean rate {turn:.4g} {options.units.named('rad/time')}"
    rows = ("ϑ", theta, ""), (name, phi, about), ("ψ", psi, note)
    for ax, (name, angle, text), std, colour in zip(axes, rows, stds, look.lines, strict=True):
        if np.abs(angle).max() < 1e-13:  # rounding errors of an angle that is 0
            ax.set_ylim(-1, 1)
        ax.plot(t, angle * factor, color=colour)
        if np.any(std):
            ends = (angle - std) * factor, (angle + std) * factor
            ax.fill_between(t, *ends, color=colour, alpha=0.3, linewidth=0)
        ax.set(ylabel=f"{name} ({unit})", xlim=(t[0], t[-1]))
        ax.set_title(text, fontsize="small", color=look.quiet, loc="right")
    axes[-1].set_xlabel(options.time_label)
    period = tilt_period(motion) or math.inf
    count = int(t[-1] / period * (1 + 1e-9))
    whole = range(step := math.ceil(count / 8) or 1, count + 1, step)
    mark_above(axes, {n * period: f"{n} T".removeprefix("1 ") for n in whole}, look)
    return "Tilt ϑ, spin φ, precession ψ" + "; bands: ±1σ" * (options.stds is not None)


def mark_above(axes: Sequence[Axes], names: Mapping[float, str], look: Look) -> None:
    """Mark places by thin lines in all panels, with their names above the first panel."""
    for ax in axes:
        ax.vlines([*names], 0, 1, look.quiet, transform=ax.get_xaxis_transform(), lw=0.5)
    above = axes[0].secondary_xaxis("top")
    above.set_xticks([*names], [*names.values()], size="small")
    above.tick_params(length=3, pad=1)
    above.spines["top"].set_visible(False)


# --- cubic and phase


def cubic(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """Draw f(u), its roots, and the band of the motion."""
    (ax,), look = axes, options.look
    u1, u2, u3 = float(motion.u1 or 0), float(motion.u2 or 0), motion.u3
    near = u3 is not None and u3 - u1 <= (1.5 * (u1 - u2) or 2.0)
    right = float(u3 or 0) if near else u1
    width = max(right - u2, 1e-9) if right > u2 else 0.4
    u = np.linspace(u2 - 0.4 * width, right + 0.4 * width, 801)
    total = motion.energy_constant + float(motion.b) ** 2  # the roots add up to total / a
    f = (u - u1) * (u - u2) * (float(motion.a) * (u + u1 + u2) - total)
    inside = (u >= u2) & (u <= u1)
    ax.axhline(0.0, color=look.quiet, lw=0.9)
    ax.axvspan(u2, u1, color=look.faint, zorder=0)
    ax.fill_between(u, 0.0, f, where=inside.tolist(), color=look.lines[0], alpha=0.3, linewidth=0)
    ax.plot(u, f, color=look.lines[0])
    hump, most = float(f[inside].max(initial=0.0)), float(np.abs(f).max()) or 1.0
    ax.set_xlim(u[0], u[-1])
    ax.set_ylim(*((-0.6 * most, 1.1 * most) if hump < 1e-3 * most else (-1.3 * hump, 1.3 * hump)))
    mark_above(axes, {-1: "hanging", 1: "upright"}, look)
    roots = {"u₁ = u₂": u1} if u1 == u2 else {"u₂": u2, "u₁": u1}
    known = roots | ({} if u3 is None else {"u₃": float(u3)})
    offsets = {"u₁ = u₂": (0, 13), "u₂": (-13, 11), "u₁": (-13, -11), "u₃": (13, -11)}
    for name, root in known.items() if near else roots.items():
        ax.plot(root, 0.0, "o", ms=7, color=look.ink)
        place: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center"}
        ax.annotate(name, (root, 0.0), offsets[name], **place)
    values = ",   ".join(f"{name} = {root:.7g}" for name, root in known.items())
    ax.set_xlabel(f"u = cos ϑ;   {values}", fontsize="small")
    ax.set_ylabel(f"f(u) ({options.units.named('1/time²')})")
    ax.locator_params(axis="x", nbins=5 if width > 1e-4 else 2)
    return "The cubic f(u) = u̇² (4,9), the motion shaded"


def phase(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """Draw the nutation rate against the tilt, and the separatrix."""
    (ax,), look, units = axes, options.look, options.units
    factor, unit = units.radian, units.angle
    _, theta, rate = sampled(motion, last_time(motion, None, 1, 1), ["theta", "thetadot"])
    ax.axhline(0.0, color=look.quiet, lw=0.9)
    ax.plot(theta * factor, rate, color=look.lines[0], label="this motion")
    stays = motion.theta_min_deg == motion.theta_max_deg
    name = "the tilt stays here" if stays else "start"
    mark_start(ax, (theta[0] * factor, float(motion.top.thetadot0)), look, name)
    a, b = float(motion.a), float(motion.b)
    if b * b < 2 * a:  # with alpha = a and beta = b, (4,9) is
        # theta'^2 = 2 a sin^2(theta/2) - b^2 tan^2(theta/2)
        tilt = math.acos(b * b / a - 1) * np.sin(np.linspace(0.0, math.pi, 385))
        square = 2 * a * np.sin(tilt / 2) ** 2 - (b * np.tan(tilt / 2)) ** 2
        speed = np.sqrt(np.maximum(square, 0.0)) * np.where(np.arange(385) < 192, 1, -1)
        name = "upright top with this spin" + ", for comparison" * (motion.swing is None)
        ax.plot(tilt * factor, speed, color=look.ink, lw=1.4, ls=(0, (5, 2)), label=name)
    else:
        why = "without torque" if a == 0 else "the upright top is stable with this spin"
        ax.plot([], [], ls="none", label=f"no separatrix: {why}")
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)
    ax.set(xlabel=f"tilt ϑ ({unit})", ylabel=f"nutation rate ϑ̇ ({options.units.named('rad/time')})")
    ax.margins(0.06)
    ax.locator_params(axis="x", nbins=5)
    return "Nutation in the phase plane"


# --- map


def map(motion: Motion, axes: Sequence[Axes], options: Options) -> str:
    """Draw a key of the record over a grid of two inputs, the border of stability and the scene.

    Raises LagtopError for an unknown key, for wrong axes, and if the key has no value anywhere.
    """
    (ax,), look = axes, options.look
    key = DEGREES.key("mean_precession_rate" if options.key is None else options.key)
    check_names("key", [key], [*WORDS, *NUMBERS])
    grid = grid_of(motion, options)
    tilt = options.units.key("theta0_deg")
    (x, xs), (y, ys) = ((tilt if x == "theta0" else x, values) for x, values in grid.items())
    inputs: dict[str, Any] = dict(motion.top.inputs(radians=options.units.radians))
    own = float(inputs[x]), float(inputs[y])
    inputs["psidot0"] = motion.top.as_dict()["psidot0"]  # it may be a word
    inputs |= {x: xs[np.newaxis, :], y: ys[:, np.newaxis]}
    for_borders = "stability_factor", "momentum_constant", "b", "u1"
    found = sweep(keys=list(dict.fromkeys([key, *for_borders])), **inputs)
    title = (draw_words if key in WORDS else draw_numbers)(ax, (xs, ys), found[key], key, options)
    stable, beta, b, u1 = (found[x] for x in for_borders)
    borders = {"border of stability (upright top)": (stable - 1, look.ink, "--")}
    if key == "path":  # beta - b u, and with it the precession, is 0 at u1, at u = 1 or at u = -1
        size = np.nanmax(np.abs(b), initial=0.0) or 1.0
        beta, b = np.where(b, beta, 0.0) / size, b / size  # a top without spin has no cusps
        borders["cusped"] = beta - b * u1, look.ink, "-"
        borders["through the vertical"] = beta**2 - b**2, look.lines[0], "-"
    for label, (height, colour, dashes) in borders.items():
        if np.any(height < -1e-9) and np.any(height > 1e-9):
            ax.contour(xs, ys, height, [0.0], colors=colour, linewidths=2.2, linestyles=dashes)
            ax.plot([], [], dashes, color=colour, label=label)
    for side, (name, points) in zip("xy", grid.items(), strict=True):
        declared = DECLARED[name]
        unit = options.units.named(declared.unit)
        known = "" if "len" in unit or "mass" in unit else f" ({unit})"
        ax.set(**{f"{side}label": f"{declared.name} {declared.symbol}{known}"})
        if points[0] > 0 and np.ptp(np.diff(np.log(points))) < 1e-9 < np.ptp(np.diff(points)):
            ax.set(**{f"{side}scale": "log"})
    if xs[0] <= own[0] <= xs[-1] and ys[0] <= own[1] <= ys[-1]:
        mark_start(ax, own, look, "this scene")
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3)
    return title


def grid_of(motion: Motion, options: Options) -> dict[str, Array]:
    """Return the two inputs of a map, horizontal first, with their increasing values.

    The spins go up to twice the threshold of the sleeping top, or beyond the top's own spin.
    """
    most = max(2 * float(motion.r0_sleeping or 0), 1.25 * abs(float(motion.top.r0))) or 1.0
    x = options.x or ("r0", (np.arange(200) + 0.5) * most / 200)
    y = options.y or ("theta0", np.radians(np.linspace(1.0, 179.0, 100)) * options.units.radian)
    if x[0] == y[0]:
        raise LagtopError(f"x and y must be two inputs, got {x[0]} twice")
    grid = {name: np.asarray(values, float) for name, values in (x, y)}
    for option, (name, values) in zip("xy", grid.items(), strict=True):
        check_names(option, [name], NINE)
        wanted, found = f"2 to {MOST_MAP_VALUES} values", str(values.size)
        if is_long := 2 <= values.size <= MOST_MAP_VALUES:
            wanted, found = "start < stop", f"{name}={values[0]:g}:{values[-1]:g}"
        if not (is_long and np.all(np.diff(values) > 0)):
            raise LagtopError(f"{option} must have {wanted}, got {found}", option)
    return grid


def draw_words(ax: Axes, grid: Any, values: Any, key: str, _: Options) -> str:
    """Draw words as coloured regions with a legend, and return a title."""
    names, classes = np.unique(values.astype(str), return_inverse=True)
    colours = ListedColormap(COLOURS_OF_WORDS[: names.size])
    ax.pcolormesh(*grid, classes.reshape(values.shape), cmap=colours, rasterized=True)
    for colour, name in zip(COLOURS_OF_WORDS, names, strict=False):
        ax.plot([], [], "s", color=colour, label=name.replace("None", "undefined"))
    return KEYS[key].meaning.capitalize()


def draw_numbers(ax: Axes, grid: Any, values: Any, key: str, options: Options) -> str:
    """Draw numbers in colours with a bar, and return a title.

    The colours span the numbers without the lowest and the highest 1 %, which may be a peak.
    """
    look, declared = options.look, NUMBERS[key]
    unit = options.units.named(declared.unit)
    if declared.unit == "angle":  # keys of angles are in degrees
        values = np.radians(values) * options.units.radian
    shown = np.ma.masked_invalid(values)
    if not shown.count():
        raise LagtopError(f"no map: {key} is undefined for all of these tops")
    low, high = np.percentile(shown.compressed(), [1, 99])
    mesh = ax.pcolormesh(*grid, shown, cmap=scale(look), vmin=low, vmax=high, rasterized=True)
    label = f"{declared.symbol} ({unit})" if unit else declared.symbol
    bar = ax.figure.colorbar(mesh, ax=ax, aspect=28, extend="both", label=label)
    bar.outline.set_visible(False)
    if shown.count() < shown.size:
        ax.set_facecolor(look.faint)
        ax.plot([], [], "s", color=look.faint, mec=look.quiet, label="undefined")
    return f"{declared.symbol}: {declared.meaning}"


# --- sheets


PICTURES: dict[str, tuple[Callable[[Motion, Sequence[Axes], Options], str], int, Any]] = {
    "sphere": (sphere, 1, (6.0, 4.4)),
    "angles": (angles, 3, (6.8, 6.0)),
    "cubic": (cubic, 1, (6.4, 4.8)),
    "phase": (phase, 1, (6.4, 4.8)),
    "map": (map, 1, (6.8, 5.0)),
}
"""The function of each kind, which draws on axes and returns a title; the number of its axes, one
below the other; and the width and height of one picture (inches)."""
WHOLE = 4.6, 5.0
"""The width and height of a whole sphere (inches)."""


def figure_of(
    scenes: Sequence[tuple[str, Motion]],
    kinds: Sequence[str],
    options: Options,
    title: str | None = None,
    caption: Sequence[str] = (),
) -> Figure:
    """Return a figure with a panel for each kind of each scene, a name and a motion.

    The panels of several scenes fill a slide, with the names of the scenes above them.  A `title`
    above the figure replaces the names of the kinds; an empty one omits all names.  The keys of
    `caption` are printed below the panels of a scene.  Raises LagtopError for an unknown key.
    """
    several = len(scenes) > 1
    options = options._replace(whole=several)
    panels = [(i, kind) for kind in kinds for i in range(len(scenes))]
    sizes = [WHOLE if several and kind == "sphere" else PICTURES[kind][2] for kind in kinds]
    width, height = np.max(sizes, axis=0)
    columns = columns_on_slide(len(panels), width / height)
    if several and len(kinds) > 1:
        columns = len(scenes)
    rows = -(-len(panels) // columns)
    figure = Figure(figsize=(width * columns, height * rows))
    spheres = []
    places = figure.add_gridspec(rows, columns)
    for n, (i, kind) in enumerate(panels):
        (name, motion), (draw, count, _), place = scenes[i], PICTURES[kind], places[n]
        column: Any = place.subgridspec(count, 1).subplots(sharex=True) if count > 1 else []
        axes = [*column] or [figure.add_subplot(place)]
        shown = draw(motion, axes, options)
        stem = PurePath(name).stem if several else ""
        if title is None and shown not in stem:
            stem = f"{stem}: {shown}" if stem else shown
        axes[0].set_title(plain(stem) if title != "" else "", pad=18)
        if caption and several:
            add_caption(axes[-1], caption_of(motion, caption, options.units))
        spheres += axes * (kind == "sphere")
    add_time_bar(spheres, options.time_label)
    if title:
        figure.suptitle(plain(title), x=0.012, ha="left")
    if caption and not several:
        figure.supxlabel(caption_of(scenes[0][1], caption, options.units), size="medium")
    if engine := figure.get_layout_engine():  # for pictures of equal scales, two rounds do not do
        for _ in range(2):
            engine.execute(figure)
    return figure


def caption_of(motion: Motion, keys: Sequence[str], units: Units) -> str:
    """Return inputs and results of a motion, with their symbols and units, in one line.

    Raises LagtopError for an unknown key.
    """
    record = motion.record(
        keys=check_names("caption", keys, all_keys(units)), radians=units.radians
    )
    declared = shown_keys(units, requested=True)
    words = []
    for key in keys:
        value = record[key]
        if value is None:
            continue
        unit = declared[key].unit if units.si or key.endswith("deg") else ""  # names of no units
        shown = f"{value:.4g} {unit}" if isinstance(value, float) else str(value)
        words.append(f"{declared[key].symbol or key} = {shown}".strip())
    return ",  ".join(words)


def add_caption(axes: Axes, text: str) -> None:
    """Write a text below axes: above the legend, or else below the label."""
    if legend := axes.get_legend():
        legend.set_title(text)
        legend.get_title().set_fontsize("small")
    else:
        axes.set_xlabel(f"{axes.get_xlabel()}\n{text}".strip(), fontsize="small")


def columns_on_slide(count: int, shape: float) -> int:
    """Return the columns in which `count` panels of width/height `shape` are largest on 16:9."""
    return max(
        range(1, count + 1),
        key=lambda columns: min(16 / 9 / columns, shape / -(-count // columns)),
    )
