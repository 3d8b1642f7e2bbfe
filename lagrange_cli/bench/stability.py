"""The stability report: methods of all kinds in random scenes of every hard kind.

Each stratum has a row per method.  The row of lagtop also has the errors of its record, angles and
quaternion, to compare with the promised bounds.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from contextlib import closing
from functools import lru_cache, partial
from typing import Any, NamedTuple

from ..arithmetic.rounding import FIRST_DIGITS
from ..inputs.names import ANGLES
from ..inputs.top import Top
from ..output.report import Field, Report, fields_of, short
from ..output.terminal import Progress
from ..sweep.jobs import in_order
from .battery import CONTRACT, KEY_CONTRACT, Case, HardScene, hard_scene, judged_case, prove
from .hard_scenes import words_of
from .measure import common_conditions, settled_reference
from .method import OURS
from .peers import (
    LONG_SPAN,
    PEERS,
    SPANS,
    VERDICTS,
    ExactSpans,
    PeerRun,
    exact_spans,
    peer_conditions,
    peer_run,
)
from .reference import Reference

TIMES = 2
"""Random times per scene for lagtop; six more are next to half, quarter and whole periods."""
FINE, EXCEEDED = "fine", "EXCEEDED"
PROVED = (
    f"lagtop's own balls of {FIRST_DIGITS} digits or more, which Arb has checked in the tests: "
    "every error is a proved upper bound; `proved` is the worst of the angles and the quaternion"
)
Scene = tuple[str, int, int]
"""Stratum, seed and number of a scene."""
PARTS = ("", *PEERS)
"""Parts of the work on a scene: the check of lagtop's promise, and the run of each method."""


class StratumRow(NamedTuple):
    """One method in one stratum: its run in its worst scene, and the worst errors of lagtop."""

    stratum: str
    method: str
    scenes: int
    verdict: str
    error_5_rad: float | None = None
    """Greatest error over 5 periods (rad); infinite if the method gave up earlier."""
    error_100_rad: float | None = None
    error_10000_rad: float | None = None
    condition_rad: float | None = None
    """Rotation of the attitude by half a unit in the last place of the inputs, over 100 periods."""
    growth: float | None = None
    """Exponent of the growth of the error in time."""
    energy: float | None = None
    """Change of the energy since the start, over the sum of its terms."""
    Lz: float | None = None
    evaluations: int | None = None
    theta_units: float | None = None
    """Worst error of lagtop in units (see `reference`), as for the next fields."""
    phi_units: float | None = None
    psi_units: float | None = None
    quaternion_units: float | None = None
    key_ulps: float | None = None
    worst_key: str | None = None
    proved_units: float | None = None
    """The worst of the angles and the quaternion, if errors are proved bounds."""
    worst_case: str | None = None
    """A command line that shows lagtop's worst number."""
    remark: str | None = None
    run: PeerRun | None = None
    """The run of the worst scene, for the picture."""


def _error(error: float) -> str:
    return "gave up" if math.isinf(error) else short(error)


def _hundredths(error: float) -> str:
    return f"{error:.2f}" if error < 1000 else short(error)


_UNITS = [f"{name}_units" for name in (*ANGLES, "quaternion")]
_WORST = [*_UNITS, "key_ulps", "energy", "Lz"]
"""Errors of lagtop that a row has from the worst of all scenes, each for itself."""
_ALWAYS = [
    Field(name, name, is_text=True, names_the_row=name != "verdict")
    for name in ("stratum", "method", "verdict")
]
_COMPARED = [
    Field("error_5_rad", "5 periods", _error),
    Field("error_100_rad", "100", _error),
    Field("condition_rad", "condition", short),
    Field("growth", "growth", lambda growth: f"t^{growth:.1f}"),
    Field("energy", "energy", short),
    Field("Lz", "Lz", short),
]
_LONG = Field("error_10000_rad", f"{LONG_SPAN:.0e}", _error)
_PROVED = [
    *(
        Field(name, heading, _hundredths)
        for name, heading in zip(_WORST, (*ANGLES, "quat.", "keys"), strict=False)
    ),
    Field("proved_units", "proved", lambda bound: f"<= {_hundredths(bound)}"),
]


def run_battery(
    strata: Sequence[str],
    samples: int,
    seed: int,
    progress: Progress,
    jobs: int = 1,
    *,
    certify: bool = False,
    is_long: bool = False,
) -> Report:
    """Return the report on `samples` scenes of each stratum, computed by `jobs` processes.

    With `certify`, only lagtop is checked, by enclosures, and errors are proved bounds.
    """
    cases: dict[str, list[Case]] = {name: [] for name in strata}
    runs: dict[str, dict[str, list[PeerRun]]] = {name: {} for name in strata}
    scenes = [(name, seed, i) for name in strata for i in range(samples)]
    parts = [(scene, part) for scene in scenes for part in (PARTS[:1] if certify else PARTS)]
    work = partial(judged, certify=certify, is_long=is_long)
    with closing(in_order(work, parts, jobs)) as results:
        for (name, _, _), _ in progress(parts, "runs"):
            result = next(results)
            if isinstance(result, Case):
                cases[name].append(result)
            else:
                runs[name].setdefault(result.method, []).append(result)
    rows = [row for name in strata for row in stratum_rows(name, cases[name], runs[name].values())]
    agreement = max(case.agreement for of_stratum in cases.values() for case in of_stratum)
    conditions = common_conditions(agreement) | _conditions(strata, samples, seed)
    if certify:
        conditions["reference"] = PROVED
    else:
        conditions |= peer_conditions(is_long=is_long)
    shown = _PROVED if certify else [*_COMPARED, _LONG] if is_long else _COMPARED
    fields = fields_of(StratumRow._fields[:-1], *_ALWAYS, *shown)
    return Report(conditions, fields, rows, _conclusions(rows))


def judged(part: tuple[Scene, str], *, certify: bool, is_long: bool) -> Case | PeerRun:
    """Return lagtop's errors in a scene, or the run of one method.

    A scene is given by stratum, seed and number.  With `certify`, the errors are proved bounds.
    """
    scene, name = part
    if certify:
        return prove(hard_scene(*scene, TIMES))
    hard, settled, exact = _prepared(scene, is_long)
    return peer_run(name, exact) if name else judged_case(hard, settled)


@lru_cache(maxsize=1)
def _prepared(scene: Scene, is_long: bool) -> tuple[HardScene, tuple[Reference, float], ExactSpans]:
    """Return a scene, its settled reference and its exact spans, for all parts of the scene."""
    hard = hard_scene(*scene, TIMES)
    top = Top(**hard.inputs)
    settled = settled_reference(top)
    return hard, settled, exact_spans(top, settled[0], is_long=is_long)


def stratum_rows(
    stratum: str, cases: Sequence[Case], methods: Iterable[Sequence[PeerRun]]
) -> list[StratumRow]:
    """Return the rows of a stratum, one per method, or one of proved bounds if none was run."""
    worst = max(cases, key=lambda case: case.excess)
    ours: dict[str, Any] = {name: max(getattr(x, name) for x in cases) for name in _WORST}
    ours["worst_key"] = max(cases, key=lambda case: case.key_ulps).worst_key
    ours["worst_case"] = worst.command()
    if worst.excess > 1:
        ours["verdict"] = EXCEEDED
    rows = []
    for runs in methods:
        run = max(runs, key=_badness)
        row = StratumRow(
            stratum,
            run.method,
            len(cases),
            run.verdict,
            error_5_rad=run.error(SPANS[0]),
            error_100_rad=run.error(SPANS[1]),
            error_10000_rad=run.error(LONG_SPAN),
            condition_rad=run.condition(SPANS[1]),
            growth=run.growth,
            energy=run.drift[0],
            Lz=run.drift[1],
            evaluations=run.evaluations,
            remark=run.remark,
            run=run,
        )
        rows.append(row._replace(**ours) if run.method == OURS else row)
    ours = {"verdict": FINE, "proved_units": max(ours[name] for name in _UNITS)} | ours
    return rows or [StratumRow(stratum, OURS, len(cases), **ours)]


def _badness(run: PeerRun) -> tuple[int, float]:
    """Return a sorting key for the badness of a run: its verdict, then its error."""
    place = list(VERDICTS).index(run.verdict) if run.verdict else -1
    return place, run.error(SPANS[1]) or 0.0


def exceeded(report: Report) -> list[str]:
    """Return the strata in which lagtop breaks a promise, each with its worst case."""
    bad = (row for row in report.rows if row.verdict == EXCEEDED)
    return [f"{row.stratum}: {row.worst_case}" for row in bad]


def _conditions(strata: Sequence[str], samples: int, seed: int) -> dict[str, str]:
    return {
        "scenes": f"{samples} per stratum, seed {seed}; lagtop also at {TIMES} times 1e-9 to 1e14 "
        "periods before or after the start, and at the doubles next to a half period on one side "
        "and to a quarter, half or whole number of periods on the other, from 1 to 1e14",
        "strata": "; ".join(f"{name}: {words_of(name)}" for name in strata),
        "promise": f"lagtop: angles and quaternion within {CONTRACT:g} units, every key of the "
        f"record within {KEY_CONTRACT:g} gaps between doubles",
    }


def _conclusions(rows: Sequence[StratumRow]) -> list[str]:
    ours = [row for row in rows if row.method == OURS]
    bad = [row.stratum for row in ours if row.verdict == EXCEEDED]
    verdict = f"Exceeded in: {', '.join(bad)}." if bad else "All strata are within the contract."
    missing = dict.fromkeys(f"{row.method} ({row.remark})" for row in rows if not row.verdict)
    cases = (f"{row.stratum}: {row.worst_case}" for row in ours)
    return [verdict, *(f"Not compared: {x}." for x in missing), "", "Worst cases:", *cases]
