"""Engines with mistakes, and how `compare` names them: `python tests/tools/mistakes.py [SCENE]`.

Engines about the pivot take RK4 or semi-implicit steps; one in maximal coordinates keeps the pivot
by a constraint.  Steps are fine, or r0 dt = 0.33.  A result is a `name`; right `numbers`; `several`
competing causes with the right one; advice to use smaller `steps`; `none`; or a `WRONG` cause.
"""

from __future__ import annotations

import math
import re
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from lagtop import Comparison, Top, compare

Scene = dict[str, float]
_KEYS = "m", "A", "C", "s", "g", "r0", "theta0", "thetadot0", "psidot0", "end"
_SCENES: dict[str, tuple[float, ...]] = {
    "default": (1587.0, 39032.0, 17458.0, 4.0, 981.0, 50.0, 30.0, 0.0, 0.0, 2.0),
    "toy": (0.1, 3e-4, 6e-5, 0.04, 9.81, 150.0, 40.0, 0.0, 0.0, 1.0),
    "general": (1.0, 0.02, 0.006, 0.08, 9.81, 40.0, 55.0, 0.7, 1.3, 2.0),
    "wheel": (2.4, 0.06, 0.025, 0.11, 9.81, 36.0, 68.0, 0.0, 0.0, 2.2),
    "dart": (0.35, 9.5e-4, 2.1e-4, 0.035, 9.81, 110.0, 25.0, -1.2, 2.4, 1.4),
    "disc": (0.5, 2.2e-3, 3.1e-3, 0.04, 9.81, 30.0, 80.0, 0.5, -0.8, 1.6),
}
SCENES: dict[str, Scene] = {x: dict(zip(_KEYS, y, strict=True)) for x, y in _SCENES.items()}
MOON = 1.62 / 9.81
FINE, COARSE = 0.02, 0.33
"""The angle by which the spin turns in a step."""


class Engine(NamedTuple):
    """An engine about the pivot: its numbers, and the rules that it breaks."""

    A: float
    twist: float
    """C - A in the gyroscopic term."""
    torque: float
    tilt: float
    rates: tuple[float, float, float]
    damping: float = 0.0
    clock: float = 1.0
    half: float = 0.5
    rule: str = ""


class Mistake(NamedTuple):
    """A mistake with a part of its name, and its true a, b and r0 over those of the scene."""

    name: str
    engine: Engine
    ratios: tuple[float, float, float] | None = (1, 1, 1)


def mistakes_of(scene: Scene) -> dict[str, Mistake]:
    """Return mistakes, and pairs of them, by a short name."""
    m, A, C, s, g, r0 = (scene[x] for x in _KEYS[:6])
    tilt, slope, around = math.radians(scene["theta0"]), scene["thetadot0"], scene["psidot0"]
    steiner, c, moved = m * s * s, C / A, (slope, around * math.sin(tilt))
    right = Engine(A, C - A, m * g * s, tilt, (*moved, r0))
    k = steiner / A

    def weight(factor: float, of: Engine = right) -> Engine:
        return of._replace(torque=factor * m * g * s)

    def spin(r: float, of: Engine = right) -> Engine:
        return of._replace(rates=(*moved, r))

    def moments(a: float = A, c: float = C, of: Engine = right) -> Engine:
        return of._replace(A=a, twist=c - a)

    lying = math.pi / 2 - tilt
    vertical = (slope, moved[1] + r0 * math.sin(tilt), r0 * math.cos(tilt))
    no_com = moments(c=A - steiner)
    found = {
        "right": Mistake("#", right),
        "gravity x 2": Mistake("twice", weight(2), (2, 1, 1)),
        "gravity / 2": Mistake("halved", weight(0.5), (0.5, 1, 1)),
        "moon": Mistake("Moon", weight(MOON), (MOON, 1, 1)),
        "no gravity": Mistake("g is 0", weight(0), (0, 1, 1)),
        "gravity up": Mistake("upwards", weight(-1), (1, 1, 1)),
        "g 10": Mistake("g is 10", weight(10 / 9.81), (10 / 9.81, 1, 1)),
        "m + 7 %": Mistake("m, g or s is 7.0 %", weight(1.07), (1.07, 1, 1)),
        "C = A": Mistake("(as if C = A)", moments(c=A), (1, 1 / c, 1)),
        "gyro / 2": Mistake("halved", moments(c=(A + C) / 2), (1, (1 + c) / 2 / c, 1)),
        "gyro reversed": Mistake("2A - C", moments(c=2 * A - C), (1, (2 - c) / c, 1)),
        "no gyro com": Mistake("C = A - m s^2", no_com, (1, (1 - k) / c, 1)),
        "A + 5 %": Mistake("A is", moments(1.05 * A), (1 / 1.05, 1 / 1.05, 1)),
        "C - 5 %": Mistake("C is", moments(c=0.95 * C), (1, 0.95, 1)),
        "C + 20 %": Mistake("C is", moments(c=1.2 * C), (1, 1.2, 1)),
        "A + ms2": Mistake("(A + m s^2)", moments(A + steiner), (1 / (1 + k), 1 / (1 + k), 1)),
        "A - ms2": Mistake("(A - m s^2)", moments(A - steiner), (1 / (1 - k), 1 / (1 - k), 1)),
        "A, C exchanged": Mistake("exchanged", Engine(C, A - C, *right[2:]), (1 / c, 1 / c**2, 1)),
        "vertical spin": Mistake(
            "about the vertical",
            right._replace(rates=vertical),
            (1, math.cos(tilt), math.cos(tilt)),
        ),
        "r0 sign": Mistake("r0 has the wrong sign", spin(-r0), (1, -1, -1)),
        "r0 - 10 %": Mistake("r0 is", spin(0.9 * r0), (1, 0.9, 0.9)),
        "damping .05": Mistake("#decay", right._replace(damping=0.05)),
        "damping .5": Mistake("#decay", right._replace(damping=0.5), None),
        "dt x 2": Mistake("twice as long", right._replace(clock=2), (4, 2, 2)),
        "dt / 2": Mistake("half as long", right._replace(clock=0.5), (0.25, 0.5, 0.5)),
        "half missing": Mistake("factor 1/2", right._replace(half=1), (2, (1 + c) / c, 2)),
        "horizontal": Mistake("horizontal", right._replace(tilt=lying)),
        "theta x 2": Mistake("doubled", right._replace(tilt=2 * tilt)),
        "inertia": Mistake("does not turn", right._replace(rule="inertia"), None),
        "side": Mistake("on the left", right._replace(rule="side"), None),
        "torque": Mistake("torque", right._replace(rule="torque"), None),
        "gravity x 2 + r0 sign": Mistake("twice; r0 has", weight(2, spin(-r0)), (2, -1, -1)),
        "C = A + damping": Mistake("#decay", moments(c=A)._replace(damping=0.05), (1, 1 / c, 1)),
        "gyro / 2 + horizontal": Mistake(
            "#", moments(c=(A + C) / 2)._replace(tilt=lying), (1, (1 + c) / 2 / c, 1)
        ),
        "no gyro com + moon": Mistake("#", weight(MOON, no_com), (MOON, (1 - k) / c, 1)),
        "A + 5 % + r0 sign": Mistake("#", spin(-r0, moments(1.05 * A)), (1 / 1.05, -1 / 1.05, -1)),
        "C = A + gravity / 2": Mistake("#", weight(0.5, moments(c=A)), (0.5, 1 / c, 1)),
        "C - 5 % + moon": Mistake("#", weight(MOON, moments(c=0.95 * C)), (MOON, 0.95, 1)),
        "r0 - 10 % + g 10": Mistake("#", weight(10 / 9.81, spin(0.9 * r0)), (10 / 9.81, 0.9, 0.9)),
        "A - ms2 + r0 sign": Mistake(
            "s^2); r0", spin(-r0, moments(A - steiner)), (1 / (1 - k), -1 / (1 - k), -1)
        ),
        "C + 20 % + damping": Mistake(
            "#decay", moments(c=1.2 * C)._replace(damping=0.05), (1, 1.2, 1)
        ),
    }
    for name, r in (("rpm", r0 * math.pi / 30), ("degrees", math.radians(r0))):
        found[f"r0 {name}"] = Mistake(f"taken as {name}", spin(r), (1, r / r0, r / r0))
    if slope or around:
        for name, first, second in (
            ("thetadot0 is left out", 0.0, moved[1]),
            ("psidot0 has the wrong sign", slope, -moved[1]),
            ("psidot0 is left out", slope, 0.0),
        ):
            found[name] = Mistake(name, right._replace(rates=(first, second, r0)))
    return found


State = list[float]


def _product(a: Any, b: Any) -> tuple[float, float, float, float]:
    (w, x, y, z), (W, X, Y, Z) = a, b
    return (
        w * W - x * X - y * Y - z * Z,
        w * X + x * W + y * Z - z * Y,
        w * Y - x * Z + y * W + z * X,
        w * Z + x * Y - y * X + z * W,
    )


def _slope(e: Engine, state: State) -> State:
    w, x, y, z, p, q, r = state
    up_x, up_y = 2 * (x * z - w * y), 2 * (y * z + w * x)
    if e.rule == "torque":  # that of the start, in the body
        up_x, up_y = 0.0, math.sin(e.tilt)
    if e.rule == "inertia":  # rates in space
        up_x, up_y = -2 * (x * z + w * y), 2 * (w * x - y * z)
    speed_up = (e.torque * up_y - e.twist * q * r) / e.A, (e.twist * p * r - e.torque * up_x) / e.A
    is_left = e.rule in {"side", "inertia"}
    pair = ((0, p, q, r), (w, x, y, z)) if is_left else ((w, x, y, z), (0, p, q, r))
    turn = [e.half * v for v in _product(*pair)]
    return [*turn, speed_up[0] - e.damping * p, speed_up[1] - e.damping * q, -e.damping * r]


def _rk4(e: Engine, y: State, h: float) -> State:
    def moved(by: float, slope: State) -> State:
        return [u + by * v for u, v in zip(y, slope, strict=True)]

    a = _slope(e, y)
    b = _slope(e, moved(h / 2, a))
    c = _slope(e, moved(h / 2, b))
    d = _slope(e, moved(h, c))
    return moved(h / 6, [i + 2 * j + 2 * k + n for i, j, k, n in zip(a, b, c, d, strict=True)])


def _semi_implicit(e: Engine, y: State, h: float) -> State:
    rates = [u + h * v for u, v in zip(y[4:], _slope(e, y)[4:], strict=True)]
    size = math.hypot(*rates) or 1e-300
    half = e.half * h * size
    turn = math.cos(half), *(math.sin(half) / size * x for x in rates)
    is_left = e.rule in {"side", "inertia"}
    return [*(_product(turn, y[:4]) if is_left else _product(y[:4], turn)), *rates]


def run(e: Engine, h: float, end: float, every: int, method: Any) -> Any:
    """Return the times and quaternions of every so many steps."""
    y = [math.cos(e.tilt / 2), math.sin(e.tilt / 2), 0.0, 0.0, *e.rates]
    if e.rule == "inertia":
        (p, q, r), cos, sin = e.rates, math.cos(e.tilt), math.sin(e.tilt)
        y[4:] = [p, cos * q - sin * r, sin * q + cos * r]
    rows = [y[:4]]
    for i in range(1, round(end / h) + 1):
        y = method(e, y, h * e.clock)
        size = math.hypot(*y[:4])
        y[:4] = [x / size for x in y[:4]]
        if i % every == 0:
            rows.append(y[:4])
    return np.arange(len(rows)) * h * every, np.array(rows)


def constrained(
    scene: Scene, h: float, every: int, *, twist: bool = True, weight: float = 1.0, c: float = 1.0
) -> Any:
    """Return a run about the centre of mass; an impulse keeps the pivot (Baumgarte, 0.2)."""
    m, A, C, s, g = (scene[x] for x in _KEYS[:5])
    moments, tilt = np.array([A - m * s * s, A - m * s * s, c * C]), math.radians(scene["theta0"])
    q = np.array([math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0])
    rates = [scene["thetadot0"], scene["psidot0"] * math.sin(tilt), scene["r0"]]

    def matrix(q: Any) -> Any:
        return np.array(
            [_product(_product(q, (0, *x)), q * [1, -1, -1, -1])[1:] for x in np.eye(3)]
        ).T

    def crossing(v: Any) -> Any:
        return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])

    turn = matrix(q)
    omega = turn @ rates
    x, rows = s * turn[:, 2], [q]
    v = np.cross(omega, x)
    for i in range(1, round(scene["end"] / h) + 1):
        v = v - [0, 0, h * g * weight]
        inverse = (turn / moments) @ turn.T
        if twist:
            omega = omega - h * inverse @ np.cross(omega, (turn * moments) @ turn.T @ omega)
        arm = -s * turn[:, 2]
        K = crossing(arm)
        off = v + np.cross(omega, arm) + 0.2 / h * (x + arm)
        push = np.linalg.solve(np.eye(3) / m - K @ inverse @ K, -off)
        v, omega = v + push / m, omega + inverse @ (K @ push)
        x, size = x + h * v, float(np.linalg.norm(omega))
        k = math.sin(size * h / 2) / size
        q = np.array(_product((math.cos(size * h / 2), *(k * omega)), q))
        q = q / np.linalg.norm(q)
        turn = matrix(q)
        if i % every == 0:
            rows.append(q)
    return np.arange(len(rows)) * h * every, np.array(rows)


def runs(scene: Scene) -> Iterator[tuple[str, str, Mistake, Any]]:
    """Yield the method, the kind of step, the mistake, and its run."""
    found, r0, end = mistakes_of(scene), scene["r0"], scene["end"]
    for kind, h in (("fine", FINE / r0), ("coarse", COARSE / r0)):
        every = max(1, round(end / h / 400)) if kind == "fine" else 1
        for method in (_rk4, _semi_implicit):
            for name, x in found.items():
                yield f"{method.__name__} {kind}", name, x, run(x.engine, h, end, every, method)
        constraints: dict[str, dict[str, Any]] = {
            "right": {},
            "no gyro com": {"twist": False},
            "gravity x 2": {"weight": 2.0},
            "no gravity": {"weight": 0.0},
            "C + 20 %": {"c": 1.2},
        }
        for name, how in constraints.items():
            yield f"_constraint {kind}", name, found[name], constrained(scene, h, every, **how)


def outcome(found: Comparison, mistake: Mistake, tolerance: float) -> str:
    """Return the outcome of a comparison."""
    names, numbers = (found.cause or "").split("; or "), found.numbers or ""
    estimated = "(m, g or s|A|C|r0) is (wrong|[0-9.]* %)"
    got = "none"
    if found.cause and mistake.name[0] != "#" and any(mistake.name in x for x in names):
        got = "name" if len(names) == 1 else "several"
    elif found.cause and not all(re.match(estimated, x) for x in names):
        got = "WRONG" if len(names) == 1 else "wrong several"
    elif mistake.ratios and found.a_ratio is not None and found.b_ratio is not None:
        ratios = zip((found.a_ratio, found.b_ratio), mistake.ratios[:2], strict=True)
        is_right = all(abs(x - y) <= tolerance * max(abs(y), 0.25) for x, y in ratios)
        is_right &= "decay" in numbers or "decay" not in mistake.name
        got = "numbers" if is_right else "numbers off"
    elif "smaller steps" in numbers:
        got = "steps"
    elif mistake.ratios is None and "decay" in numbers:
        got = "numbers"
    return "name" if found.verdict == "fine" and mistake.name == "#" else got


def main() -> None:
    """Print the score, and what is not right."""
    tally, seconds = defaultdict[str, Counter[str]](Counter), []
    only = sys.argv[1:]
    for name in only or SCENES:
        scene = SCENES[name]
        inputs = {x: scene[x] for x in _KEYS[:6]}
        inputs |= {"theta0_deg": scene["theta0"], "thetadot0": scene["thetadot0"]}
        top = Top(**inputs, psidot0=scene["psidot0"])
        for method, bug, mistake, (t, q) in runs(scene):
            before = time.process_time()
            found = compare(top, t, quaternion=np.round(q, 10))
            seconds.append(time.process_time() - before)
            got = outcome(found, mistake, 0.02 if "fine" in method else 0.12)
            tally[method][got] += 1
            if got not in {"name", "numbers"}:
                true = mistake.ratios and tuple(round(x, 4) for x in mistake.ratios)
                print(f"{got:14}{name} {method}, {bug} {true}: {found.cause} | {found.numbers}")
    for method, counts in tally.items():
        print(f"{method:24}{counts.total():4}", dict(counts.most_common()))
    seconds.sort()
    print(f"seconds: median {seconds[len(seconds) // 2]:.2f}, most {seconds[-1]:.2f}")


if __name__ == "__main__":
    main()
