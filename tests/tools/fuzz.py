"""Fresh random scenes of the worst kinds, checked by formulas in mpmath; not collected by pytest.

    python tests/tools/fuzz.py --scenes 20000 --seed 1
    python tests/tools/fuzz.py --scenes 2000 --kinds 'over a pole,double cusp' --sweep --times 10

Every number of `solve` must be the double nearest to that of `record_reference`, whose formulas
differ except for the roots, or exist in neither.  A third of the scenes are checked as decimals of
twenty to sixty digits, or of up to 400 with --long, and printed in 5 to 40.  Some give phidot0 in
place of r0, and A_cm in place of A.  With --times N, the attitude of tops that nutate is checked at
N times, next to halves and quarters of a period up to 1e14 periods away.  With --sweep, every
number of a sweep must be within 10 eps.

What exceeds the bounds is listed with a command that shows it, and the exit code is 1.  A run that
is stopped lists what it has found.  About five scenes a second and core, with --sweep one.
"""

from __future__ import annotations

import argparse
import math
import random
import signal
import sys
import time
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from decimal import Decimal, localcontext
from fractions import Fraction
from multiprocessing import Pool
from pathlib import Path
from typing import Any

import mpmath

sys.path.append(str(Path(__file__).parents[1]))  # references of the tests

from lagtop import LagtopError, Motion, Top, solve, sweep
from record_reference import reference_columns, reference_record

from lagrange_cli.bench.hard_scenes import CORNERS, KINDS, Scene
from lagrange_cli.bench.reference import rotation_angle
from lagrange_cli.errors import OutOfRangeError
from lagrange_cli.solver.keys import NUMBER_KEYS, NUMBERS

HALF_ULP, ATTITUDE, SWEEP_EPS = 0.5 + 1e-9, 8.0, 10.0
"""The bounds: of a number in its last place, of an attitude in units, of a sweep in eps."""
CHUNK, MOST_SHOWN = 20, 40
NOISE_OF_PERIODS = mpmath.mpf(10) ** 500
"""Period of the reference beyond which it is that of a rate of 0 with rounding errors."""
Numbers = Mapping[str, Any]
ALL_KINDS = KINDS | CORNERS


class Tally:
    """Results of some scenes of one kind."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.worst: dict[str, float] = {}
        self.violations: list[str] = []

    def note(self, name: str, error: float, bound: float, show: str) -> None:
        """Keep an error, and how to see it if it exceeds its bound."""
        self.counts[name] += 1
        self.worst[name] = max(self.worst.get(name, 0.0), error)
        if not error <= bound:
            self.violations.append(f"{name} {error:.3g}: {show}")

    def add(self, other: Tally) -> None:
        """Take in the tally of more scenes."""
        self.counts += other.counts
        self.violations += other.violations
        for name, error in other.worst.items():
            self.worst[name] = max(self.worst.get(name, 0.0), error)


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


def varied(rng: random.Random, scene: Scene, long: bool) -> tuple[Scene, int]:
    """Return a scene, perhaps with other inputs or in decimals, and the digits to print."""
    digits = 0
    if rng.random() < 1 / 3 or any(isinstance(x, Fraction) for x in scene.values()):
        scene, digits = as_decimals(rng, scene), rng.randrange(5, 40)
    if long:
        tail = Fraction(rng.randrange(10**9), 10 ** rng.randrange(30, 400))
        scene, digits = scene | {"r0": Fraction(scene.get("r0", 0)) + tail}, digits or 20
    if rng.random() < 1 / 6:
        scene = {("phidot0" if x == "r0" else x): y for x, y in scene.items()}
    if rng.random() < 1 / 6:
        A_cm = Fraction(scene["A"]) - Fraction(scene["m"]) * Fraction(scene["s"]) ** 2
        if A_cm >= 0:
            scene = {x: y for x, y in scene.items() if x != "A"} | {"A_cm": A_cm}
    return scene, digits


def typed(command: str, top: Top, *options: str) -> str:
    """Return a command for a top, with all digits of its inputs."""
    names = {"theta0_deg": "theta0", "theta0_rad": "rad --theta0", "A_cm": "A-cm"}
    given = [(names.get(x, x), Fraction(y)) for x, y in top.as_dict().items() if y is not None]
    with localcontext() as context:
        context.prec = 2000
        words = [f"--{x} {(Decimal(y.numerator) / y.denominator).normalize():g}" for x, y in given]
    return " ".join(["lagtop", command, *words, *options])


def number_of(motion: Motion, key: str, digits: int) -> Any:
    """Return a number of a motion; one beyond the doubles as 0 or an infinity."""
    try:
        found = motion.number(key, digits or None)
    except OutOfRangeError as error:
        return 0.0 if "5e-324" in str(error) else math.inf
    return None if found is None else found.value


def check_record(tally: Tally, exact: Numbers, motion: Motion, digits: int) -> None:
    """Check every number of a motion: correctly rounded, or rightly none."""
    for key in NUMBERS:
        value, true = number_of(motion, key, digits), exact.get(key)
        if value is None and true is not None and abs(true) > NOISE_OF_PERIODS:
            true = None
        show = typed("solve", motion.top, f"--digits {digits or 17} --get {key}  # {value}")
        if (value is None) != (true is None):
            known = true and mpmath.nstr(true, 20)
            tally.violations.append(f"{key} is {value!r}, the reference has {known}: {show}")
        elif value is not None:
            with mpmath.workdps(450):
                tally.note("number", _in_last_places(value, true, digits), HALF_ULP, show)


def checked_record(tally: Tally, motion: Motion, digits: int, most: int) -> Numbers:
    """Check the numbers of a motion, again with more digits if they differ; return exact ones."""
    for root_digits, kept in ((2_000, most), (6_000, 450)):
        found, inputs = Tally(), motion.top.as_dict()
        exact = reference_record(inputs, digits=kept, root_digits=root_digits)
        check_record(found, exact, motion, digits)
        if not found.violations:
            break
    tally.add(found)
    return exact


def _in_last_places(value: Any, true: Any, digits: int) -> float:
    """Return the error of a number in units of its last place; 0 if both agree with 0."""
    if value == math.inf:
        return 0.0 if abs(true) > sys.float_info.max else math.inf
    number = mpmath.mpf(value)
    if not number:
        return 0.0 if abs(true) <= mpmath.mpf(10) ** -90 else math.inf  # the noise of the reference
    if digits:
        unit = mpmath.mpf(10) ** (Decimal(value).adjusted() + 1 - digits)
    else:
        unit = mpmath.mpf(math.ulp(value))
    return float(abs(number - true) / unit)


def check_attitudes(tally: Tally, motion: Motion, exact: Numbers, times: list[float]) -> None:
    """Check attitudes at times."""
    columns = motion.table(times, ["quaternion"])
    rates = (exact[key] for key in ("mean_spin_rate", "mean_precession_rate"))
    speed = 2 * sum(abs(float(x)) for x in (*rates, 1 / exact["T_nutation"]))
    for t, *computed in zip(times, *columns.values(), strict=True):
        true = reference_columns(motion.top.as_dict(), t)
        with mpmath.workdps(60):
            away = rotation_angle(computed, tuple(true[name] for name in columns))
            turns = mpmath.mpf(t) / exact["T_nutation"]
            tau = float((turns - mpmath.nint(turns)) * exact["T_nutation"])
        show = typed("table", motion.top, f"--columns quaternion --t-min {t!r} --n 1")
        tally.note("attitude", away / (2.0**-52 * (1 + abs(tau) * speed)), ATTITUDE, show)


def times_of(rng: random.Random, period: float, count: int) -> list[float]:
    """Return times next to quarters of a period, and others."""
    found = []
    for _ in range(count):
        quarter = (4 * int(10 ** rng.uniform(0, 14)) + rng.choice([0, 1, 2, 2, 3])) / 4
        number = rng.choice([quarter, quarter, rng.random() * 10 ** rng.uniform(-9, 14)])
        t = rng.choice([-1, 1]) * period * number
        found.append(rng.choice([t, math.nextafter(t, math.inf), math.nextafter(t, -math.inf)]))
    return found


def size_in_sweeps(key: str, record: Numbers, r0: Any) -> Any:
    """Return the size to which a sweep's error of a key is compared, given the exact record.

    It is 1 for a cosine and the larger part of a difference for a rate at T/2.
    """
    if NUMBERS[key].relative_to:
        return 1
    if not key.endswith("rate_half"):
        return abs(record[key])
    turn, apart = record["precession_rate_half"], record["spin_rate_half"] - r0
    return max(abs(r0), abs(turn + apart) / 2, abs(turn - apart) / 2)


def check_sweep(tally: Tally, tilt: str, checks: list[tuple[Scene, Numbers]]) -> None:
    """Check every number of a sweep of scenes, all with tilts in degrees or all in radians."""
    names = (*"m A C s g r0 thetadot0 psidot0".split(), tilt)
    inputs: Any = {x: [float(scene.get(x, 0)) for scene, _ in checks] for x in names}
    columns = sweep(keys=[*NUMBER_KEYS, "error"], **inputs)
    for i, (scene, exact) in enumerate(checks):
        if columns["error"][i] is not None:
            tally.counts["sweep refused"] += 1
            continue
        for key in NUMBER_KEYS:
            value, true = float(columns[key][i]), exact.get(key)
            show = typed("sweep", Top(**scene), f"--keys {key}  # {value!r}")
            if true is None or math.isnan(value):
                if true is not None or not math.isnan(value):
                    tally.violations.append(f"sweep {key} is {value!r}: {show}")
                continue
            if not value and abs(true) <= mpmath.mpf(10) ** -90:  # the noise of the reference
                true = mpmath.mpf(0)
            size = size_in_sweeps(key, exact, mpmath.mpf(scene["r0"]))
            away = abs(mpmath.mpf(value) - true)
            tally.note("sweep", float(away / size / 2.0**-52) if away else 0.0, SWEEP_EPS, show)


Task = tuple[str, int, int, int, Any]
"""A kind, a seed, the first scene, how many, and the options."""


def run_chunk(task: Task) -> tuple[str, Tally]:
    """Check some scenes of one kind."""
    kind, seed, first, count, options = task
    tally = Tally()
    checks: list[tuple[Scene, Numbers]] = []
    for i in range(first, first + count):
        rng = random.Random(f"{seed} {kind} {i}")
        scene, digits = varied(rng, ALL_KINDS[kind](rng), options.long)
        tally.counts["scenes"] += 1
        try:
            motion = solve(Top(**scene))
        except LagtopError as error:
            tally.counts[f"refused: {str(error)[:60]}"] += 1
            continue
        exact = checked_record(tally, motion, digits, 450 if options.long else 120)
        if options.times and not digits and motion.facts.nutates:
            with suppress(LagtopError):  # too many turns for an attitude in doubles
                times = times_of(rng, motion.T_nutation, options.times)
                check_attitudes(tally, motion, exact, times)
        if not digits and "phidot0" not in scene and "A_cm" not in scene:
            checks.append((scene, exact))
    for tilt in ("theta0_deg", "theta0_rad") if options.sweep else ():
        if some := [(scene, exact) for scene, exact in checks if tilt in scene]:
            with mpmath.workdps(120):
                check_sweep(tally, tilt, some)
    return kind, tally


def stop(*_: object) -> None:
    """End a run at its first signal; `timeout` sends two."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=1000, help="how many, over all kinds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", help="only these, comma-separated: " + ", ".join(ALL_KINDS))
    parser.add_argument("--long", action="store_true", help="inputs of 30 to 400 digits")
    parser.add_argument("--sweep", action="store_true", help="check `sweep` too")
    parser.add_argument("--times", type=int, default=0, help="check attitudes at N times")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    options = parser.parse_args()
    kinds = list(map(str.strip, options.kinds.split(","))) if options.kinds else list(ALL_KINDS)
    if unknown := set(kinds) - set(ALL_KINDS):
        parser.error(f"kinds must be one of {', '.join(ALL_KINDS)}, got {min(unknown)!r}")
    tallies, begun = {kind: Tally() for kind in kinds}, time.monotonic()
    share = -(-options.scenes // len(kinds))
    tasks = [
        (kind, options.seed, first, min(CHUNK, share - first), options)
        for first in range(0, share, CHUNK)
        for kind in kinds
    ]
    with Pool(options.jobs, signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, stop)
        with suppress(KeyboardInterrupt):  # of a run that is stopped, print what was found
            for kind, tally in pool.imap_unordered(run_chunk, tasks):
                tallies[kind].add(tally)
    for kind, tally in tallies.items():
        worst = ", ".join(f"{name} {x:.3g}" for name, x in tally.worst.items())
        counts = ", ".join(f"{name} {n}" for name, n in tally.counts.items())
        beyond = [f"\n    {line}" for line in tally.violations[:MOST_SHOWN]]
        print(f"{kind}: {counts}; worst: {worst}; beyond: {len(tally.violations)}", *beyond, sep="")
    done = sum(tally.counts["scenes"] for tally in tallies.values())
    asked = f"{done} of {share * len(kinds)} scenes"
    print(f"{asked}, seed {options.seed}, in {time.monotonic() - begun:.0f} s")
    return 1 if any(tally.violations for tally in tallies.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
