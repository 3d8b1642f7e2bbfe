"""Random scenes of every hard kind: the one list of `stability`, of the tests and of the fuzz.

A kind is a function, and its docstring describes it.  Starts are general, of both signs.  Lengths,
masses and times are of the size of 1, unless a kind states otherwise.  Numbers are doubles, or
fractions if a double cannot be near enough to the hard case.  An exact separatrix, cusp, pass or
precession uses tilts whose cosine is rational and numbers with few bits.

Many kinds change a random `top`.  `powers` is a range of exponents of ten: of a size, or of the
relative distance from a value.  A new kind is one function, listed in NUTATING_KINDS or KINDS.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from decimal import Decimal
from fractions import Fraction
from functools import partial
from random import Random
from typing import Any

from ..errors import LagtopError
from ..solver.solve import solve
from ..top.top import Top
from .reference import exact_motion

Scene = dict[str, Any]
Kind = Callable[[Random], Scene]
Powers = tuple[float, float]
_HALF_PI = Decimal("1.57079632679489661923132169163975144209858469968755291048747")
_RATES = ("r0", "thetadot0", "psidot0")


def ten_to(rng: Random, low: float, high: float) -> float:
    """Return a number between 10^low and 10^high, with a uniform logarithm."""
    return 10 ** rng.uniform(low, high)


def signed(rng: Random, size: float) -> float:
    """Return the size with a random sign."""
    return rng.choice([-1, 1]) * size


def near(rng: Random, value: float, powers: Powers | None = None) -> float:
    """Return a double next to a value; without `powers` up to a few or up to 1e-2 of it away."""
    if not powers and rng.random() < 0.3:
        for _ in range(rng.randrange(3)):
            value = math.nextafter(value, signed(rng, math.inf))
        return value
    return value * (1 + signed(rng, ten_to(rng, *powers or (-16, -2))))


def _body(rng: Random) -> Scene:
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


def moving(rng: Random) -> Scene:
    """Return an ordinary top with moderate rates."""
    A = rng.uniform(0.5, 2)
    return {
        **{"m": 1, "s": 1, "g": 1, "A": A, "C": A * rng.uniform(0.05, 2)},
        "r0": rng.uniform(-6, 6),
        "theta0_deg": rng.uniform(1, 179),
        "thetadot0": rng.uniform(-3, 3),
        "psidot0": rng.uniform(-4, 4),
    }


def released(rng: Random) -> Scene:
    """Return an ordinary top that is released from rest, with a moderate spin."""
    return moving(rng) | {"thetadot0": 0, "psidot0": 0}


def ordinary(rng: Random) -> Scene:
    """Return an ordinary top; half of them start at an end of their nutation."""
    scene = moving(rng)
    return scene | {"thetadot0": rng.choice([0, scene["thetadot0"]])}


def generic(rng: Random) -> Scene:
    """Return any start of any body: a sphere, a disc, a needle."""
    scene = ordinary(rng) | _body(rng)
    return scene | {"psidot0": rng.choice([0, scene["psidot0"], scene["psidot0"]])}


def from_rest(rng: Random) -> Scene:
    """Return a release from rest, slow to fast."""
    scene = generic(rng) | {"thetadot0": 0, "psidot0": 0}
    return scene | {"r0": signed(rng, rng.choice([ten_to(rng, -3, 3), rng.uniform(0, 9)]))}


def units(rng: Random, top: Kind = generic, powers: Powers = (-20, 20), wild: bool = True) -> Scene:
    """Return masses, lengths and times of 1e-20 to 1e20; half of the wild ones with other rates."""
    scene, (mass, length, second) = top(rng), (ten_to(rng, *powers) for _ in range(3))
    scene |= {"m": mass, "s": length, "g": length / second**2}
    scene |= {key: scene[key] * mass * length**2 for key in ("A", "C")}
    wild = wild and rng.random() < 0.5
    for key in _RATES:
        scene[key] *= ten_to(rng, -12, 12) / second if wild else 1 / second
    return scene


def stiff(rng: Random, top: Kind = generic, powers: Powers = (1, 15), among: str = "") -> Scene:
    """Return fast rates: the spin, or some `among` those named."""
    return slow(rng, top, powers, among or rng.choice(["r0", "r0", " ".join(_RATES)]))


def slow(
    rng: Random, top: Kind = generic, powers: Powers = (-30, -1), among: str = " ".join(_RATES)
) -> Scene:
    """Return tiny rates, some or all of those named."""
    scene, names = top(rng), among.split()
    for key in rng.sample(names, rng.randint(1, len(names))):
        scene[key] = signed(rng, ten_to(rng, *powers))
    return scene


def near_separatrix(rng: Random, top: Kind = generic, powers: Powers | None = None) -> Scene:
    """Return a swing that nearly ends upright."""
    scene = top(rng)
    part = rng.uniform(0.05, 0.9)
    scene["r0"] = signed(rng, _threshold_spin(scene) * math.sqrt(part))
    u = rng.uniform(2 * part - 1, 1)
    scene |= _to_pole(scene, u, 1, 2 / scene["A"] * (1 - u))
    scene["thetadot0"] = signed(rng, near(rng, scene["thetadot0"], powers))
    return scene if powers else scene | {"psidot0": near(rng, scene["psidot0"])}


def near_steady(rng: Random, top: Kind = generic, powers: Powers | None = None) -> Scene:
    """Return a steady precession, a little disturbed."""
    scene = top(rng) | {"thetadot0": rng.choice([0, signed(rng, ten_to(rng, -16, -3))])}
    scene["r0"] = signed(rng, _threshold_spin(scene) * rng.uniform(1, 5))
    u, b = math.cos(math.radians(scene["theta0_deg"])), scene["C"] * scene["r0"]
    root = math.copysign(math.sqrt(max(b * b - 4 * scene["A"] * u, 0)), b)
    return scene | {"psidot0": near(rng, 2 / (b + root), powers)}


def next_to_a_cusp(rng: Random) -> Scene:
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


def double_cusp(rng: Random) -> Scene:
    """Return a start off two cusps that coincide, by 1e-60 to 1e-3."""
    turn = Fraction(rng.randrange(1, 9), 4)  # b = a/2: the cubic at beta/b has a double root
    m = rng.choice([1, 2, 5])
    off = Fraction(f"{rng.choice([-1, 1])}e{rng.randrange(-60, -2)}")
    scene: Scene = {"m": m, "A": 1, "C": 1, "s": 1, "g": 1, "r0": m / turn}
    rise = rng.choice([Fraction(1), Fraction(1, 2)])
    return scene | {"theta0_deg": 90, "thetadot0": rise, "psidot0": turn * (1 + off)}


def near_a_pole(rng: Random, top: Kind = generic, powers: Powers | None = None) -> Scene:
    """Return a start whose axis passes within 1e-16 to 1e-2 of a pole."""
    scene = top(rng) | {"r0": rng.uniform(-3, 3)}
    u = math.cos(math.radians(scene["theta0_deg"]))
    scene |= _to_pole(scene, u, rng.choice([-1, 1]), rng.uniform(0, 40))
    return scene | {"psidot0": near(rng, scene["psidot0"], powers)}


def no_spin(rng: Random) -> Scene:
    """Return a pendulum, plane or spherical, or nearly."""
    scene = generic(rng) | {"r0": rng.choice([0, 0, signed(rng, ten_to(rng, -60, -6))])}
    scene["psidot0"] *= rng.choice([0, 1])
    return scene | {"theta0_deg": rng.choice([60, 90, 120, scene["theta0_deg"]])}


def tiny_tilt(rng: Random) -> Scene:
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


def any_rates(rng: Random) -> Scene:
    """Return a spin of 1e-3 to 1e3, and other rates of 0, of 1 or down to 1e-25."""
    scene = generic(rng) | {"r0": signed(rng, ten_to(rng, -3, 3))}
    return scene | {
        key: rng.choice([0, signed(rng, ten_to(rng, -25, 1)), 1]) for key in _RATES if key != "r0"
    }


def tiny_tilt_with_rates(rng: Random, top: Kind = any_rates, powers: Powers = (-150, -1)) -> Scene:
    """Return rates at a tilt of 1e-150 to 0.1 degrees; smaller tilts are refused."""
    return top(rng) | {"theta0_deg": ten_to(rng, *powers)}


def near_hanging(rng: Random, top: Kind = any_rates, powers: Powers = (-300, -1)) -> Scene:
    """Return a tilt of 1e-300 to 0.1 degrees below 180, a decimal."""
    above = Fraction(f"{rng.uniform(1, 9):.3f}e{int(rng.uniform(*powers))}")
    return top(rng) | {"theta0_deg": 180 - above}


def radians(rng: Random) -> Scene:
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


def any_spin(rng: Random) -> Scene:
    """Return a spin from 1e-300 to 1e100, with both rates."""
    scene = generic(rng) | {"r0": signed(rng, ten_to(rng, -300, 100))}
    return scene | {
        "thetadot0": rng.choice([0, rng.uniform(-3, 3)]),
        "psidot0": signed(rng, rng.choice([1, 3, ten_to(rng, -6, 6)])),
    }


def thresholds(rng: Random) -> Scene:
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


def separatrix(rng: Random) -> Scene:
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


def steady(rng: Random) -> Scene:
    """Return an exact steady precession, 2 b P = a + 2 P^2 cos(theta0)."""
    degrees, turn = rng.choice(list(TILTS)), signed(rng, 2.0 ** rng.randrange(-4, 5))
    m = rng.randrange(1, 64) / 8
    b = m / turn + turn * TILTS[degrees]
    scene: Scene = {"m": m, "A": 1, "C": 1, "s": 1, "g": 1, "r0": b}
    return scene | {"theta0_deg": degrees, "psidot0": turn}


def over_a_pole(rng: Random) -> Scene:
    """Return a start whose axis passes exactly over a pole, P (1 +- cos(theta0)) = +-b."""
    degrees, pole = rng.choice(list(TILTS)), rng.choice([-1, 1])
    turn = signed(rng, rng.randrange(1, 33) / 8)
    body = {"m": rng.randrange(1, 9) / 4, "A": 1, "C": rng.choice([0.5, 1, 2]), "s": 1, "g": 1}
    r0 = turn * pole * (1 + pole * TILTS[degrees]) / body["C"]
    rise = rng.choice([rng.uniform(-6, 6), rng.uniform(-1, 1), 0])
    return body | {"r0": r0, "theta0_deg": degrees, "psidot0": turn, "thetadot0": rise}


def from_a_pole(rng: Random) -> Scene:
    """Return a start on the vertical that leaves it."""
    scene = generic(rng) | {"theta0_deg": rng.choice([0, 180]), "psidot0": 0}
    scene["thetadot0"] = signed(rng, rng.choice([rng.uniform(0.01, 6), ten_to(rng, -9, 1)]))
    return scene | {"r0": rng.choice([0, scene["r0"], scene["r0"]])}


def no_torque(rng: Random) -> Scene:
    """Return a top without torque, or nearly."""
    scene = generic(rng) | {rng.choice(["g", "s"]): rng.choice([0, 0, ten_to(rng, -18, -3)])}
    scene["r0"] *= rng.choice([0, 1, 1, 1])
    scene["theta0_deg"] = rng.choice([60, 90, 0, scene["theta0_deg"]])
    return scene | ({} if scene["theta0_deg"] else {"psidot0": 0})


def nice_numbers(rng: Random) -> Scene:
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


def _sized(rng: Random, scene: Scene, among: str, powers: Powers) -> Scene:
    """Return a scene in which one input has another size; A and C keep their ratio."""
    name, size = rng.choice(among.split()), ten_to(rng, *powers)
    sizes = {x: size * (abs(scene["C"] / scene["A"]) if x == "C" else 1) for x in name.split(":")}
    return scene | {x: signed(rng, y) if x in _RATES else y for x, y in sizes.items()}


def subnormal(rng: Random, top: Kind = ordinary) -> Scene:
    """Return a top with a rate or g of 1e-323 to 1e-290."""
    return _sized(rng, top(rng), "g r0 thetadot0 psidot0", (-323, -290))


def small(rng: Random, top: Kind = ordinary) -> Scene:
    """Return a top with a mass, length or moment of 1e-100 to 1e-90, the least that is accepted."""
    return _sized(rng, top(rng), "m s A:C", (-97.5, -90))


def huge(rng: Random, top: Kind = ordinary) -> Scene:
    """Return a top with an input of 1e90 to 1e100, the greatest that is accepted."""
    return _sized(rng, top(rng), "m s g A:C r0 thetadot0 psidot0", (90, 99.5))


def both_ends(rng: Random) -> Scene:
    """Return a top with three inputs at the ends, in ratios of 1e180 to 1e420."""
    return huge(rng, partial(small, top=subnormal))


def _named(*functions: Kind) -> dict[str, Kind]:
    return {function.__name__.replace("_", " "): function for function in functions}


CORNERS = _named(subnormal, small, huge, both_ends)
"""Kinds at the ends of the doubles; many of their numbers lie beyond."""
NUTATING_KINDS = _named(
    *(generic, from_rest, stiff, slow, tiny_tilt, tiny_tilt_with_rates, near_a_pole),
    *(near_separatrix, near_steady, next_to_a_cusp, double_cusp, no_spin, radians, units),
    *(any_spin, thresholds),
)
"""The kinds whose tops nearly all nutate under a torque, by name."""
KINDS = NUTATING_KINDS | _named(
    *(near_hanging, separatrix, steady, over_a_pole, from_a_pole, no_torque, nice_numbers)
)
"""All kinds but CORNERS."""


def in_doubles(scene: Scene) -> Scene:
    """Return a scene with each input rounded to the nearest double."""
    return {name: float(value) for name, value in scene.items()}


def nutating(kind: str, rng: Random) -> Scene:
    """Return the inputs, as doubles, of a scene of a kind that nutates under a torque."""
    while True:
        scene = in_doubles(NUTATING_KINDS[kind](rng))
        with suppress(LagtopError):
            exact_motion(solve(Top(**scene)))
            return scene
