"""Random scenes, a stratum for each thing that is hard; a new stratum is one function in STRATA.

Starts are general, of both signs, and lengths, masses and times are of the size of 1 but for the
stratum of units.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any, NamedTuple

Scene = dict[str, float]


def log_uniform(rng: random.Random, low: float, high: float) -> float:
    """Return a number between 10^low and 10^high, its logarithm uniform."""
    return 10 ** rng.uniform(low, high)


def any_body(rng: random.Random) -> Scene:
    """Return a top with m = s = g = 1."""
    A = rng.uniform(0.5, 2)
    return {"m": 1, "s": 1, "g": 1, "A": A, "C": A * rng.uniform(0.05, 2)}


def signed(rng: random.Random, size: float) -> float:
    """Return the size with a random sign."""
    return rng.choice([-1, 1]) * size


def _generic(rng: random.Random) -> Scene:
    """Return a scene with any tilt and moderate rates."""
    return any_body(rng) | {
        "r0": rng.uniform(-6, 6),
        "theta0_deg": rng.uniform(1, 179),
        "thetadot0": rng.choice([0, rng.uniform(-3, 3)]),
        "psidot0": rng.uniform(-4, 4),
    }


def _from_rest(rng: random.Random) -> Scene:
    """Return the paper's case: a release from rest, slow to fast."""
    scene = any_body(rng) | {"theta0_deg": rng.uniform(1, 179)}
    return scene | {"r0": signed(rng, rng.choice([log_uniform(rng, -3, 3), rng.uniform(0.1, 6)]))}


def _fast(rng: random.Random) -> Scene:
    """Return a scene with a spin of 10^2 to 10^12."""
    return _generic(rng) | {"r0": signed(rng, log_uniform(rng, 2, 12))}


def _slow(rng: random.Random) -> Scene:
    """Return a scene with a spin of 10^-12 to 0.1."""
    scene = _generic(rng) | {"r0": signed(rng, log_uniform(rng, -12, -1))}
    return scene | {"psidot0": signed(rng, log_uniform(rng, -6, 0))}


def threshold_spin(scene: Scene) -> float:
    """Return the spin above which the upright top sleeps stably."""
    return 2 * math.sqrt(scene["A"]) / scene["C"]


def _upright(rng: random.Random, factor: float) -> Scene:
    """Return a start next to the upright position; `factor` is the spin over its threshold."""
    scene = _generic(rng)
    scene["r0"] = signed(rng, threshold_spin(scene) * factor)
    scene["theta0_deg"] = log_uniform(rng, -12, 0)
    scene["thetadot0"] = rng.choice([0, signed(rng, log_uniform(rng, -12, -1))])
    return scene


def _upright_below(rng: random.Random) -> Scene:
    """Return an upright start too slow to sleep, some within 10^-12 of the threshold."""
    return _upright(rng, rng.choice([rng.uniform(0.1, 0.99), 1 - log_uniform(rng, -12, -2)]))


def _upright_above(rng: random.Random) -> Scene:
    """Return an upright start fast enough to sleep, some within 10^-12 of the threshold."""
    return _upright(rng, rng.choice([rng.uniform(1.01, 5), 1 + log_uniform(rng, -12, -2)]))


def _hanging(rng: random.Random) -> Scene:
    """Return a start next to the lowest position."""
    scene = _generic(rng) | {"theta0_deg": 180 - log_uniform(rng, -12, 0)}
    return scene | {"thetadot0": rng.choice([0, signed(rng, log_uniform(rng, -12, -1))])}


def _separatrix(rng: random.Random) -> Scene:
    """Return a start with beta = b and alpha = a but for a small factor."""
    scene = _generic(rng)
    lam = rng.uniform(0.01, 0.9)
    scene["r0"] = signed(rng, threshold_spin(scene) * math.sqrt(lam))
    u = rng.uniform(2 * lam - 1, 1)
    return scene | to_pole(scene, u, 1, 2 / scene["A"] * (1 - u), log_uniform(rng, -15, -6))


def to_pole(scene: Scene, u: float, pole: int, speed2: float, miss: float = 0) -> Scene:
    """Return rates at cos(theta0) = u whose angular momentum leads almost over a pole."""
    b = scene["C"] * scene["r0"] / scene["A"]
    rate = pole * b / (1 + pole * u) * (1 + miss)
    theta_rate = math.sqrt(max(speed2 - rate * rate * (1 - u * u), 0))
    return {"theta0_deg": math.degrees(math.acos(u)), "psidot0": rate, "thetadot0": theta_rate}


def _bottom_pass(rng: random.Random) -> Scene:
    """Return a start that passes the lower pole within 10^-9 to 10^-6."""
    scene, u = _generic(rng), rng.uniform(-0.9, 0.9)
    scene["r0"] = rng.uniform(-2, 2)
    return scene | to_pole(scene, u, -1, rng.uniform(0, 30), log_uniform(rng, -9, -6))


def _top_pass(rng: random.Random) -> Scene:
    """Return a start that passes the upper pole within 10^-9 to 10^-6."""
    scene, u = _generic(rng), rng.uniform(-0.9, 0.9)
    scene["r0"] = rng.uniform(-2, 2)
    return scene | to_pole(scene, u, 1, rng.uniform(10, 40), log_uniform(rng, -9, -6))


def _tiny_nutation(rng: random.Random) -> Scene:
    """Return a steady precession, A u psi'^2 - C r0 psi' + m g s = 0, a little disturbed."""
    scene = _generic(rng) | {"thetadot0": 0.0}
    scene["r0"] = signed(rng, threshold_spin(scene) * rng.uniform(1, 5))
    u, b = math.cos(math.radians(scene["theta0_deg"])), scene["C"] * scene["r0"]
    root = math.copysign(math.sqrt(b * b - 4 * scene["A"] * u), b)
    scene["psidot0"] = 2 / (b + root) * (1 + signed(rng, log_uniform(rng, -12, -4)))
    return scene


def _sphere(rng: random.Random) -> Scene:
    """Return a scene with A = C."""
    scene = _generic(rng)
    return scene | {"C": scene["A"]}


def _disc(rng: random.Random) -> Scene:
    """Return a scene with C = 2A, the most a rigid body can have."""
    scene = _generic(rng)
    return scene | {"C": 2 * scene["A"]}


def _sphere_limit(rng: random.Random) -> Scene:
    """Return a scene with C within 10^-15 to 10^-6 of A."""
    scene = _generic(rng)
    return scene | {"C": scene["A"] * (1 + signed(rng, log_uniform(rng, -15, -6)))}


def _disc_limit(rng: random.Random) -> Scene:
    """Return C less than 2A by 10^-15 to 10^-6 of it, or a needle, C = 10^-6 to 10^-2 of A."""
    scene = _generic(rng)
    part = rng.choice([2 * (1 - log_uniform(rng, -15, -6)), log_uniform(rng, -6, -2)])
    return scene | {"C": scene["A"] * part}


def _units(rng: random.Random) -> Scene:
    """Return a generic scene in units of mass, length and time of 10^-30 to 10^30."""
    scene, (mass, length, time) = _generic(rng), (log_uniform(rng, -30, 30) for _ in range(3))
    scene |= {"m": mass, "s": length, "g": length / time**2}
    scene |= {key: scene[key] * mass * length**2 for key in ("A", "C")}
    return scene | {key: scene[key] / time for key in ("r0", "thetadot0", "psidot0")}


def _far_times(rng: random.Random) -> Scene:
    """Return a scene of another stratum, for 10^11 to 10^14 periods (see `hard_scene`)."""
    return rng.choice(
        [_generic, _fast, _slow, _upright_below, _hanging, _bottom_pass, _tiny_nutation]
    )(rng)


def _thresholds(rng: random.Random) -> Scene:
    """Return a scene next to where the program or the motion changes its kind, within 10^-15."""
    return rng.choice([_series_change, _sleeping_threshold, _hardly_torque, _hardly_start])(rng)


def _series_change(rng: random.Random) -> Scene:
    """Return a release at k = k' (lambda = cos(theta0)), where the series change their nome."""
    scene = any_body(rng) | {"theta0_deg": rng.uniform(1, 85)}
    lam = math.cos(math.radians(scene["theta0_deg"])) * (1 + signed(rng, log_uniform(rng, -15, -3)))
    return scene | {"r0": signed(rng, threshold_spin(scene) * math.sqrt(lam))}


def _sleeping_threshold(rng: random.Random) -> Scene:
    """Return a release next to the vertical, at the spin that just makes it sleep."""
    scene = any_body(rng) | {"theta0_deg": log_uniform(rng, -9, 0)}
    miss = 1 + signed(rng, log_uniform(rng, -15, -3))
    return scene | {"r0": signed(rng, threshold_spin(scene) * miss)}


def _hardly_torque(rng: random.Random) -> Scene:
    """Return a scene that is nearly torque-free."""
    return _generic(rng) | {"g": log_uniform(rng, -15, -6)}


def _hardly_start(rng: random.Random) -> Scene:
    """Return a scene next to a release from rest, and next to no spin."""
    scene = _generic(rng) | {"r0": signed(rng, log_uniform(rng, -15, -12))}
    return scene | {key: signed(rng, log_uniform(rng, -15, -6)) for key in ("thetadot0", "psidot0")}


STRATA: dict[str, Callable[[random.Random], Scene]] = {
    function.__name__[1:].replace("_", " "): function
    for function in (
        _generic,
        _from_rest,
        _fast,
        _slow,
        _upright_below,
        _upright_above,
        _hanging,
        _separatrix,
        _bottom_pass,
        _top_pass,
        _tiny_nutation,
        _sphere,
        _disc,
        _sphere_limit,
        _disc_limit,
        _units,
        _thresholds,
        _far_times,
    )
}


class HardScene(NamedTuple):
    """A scene of the battery and the times it is judged at."""

    inputs: Scene
    periods: list[float]
    """Times anywhere, in nutation periods."""
    quarters: list[int]
    """Times next to which angles leap if they leap anywhere, in quarters of a period."""

    def times(self, period: Any) -> list[float]:
        """Return all the times, with both neighbours of the double next to each quarter.

        `period` is the exact nutation period, in many digits.
        """
        times = [float(period * number) for number in self.periods]
        for number in self.quarters:
            t = float(period * number / 4)
            times += [t, math.nextafter(t, math.inf), math.nextafter(t, -math.inf)]
        return times


def hard_scene(stratum: str, seed: int, i: int, count: int) -> HardScene:
    """Return the i-th scene of a stratum, with `count` times anywhere and one half period at each
    side of the start, one of which may be a quarter or a whole number of periods instead."""
    rng = random.Random(f"{seed} {stratum} {i}")
    scene = STRATA[stratum](rng)
    least, nearest = (11, 11) if stratum == "far times" else (-9, 0)
    periods = [signed(rng, log_uniform(rng, least, 14)) for _ in range(count)]
    sides = rng.sample([-1, 1], 2)
    halves = [4 * int(log_uniform(rng, nearest, 14)) + part for part in (2, rng.randrange(4))]
    return HardScene(scene, periods, [side * n for side, n in zip(sides, halves, strict=True)])
