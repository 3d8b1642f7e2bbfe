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
from typing import Any

import numpy as np
from engines import Body, product, rk4_step, semi_implicit, stepped, unit
from lagtop import Comparison, Top, compare

Scene = dict[str, float]
_KEYS = "m", "A", "C", "s", "g", "r0", "theta0_deg", "thetadot0", "psidot0", "end"
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


def top_of(scene: Scene) -> Top:
    """Return the top of a scene."""
    return Top(**{key: x for key, x in scene.items() if key != "end"})


def ratios(engine: Body, right: Body) -> tuple[float, ...] | None:
    """Return a, b and r0 over those of the right engine, None if an engine moves no top."""

    def numbers(e: Body) -> tuple[float, ...]:
        a, twist = 2 * e.half * abs(e.torque) / e.A, (e.C - e.A) / e.A
        b = (twist + 2 * e.half) * e.rates[2]
        return a * e.clock**2, b * e.clock, 2 * e.half * e.rates[2] * e.clock

    if engine.rule or engine.damping > 0.1:
        return None
    return tuple(x / y for x, y in zip(numbers(engine), numbers(right), strict=True))


def mistakes_of(scene: Scene) -> dict[str, tuple[str, Body]]:
    """Return engines with mistakes, and pairs of them, by a short name.

    Each comes with a part of the name that `compare` has for it, or "#" if it has none.
    """
    m, A, C, s, g, r0, degrees, thetadot0, psidot0, _ = scene.values()
    tilt, steiner, w = math.radians(degrees), m * s * s, m * g * s
    no_com = {"C": A - steiner}

    def start(
        angle: float = tilt, r: float = r0, slope: float = 1, turn: float = 1
    ) -> dict[str, Any]:
        around = turn * psidot0 * math.sin(angle)
        return {"tilt": angle, "rates": (slope * thetadot0, around, r)}

    lying = start(math.pi / 2 - tilt, slope=-1)
    around, upright = (psidot0 + r0) * math.sin(tilt), r0 * math.cos(tilt)

    found: dict[str, tuple[str, dict[str, Any]]] = {
        "right": ("#", {}),
        "gravity x 2": ("gravity acts twice", {"torque": 2 * w}),
        "gravity / 2": ("halved", {"torque": w / 2}),
        "moon": ("g is that of the Moon", {"torque": MOON * w}),
        "no gravity": ("g is 0", {"torque": 0.0}),
        "gravity up": ("g points upwards", {"torque": -w}),
        "g 10": ("g is 10 (or m or s is wrong by the same factor)", {"torque": w * 10 / 9.81}),
        "m + 7 %": ("m, g or s is 7.0 % larger than given", {"torque": 1.07 * w}),
        "C = A": ("the gyroscopic term is left out of Euler's equations", {"C": A}),
        "gyro / 2": ("halved", {"C": (A + C) / 2}),
        "gyro reversed": ("the gyroscopic term has the wrong sign", {"C": 2 * A - C}),
        "no gyro com": ("(as if C = A - m s^2)", no_com),
        "A + 5 %": ("A is", {"A": 1.05 * A}),
        "C - 5 %": ("C is 5.0 % smaller than given", {"C": 0.95 * C}),
        "C + 20 %": ("C is 20.0 % larger than given", {"C": 1.2 * C}),
        "A + ms2": ("(A + m s^2)", {"A": A + steiner}),
        "A - ms2": ("(A - m s^2)", {"A": A - steiner}),
        "A, C exchanged": ("A and C are exchanged", {"A": C, "C": A}),
        "vertical spin": (
            "the spin r0 is about the vertical",
            {"rates": (thetadot0, around, upright)},
        ),
        "r0 sign": ("r0 has the wrong sign", start(r=-r0)),
        "r0 - 10 %": ("r0 is", start(r=0.9 * r0)),
        "r0 rpm": ("r0 in radians was taken as rpm", start(r=r0 * math.pi / 30)),
        "r0 degrees": ("r0 in radians was taken as degrees", start(r=math.radians(r0))),
        "damping .05": ("#decay", {"damping": 0.05}),
        "damping .5": ("#decay", {"damping": 0.5}),
        "dt x 2": ("twice as long", {"clock": 2}),
        "dt / 2": ("half as long", {"clock": 0.5}),
        "half missing": ("the factor 1/2 is missing in the rate of the quaternion", {"half": 1}),
        "horizontal": ("theta0 is measured from the horizontal", lying),
        "theta x 2": ("theta0 is doubled", start(2 * tilt)),
        "theta degrees": ("theta0 in radians was taken as degrees", start(math.radians(tilt))),
        "theta radians": ("theta0 in degrees was taken as radians", start(degrees)),
        "inertia": ("does not turn", {"rule": "inertia"}),
        "side": ("on the left", {"rule": "side"}),
        "torque": ("torque", {"rule": "torque"}),
        "gravity x 2 + r0 sign": ("twice; r0 has", {"torque": 2 * w} | start(r=-r0)),
        "C = A + damping": ("#decay", {"C": A} | {"damping": 0.05}),
        "gyro / 2 + horizontal": ("#", {"C": (A + C) / 2} | lying),
        "no gyro com + moon": ("#", no_com | {"torque": MOON * w}),
        "A + 5 % + r0 sign": ("#", start(r=-r0) | {"A": 1.05 * A}),
        "C = A + gravity / 2": ("#", {"torque": w / 2} | {"C": A}),
        "C - 5 % + moon": ("#", {"torque": MOON * w} | {"C": 0.95 * C}),
        "r0 - 10 % + g 10": ("#", {"torque": w * 10 / 9.81} | start(r=0.9 * r0)),
        "A - ms2 + r0 sign": ("s^2); r0", start(r=-r0) | {"A": A - steiner}),
        "C + 20 % + damping": ("#decay", {"C": 1.2 * C} | {"damping": 0.05}),
    }
    if thetadot0 and psidot0:
        for name, x in {
            "thetadot0 is left out": start(slope=0),
            "thetadot0 has the wrong sign": start(slope=-1),
            "psidot0 has the wrong sign": start(turn=-1),
            "psidot0 is left out": start(turn=0),
            "theta0 has the wrong sign": start(-tilt),
            "theta0 and its rate are measured from": start(math.pi / 2 - tilt),
            "r0 was taken as the gimbal's rate phi'": start(r=r0 + psidot0 * math.cos(tilt)),
        }.items():
            found[name] = name, x
    right = Body.of(top_of(scene))
    return {short: (name, right._replace(**x)) for short, (name, x) in found.items()}


def run(e: Body, h: float, end: float, every: int, method: Any) -> Any:
    """Return the times and quaternions of every so many steps, with quaternions of norm 1."""
    t, states = stepped(e, h, end, lambda *x: unit(method(*x)), every)
    return t, states[:, :4]


def constrained(
    scene: Scene, h: float, every: int, *, twist: bool = True, weight: float = 1.0, c: float = 1.0
) -> Any:
    """Return a run about the centre of mass; an impulse keeps the pivot (Baumgarte, 0.2)."""
    m, A, C, s, g = (scene[x] for x in _KEYS[:5])
    moments, tilt = (
        np.array([A - m * s * s, A - m * s * s, c * C]),
        math.radians(scene["theta0_deg"]),
    )
    q = np.array([math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0])
    rates = [scene["thetadot0"], scene["psidot0"] * math.sin(tilt), scene["r0"]]

    def matrix(q: Any) -> Any:
        return np.array(
            [product(product(q, (0, *x)), q * [1, -1, -1, -1])[1:] for x in np.eye(3)]
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
        q = np.array(product((math.cos(size * h / 2), *(k * omega)), q))
        q = q / np.linalg.norm(q)
        turn = matrix(q)
        if i % every == 0:
            rows.append(q)
    return np.arange(len(rows)) * h * every, np.array(rows)


def runs(scene: Scene) -> Iterator[tuple[str, str, Any]]:
    """Yield the method with the kind of step, the short name of a mistake, and its run."""
    found, r0, end = mistakes_of(scene), scene["r0"], scene["end"]
    for kind, h in (("fine", FINE / r0), ("coarse", COARSE / r0)):
        every = max(1, round(end / h / 400)) if kind == "fine" else 1
        for name, method in (("rk4", rk4_step), ("semi_implicit", semi_implicit)):
            for bug, (_, engine) in found.items():
                yield f"{name} {kind}", bug, run(engine, h, end, every, method)
        constraints: dict[str, dict[str, Any]] = {
            "right": {},
            "no gyro com": {"twist": False},
            "gravity x 2": {"weight": 2.0},
            "no gravity": {"weight": 0.0},
            "C + 20 %": {"c": 1.2},
        }
        for bug, how in constraints.items():
            yield f"_constraint {kind}", bug, constrained(scene, h, every, **how)


def outcome(found: Comparison, name: str, true: tuple[float, ...] | None, tolerance: float) -> str:
    """Return the outcome of a comparison."""
    names, numbers = (found.cause or "").split("; or "), found.numbers or ""
    estimated = "(m, g or s|A|C|r0) is (wrong|[0-9.]* %)"
    if found.verdict == "fine" and name == "#":
        return "name"
    if found.cause and name[0] != "#" and any(name in x for x in names):
        return "name" if len(names) == 1 else "several"
    if found.cause and not all(re.match(estimated, x) for x in names):
        return "WRONG" if len(names) == 1 else "wrong several"
    is_said = "decay" in numbers or "decay" not in name
    if true and found.a_ratio is not None and found.b_ratio is not None:
        ratios = zip((found.a_ratio, found.b_ratio), true[:2], strict=True)
        is_right = all(abs(x - y) <= tolerance * max(abs(y), 0.25) for x, y in ratios)
        return "numbers" if is_right and is_said else "numbers off"
    if not true and is_said and "decay" in name:
        return "numbers"
    return "steps" if "smaller steps" in numbers else "none"


def main() -> None:
    """Print the score, and what is not right."""
    tally, seconds = defaultdict[str, Counter[str]](Counter), []
    for scene in sys.argv[1:] or SCENES:
        top, mistakes = top_of(SCENES[scene]), mistakes_of(SCENES[scene])
        for method, bug, (t, q) in runs(SCENES[scene]):
            name, engine = mistakes[bug]
            before = time.process_time()
            found = compare(top, t, quaternion=np.round(q, 10))
            seconds.append(time.process_time() - before)
            true = ratios(engine, mistakes["right"][1])
            got = outcome(found, name, true, 0.02 if "fine" in method else 0.12)
            tally[method][got] += 1
            if got not in {"name", "numbers"}:
                said = true and tuple(round(x, 4) for x in true)
                print(f"{got:14}{scene} {method}, {bug} {said}: {found.cause} | {found.numbers}")
    for method, counts in tally.items():
        print(f"{method:24}{counts.total():4}", dict(counts.most_common()))
    seconds.sort()
    print(f"seconds: median {seconds[len(seconds) // 2]:.2f}, most {seconds[-1]:.2f}")


if __name__ == "__main__":
    main()
