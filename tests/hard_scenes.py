"""Random scenes of every hard kind, with a function for each, whose docstring describes it.

Starts are general, of both signs.  Lengths, masses and times are of the size of 1, unless a kind
states otherwise.  Numbers are doubles, or fractions if a double cannot be near enough to the hard
case.  An exact separatrix, cusp, pass or precession uses tilts whose cosine is rational and numbers
with few bits.  A new kind is one function in KINDS.  Named scenes are in `scenes.py`.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from typing import Any

from lagtop import LagtopError, Top, solve

from lagrange_cli.bench.reference import exact_motion

Scene = dict[str, Any]
_HALF_PI = Decimal("1.57079632679489661923132169163975144209858469968755291048747")
_RATES = ("r0", "thetadot0", "psidot0")


def ten_to(rng: random.Random, low: float, high: float) -> float:
    """Return a number between 10^low and 10^high, with a uniform logarithm."""
    return 10 ** rng.uniform(low, high)


def signed(rng: random.Random, size: float) -> float:
    """Return the size with a random sign."""
    return rng.choice([-1, 1]) * size


def near(rng: random.Random, value: float) -> float:
    """Return a double next to a value, up to a few or up to 1e-2 of it away."""
    if rng.random() < 0.3:
        for _ in range(rng.randrange(3)):
            value = math.nextafter(value, signed(rng, math.inf))
        return value
    return value * (1 + signed(rng, ten_to(rng, -16, -2)))


def _body(rng: random.Random) -> Scene:
    """Return a body, which may be a sphere, a disc (C = 2A), a needle, or nearly."""
    A, tiny = rng.uniform(0.5, 2), rng.choice([0.0, ten_to(rng, -15, -6)])
    some = rng.uniform(0.01, 2), ten_to(rng, -8, -2)
    ratio = rng.choice([*some, 1 + signed(rng, tiny), 2 * (1 - tiny)])
    return {"m": 1, "s": 1, "g": 1, "A": A, "C": A * ratio}


def _threshold_spin(scene: Scene) -> float:
    """Return the spin above which the upright top sleeps stably."""
    return float(2 * math.sqrt(scene["A"]) / scene["C"])


def _to_pole(scene: Scene, u: float, pole: int, speed2: float) -> Scene:
    """Return rates at cos(theta0) = u for which the axis passes over a pole."""
    rate = pole * scene["C"] * scene["r0"] / scene["A"] / (1 + pole * u)
    theta_rate = math.sqrt(max(speed2 - rate * rate * (1 - u * u), 0))
    return {"theta0_deg": math.degrees(math.acos(u)), "psidot0": rate, "thetadot0": theta_rate}


def ordinary(rng: random.Random) -> Scene:
    """Return an ordinary top with moderate rates."""
    A = rng.uniform(0.5, 2)
    return {
        **{"m": 1, "s": 1, "g": 1, "A": A, "C": A * rng.uniform(0.05, 2)},
        "r0": rng.uniform(-6, 6),
        "theta0_deg": rng.uniform(1, 179),
        "thetadot0": rng.choice([0, rng.uniform(-3, 3)]),
        "psidot0": rng.uniform(-4, 4),
    }


def generic(rng: random.Random) -> Scene:
    """Return any start of any body: a sphere, a disc, a needle."""
    scene = ordinary(rng) | _body(rng)
    return scene | {"psidot0": rng.choice([0, scene["psidot0"], scene["psidot0"]])}


def from_rest(rng: random.Random) -> Scene:
    """Return a release from rest, slow to fast."""
    scene = _body(rng) | {"theta0_deg": rng.uniform(0.1, 179.9)}
    return scene | {"r0": signed(rng, rng.choice([ten_to(rng, -3, 3), rng.uniform(0, 9)]))}


def units(rng: random.Random) -> Scene:
    """Return masses, lengths and times of 1e-20 to 1e20."""
    scene, (mass, length, second) = generic(rng), (ten_to(rng, -20, 20) for _ in range(3))
    scene |= {"m": mass, "s": length, "g": length / second**2}
    scene |= {key: scene[key] * mass * length**2 for key in ("A", "C")}
    wild = rng.random() < 0.5
    for key in _RATES:
        scene[key] *= ten_to(rng, -12, 12) / second if wild else 1 / second
    return scene


def stiff(rng: random.Random) -> Scene:
    """Return a fast spin, or other rates, of 10 to 1e15."""
    scene = generic(rng)
    for key in rng.choice([["r0"], ["r0"], rng.sample(_RATES, rng.choice([1, 2, 3]))]):
        scene[key] = signed(rng, ten_to(rng, 1, 15))
    return scene


def slow(rng: random.Random) -> Scene:
    """Return tiny rates, one or all of them."""
    scene = generic(rng)
    for key in rng.sample(_RATES, rng.choice([1, 2, 3])):
        scene[key] = signed(rng, ten_to(rng, -30, -1))
    return scene


def near_separatrix(rng: random.Random) -> Scene:
    """Return a swing that nearly ends upright."""
    scene = generic(rng)
    part = rng.uniform(0.05, 0.9)
    scene["r0"] = signed(rng, _threshold_spin(scene) * math.sqrt(part))
    u = rng.uniform(2 * part - 1, 1)
    scene |= _to_pole(scene, u, 1, 2 / scene["A"] * (1 - u))
    scene["thetadot0"] = signed(rng, near(rng, scene["thetadot0"]))
    return scene | {"psidot0": near(rng, scene["psidot0"])}


def near_steady(rng: random.Random) -> Scene:
    """Return a steady precession, a little disturbed."""
    scene = generic(rng) | {"thetadot0": rng.choice([0, signed(rng, ten_to(rng, -16, -3))])}
    scene["r0"] = signed(rng, _threshold_spin(scene) * rng.uniform(1, 5))
    u, b = math.cos(math.radians(scene["theta0_deg"])), scene["C"] * scene["r0"]
    root = math.copysign(math.sqrt(max(b * b - 4 * scene["A"] * u, 0)), b)
    return scene | {"psidot0": near(rng, 2 / (b + root))}


def next_to_a_cusp(rng: random.Random) -> Scene:
    """Return a start off a cusp, by 1e-2 to 1e-60 of its rates.

    It is just off rest, or b N^2 + P (b P - a) sin^2 nearly 0.
    """
    scene = generic(rng)
    if rng.random() < 0.4:
        tiny = {key: signed(rng, ten_to(rng, -18, -3)) for key in ("thetadot0", "psidot0")}
        tiny[rng.choice(["thetadot0", "psidot0"])] *= rng.choice([0, 1])
        return scene | tiny
    b, a = scene["C"] * scene["r0"] / scene["A"], 2 / scene["A"]
    turn = near(rng, a / b * rng.random())
    sine = math.sin(math.radians(scene["theta0_deg"]))
    rise = math.sqrt(max(turn * (a - b * turn) / b, 0)) * sine
    off = Fraction(rng.choice(["0", f"{rng.uniform(-9, 9):.3f}e-{rng.randrange(20, 60)}"]))
    return scene | {
        "psidot0": (1 + off) * Fraction(turn),
        "thetadot0": signed(rng, near(rng, rise)),
    }


def double_cusp(rng: random.Random) -> Scene:
    """Return a start off two cusps that coincide, by 1e-60 to 1e-3."""
    turn = Fraction(rng.randrange(1, 9), 4)  # b = a/2: the cubic at beta/b has a double root
    m = rng.choice([1, 2, 5])
    off = Fraction(f"{rng.choice([-1, 1])}e{rng.randrange(-60, -2)}")
    scene: Scene = {"m": m, "A": 1, "C": 1, "s": 1, "g": 1, "r0": m / turn}
    rise = rng.choice([Fraction(1), Fraction(1, 2)])
    return scene | {"theta0_deg": 90, "thetadot0": rise, "psidot0": turn * (1 + off)}


def near_a_pole(rng: random.Random) -> Scene:
    """Return a start whose axis passes within 1e-16 to 1e-2 of a pole."""
    scene = generic(rng) | {"r0": rng.uniform(-3, 3)}
    u = math.cos(math.radians(scene["theta0_deg"]))
    scene |= _to_pole(scene, u, rng.choice([-1, 1]), rng.uniform(0, 40))
    return scene | {"psidot0": near(rng, scene["psidot0"])}


def no_spin(rng: random.Random) -> Scene:
    """Return a pendulum, plane or spherical, or nearly."""
    scene = generic(rng) | {"r0": rng.choice([0, 0, signed(rng, ten_to(rng, -60, -6))])}
    scene["psidot0"] *= rng.choice([0, 1])
    return scene | {"theta0_deg": rng.choice([60, 90, 120, scene["theta0_deg"]])}


def tiny_tilt(rng: random.Random) -> Scene:
    """Return a tilt of 1e-30 to 1 degree from the vertical.

    The spin is next to the threshold above which an upright top sleeps.
    """
    tilt = rng.choice([ten_to(rng, -12, 0), ten_to(rng, -30, 0), 180 - ten_to(rng, -12, 0)])
    scene = generic(rng) | {"theta0_deg": tilt}
    factor = rng.choice([rng.uniform(0.1, 3), near(rng, 1), near(rng, 1)])
    return scene | {
        "r0": signed(rng, _threshold_spin(scene) * factor),
        "thetadot0": rng.choice([0, signed(rng, ten_to(rng, -20, -1))]),
        "psidot0": rng.choice([0, 1, -2.5]),
    }


def tiny_tilt_with_rates(rng: random.Random) -> Scene:
    """Return rates at a tilt of 1e-150 to 0.1 degrees, or next to 180.

    Smaller tilts are refused; those next to 180, 1e-300 to 0.1 degrees below, are decimals.
    """
    tilt: float | Fraction = ten_to(rng, -150, -1)
    if rng.random() < 0.4:
        tilt = 180 - Fraction(f"{rng.uniform(1, 9):.3f}e{rng.randrange(-300, -1)}")
    scene = _body(rng) | {"r0": signed(rng, ten_to(rng, -3, 3)), "theta0_deg": tilt}
    for key in ("thetadot0", "psidot0"):
        scene[key] = rng.choice([0, signed(rng, ten_to(rng, -25, 1)), 1])
    return scene


def radians(rng: random.Random) -> Scene:
    """Return a tilt in radians, mostly next to 0, pi/2 or pi."""
    scene, digits, quarters = generic(rng), rng.randrange(20, 60), rng.randrange(3)
    degrees = scene.pop("theta0_deg")
    if rng.random() < 0.2:
        return scene | {"theta0_rad": math.radians(degrees)}
    inwards = 1 if quarters == 0 else -1 if quarters == 2 else rng.choice([-1, 1])
    exact = quarters * _HALF_PI + inwards * Decimal(ten_to(rng, -30, -1))
    tilt: float | Fraction = Fraction(f"{exact:.{digits}f}")
    if rng.random() < 0.5:
        tilt = float(exact) if 0 < float(exact) < math.pi else math.nextafter(math.pi, 0)
    if rng.random() < 0.5:
        scene |= {"thetadot0": 0, "psidot0": 0}
    return scene | {"theta0_rad": tilt if tilt > 0 else 1e-9}


def any_spin(rng: random.Random) -> Scene:
    """Return a spin from 1e-300 to 1e100, with both rates."""
    scene = generic(rng) | {"r0": signed(rng, ten_to(rng, -300, 100))}
    return scene | {
        "thetadot0": rng.choice([0, rng.uniform(-3, 3)]),
        "psidot0": signed(rng, rng.choice([1, 3, ten_to(rng, -6, 6)])),
    }


def thresholds(rng: random.Random) -> Scene:
    """Return a start close to k = k', to no torque or to rest."""
    kind, miss = rng.randrange(3), 1 + signed(rng, ten_to(rng, -15, -3))
    if kind == 0:
        scene = _body(rng) | {"theta0_deg": rng.uniform(1, 85)}
        lam = math.cos(math.radians(scene["theta0_deg"])) * miss  # at k = k'
        return scene | {"r0": signed(rng, _threshold_spin(scene) * math.sqrt(lam))}
    if kind == 1:
        return ordinary(rng) | {"g": ten_to(rng, -15, -6)}
    return ordinary(rng) | {key: signed(rng, ten_to(rng, -15, -6)) for key in _RATES}


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


HARD_KINDS: dict[str, Callable[[random.Random], Scene]] = {
    function.__name__.replace("_", " "): function
    for function in (
        *(generic, from_rest, stiff, slow, tiny_tilt, tiny_tilt_with_rates, near_a_pole),
        *(near_separatrix, near_steady, next_to_a_cusp, double_cusp, no_spin, radians, units),
        *(any_spin, thresholds),
    )
}
"""The kinds whose tops nearly all nutate under a torque, by name."""
KINDS = HARD_KINDS | {
    function.__name__.replace("_", " "): function
    for function in (separatrix, steady, over_a_pole, from_a_pole, no_torque, nice_numbers)
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


def in_doubles(scene: Scene) -> Scene:
    """Return a scene with each input rounded to the nearest double."""
    return {name: float(value) for name, value in scene.items()}


def nutating(kind: str, rng: random.Random) -> Scene:
    """Return the inputs, as doubles, of a scene of a kind that nutates under a torque."""
    while True:
        scene = in_doubles(HARD_KINDS[kind](rng))
        with suppress(LagtopError):
            exact_motion(solve(Top(**scene)))
            return scene


COSINES = ("u1", "u2", "u_quarter")


def size_in_sweeps(key: str, record: Mapping[str, Any], r0: Any) -> Any:
    """Return the size to which a sweep's error of a key is compared, given the exact record.

    It is 1 for a cosine and the larger part of a difference for a rate at T/2.
    """
    if key in COSINES:
        return 1
    if not key.endswith("rate_half"):
        return abs(record[key])
    turn, apart = record["precession_rate_half"], record["spin_rate_half"] - r0
    return max(abs(r0), abs(turn + apart) / 2, abs(turn - apart) / 2)
