"""Random scenes of the worst kinds, for `fuzz.py`; each kind is one function and one entry.

Numbers are doubles, so that what is to be exact (a cusp, a pass over a pole, a steady precession)
uses tilts whose cosine is rational and numbers with few bits.  Kinds of `lagtop stability` stand
in `bench/hard_scenes.py`, with what both share.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from typing import Any

from lagrange_cli.bench.hard_scenes import (
    STRATA,
    any_body,
    log_uniform,
    signed,
    threshold_spin,
    to_pole,
)

Scene = dict[str, Any]
TILTS = {60: 0.5, 90: 0.0, 120: -0.5}
"""Degrees whose cosine is rational."""


def near(rng: random.Random, value: float) -> float:
    """Return a double next to a value, up to a few or up to 1e-2 of it away."""
    if rng.random() < 0.3:
        for _ in range(rng.randrange(3)):
            value = math.nextafter(value, signed(rng, math.inf))
        return value
    return value * (1 + signed(rng, log_uniform(rng, -16, -2)))


def body(rng: random.Random) -> Scene:
    """Return a top with m = s = g = 1, which may be a sphere, a disc or a needle."""
    scene: Scene = dict(any_body(rng))
    ratio = rng.choice([rng.uniform(0.01, 2), 1, 2, log_uniform(rng, -8, -2)])
    return scene | {"C": scene["A"] * ratio}


def generic(rng: random.Random) -> Scene:
    """Return a scene with nothing special, which may have no precession rate."""
    scene = STRATA["generic"](rng) | body(rng)
    return scene | {"psidot0": rng.choice([0, scene["psidot0"], scene["psidot0"]])}


def from_rest(rng: random.Random) -> Scene:
    """Return a release from rest, slow to fast."""
    scene = body(rng) | {"theta0_deg": rng.uniform(0.1, 179.9)}
    return scene | {"r0": signed(rng, rng.choice([log_uniform(rng, -3, 3), rng.uniform(0, 9)]))}


def in_radians(rng: random.Random) -> Scene:
    """Return a generic scene with its tilt in radians."""
    scene = generic(rng)
    scene["theta0_rad"] = math.radians(scene.pop("theta0_deg"))
    return scene


def extreme(rng: random.Random) -> Scene:
    """Return sizes from 1e-30 to 1e30, in units of their own and in the rates."""
    scene, (mass, length, second) = generic(rng), (log_uniform(rng, -20, 20) for _ in range(3))
    scene |= {"m": mass, "s": length, "g": length / second**2}
    scene |= {key: scene[key] * mass * length**2 for key in ("A", "C")}
    wild = rng.random() < 0.5
    for key in ("r0", "thetadot0", "psidot0"):
        scene[key] *= log_uniform(rng, -12, 12) / second if wild else 1 / second
    return scene


def fast(rng: random.Random) -> Scene:
    """Return large rates, one or all of them."""
    scene = generic(rng)
    for key in rng.sample(["r0", "thetadot0", "psidot0"], rng.choice([1, 1, 2, 3])):
        scene[key] = signed(rng, log_uniform(rng, 1, 15))
    return scene


def slow(rng: random.Random) -> Scene:
    """Return tiny rates, one or all of them."""
    scene = generic(rng)
    for key in rng.sample(["r0", "thetadot0", "psidot0"], rng.choice([1, 2, 3])):
        scene[key] = signed(rng, log_uniform(rng, -30, -1))
    return scene


def near_separatrix(rng: random.Random) -> Scene:
    """Return a swing that nearly ends upright."""
    scene = generic(rng)
    part = rng.uniform(0.05, 0.9)
    scene["r0"] = signed(rng, threshold_spin(scene) * math.sqrt(part))
    u = rng.uniform(2 * part - 1, 1)
    scene |= to_pole(scene, u, 1, 2 / scene["A"] * (1 - u))
    scene["thetadot0"] = signed(rng, near(rng, scene["thetadot0"]))
    return scene | {"psidot0": near(rng, scene["psidot0"])}


def separatrix(rng: random.Random) -> Scene:
    """Return exact separatrices, with thetadot0 = P x and cos(theta0) = c.

    With A = C = s = g = 1, 2 m = a, b = r0 = P (1 + c), thetadot0^2 = (1 - c)(a - P b).
    """
    degrees, turn = rng.choice([60, 120]), rng.randrange(1, 9) / 4
    c = TILTS[degrees]
    x = rng.randrange(-6, 7) * (0.25 if degrees == 60 else 0.75)  # x^2/(1 - c) ends in bits
    m = (turn * turn * (1 + c) + x * x / (1 - c)) / 2
    turn = signed(rng, turn)
    scene: Scene = {"m": m, "A": 1, "C": 1, "s": 1, "g": 1, "r0": turn * (1 + c)}
    return scene | {"theta0_deg": degrees, "psidot0": turn, "thetadot0": x}


def near_steady(rng: random.Random) -> Scene:
    """Return a steady precession, a little disturbed."""
    scene = generic(rng) | {"thetadot0": rng.choice([0, signed(rng, log_uniform(rng, -16, -3))])}
    scene["r0"] = signed(rng, threshold_spin(scene) * rng.uniform(1, 5))
    u, b = math.cos(math.radians(scene["theta0_deg"])), scene["C"] * scene["r0"]
    root = math.copysign(math.sqrt(max(b * b - 4 * scene["A"] * u, 0)), b)
    return scene | {"psidot0": near(rng, 2 / (b + root))}


def steady(rng: random.Random) -> Scene:
    """Return exact steady precessions, 2 b P = a + 2 P^2 cos(theta0)."""
    degrees, turn = rng.choice(list(TILTS)), signed(rng, 2.0 ** rng.randrange(-4, 5))
    m = rng.randrange(1, 64) / 8
    b = m / turn + turn * TILTS[degrees]
    scene: Scene = {"m": m, "A": 1, "C": 1, "s": 1, "g": 1, "r0": b}
    return scene | {"theta0_deg": degrees, "psidot0": turn}


def cusp(rng: random.Random) -> Scene:
    """Return a scene at a cusp: just off rest, or b N^2 + P (b P - a) sin^2 nearly 0."""
    scene = generic(rng)
    if rng.random() < 0.4:
        tiny = {key: signed(rng, log_uniform(rng, -18, -3)) for key in ("thetadot0", "psidot0")}
        tiny[rng.choice(["thetadot0", "psidot0"])] *= rng.choice([0, 1])
        return scene | tiny
    b, a = scene["C"] * scene["r0"] / scene["A"], 2 / scene["A"]
    turn = near(rng, a / b * rng.random())
    sine = math.sin(math.radians(scene["theta0_deg"]))
    rise = math.sqrt(max(turn * (a - b * turn) / b, 0)) * sine
    return scene | {"psidot0": turn, "thetadot0": signed(rng, near(rng, rise))}


def over_a_pole(rng: random.Random) -> Scene:
    """Return a start whose axis passes exactly over a pole, P (1 +- cos(theta0)) = +-b."""
    degrees, pole = rng.choice(list(TILTS)), rng.choice([-1, 1])
    turn = signed(rng, rng.randrange(1, 33) / 8)
    body = {"m": rng.randrange(1, 9) / 4, "A": 1, "C": rng.choice([0.5, 1, 2]), "s": 1, "g": 1}
    r0 = turn * pole * (1 + pole * TILTS[degrees]) / body["C"]
    fast = rng.choice([rng.uniform(-6, 6), rng.uniform(-1, 1), 0])
    return body | {"r0": r0, "theta0_deg": degrees, "psidot0": turn, "thetadot0": fast}


def from_a_pole(rng: random.Random) -> Scene:
    """Return a start on the vertical that leaves it."""
    scene = generic(rng) | {"theta0_deg": rng.choice([0, 180]), "psidot0": 0}
    scene["thetadot0"] = signed(rng, rng.choice([rng.uniform(0.01, 6), log_uniform(rng, -9, 1)]))
    return scene | {"r0": rng.choice([0, scene["r0"], scene["r0"]])}


def near_a_pole(rng: random.Random) -> Scene:
    """Return a start whose axis passes within 1e-16 to 1e-2 of a pole."""
    scene = generic(rng) | {"r0": rng.uniform(-3, 3)}
    u = math.cos(math.radians(scene["theta0_deg"]))
    scene |= to_pole(scene, u, rng.choice([-1, 1]), rng.uniform(0, 40))
    return scene | {"psidot0": near(rng, scene["psidot0"])}


def no_torque(rng: random.Random) -> Scene:
    """Return a free top, or nearly."""
    scene = generic(rng) | {rng.choice(["g", "s"]): rng.choice([0, 0, log_uniform(rng, -18, -3)])}
    scene["r0"] *= rng.choice([0, 1, 1, 1])
    scene["theta0_deg"] = rng.choice([60, 90, 0, scene["theta0_deg"]])
    return scene | ({} if scene["theta0_deg"] else {"psidot0": 0})


def no_spin(rng: random.Random) -> Scene:
    """Return a pendulum, plane or spherical, or nearly."""
    scene = generic(rng) | {"r0": rng.choice([0, 0, signed(rng, log_uniform(rng, -60, -6))])}
    scene["psidot0"] *= rng.choice([0, 1])
    return scene | {"theta0_deg": rng.choice([60, 90, 120, scene["theta0_deg"]])}


def tiny_tilt(rng: random.Random) -> Scene:
    """Return a start within 1e-30 to 1 degree of the vertical."""
    tilt = rng.choice([log_uniform(rng, -12, 0), log_uniform(rng, -30, 0)])
    scene = generic(rng) | {"theta0_deg": tilt}
    if rng.random() < 0.4:
        scene["theta0_deg"] = 180 - log_uniform(rng, -12, 0)
    factor = rng.choice([rng.uniform(0.1, 3), near(rng, 1), near(rng, 1)])
    scene["thetadot0"] = rng.choice([0, signed(rng, log_uniform(rng, -20, -1))])
    return scene | {
        "r0": signed(rng, threshold_spin(scene) * factor),
        "psidot0": rng.choice([0, 1, -2.5]),
    }


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


def tiny_tilt_with_rates(rng: random.Random) -> Scene:
    """Return a start with rates next to a pole: 1e-150 to 0.1 degrees, or 180 less 1e-300 to 0.1.

    Smaller tilts are refused; the latter are decimals.
    """
    scene = body(rng) | {"r0": signed(rng, log_uniform(rng, -3, 3))}
    tilt: float | Fraction = log_uniform(rng, -150, -1)
    if rng.random() < 0.4:
        tilt = 180 - Fraction(f"{rng.uniform(1, 9):.3f}e{rng.randrange(-300, -1)}")
    rates = {
        "thetadot0": rng.choice([0, signed(rng, log_uniform(rng, -25, 1)), 1]),
        "psidot0": rng.choice([0, signed(rng, log_uniform(rng, -25, 1)), 1]),
    }
    return scene | {"theta0_deg": tilt} | rates


def special_radians(rng: random.Random) -> Scene:
    """Return a tilt in radians next to 0, pi/2 or pi: within an ulp, or within 1e-30 of it."""
    scene, digits = generic(rng), rng.randrange(20, 60)
    del scene["theta0_deg"]
    quarters = rng.randrange(3)
    exact = Decimal(quarters) * _HALF_PI
    away = Decimal(log_uniform(rng, -30, -1))
    inwards = 1 if quarters == 0 else -1 if quarters == 2 else rng.choice([-1, 1])
    near_pole = exact + inwards * away
    tilt: float | Fraction = Fraction(f"{near_pole:.{digits}f}")
    if rng.random() < 0.5:
        tilt = float(near_pole) if 0 < float(near_pole) < math.pi else math.nextafter(math.pi, 0)
    if rng.random() < 0.5:
        scene |= {"thetadot0": 0, "psidot0": 0}
    return scene | {"theta0_rad": tilt if tilt > 0 else 1e-9}


_HALF_PI = Decimal("1.57079632679489661923132169163975144209858469968755291048747")


def any_spin(rng: random.Random) -> Scene:
    """Return |r0| from 1e-300 to 1e100 with both rates."""
    scene = generic(rng) | {"r0": signed(rng, log_uniform(rng, -300, 100))}
    return scene | {
        "thetadot0": rng.choice([0, rng.uniform(-3, 3)]),
        "psidot0": signed(rng, rng.choice([1, 3, log_uniform(rng, -6, 6)])),
    }


def next_to_a_cusp(rng: random.Random) -> Scene:
    """Return a start just off a cusp, or off two that coincide, by 1e-60 to 1e-3."""
    if rng.random() < 0.5:  # a double cusp: with b = a/2 the cubic at beta/b has a double root
        turn = Fraction(rng.randrange(1, 9), 4)
        m = rng.choice([1, 2, 5])
        off = Fraction(f"{rng.choice([-1, 1])}e{rng.randrange(-60, -2)}")
        scene: Scene = {"m": m, "A": 1, "C": 1, "s": 1, "g": 1, "r0": m / turn}
        rise = rng.choice([Fraction(1), Fraction(1, 2)])
        return scene | {"theta0_deg": 90, "thetadot0": rise, "psidot0": turn * (1 + off)}
    scene = cusp(rng)
    digits = rng.randrange(20, 60)
    rate = Fraction(scene["psidot0"]) * (1 + Fraction(f"{rng.uniform(-9, 9):.3f}e-{digits}"))
    return scene | {"psidot0": rate}


def in_doubles(scene: Scene) -> Scene:
    """Return a scene with each input rounded to the nearest double."""
    return {name: float(value) for name, value in scene.items()}


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


KINDS: dict[str, Callable[[random.Random], Scene]] = {
    function.__name__.replace("_", " "): function
    for function in (
        generic,
        from_rest,
        in_radians,
        extreme,
        fast,
        slow,
        near_separatrix,
        separatrix,
        near_steady,
        steady,
        cusp,
        over_a_pole,
        from_a_pole,
        near_a_pole,
        no_torque,
        no_spin,
        tiny_tilt,
        tiny_tilt_with_rates,
        special_radians,
        any_spin,
        next_to_a_cusp,
        nice_numbers,
    )
}
