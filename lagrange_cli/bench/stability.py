"""Errors of methods in stiff and extreme scenes, beside the error that input rounding causes.

A new kind of scene is one entry in HARD_KINDS.  The README describes the kinds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from itertools import chain, islice, product, repeat
from random import Random
from typing import TYPE_CHECKING

from ..names import check_names
from ..output.report import Report
from ..output.terminal import Progress, silent
from ..plot.style import LIGHT
from ..solver.facts import Regime
from ..solver.solve import Motion, solve
from ..top.top import Top
from .measure import ERROR, Row, looks, measure, panels_of, report_of, task_of
from .methods import METHODS
from .reference import Reference, rotation_angle

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPANS = 1.0, 100.0
"""Spans in nutation periods."""
TIMES = 8
"""Number of times in each span that are compared; a quarter of them for the input rounding."""
COMPARED = "lagtop", "scipy.special", "DOP853", "Radau", "Taylor"
SLOW = 1.0
"""CPU seconds after which a run is too slow."""
AT_ROUNDING, LOST = 100, 1e-3
"""Limits of the verdicts: a multiple of the effect of input rounding, and an error in rad."""
VERDICTS = "rounding level", "inaccurate", "lost", "too slow", "failed", "not installed"
"""The verdicts from good to bad."""

Scene = dict[str, float]
UNIT: Scene = {"m": 1, "s": 1, "g": 1, "A": 1, "C": 0.5, "theta0_deg": 50}


def body(rng: Random) -> Scene:
    """Return a body with m = s = g = 1, from a needle to a disc."""
    A = rng.uniform(0.5, 2)
    return UNIT | {"A": A, "C": A * rng.uniform(0.05, 2)}


def moving(rng: Random) -> Scene:
    """Return an ordinary top with moderate rates."""
    rates = {name: rng.uniform(-3, 3) for name in ("r0", "thetadot0", "psidot0")}
    return body(rng) | {"theta0_deg": rng.uniform(10, 170)} | rates


def rising(rng: Random, miss: float) -> Scene:
    """Return a rise towards the upright position, too slow by a relative amount."""
    scene, part = body(rng), rng.uniform(0.1, 0.8)
    spin = 2 * math.sqrt(scene["A"]) / scene["C"] * math.sqrt(part)
    u = rng.uniform(2 * part - 1, 0.9)
    rate = scene["C"] * spin / scene["A"] / (1 + u)  # by which Lz = C r0
    rise = math.sqrt(max(2 / scene["A"] * (1 - u) - rate * rate * (1 - u * u), 0))
    start = {"theta0_deg": math.degrees(math.acos(u)), "psidot0": rate}
    return scene | start | {"r0": spin, "thetadot0": -rise * (1 - miss)}


def near_hanging(rng: Random) -> Scene:
    """Return a small swing about the hanging position."""
    tilt = 180 - 10 ** rng.uniform(-9, -2)
    return body(rng) | {"r0": rng.uniform(-5, 5), "theta0_deg": tilt}


def near_vertical(rng: Random) -> Scene:
    """Return a start next to the vertical, or a path that passes next to it."""
    if rng.random() < 0.5:
        return moving(rng) | {"theta0_deg": 10 ** rng.uniform(-8, -2)}
    scene = rising(rng, -rng.uniform(0.1, 1))
    return scene | {"psidot0": scene["psidot0"] * (1 + 10 ** rng.uniform(-10, -4))}


def near_steady(rng: Random) -> Scene:
    """Return a steady precession with a disturbed rate."""
    scene = body(rng) | {"theta0_deg": rng.uniform(20, 160)}
    spin = 2 * math.sqrt(scene["A"]) / scene["C"] * rng.uniform(1.1, 5)
    b, u = scene["C"] * spin, math.cos(math.radians(scene["theta0_deg"]))
    steady = 2 / (b + math.sqrt(b * b - 4 * scene["A"] * u))
    return scene | {"r0": spin, "psidot0": steady * (1 + 10 ** rng.uniform(-12, -3))}


def extreme_sizes(rng: Random) -> Scene:
    """Return an ordinary top in other units of mass, length and time."""
    mass, length, second = (10 ** rng.uniform(-12, 12) for _ in range(3))
    scene = moving(rng)
    found = scene | {"m": mass, "s": length, "g": length / second**2}
    found |= {name: scene[name] * mass * length**2 for name in ("A", "C")}
    return found | {name: scene[name] / second for name in ("r0", "thetadot0", "psidot0")}


FIXED: list[tuple[str, Scene]] = [
    ("fast-spin", {"r0": 1e4, "theta0_deg": 30, "psidot0": 1}),
    ("slow-spin", {"r0": 1e-3, "theta0_deg": 120}),
    ("near-separatrix", rising(Random(1), 1e-6)),
    ("near-vertical", {"r0": 2, "theta0_deg": 1e-6, "psidot0": 1}),
    ("near-vertical", rising(Random(2), -0.5)),
    ("tiny-tilt-with-rates", {"r0": 3, "theta0_deg": 1e-30, "thetadot0": 1}),
    ("near-steady", {"r0": 6, "theta0_deg": 60, "psidot0": 0.382}),
    ("near-hanging", {"r0": 2, "theta0_deg": 179.999}),
    ("extreme-sizes", {"m": 1e12, "s": 1e-12, "g": 1e6, "A": 1e-12, "C": 1e-12, "r0": 1e9}),
]
"""The fixed scenes of each kind, for the body UNIT."""
HARD_KINDS: dict[str, Callable[[Random], Scene]] = {
    "fast-spin": lambda rng: moving(rng) | {"r0": 10 ** rng.uniform(3, 6)},
    "slow-spin": lambda rng: (
        body(rng) | {"r0": 10 ** rng.uniform(-9, -2), "theta0_deg": rng.uniform(20, 170)}
    ),
    "near-separatrix": lambda rng: rising(rng, 10 ** rng.uniform(-9, -3)),
    "near-vertical": near_vertical,
    "tiny-tilt-with-rates": lambda rng: moving(rng) | {"theta0_deg": 10 ** rng.uniform(-60, -9)},
    "near-steady": near_steady,
    "near-hanging": near_hanging,
    "extreme-sizes": extreme_sizes,
}
"""The function that returns a random scene of each kind."""
SHOWN = "scene method setting periods error_rad input_rounding verdict inputs remark"


def stability(
    kinds: Sequence[str] | None = None,
    samples: int = 1,
    seed: int = 1952,
    progress: Progress = silent,
) -> Report:
    """Compare methods in the fixed scenes of each kind and in `samples` random ones.

    Each method runs at its tightest setting.  Raises LagtopError for an unknown kind.
    """
    names = list(HARD_KINDS) if kinds is None else check_names("kinds", kinds, HARD_KINDS)
    scenes = [(kind, x) for kind in names for x in motions(kind, samples, seed)]
    rows = [row for kind, motion in progress(scenes, "scenes") for row in compared(kind, motion)]
    found = [
        max((x for x in rows if (x.scene, x.periods, x.method) == case), key=badness)
        for case in product(names, SPANS, COMPARED)
    ]
    return report_of(conditions(samples, seed), SHOWN, TIMES + 1, found, conclusions(found))


def motions(kind: str, samples: int, seed: int) -> list[Motion]:
    """Return the fixed motions of a kind, and random ones that nutate under a torque."""
    fixed, rng = [UNIT | scene for name, scene in FIXED if name == kind], Random(f"{seed} {kind}")
    tops = (Top(**x) for x in chain(fixed, (HARD_KINDS[kind](rng) for _ in repeat(None))))
    nutating = (x for x in map(solve, tops) if x.regime in (Regime.REGULAR, Regime.NO_SPIN))
    return list(islice(nutating, len(fixed) + samples))


def compared(kind: str, motion: Motion) -> Iterator[Row]:
    """Yield the rows of all methods in one scene, span by span."""
    moved = list(neighbours(motion.top))
    for span in SPANS:
        task = task_of(kind, motion, 0.97 * span, TIMES + 1)
        rounding = max(
            sum(rotation_angle(each.attitude(t), exact) for each in moved)
            for t, exact in list(zip(task.times.tolist(), task.exact.values(), strict=True))[4::4]
        )
        for name in COMPARED:
            row = measure(task, name, METHODS[name].settings[-1], SLOW, runs=1)
            verdict = verdict_of(row.error_rad, rounding, row.remark)
            row = row._replace(input_rounding=rounding, verdict=verdict)
            yield row._replace(periods=span, inputs=motion.top.as_text())


def neighbours(top: Top) -> Iterator[Reference]:
    """Yield the exact motions after each input in turn has grown by half an ulp."""
    for name, value in top.as_dict().items():
        if value:
            moved = Fraction(value) + Fraction(math.ulp(value)) / 2
            yield Reference(top.replace(**{name: moved}))


def verdict_of(error: float | None, rounding: float, remark: str | None = None) -> str:
    """Return the verdict on a run: from its remark, or from its error and the input rounding."""
    if error is None:
        return (remark or "").partition(":")[0]
    if error <= AT_ROUNDING * rounding:
        return VERDICTS[0]
    return "lost" if error > LOST else "inaccurate"


def badness(row: Row) -> tuple[int, float]:
    """Return a key by which the worst row is the greatest."""
    return VERDICTS.index(str(row.verdict)), (row.error_rad or 0) / (row.input_rounding or 1)


def failures(report: Report) -> list[str]:
    """Return the kinds in which lagtop is not at rounding level."""
    bad = [x for x in report.rows if x.method == "lagtop" and x.verdict != VERDICTS[0]]
    return [f"{x.scene} over {periods_of(x.periods)}: {x.verdict} ({x.inputs})" for x in bad]


def periods_of(span: float) -> str:
    """Return a span in words."""
    return f"{span:g} nutation period{'s' * (span != 1)}"


def conclusions(rows: Sequence[Row]) -> Iterator[str]:
    """Yield one line for each method: its kinds by verdict after the longest span."""
    for name in COMPARED:
        mine = {x.scene: x.verdict for x in rows if (x.method, x.periods) == (name, SPANS[-1])}
        kinds = {y: [kind for kind, x in mine.items() if x == y] for y in VERDICTS}
        places = {x: y if len(y) < len(mine) else ["all kinds"] for x, y in kinds.items() if y}
        said = "; ".join(f"{verdict} in {', '.join(found)}" for verdict, found in places.items())
        yield f"{name} over {periods_of(SPANS[-1])}: {said}."


def conditions(samples: int, seed: int) -> dict[str, str]:
    """Return what the figures depend on."""
    return {
        "scenes": f"the fixed scene of each kind and {samples} random, seed {seed}; a row shows "
        "the worst scene",
        "rounding": "input rounding: sum of the rotations that half an ulp of each input causes",
        "verdicts": f"rounding level: error at most {AT_ROUNDING} times input rounding; lost: "
        f"error above {LOST:g} rad; inaccurate: between; too slow: more than {SLOW:g} s of CPU",
        "settings": ", ".join(f"{x} {METHODS[x].settings[-1]}" for x in COMPARED),
    }


def stability_figure(report: Report) -> Figure:
    """Return a panel for each span: the error of each method by kind, over the input rounding."""
    kinds = list(dict.fromkeys(row.scene for row in report.rows))
    figure, panels = panels_of(1, len(SPANS), 13, 5)
    for axes, span in zip(panels, SPANS, strict=True):
        rows = [row for row in report.rows if row.periods == span]
        bars = [max(x.input_rounding or 0 for x in rows if x.scene == kind) for kind in kinds]
        axes.bar(kinds, bars, color=LIGHT.faint, label="input rounding", zorder=0)
        for i, name in enumerate(COMPARED):
            mine = [x for x in rows if x.method == name and x.error_rad is not None]
            places = [kinds.index(x.scene) + 0.12 * (i - 2) for x in mine]
            axes.plot(places, [x.error_rad for x in mine], ls="none", **looks()[name])
        axes.set(yscale="log", ylim=(1e-17, 10), ylabel=ERROR)
        axes.set_title(f"over {periods_of(span)}")
        axes.set_xticks(range(len(kinds)), kinds, rotation=40, ha="right")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right upper")
    return figure
