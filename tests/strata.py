"""Random scenes, a stratum for each thing that is hard; general starts, both signs of all."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

Scene = dict[str, float]


def power(rng: random.Random, low: float, high: float) -> float:
    """A number between 10^low and 10^high, its logarithm uniform."""
    return 10 ** rng.uniform(low, high)


def body(rng: random.Random) -> Scene:
    A = rng.uniform(0.5, 2)
    return {"m": 1, "s": 1, "g": 1, "A": A, "C": A * rng.uniform(0.05, 2)}


def signed(rng: random.Random, size: float) -> float:
    return rng.choice([-1, 1]) * size


def generic(rng: random.Random) -> Scene:
    return body(rng) | {
        "r0": rng.uniform(-6, 6),
        "theta0_deg": rng.uniform(1, 179),
        "thetadot0": rng.choice([0, rng.uniform(-3, 3)]),
        "psidot0": rng.uniform(-4, 4),
    }


def fast(rng: random.Random) -> Scene:
    return generic(rng) | {"r0": signed(rng, power(rng, 2, 12))}


def slow(rng: random.Random) -> Scene:
    scene = generic(rng) | {"r0": signed(rng, power(rng, -12, -1))}
    return scene | {"psidot0": signed(rng, power(rng, -6, 0))}


def threshold_spin(scene: Scene) -> float:
    """The spin above which the upright top sleeps stably."""
    return 2 * math.sqrt(scene["A"]) / scene["C"]


def upright(rng: random.Random, factor: float) -> Scene:
    scene = generic(rng)
    scene["r0"] = signed(rng, threshold_spin(scene) * factor)
    scene["theta0_deg"] = power(rng, -12, 0)
    scene["thetadot0"] = rng.choice([0, signed(rng, power(rng, -12, -1))])
    return scene


def upright_below(rng: random.Random) -> Scene:
    return upright(rng, rng.choice([rng.uniform(0.1, 0.99), 1 - power(rng, -12, -2)]))


def upright_above(rng: random.Random) -> Scene:
    return upright(rng, rng.choice([rng.uniform(1.01, 5), 1 + power(rng, -12, -2)]))


def hanging(rng: random.Random) -> Scene:
    scene = generic(rng) | {"theta0_deg": 180 - power(rng, -12, 0)}
    return scene | {"thetadot0": rng.choice([0, signed(rng, power(rng, -12, -1))])}


def separatrix(rng: random.Random) -> Scene:
    """beta = b and alpha = a but for a small factor."""
    scene = generic(rng)
    lam = rng.uniform(0.01, 0.9)
    scene["r0"] = signed(rng, threshold_spin(scene) * math.sqrt(lam))
    u = rng.uniform(2 * lam - 1, 1)
    return scene | to_pole(scene, u, 1, 2 / scene["A"] * (1 - u), power(rng, -15, -6))


def to_pole(scene: Scene, u: float, pole: int, speed2: float, miss: float) -> Scene:
    """A start at cos(theta0) = u whose angular momentum leads it past a pole, almost over it."""
    b = scene["C"] * scene["r0"] / scene["A"]
    rate = pole * b / (1 + pole * u) * (1 + miss)
    theta_rate = math.sqrt(max(speed2 - rate * rate * (1 - u * u), 0))
    return {"theta0_deg": math.degrees(math.acos(u)), "psidot0": rate, "thetadot0": theta_rate}


def bottom_pass(rng: random.Random) -> Scene:
    scene, u = generic(rng), rng.uniform(-0.9, 0.9)
    scene["r0"] = rng.uniform(-2, 2)
    return scene | to_pole(scene, u, -1, rng.uniform(0, 30), power(rng, -9, -6))


def top_pass(rng: random.Random) -> Scene:
    scene, u = generic(rng), rng.uniform(-0.9, 0.9)
    scene["r0"] = rng.uniform(-2, 2)
    return scene | to_pole(scene, u, 1, rng.uniform(10, 40), power(rng, -9, -6))


def tiny_nutation(rng: random.Random) -> Scene:
    """A steady precession, A u psi'^2 - C r0 psi' + m g s = 0, a little disturbed."""
    scene = generic(rng) | {"thetadot0": 0.0}
    scene["r0"] = signed(rng, threshold_spin(scene) * rng.uniform(1, 5))
    u, b = math.cos(math.radians(scene["theta0_deg"])), scene["C"] * scene["r0"]
    root = math.copysign(math.sqrt(b * b - 4 * scene["A"] * u), b)
    scene["psidot0"] = 2 / (b + root) * (1 + signed(rng, power(rng, -12, -4)))
    return scene


def sphere(rng: random.Random) -> Scene:
    scene = generic(rng)
    return scene | {"C": scene["A"]}


def disc(rng: random.Random) -> Scene:
    scene = generic(rng)
    return scene | {"C": 2 * scene["A"]}


STRATA: dict[str, Callable[[random.Random], Scene]] = {
    function.__name__.replace("_", " "): function
    for function in (
        generic,
        fast,
        slow,
        upright_below,
        upright_above,
        hanging,
        separatrix,
        bottom_pass,
        top_pass,
        tiny_nutation,
        sphere,
        disc,
    )
}


def times(rng: random.Random, period: float, count: int = 5) -> list[float]:
    """Times of 1e-9 to 1e12 periods, before and after the start."""
    return [period * signed(rng, power(rng, -9, 12)) for _ in range(count)]
