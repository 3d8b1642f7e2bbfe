"""Error against run time, for every method at the same times, against one reference."""

from __future__ import annotations

import math
import platform
import statistics
import time
from collections.abc import Sequence
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from typing import Any, NamedTuple

import mpmath
import numpy as np
from numpy.typing import NDArray

from ..arithmetic.types import Array
from ..errors import LagtopError, UnavailableError
from ..inputs.names import ANGLES, check_names
from ..inputs.top import Top
from ..motion.regime import Regime
from ..motion.solve import Motion
from ..output.terminal import Progress, silent
from .closed_forms import CLOSED_FORMS
from .engines import SCHEMES, engines
from .integrators import integrators
from .method import FAILURES, AngleFunction, Method, MethodRow, Run, failure_remark, is_out
from .reference import EPS, ExactAngles, Reference, angle_differences, angle_units

JUDGED = 201
"""Number of times that are compared with the reference; the last time is one of them."""
_DIGITS, _MORE_DIGITS, _AGREEMENT = 80, 30, 1e-9
"""Least digits of the reference, additional digits of its check, and units by which both may
differ.
"""
RUNS, SECONDS_OF_RUNS = 9, 0.3
"""Largest number of repetitions of a timing, and the seconds after which they end."""


class Task(NamedTuple):
    """Times for one top, and the exact angles at some of them."""

    scene: str | None
    """The name of the scene, if it was given."""
    motion: Motion
    times: Array
    judged: NDArray[np.int64]
    """Indices of the times with exact angles."""
    exact: list[ExactAngles]
    agreement: float
    """Greatest difference between references at two precisions, in units."""

    @property
    def periods(self) -> float:
        """The span in nutation periods."""
        return float(self.times[-1]) / reference_period(self.motion)


def reference_period(motion: Motion) -> float:
    """Return the nutation period of a scene that has passed `check_scene`."""
    return float(motion.T_nutation or math.inf)


def all_methods(limit: float) -> dict[str, Method]:
    """Return every method by name, with a time limit of a run in seconds; engines are the last."""
    return CLOSED_FORMS | integrators(limit) | engines(limit)


def groups() -> dict[str, list[str]]:
    """Return the names of groups of methods: all engines, and each engine."""
    names: dict[str, list[str]] = {"engines": list(SCHEMES)}
    for name, scheme in SCHEMES.items():
        names.setdefault(scheme.package, []).append(name)
    return names


def chosen_methods(names: Sequence[str] | None, limit: float) -> dict[str, Method]:
    """Return the methods with these names (of methods or groups), or the usual methods.

    Raises LagtopError for an unknown name, and UnavailableError if none of the methods is
    installed.
    """
    known, several = all_methods(limit), groups()
    if names is None:
        return {name: method for name, method in known.items() if not method.engine}
    check_names("methods", names, [*known, *(x for x in several if x not in known)])
    single = dict.fromkeys(x for name in names for x in several.get(name, [name]))
    chosen = {name: known[name] for name in single}
    missing = [method.missing_package() for method in chosen.values()]
    if all(missing):
        packages = " ".join(dict.fromkeys(missing))
        raise UnavailableError(f"none of these methods is installed: pip install {packages}")
    return chosen


def task(
    motion: Motion,
    t_max: float,
    count: int,
    *,
    scene: str | None = None,
    judged: int = JUDGED,
    progress: Progress = silent,
) -> Task:
    """Return `count` times from 0 to t_max (only t_max if 1), with exact angles at some of them.

    Raises LagtopError for a motion that the reference cannot check, and for a time out of reach.
    """
    check_scene(motion)
    np.empty(1 << 21)  # glibc then keeps freed memory: allocating it again would double the time
    times = np.linspace(0.0, t_max, count) if count > 1 else np.array([t_max])
    motion.sampler().check(times)
    index = np.unique(np.linspace(0, count - 1, min(judged, count)).round().astype(np.int64))
    reference, agreement = settled_reference(motion.top)
    exact = [reference.at(t) for t in progress(times[index].tolist(), "reference")]
    return Task(scene, motion, times, index, exact, agreement)


def settled_reference(top: Top) -> tuple[Reference, float]:
    """Return the reference with sufficient digits for a top, and its difference from fewer digits.

    The difference is the greatest of the angles after a quarter of a period, in units.
    """
    passes = [abs(float(mpmath.log10(x / y))) for x, y in Reference(top, _DIGITS).gaps]
    digits = _DIGITS + math.ceil(max(passes))  # to find the side of a pole
    while True:
        few, more = Reference(top, digits), Reference(top, digits + _MORE_DIGITS)
        with suppress(TypeError, ValueError, ZeroDivisionError):  # digits lost by cancellation
            t = float(more.T) / 4
            exact = more.at(t)
            agreement = max(angle_units(few.at(t)[:3], exact))
            numbers = zip(few.record().values(), more.record().values(), strict=True)
            if agreement < _AGREEMENT and all(
                x is None or abs(x - y) <= _AGREEMENT * EPS * abs(y) for x, y in numbers
            ):
                return more, agreement
        digits *= 2


def check_scene(motion: Motion) -> None:
    """Raise LagtopError for a scene that the reference, made for nutation, cannot check."""
    top = motion.top
    if motion.regime not in (Regime.REGULAR, Regime.NO_SPIN):
        raise LagtopError(f"the scene must nutate, got {motion.regime.value}")
    if top.pole:
        raise LagtopError("theta0 must be off the vertical for a comparison of Euler angles")
    if not (top.r0 or top.psidot0):
        raise LagtopError("r0 or psidot0 must be other than 0: a plane pendulum has only a tilt")


def measure(work: Task, name: str, method: Method, setting: Any) -> MethodRow:
    """Return the errors and times of a run of one method; the remark states a failure."""
    row = MethodRow(work.scene, name, setting, work.periods)
    times = work.times[work.judged] if method.costly else work.times
    try:
        with np.errstate(all="ignore"):  # values that are not finite are reported below
            sample, setup = method.start(work.motion.top, setting)
            run, seconds = _timed(sample, times)
    except FAILURES as reason:
        failed = row._replace(remark=failure_remark(reason))
        return failed._replace(setting="") if is_out(failed.remark) else failed
    timed = row._replace(
        setup_s=setup,
        ns_min=min(seconds) / times.size * 1e9,
        ns_median=statistics.median(seconds) / times.size * 1e9,
        runs=len(seconds),
        remark=method.mark(),
        **run.work._asdict(),
    )
    kept = range(times.size) if method.costly else work.judged.tolist()
    return _judged(timed, work, [[angle[i] for angle in run.angles] for i in kept], method)


def _timed(sample: AngleFunction, times: Array) -> tuple[Run, list[float]]:
    """Return the last run, and the seconds of warm runs; a long run is not repeated."""
    seconds: list[float] = []
    while True:
        begun = time.perf_counter()
        run = sample(times)
        seconds.append(time.perf_counter() - begun)
        first, *warm = seconds
        if first > SECONDS_OF_RUNS or len(warm) == RUNS or sum(warm) >= SECONDS_OF_RUNS:
            return run, warm or seconds


def _judged(
    row: MethodRow, work: Task, found: Sequence[Sequence[Any]], method: Method
) -> MethodRow:
    """Return the row with its errors."""
    turns = method.whole_turns
    pairs = list(zip(found, work.exact, strict=True))
    errors = [angle_differences(angles, exact, whole_turns=turns) for angles, exact in pairs]
    worst, end = [max(angle) for angle in zip(*errors, strict=True)], errors[-1]
    if not math.isfinite(max(worst)):
        return row._replace(remark="failed: returned values that are not finite")
    units = max(max(angle_units(angles, exact, whole_turns=turns)) for angles, exact in pairs)
    each: dict[str, Any] = {f"{name}_max": x for name, x in zip(ANGLES, worst, strict=True)}
    each |= {f"{name}_end": x for name, x in zip(ANGLES, end, strict=True)}
    return row._replace(error_rad=max(worst), error_end=max(end), units_max=units, **each)


def common_conditions(agreement: float) -> dict[str, str]:
    """Return the machine, the versions of Python and of all packages, and the reference."""
    names = []
    with suppress(OSError), open("/proc/cpuinfo", encoding="utf-8") as lines:
        names = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    processor = names[0] if names else platform.processor() or "unknown processor"
    versions = [f"Python {platform.python_version()}"]
    for name in ("lagtop", "numpy", "mpmath", "scipy", "heyoka"):
        try:
            versions.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            versions.append(f"no {name}")
    return {
        "machine": f"{processor}, {platform.system()} {platform.machine()}",
        "versions": ", ".join(versions),
        "reference": f"Legendre's third integral by mpmath, {_DIGITS} digits or more; with "
        f"{_MORE_DIGITS} digits fewer it differs by {agreement:.0e} units at most",
    }
