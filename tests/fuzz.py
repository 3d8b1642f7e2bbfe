"""Fresh random scenes of the worst kinds, judged in ball arithmetic; not collected by pytest.

    python tests/fuzz.py --scenes 20000 --seed 1
    python tests/fuzz.py --scenes 2000 --kinds 'over a pole,cusp' --sweep
    python tests/fuzz.py --scenes 100000 --certify

Each scene is judged at twenty times: fifteen next to a whole, half or quarter number of periods
(the double and both its neighbours), five anywhere, from 1 to 1e14 periods on both sides of the
start.  The report is the worst error of every kind, in units of `Judge.errors`; every key of
`solve` that is not the double nearest to the exact value; with --sweep, every key of `sweep` beyond
10 eps, and angles of all scenes at once (`sweep_angles`), up to 1e5 periods from the start.  What
exceeds the bounds is listed with a command that shows it, and the exit code is 1.
About 20 to 40 scenes a second and core.  With --certify the judge is the program's own arithmetic
of balls (`solve --certify`), for the keys of `solve` alone: about 100 scenes a second and core.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np
from ball_judge import Judge
from balls.scene import Undecided
from fuzz_scenes import KINDS, Scene

from lagrange_cli import LagtopError, Motion, Top, solve, sweep
from lagrange_cli.arithmetic.points import ListedPoints
from lagrange_cli.errors import OutOfRangeError
from lagrange_cli.motion.certified import Certified
from lagrange_cli.motion.record import NUMBER_KEYS, requested_keys
from lagrange_cli.motion.table import rows
from lagrange_cli.sweeps.angles import sweep_angles

UNITS, HALF_ULP, SWEEP_EPS = 4.0, 0.5 + 1e-9, 10.0
"""The bounds: of an angle or a part of the quaternion, of a key of `solve`, of one of `sweep`."""
NAMES = ("theta", "phi", "psi", "quaternion", "dphi", "dpsi", "wrapped")
NEAR = 5
"""Decades of periods up to which the angles of many tops at once are judged."""
COSINES = ("u1", "u2", "u_quarter")
NEIGHBOURS, ELSEWHERE = 5, 5
CHUNK, MOST_SHOWN = 50, 40


@dataclass
class Tally:
    """What the scenes of one kind have shown."""

    scenes: int = 0
    times: int = 0
    worst: dict[str, float] = field(default_factory=dict)
    counts: Counter[str] = field(default_factory=Counter)
    violations: list[str] = field(default_factory=list)

    def note(self, name: str, error: float, bound: float, show: str) -> None:
        """Keep an error, and how to see it where it exceeds its bound."""
        self.worst[name] = max(self.worst.get(name, 0.0), error)
        if not error <= bound:
            self.counts[name] += 1
            self.violations.append(f"{name} {error:.3g}: {show}")

    def add(self, other: Tally) -> None:
        """Take in the tally of more scenes."""
        self.scenes += other.scenes
        self.times += other.times
        self.counts += other.counts
        self.violations += other.violations
        for name, error in other.worst.items():
            self.worst[name] = max(self.worst.get(name, 0.0), error)


def times_of(rng: random.Random, period: Fraction, decades: int = 14) -> list[float]:
    """Return times next to quarters of a period, each with its neighbours, and others."""
    found = []
    for _ in range(NEIGHBOURS):
        quarters = 4 * int(10 ** rng.uniform(0, decades)) + rng.choice([0, 1, 2, 2, 3])
        t = rng.choice([-1, 1]) * float(period * quarters / 4)
        found += [t, math.nextafter(t, math.inf), math.nextafter(t, -math.inf)]
    for power in (rng.uniform(-9, 1), 0, *(rng.uniform(0, decades) for _ in range(ELSEWHERE - 2))):
        found.append(float(period) * rng.choice([-1, 1]) * rng.random() * 10**power)
    return found


def period_of(judge: Judge) -> Fraction:
    """Return the nutation period; where there is none, about a unit of the motion."""
    ball = judge.record.get("T_nutation")
    if ball is not None:
        mantissa, exponent = ball.mid().man_exp()
        return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    scene = judge.scene
    sizes = (scene.b, scene.r0, scene.theta_rate, scene.psi_rate, math.sqrt(scene.a))
    return 1 / Fraction(max(abs(float(size)) for size in sizes) or 1.0) / 4


def judge_angles(tally: Tally, judge: Judge, motion: Motion, times: Sequence[float]) -> None:
    """Judge the angles and the quaternion of one motion."""
    points = ListedPoints([Fraction(t) for t in times])
    columns = ("theta", "phi", "psi", "quaternion", "dphi", "dpsi")
    _, blocks = rows(motion, points, columns, radians=True)
    computed = np.concatenate(list(blocks)).tolist()
    wrapped = zip(*(angle.tolist() for angle in motion.angles(times, wrap=True)[1:]), strict=True)
    for t, values, short in zip(times, computed, wrapped, strict=True):
        tally.times += 1
        try:
            errors = judge.errors(t, tuple(values[:7]))
            remainders = judge.remainder_errors(t, tuple(values[7:]))
            turned = max(judge.wrapped_errors(t, short))
        except Undecided:
            tally.counts["undecided times"] += 1
            continue
        show = f"lagtop table {motion.top.options()} --columns {{}} --t-min {t!r} --n 1"
        shown = (*errors[:3], max(errors[3:]), *remainders, turned)
        for name, error in zip(NAMES, shown, strict=True):
            asked = "t,phi,psi --wrap" if name == "wrapped" else f"t,{name}"
            tally.note(name, error, UNITS, show.format(asked))


def judge_record(tally: Tally, judge: Judge, motion: Motion) -> None:
    """Judge every number of a record and on request: the nearest double, or rightly none."""
    for key in (*NUMBER_KEYS, *requested_keys()):
        value, exact = getattr(motion, key), judge.exact(key)
        show = f"lagtop solve {motion.top.options()} --get {key}"
        if (value is None) != (exact is None):
            tally.counts[f"absent {key}"] += 1
            tally.violations.append(f"{key} is {value!r}, the judge has {exact}: {show}")
        elif value is not None:
            tally.note("key", judge.ulps(key, value), HALF_ULP, show + f"  # {key} {value!r}")


def inputs_of(judges: Sequence[tuple[Scene, Judge]]) -> dict[str, list[float]]:
    """Return scenes as inputs of many tops."""
    inputs = {
        key: [float(scene.get(key, np.nan)) for scene, _ in judges]
        for key in ("m", "A", "C", "s", "g", "r0", "theta0_deg", "theta0_rad")
    }
    for key in ("thetadot0", "psidot0"):
        inputs[key] = [float(scene.get(key, 0)) for scene, _ in judges]
    return inputs


def judge_many(tally: Tally, judges: Sequence[tuple[Scene, Judge]], rng: random.Random) -> None:
    """Judge the angles of many tops at once."""
    times = [times_of(rng, period_of(judge), NEAR) for _, judge in judges]
    inputs: dict[str, Any] = inputs_of(judges)
    found: dict[str, Any] = sweep_angles(times, **inputs)
    for i, (scene, judge) in enumerate(judges):
        if found["error"][i] is not None:
            tally.counts["sweep_angles refused"] += 1
            continue
        show = f"sweep_angles of lagtop table {Top(**scene).options()} --t-min"
        for j, t in enumerate(times[i]):
            computed = tuple(float(found[name][i][j]) for name in ("theta", "phi", "psi"))
            try:
                errors = judge.angle_errors(t, computed)  # type: ignore[arg-type]
            except Undecided:
                tally.counts["undecided times"] += 1
                continue
            tally.note("many", max(errors), UNITS, f"{show} {t!r} --n 1")


def judge_sweep(tally: Tally, judges: Sequence[tuple[Scene, Judge]]) -> None:
    """Judge every number of a sweep of scenes."""
    inputs = inputs_of(judges)
    columns = sweep(keys=[*NUMBER_KEYS, "error"], **inputs)  # type: ignore[arg-type]
    for i, (scene, judge) in enumerate(judges):
        if columns["error"][i] is not None:
            tally.counts["sweep refused"] += 1
            continue
        options = Top(**scene).options()
        for key in NUMBER_KEYS:
            value, exact = float(columns[key][i]), judge.record.get(key)
            show = f"lagtop sweep {options} --keys {key}  # {value!r}"
            if math.isnan(value) != (exact is None):
                tally.counts[f"sweep absent {key}"] += 1
                tally.violations.append(f"sweep {key}, the judge has {exact}: {show}")
            elif exact is not None:
                error = sweep_error(judge, key, value)
                tally.note("sweep", error, SWEEP_EPS, show)


def sweep_error(judge: Judge, key: str, value: float) -> float:
    """Return the error of a key of a sweep in eps of what its promise is measured by."""
    if key in COSINES:
        return judge.relative(key, value, absolute=1.0)
    if key.endswith("_half") and judge.half_parts is not None:
        parts = [abs(float(part)) for part in judge.half_parts]
        return judge.relative(key, value, absolute=max(abs(float(judge.scene.r0)), *parts))
    return judge.relative(key, value)


def certify_chunk(task: tuple[str, int, int, int, bool]) -> tuple[str, Tally]:
    """Prove of some scenes of one kind that every number of `solve` is the nearest double."""
    kind, seed, first, count, _ = task
    tally = Tally()
    for i in range(first, first + count):
        scene = KINDS[kind](random.Random(f"{seed} {kind} {i}"))
        tally.scenes += 1
        try:
            motion = solve(Top(**scene))
            proofs = Certified(motion.exact)
            record, _ = motion.record_in_range()
        except LagtopError as error:
            tally.counts[f"refused: {str(error)[:60]}"] += 1
            continue
        for key in NUMBER_KEYS:
            value = record[key]
            show = f"lagtop solve {motion.top.options()} --get {key}  # {value!r}"
            try:
                found = proofs.number(key)
                proved = None if found is None else found.value
            except OutOfRangeError:
                proved = None
            except LagtopError:
                tally.counts["undecided keys"] += 1
                tally.violations.append(f"undecided {key}: {show}")
                continue
            tally.counts["proved keys"] += 1
            if value != proved:
                tally.counts["not nearest"] += 1
                tally.violations.append(f"{key} is not {proved!r}: {show}")
    return kind, tally


def run_chunk(task: tuple[str, int, int, int, bool]) -> tuple[str, Tally]:
    """Judge some scenes of one kind."""
    kind, seed, first, count, with_sweep = task
    tally, judges = Tally(), []
    for i in range(first, first + count):
        rng = random.Random(f"{seed} {kind} {i}")
        scene = KINDS[kind](rng)
        tally.scenes += 1
        try:
            motion, judge = solve(Top(**scene)), Judge(Top(**scene).as_dict())
            judge.record, judge.requested  # noqa: B018 - made here, so that what is undecided is counted once
            judge_record(tally, judge, motion)
            judge_angles(tally, judge, motion, times_of(rng, period_of(judge)))
        except LagtopError as error:
            tally.counts["refused"] += 1
            tally.counts[f"refused: {str(error)[:60]}"] += 1
            continue
        except Undecided:
            tally.counts["undecided scenes"] += 1
            continue
        judges.append((scene, judge))
    if with_sweep and judges:
        judge_sweep(tally, judges)
        judge_many(tally, judges, random.Random(f"{seed} {kind} {first} many"))
    return kind, tally


def run(
    kinds: Sequence[str],
    scenes: int,
    seed: int,
    *,
    jobs: int,
    with_sweep: bool,
    judge: Callable[..., Any] = run_chunk,
) -> Any:
    """Yield the tally of each chunk, as they come."""
    share = -(-scenes // len(kinds))
    tasks = [
        (kind, seed, first, min(CHUNK, share - first), with_sweep)
        for first in range(0, share, CHUNK)
        for kind in kinds
    ]
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(judge, tasks)


def lines_of(tallies: dict[str, Tally]) -> Iterator[str]:
    """Yield the report, a line per kind and then what exceeds its bound."""
    names = "theta    phi    psi   quat   dphi   dpsi   wrap    key  sweep   many"
    yield f"{'kind':24} scenes  times  {names}  beyond"
    for kind, tally in tallies.items():
        worst = [tally.worst.get(name, 0.0) for name in (*NAMES, "key", "sweep", "many")]
        shown = " ".join(f"{error:6.3g}" for error in worst)
        beyond = len(tally.violations)
        yield f"{kind:24} {tally.scenes:6} {tally.times:6} {shown}  {beyond}"
    for kind, tally in tallies.items():
        if tally.counts:
            yield f"\n{kind}: " + ", ".join(f"{name} {n}" for name, n in tally.counts.items())
        yield from tally.violations[:MOST_SHOWN]


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=1000, help="how many, over all kinds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", help="only these, with commas between: " + ", ".join(KINDS))
    parser.add_argument("--sweep", action="store_true", help="judge `sweep` too")
    parser.add_argument("--certify", action="store_true", help="prove the keys of `solve` alone")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    options = parser.parse_args()
    kinds = [kind.strip() for kind in options.kinds.split(",")] if options.kinds else list(KINDS)
    if unknown := set(kinds) - set(KINDS):
        parser.error(f"kinds must be among {', '.join(KINDS)}, got {min(unknown)!r}")
    tallies, begun = {kind: Tally() for kind in kinds}, time.monotonic()
    how: dict[str, Any] = {"jobs": options.jobs, "with_sweep": options.sweep}
    how["judge"] = certify_chunk if options.certify else run_chunk
    for kind, tally in run(kinds, options.scenes, options.seed, **how):
        tallies[kind].add(tally)
    print("\n".join(lines_of(tallies)))
    done = sum(tally.scenes for tally in tallies.values())
    seconds = time.monotonic() - begun
    print(
        f"\n{done} scenes, seed {options.seed}, in {seconds:.0f} s: {done / seconds:.0f} a second"
    )
    return 1 if any(tally.violations for tally in tallies.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
