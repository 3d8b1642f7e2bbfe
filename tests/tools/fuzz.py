"""Fresh random scenes of the hard kinds, checked as in the tests; not collected by pytest.

    python tests/tools/fuzz.py --scenes 20000 --seed 1
    python tests/tools/fuzz.py --scenes 2000 --kinds 'over a pole,double cusp' --sweep --times 10

Every number of `solve` is compared with `record_reference`, whose formulas differ except for the
roots.  A third of the scenes are checked as decimals of twenty to sixty digits, or of up to 400
with --long, and printed in 5 to 40.  Some give phidot0 in place of r0, and A_cm in place of A.
With --times N, the angles of tops that nutate are compared with proved rows at N times, next to
quarters of a period up to 1e15 periods away.  With --sweep, every number of a sweep must be within
its bound.

What fails is listed with a command that shows it, and the exit code is 1.  About five scenes a
second and core.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import partial
from multiprocessing import Pool
from pathlib import Path

sys.path.extend(str(Path(__file__).parents[1] / folder) for folder in ("", "solver", "sweeps"))

from lagtop import LagtopError, Top, solve
from test_columns import errors, turning_times
from test_digits import assert_correct
from test_trusted_numbers import assert_trusted

from lagrange_cli.bench.hard_scenes import CORNERS, KINDS, Scene
from lagrange_cli.errors import OutOfRangeWarning

ALL_KINDS = KINDS | CORNERS
MOST_UNITS = 5.0
"""The greatest error of angles, in the units of `test_columns`."""
CHUNK = 20


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


def typed(top: Top) -> str:
    """Return a command for a top, with all digits of its inputs."""
    names = {"theta0_deg": "theta0", "theta0_rad": "rad --theta0", "A_cm": "A-cm"}
    given = [(names.get(x, x), Fraction(y)) for x, y in top.as_dict().items() if y is not None]
    with localcontext() as context:
        context.prec = 2000
        words = [f"--{x} {(Decimal(y.numerator) / y.denominator).normalize():g}" for x, y in given]
    return " ".join(["lagtop solve", *words])


def faults(rng: random.Random, top: Top, digits: int, options: argparse.Namespace) -> Iterator[str]:
    """Yield what is wrong with the numbers and the angles of a top."""
    motion = solve(top)
    try:
        assert_correct(motion, digits or 17, 2_000, 450 if options.long else 120)
    except AssertionError:  # perhaps the reference has too few digits
        try:
            assert_correct(motion, digits or 17, 6_000, 450)
        except AssertionError as error:
            yield f"{error}: {typed(top)} --digits {digits or 17}"
    if options.times and not digits and motion.facts.nutates:
        times = list(turning_times(motion, rng))
        for t in rng.sample(times, min(options.times, len(times))):
            if (worst := max(errors(motion, [t]))) > MOST_UNITS:
                yield f"{worst:.3g} units at t = {t!r}: {typed(top)}"


def run_chunk(
    options: argparse.Namespace, task: tuple[str, int, int]
) -> tuple[str, Counter[str], list[str]]:
    """Check some scenes of one kind."""
    warnings.simplefilter("ignore", OutOfRangeWarning)
    (kind, first, last), counts, found = task, Counter[str](), list[str]()
    swept: dict[str, list[Scene]] = {"theta0_deg": [], "theta0_rad": []}
    for i in range(first, last):
        rng = random.Random(f"{options.seed} {kind} {i}")
        scene, digits = varied(rng, ALL_KINDS[kind](rng), options.long)
        counts["scenes"] += 1
        try:
            found += faults(rng, Top(**scene), digits, options)
        except LagtopError as error:
            counts[f"refused: {str(error)[:60]}"] += 1
            continue
        if options.sweep and not digits and {"r0", "A"} <= {*scene}:
            swept["theta0_rad" if "theta0_rad" in scene else "theta0_deg"].append(scene)
    for scenes in filter(None, swept.values()):
        try:
            assert_trusted(scenes, 0)
        except AssertionError as error:
            found.append(f"sweep: {error}")
    return kind, counts, found


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=1000, help="how many, over all kinds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", help="only these, comma-separated: " + ", ".join(ALL_KINDS))
    parser.add_argument("--long", action="store_true", help="inputs of 30 to 400 digits")
    parser.add_argument("--sweep", action="store_true", help="check `sweep` too")
    parser.add_argument("--times", type=int, default=0, help="check angles at N times")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    options = parser.parse_args()
    kinds = list(map(str.strip, options.kinds.split(","))) if options.kinds else list(ALL_KINDS)
    if unknown := set(kinds) - set(ALL_KINDS):
        parser.error(f"kinds must be one of {', '.join(ALL_KINDS)}, got {min(unknown)!r}")
    begun, share = time.monotonic(), -(-options.scenes // len(kinds))
    firsts, totals, failed = range(0, share, CHUNK), Counter[str](), 0
    tasks = [(kind, i, min(i + CHUNK, share)) for i in firsts for kind in kinds]
    with Pool(options.jobs) as pool:
        for kind, counts, found in pool.imap_unordered(partial(run_chunk, options), tasks):
            for line in found:
                print(f"{kind}: {line}", flush=True)
            totals, failed = totals + counts, failed + len(found)
    said = ", ".join(f"{name} {count}" for name, count in totals.most_common())
    print(f"{said}; failed {failed}; seed {options.seed}, in {time.monotonic() - begun:.0f} s")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
