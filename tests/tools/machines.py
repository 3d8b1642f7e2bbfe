"""Motions of machines and data that are nearly those of a Lagrange top, for `fuzz_fits.py`.

Every machine is integrated by itself, and nothing of the closed form or of the templates of `fit`
is used.  Sizes are fractions, such as 0.1 for a stand with a tenth of A.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from engines import Array
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.signal import savgol_filter

Angles = dict[str, Array]
_LOCKED = 0.1
"""sin(theta) below which gimbals lock."""
_PRECISE = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-11}


def gimballed(a: float, b: float, r0: float, start: Array, t: Array, **sizes: float) -> Angles:
    """Return the angles of a gyroscope with A = 1 in gimbals, by Lagrange's equations.

    `start` is (theta, thetadot, psidot).  The sizes are moments of a `stand` and a `yoke`, losses
    over the recording by a `drag` or `dry` friction of the spin and in the bearings of the
    `vertical` and the `nodes`, and a `magnet`.  All angles are 0 if the axis comes near a
    pole, where gimbals lock.
    """
    of = dict.fromkeys(("stand", "yoke", "drag", "dry", "vertical", "nodes", "magnet"), 0.0) | sizes

    def slope(_: float, y: Array) -> list[float]:
        theta, v, _, w, _, spin = y.tolist()
        s, c = math.sin(theta), math.cos(theta)
        lost = of["drag"] * spin + of["dry"] * b
        torque = s * c * w * w - spin * w * s + a / 2 * s + of["magnet"] * a * s * c
        bend = (torque - of["nodes"] * v / t[-1]) / (1 + of["yoke"])
        turn = -2 * s * c * v * w + spin * s * v - of["vertical"] * w / t[-1]
        turn /= s * s + of["stand"]
        return [v, bend, w, turn, r0 / b * spin - w * c, -lost / t[-1]]

    def height(_: float, y: Array) -> float:
        return math.sin(y[0]) - _LOCKED

    height.terminal = True  # type: ignore[attr-defined]
    first = [start[0], start[1], 0.0, start[2], 0.0, b]
    found = solve_ivp(slope, (0, t[-1]), first, t_eval=t, events=height, **_PRECISE)
    theta, _, psi, _, phi, _ = found.y if found.status == 0 else np.zeros((6, t.size))
    return {"theta": theta, "phi": phi, "psi": psi}


def unlike(a: float, b: float, r0: float, start: Array, t: Array, **sizes: float) -> Angles:
    """Return the angles of a body with unlike moments, or a centre of mass beside the axis.

    Euler's equations in the frame of the body, with a quaternion.
    """
    of = {"moments": 0.0, "beside": 0.0} | sizes
    inertia = np.array([1 + of["moments"] / 2, 1 - of["moments"] / 2, b / r0])
    centre = np.array([of["beside"], 0.0, 1.0])

    def slope(_: float, y: Array) -> Array:
        (w, x, v, z), rate = y[:4], y[4:]
        up = np.array([2 * (x * z - w * v), 2 * (v * z + w * x), w * w + z * z - x * x - v * v])
        p, q, r = rate
        turn = [-x * p - v * q - z * r, w * p + v * r - z * q]
        turn += [w * q + z * p - x * r, w * r + x * q - v * p]
        torque = np.cross(up, centre) * a / 2 - np.cross(rate, inertia * rate)
        return np.concatenate([np.array(turn) / 2, torque / inertia])

    theta, thetadot, psidot = start
    first = [math.cos(theta / 2), math.sin(theta / 2), 0, 0, thetadot, psidot * math.sin(theta), r0]
    w, x, v, z, *_ = solve_ivp(slope, (0, t[-1]), first, t_eval=t, **_PRECISE).y
    upper, lower = np.arctan2(z, w), np.arctan2(v, x)
    theta = 2 * np.arctan2(np.hypot(x, v), np.hypot(w, z))
    return {"theta": theta, "phi": np.unwrap(upper - lower), "psi": np.unwrap(upper + lower)}


class Machine(NamedTuple):
    """A machine or a fault of data: its integrator, the name of its size, and words of a name."""

    motion: Callable[..., Angles] | None
    size: str
    words: str
    needs: str = ""
    """An angle that it changes, without which it is nothing."""


MACHINES = {
    "stand": Machine(gimballed, "stand", "stand|scale"),
    "yoke": Machine(gimballed, "yoke", "yoke"),
    "drag": Machine(gimballed, "drag", "decay"),
    "dry": Machine(gimballed, "dry", "decay"),
    "bearing": Machine(gimballed, "vertical", "vertical bearing"),
    "magnet": Machine(gimballed, "magnet", "second torque"),
    "moments": Machine(unlike, "moments", "moments"),
    "beside": Machine(unlike, "beside", "off the axis"),
    "camera": Machine(None, "", "camera|scale", "psi"),
    "zero": Machine(None, "", "zero|elevation", "theta"),
    "scale": Machine(None, "", "scale|camera", "psi"),
    "clock": Machine(None, "", "clock"),
    "filter": Machine(None, "", "filter|smooth"),
    "jump": Machine(None, "", "jump"),
    "repeated": Machine(None, "", "repeat|doubled"),
    "doubled": Machine(None, "", "repeat|equal|doubled"),
    "lost": Machine(None, "", "lost"),
    "runs": Machine(None, "", "again|jump|lost|begin"),
}


def disturbed(name: str, size: float, t: Array, seen: Angles, rng: np.random.Generator) -> Angles:
    """Return smooth angles with a fault of the camera or of the reading."""
    seen = {x: y if x == "theta" else np.unwrap(y) for x, y in seen.items()}
    if name == "camera":
        seen["psi"] = seen["psi"] + size * np.polyfit(t, seen["psi"], 1)[0] * t
    elif name == "zero":
        seen["theta"] = seen["theta"] + size
    elif name == "scale":
        seen["psi"] = seen["psi"] * (1 + size)
    elif name == "jump":
        angle, row = rng.choice([*seen]), int(t.size * rng.uniform(0.2, 0.8))
        seen[angle] = seen[angle] + size * (np.arange(t.size) >= row)
    return seen


def rows_of(name: str, count: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """Return the rows that a recorder with a fault writes in place of all rows."""
    rows = np.arange(count)
    at = int(count * rng.uniform(0.2, 0.8))
    number = int(rng.integers(1, 4))
    if name == "lost":
        return np.concatenate([rows[:at], rows[at + number :]])
    if name == "doubled":
        return np.sort(np.concatenate([rows, at + np.arange(number)]))
    if name == "repeated":  # 24 frames per second as 30
        return np.asarray(rows - (rows % 5 == 4), np.intp)
    if name == "runs":
        return np.concatenate([rows[: 2 * count // 3], rows[: count // 3]])
    return rows


def filtered(y: Array, width: int, kind: str) -> Array:
    """Return data after a filter of a recorder, `width` rows wide."""
    if kind == "mean":
        padded = np.pad(y, width // 2, mode="edge")
        return np.convolve(padded, np.ones(width) / width, "valid")
    if kind == "cubic":
        return np.asarray(savgol_filter(y, max(width, 5), 2))
    found = y.copy()
    share = 1 - math.exp(-2 / width)
    for i in range(1, y.size):
        found[i] = found[i - 1] + share * (y[i] - found[i - 1])
    return found
