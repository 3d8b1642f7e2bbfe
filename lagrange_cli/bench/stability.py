"""Errors of methods in stiff and extreme scenes, beside the error that input rounding causes.

The README describes the kinds of scenes.  A new kind is a row in `hard_scenes`, and FIXED scenes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import product
from random import Random
from typing import TYPE_CHECKING

from ..names import check_names
from ..output.report import Report
from ..output.terminal import with_progress
from ..plot.style import LIGHT
from ..solver.solve import Motion, solve
from ..top.top import Top
from .hard_scenes import nutating
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

UNIT = {"m": 1, "s": 1, "g": 1, "A": 1, "C": 0.5, "theta0_deg": 50}
FIXED: dict[str, list[dict[str, float]]] = {
    "fast-spin": [{"r0": 1e4, "theta0_deg": 30, "psidot0": 1}],
    "slow-spin": [{"r0": 1e-3, "theta0_deg": 120}],
    "near-separatrix": [{"r0": 3, "theta0_deg": 60, "thetadot0": 0.4999995, "psidot0": 1}],
    "near-vertical": [
        {"r0": 2, "theta0_deg": 1e-6, "psidot0": 1},
        {"r0": 3, "theta0_deg": 60, "thetadot0": 1, "psidot0": 1.00000001},
    ],
    "tiny-tilt-with-rates": [{"r0": 3, "theta0_deg": 1e-30, "thetadot0": 1}],
    "near-steady": [{"r0": 6, "theta0_deg": 60, "psidot0": 0.382}],
    "near-hanging": [{"r0": 2, "theta0_deg": 179.999}],
    "extreme-sizes": [{"m": 1e12, "s": 1e-12, "g": 1e6, "A": 1e-12, "C": 1e-12, "r0": 1e9}],
}
"""The fixed scenes of each kind, for the body UNIT."""
SHOWN = "scene method setting periods error_rad input_rounding verdict inputs remark"


def stability(kinds: Sequence[str] | None = None, samples: int = 1, seed: int = 1952) -> Report:
    """Compare methods in the fixed scenes of each kind and in `samples` random ones.

    Each method runs at its tightest setting.  Raises LagtopError for an unknown kind.
    """
    names = list(FIXED) if kinds is None else check_names("kinds", kinds, FIXED)
    scenes = [(kind, x) for kind in names for x in motions(kind, samples, seed)]
    rows = [row for x in with_progress(scenes, "scenes") for row in compared(*x)]
    found = [
        max((x for x in rows if (x.scene, x.periods, x.method) == case), key=badness)
        for case in product(names, SPANS, COMPARED)
    ]
    return report_of(conditions(samples, seed), SHOWN, TIMES + 1, found, conclusions(found))


def motions(kind: str, samples: int, seed: int) -> list[Motion]:
    """Return the fixed motions of a kind, and random ones."""
    rng, fixed = Random(f"{seed} {kind}"), [UNIT | scene for scene in FIXED[kind]]
    return [solve(Top(**x)) for x in [*fixed, *(nutating(kind, rng) for _ in range(samples))]]


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
            verdict = row.verdict or verdict_of(row.error_rad or 0.0, rounding)
            row = row._replace(input_rounding=rounding, verdict=verdict, periods=span)
            yield row._replace(inputs=motion.top.as_text())


def neighbours(top: Top) -> Iterator[Reference]:
    """Yield the exact motions after each input in turn has grown by half an ulp."""
    for name, value in top.as_dict().items():
        if value:
            moved = Fraction(value) + Fraction(math.ulp(value)) / 2
            yield Reference(top.replace(**{name: moved}))


def verdict_of(error: float, rounding: float) -> str:
    """Return the verdict on the error of a run, beside the effect of input rounding."""
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
