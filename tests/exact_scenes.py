"""Scenes of exact kinds for tests, beside the random ones of `lagtop stability`.

An exact separatrix, precession or pass uses tilts whose cosine is rational and numbers with few
bits.  Named scenes, which tests share, are in `scenes.py`.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction

from hard_scenes import HARD_KINDS, Scene, generic, signed, ten_to

TILTS = {60: 0.5, 90: 0.0, 120: -0.5}
"""Degrees whose cosine is rational."""


def separatrix(rng: random.Random) -> Scene:
    """Return a swing that ends upright, exactly: thetadot0 = x with cos(theta0) = c.

    With A = C = s = g = 1 and psidot0 = P, 2 m = a, b = r0 = P (1 + c), x^2 = (1 - c)(a - P b).
    """
    degrees, turn = rng.choice([60, 120]), rng.randrange(1, 9) / 4
    c = TILTS[degrees]
    x = rng.randrange(-6, 7) * (0.25 if degrees == 60 else 0.75)  # x^2/(1 - c) ends in bits
    m = (turn * turn * (1 + c) + x * x / (1 - c)) / 2
    turn = signed(rng, turn)
    scene: Scene = {"m": m, "A": 1, "C": 1, "s": 1, "g": 1, "r0": turn * (1 + c)}
    return scene | {"theta0_deg": degrees, "psidot0": turn, "thetadot0": x}


def steady(rng: random.Random) -> Scene:
    """Return an exact steady precession, 2 b P = a + 2 P^2 cos(theta0)."""
    degrees, turn = rng.choice(list(TILTS)), signed(rng, 2.0 ** rng.randrange(-4, 5))
    m = rng.randrange(1, 64) / 8
    b = m / turn + turn * TILTS[degrees]
    scene: Scene = {"m": m, "A": 1, "C": 1, "s": 1, "g": 1, "r0": b}
    return scene | {"theta0_deg": degrees, "psidot0": turn}


def over_a_pole(rng: random.Random) -> Scene:
    """Return a start whose axis passes exactly over a pole, P (1 +- cos(theta0)) = +-b."""
    degrees, pole = rng.choice(list(TILTS)), rng.choice([-1, 1])
    turn = signed(rng, rng.randrange(1, 33) / 8)
    body = {"m": rng.randrange(1, 9) / 4, "A": 1, "C": rng.choice([0.5, 1, 2]), "s": 1, "g": 1}
    r0 = turn * pole * (1 + pole * TILTS[degrees]) / body["C"]
    rise = rng.choice([rng.uniform(-6, 6), rng.uniform(-1, 1), 0])
    return body | {"r0": r0, "theta0_deg": degrees, "psidot0": turn, "thetadot0": rise}


def from_a_pole(rng: random.Random) -> Scene:
    """Return a start on the vertical that leaves it."""
    scene = generic(rng) | {"theta0_deg": rng.choice([0, 180]), "psidot0": 0}
    scene["thetadot0"] = signed(rng, rng.choice([rng.uniform(0.01, 6), ten_to(rng, -9, 1)]))
    return scene | {"r0": rng.choice([0, scene["r0"], scene["r0"]])}


def no_torque(rng: random.Random) -> Scene:
    """Return a top without torque, or nearly."""
    scene = generic(rng) | {rng.choice(["g", "s"]): rng.choice([0, 0, ten_to(rng, -18, -3)])}
    scene["r0"] *= rng.choice([0, 1, 1, 1])
    scene["theta0_deg"] = rng.choice([60, 90, 0, scene["theta0_deg"]])
    return scene | ({} if scene["theta0_deg"] else {"psidot0": 0})


def nice_numbers(rng: random.Random) -> Scene:
    """Return small rationals, whose keys are often exactly 0, or midway between two doubles."""
    few = [0, 0.25, 0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 10]

    def either() -> float:
        return signed(rng, rng.choice(few))

    A = rng.choice([0.5, 1, 2, 3])
    C = A * rng.choice([0.25, 0.5, 1, 2])
    scene = {"m": rng.choice([0.5, 1, 2, 3]), "A": A, "C": C, "s": 1, "g": rng.choice([1, 1, 10])}
    tilts = [30, 45, 60, 60, 60, 90, 90, 90, 120, 120, 120, 135, 150, 0, 180]
    degrees = rng.choice([*tilts, rng.randrange(1, 180)])
    still = degrees in (0, 180)
    psidot0 = 0.0 if still else rng.choice([0, 0, either()])
    thetadot0 = rng.choice([0, 0, either()])
    return scene | {
        "r0": either(),
        "theta0_deg": degrees,
        "thetadot0": thetadot0,
        "psidot0": psidot0,
    }


def as_decimals(rng: random.Random, scene: Scene) -> Scene:
    """Return a scene whose inputs, but for integers, have 20 to 60 digits more at random."""

    def longer(x: float | Fraction) -> float | Fraction:
        if isinstance(x, Fraction) or x == int(x) or not 1e-290 < abs(x) < 1e90:
            return x
        more = "".join(rng.choice("0123456789") for _ in range(rng.randrange(3, 43)))
        mantissa, _, exponent = repr(float(x)).partition("e")
        exact = Fraction(f"{mantissa}{more}e{exponent or 0}")
        return exact if abs(exact) <= 180 or exact != x else x

    longer_scene = {name: longer(x) for name, x in scene.items()}
    if scene["C"] == 2 * scene["A"]:  # no rigid body has more
        longer_scene["C"] = 2 * longer_scene["A"]
    return longer_scene


KINDS: dict[str, Callable[[random.Random], Scene]] = HARD_KINDS | {
    function.__name__.replace("_", " "): function
    for function in (separatrix, steady, over_a_pole, from_a_pole, no_torque, nice_numbers)
}
