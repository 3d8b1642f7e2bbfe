"""Error against run time: the same times by every method, judged by the many-digit reference."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.names import check_names
from ..motion.record import Regime
from ..motion.solve import Motion
from ..output.findings import Field, Findings, short
from .closed_forms import CLOSED_FORMS
from .integrators import STEPS_PER_SECOND, integrators
from .machine import machine, versions, warm_allocator
from .method import FailedError, Method, NotApplicableError, Sample, Sampled
from .reference import Exact, Reference, angle_differences, angle_units

JUDGED = 201
"""So many of the times, the last among them, are compared with the reference."""
DIGITS, FEWER_DIGITS = 80, 50
"""Of the reference, and of the one it is checked against."""
RUNS, SECONDS_OF_RUNS = 9, 0.3
"""A timing is repeated so often, or for so long."""
NOT_APPLICABLE = "not applicable"

Steps = Callable[[Sequence[Any], str], Iterable[Any]]
"""Goes through a sequence, and may show how far it is, under a label."""


class Task(NamedTuple):
    """The angles of one top at some times, and the exact ones at a part of them."""

    motion: Motion
    times: Array
    judged: NDArray[np.int64]
    """Indices into the times."""
    exact: list[Exact]
    agreement: float
    """Greatest difference, in radians, of the reference at two precisions."""

    @property
    def periods(self) -> float:
        """The span, in nutation periods."""
        return float(self.times[-1]) / period_of(self.motion)


class Row(NamedTuple):
    """One method at one setting."""

    method: str
    setting: float | str
    periods: float
    theta_max: float | None = None
    """Greatest error over the judged times, in radians; likewise the next."""
    phi_max: float | None = None
    psi_max: float | None = None
    theta_end: float | None = None
    phi_end: float | None = None
    psi_end: float | None = None
    error_max: float | None = None
    """The greatest of the three."""
    error_end: float | None = None
    units_max: float | None = None
    setup_s: float | None = None
    ns_min: float | None = None
    """Nanoseconds a sample: least and median of the runs."""
    ns_median: float | None = None
    runs: int | None = None
    front: bool = False
    """Whether no other is both faster and more accurate."""
    remark: str | None = None


ANGLES = ("theta", "phi", "psi")
FIELDS = [
    Field("method", "method", is_text=True, names_the_row=True),
    Field("setting", "setting", names_the_row=True),
    Field("periods"),
    *(Field(f"{angle}_max") for angle in ANGLES),
    *(Field(f"{angle}_end") for angle in ANGLES),
    Field("error_max", "max error", short),
    Field("error_end", "at the end", short),
    Field("units_max", "units", short),
    Field("setup_s", "set-up ms", lambda seconds: f"{1000 * seconds:.1f}"),
    Field("ns_min", "ns/sample", lambda ns: f"{ns:.0f}"),
    Field("ns_median", "median", lambda ns: f"{ns:.0f}"),
    Field("runs", "runs"),
    Field("front", "front", lambda front: "*" if front else ""),
    Field("remark", "remark", is_text=True),
]


def period_of(motion: Motion) -> float:
    """The nutation period of a scene that `check_scene` has passed."""
    return float(motion.T_nutation or math.inf)


def _silent(items: Sequence[Any], _: str) -> Iterable[Any]:
    return items


def chosen_methods(names: Sequence[str] | None, limit: float) -> dict[str, Method]:
    """Return the methods with these names, or all.  Raises LagtopError for an unknown one."""
    known = CLOSED_FORMS | integrators(limit)
    return {x: known[x] for x in (known if names is None else check_names("methods", names, known))}


def task(
    motion: Motion, t_max: float, count: int, *, judged: int = JUDGED, steps: Steps = _silent
) -> Task:
    """`count` times from 0 to t_max (just t_max for one), and the exact angles at some of them.

    Raises LagtopError for a motion that the reference cannot judge, and for a time out of reach.
    """
    check_scene(motion)
    warm_allocator()
    times = np.linspace(0.0, t_max, count) if count > 1 else np.array([t_max])
    motion.sampler().check(times)
    index = np.unique(np.linspace(0, count - 1, min(judged, count)).round().astype(np.int64))
    references = [Reference(motion.top, digits) for digits in (DIGITS, FEWER_DIGITS)]
    pairs = [[r.at(t) for r in references] for t in steps(times[index].tolist(), "reference")]
    agreement = max(max(angle_differences(one[:3], other)) for one, other in pairs)
    return Task(motion, times, index, [one for one, _ in pairs], agreement)


def check_scene(motion: Motion) -> None:
    """Raise LagtopError where the reference, which is made for nutation, has nothing to say."""
    top = motion.top
    if motion.regime not in (Regime.REGULAR, Regime.NO_SPIN):
        raise LagtopError(f"the scene must be one that nutates, got {motion.regime.value}")
    if top.pole:
        raise LagtopError("theta0 must be off the vertical for a comparison of Euler angles")
    if not (top.r0 or top.psidot0):
        raise LagtopError("r0 or psidot0 must be other than 0: a plane pendulum has only a tilt")


def measure(work: Task, name: str, method: Method, setting: Any) -> Row:
    """Run, judge and time one method at one setting; what fails is told in the remark."""
    row = Row(name, setting, work.periods)
    times = work.times[work.judged] if method.costly else work.times
    try:
        method.check_package()
        with np.errstate(all="ignore"):  # what is not a number is judged as such
            sample, setup = _set_up(method, work, setting)
            angles, seconds = _run(sample, times)
    except NotApplicableError as reason:
        return row._replace(setting="", remark=f"{NOT_APPLICABLE}: {reason}")
    except (FailedError, ArithmeticError, ValueError) as reason:  # formulas of others in doubles
        return row._replace(remark=f"failed: {reason}")
    timed = row._replace(
        setup_s=setup,
        ns_min=min(seconds) / times.size * 1e9,
        ns_median=statistics.median(seconds) / times.size * 1e9,
        runs=len(seconds),
    )
    kept = range(times.size) if method.costly else work.judged.tolist()
    return _judged(timed, work, [[angle[i] for angle in angles] for i in kept], method)


def _set_up(method: Method, work: Task, setting: Any) -> tuple[Sample, float]:
    if method.package:
        import_module(method.package)
    begun = time.perf_counter()
    sample = method.prepare(work.motion.top, setting)
    return sample, time.perf_counter() - begun


def _run(sample: Sample, times: Array) -> tuple[Sampled, list[float]]:
    """The angles of a first run, and the seconds of those after it, which find all warm.

    A run that takes long by itself is not repeated.
    """
    seconds: list[float] = []
    begun = time.perf_counter()
    angles = sample(times)
    first = time.perf_counter() - begun
    if first > SECONDS_OF_RUNS:
        return angles, [first]
    while len(seconds) < RUNS and sum(seconds) < SECONDS_OF_RUNS:
        begun = time.perf_counter()
        sample(times)
        seconds.append(time.perf_counter() - begun)
    return angles, seconds


def _judged(row: Row, work: Task, found: Sequence[Sequence[Any]], method: Method) -> Row:
    """The row with its errors."""
    turns = method.whole_turns
    pairs = list(zip(found, work.exact, strict=True))
    errors = [angle_differences(angles, exact, whole_turns=turns) for angles, exact in pairs]
    worst, end = [max(angle) for angle in zip(*errors, strict=True)], errors[-1]
    if not math.isfinite(max(worst)):
        return row._replace(remark="failed: gave what is not a number")
    units = max(max(angle_units(angles, exact, whole_turns=turns)) for angles, exact in pairs)
    each: dict[str, Any] = {f"{name}_max": x for name, x in zip(ANGLES, worst, strict=True)}
    each |= {f"{name}_end": x for name, x in zip(ANGLES, end, strict=True)}
    return row._replace(error_max=max(worst), error_end=max(end), units_max=units, **each)


def with_front(rows: Sequence[Row]) -> list[Row]:
    """Sorted by error, those marked that no other row beats in both error and time."""
    rows = sorted(rows, key=lambda row: math.inf if row.error_max is None else row.error_max)
    return [row._replace(front=is_done(row) and not rivals(row, rows)) for row in rows]


def is_done(row: Row) -> bool:
    """Whether it has an error and a time."""
    return row.error_max is not None and row.ns_min is not None


def is_out(row: Row) -> bool:
    """Whether the method cannot do the scene, at any setting."""
    return (row.remark or "").startswith(NOT_APPLICABLE)


def rivals(row: Row, rows: Iterable[Row]) -> list[Row]:
    """The rows of other methods that are at least as fast and as accurate, and better in one."""
    mine = (row.error_max, row.ns_min)
    return [
        other
        for other in rows
        if is_done(other)
        and (theirs := (other.error_max, other.ns_min)) != mine
        and all(x <= y for x, y in zip(theirs, mine, strict=True))  # type: ignore[operator]
    ]


def report(
    motion: Motion,
    t_max: float,
    count: int,
    methods: dict[str, Method],
    *,
    limit: float,
    steps: Steps = _silent,
) -> Findings:
    """Every method at every setting over one span.  Raises LagtopError as `task` does."""
    work = task(motion, t_max, count, steps=steps)
    runs = [(name, method, x) for name, method in methods.items() for x in method.settings]
    found: list[Row] = []
    for name, method, setting in steps(runs, "methods"):
        if not (found and found[-1].method == name and is_out(found[-1])):  # said once is enough
            found.append(measure(work, name, method, setting))
    rows = with_front(found)
    return Findings(conditions(work, limit), FIELDS, rows, list(conclusions(rows)))


def conclusions(rows: Sequence[Row]) -> Iterator[str]:
    """Who beats our closed form in doubles, and by how much."""
    for row in rows:
        if row.method == "lagtop" and is_done(row):
            better = rivals(row, rows)
            for other in better:
                yield (
                    f"{other.method} at {other.setting} beats lagtop: {other.error_max:.1e} rad in "
                    f"{other.ns_min:.0f} ns against {row.error_max:.1e} rad in {row.ns_min:.0f} ns"
                )
            if not better:
                yield "No method is both faster and more accurate than lagtop."
    missing = sum(not is_done(row) for row in rows)
    if missing:
        yield f"Without a result: {missing} (see the remarks)."


def conditions(work: Task, limit: float) -> dict[str, str]:
    """All that the figures depend on."""
    motion = work.motion
    return {
        "machine": machine(),
        "versions": versions(),
        "scene": motion.top.options(),
        "regime": f"{motion.regime.value}, nutation period {motion.T_nutation}",
        "times": f"{work.times.size} from 0 to {float(work.times[-1])} "
        f"({work.periods:.6g} nutation periods)",
        "reference": f"Legendre's third integral by mpmath, {DIGITS} digits; with {FEWER_DIGITS} "
        f"digits it differs by {work.agreement:.0e} rad at most",
        "error": f"radians, greatest of the three angles at {len(work.exact)} of the times, the "
        "last among them",
        "units": "the same over eps (max(1, |angle|) + |tau rate|), tau the time since the nearest "
        "whole period",
        "turns": "compared unwrapped; quaternion forms know angles modulo 2 pi, and so are judged",
        "time": f"one thread; after a warm-up, of memory too, least and median of up to {RUNS} "
        f"runs (of one where it takes {SECONDS_OF_RUNS} s)",
        "exceptions": f"a run of {limit:g} s fails (of heyoka, one of {limit * STEPS_PER_SECOND:g} "
        "steps); lagtop-digits runs at the judged times only, "
        "set-up included",
    }
