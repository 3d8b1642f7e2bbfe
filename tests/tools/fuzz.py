"""Fresh random scenes of the worst kinds, checked in ball arithmetic; not collected by pytest.

    python tests/tools/fuzz.py --scenes 20000 --seed 1
    python tests/tools/fuzz.py --scenes 2000 --kinds 'over a pole,cusp' --sweep
    python tests/tools/fuzz.py --scenes 100000 --numbers

Each scene is checked at twenty times: fifteen next to a whole, half or quarter number of periods
(the double and both its neighbours), five anywhere, from 1 to 1e14 periods on both sides of the
start.  The report is the worst error of every kind, in the units of `BallReference.errors`; every
key of `solve` that is not the double nearest to the exact value; with --sweep, every key of `sweep`
beyond 10 eps.  What exceeds the bounds is listed with a command that shows it, and the exit code is
1.  With --mpmath N, one scene in N is checked by the formulas of `bench.reference`, which share
neither formulas nor arithmetic with lagtop: the roots, the moduli, the period, the mean rates
and, in doubles, the attitude, if the top nutates under a torque and passes over no pole.
A third of the scenes are checked as decimals of twenty to sixty digits, and printed in 5 to 40.
About 20 to 40 scenes a second and core; with --numbers, without times, more.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from decimal import Decimal, localcontext
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeVar

import mpmath
import numpy as np

sys.path.append(str(Path(__file__).parents[1]))  # references and engines of the tests

from ball_reference import BallReference
from balls.requested import Requested
from balls.scene import Undecided, exact_arb
from balls.scene import arb_bits as precision
from flint import arb
from hard_scenes import KINDS, Scene, as_decimals
from lagtop import LagtopError, Motion, Top, solve, sweep

from lagrange_cli.bench import reference as reference_module
from lagrange_cli.bench.reference import Reference, rotation_angle
from lagrange_cli.bench.reference import inputs_of as inputs_in_mpmath
from lagrange_cli.cli.app import with_options
from lagrange_cli.cli.solve import solve_command
from lagrange_cli.errors import OutOfRangeError
from lagrange_cli.solver.keys import NUMBER_KEYS, NUMBERS
from lagrange_cli.solver.tables import rows
from lagrange_cli.top.ranges import ListedPoints

UNITS, WRAPPED, HALF_ULP, SWEEP_EPS = 4.0, 5.0, 0.5 + 1e-9, 10.0
"""The bounds: of an angle or a part of the quaternion, of an angle without whole turns, of a key of
`solve`, of one of `sweep`."""
NAMES = ("theta", "phi", "psi", "quaternion", "dphi", "dpsi", "wrapped")
COSINES = ("u1", "u2", "u_quarter")
NEIGHBOURS, ELSEWHERE = 5, 5
CHUNK, MOST_SHOWN = 50, 40
T = TypeVar("T")


def options_of(top: Top) -> str:
    """Return a top as options of the command line."""
    return with_options(top.as_text(), solve_command.params)


class Tally:
    """Results of some scenes of one kind."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.worst: dict[str, float] = {}
        self.violations: list[str] = []

    def note(self, name: str, error: float, bound: float, show: str) -> None:
        """Keep an error, and how to see it where it exceeds its bound."""
        self.worst[name] = max(self.worst.get(name, 0.0), error)
        if not error <= bound:
            self.violations.append(f"{name} {error:.3g}: {show}")

    def both(self, key: str, value: T | None, exact: arb | None, show: str) -> tuple[T, arb] | None:
        """Return a number and its exact value, or None; note the key if only one of both exists."""
        if value is not None and exact is not None:
            return value, exact
        if value is not None or exact is not None:
            self.violations.append(f"{key} is {value!r}, the reference has {exact}: {show}")
        return None

    def add(self, other: Tally) -> None:
        """Take in the tally of more scenes."""
        self.counts += other.counts
        self.violations += other.violations
        for name, error in other.worst.items():
            self.worst[name] = max(self.worst.get(name, 0.0), error)


def times_of(rng: random.Random, period: Fraction, decades: int = 14) -> list[float]:
    """Return times next to quarters of a period, each with its neighbours, and others."""
    quarters = [
        (4 * int(10 ** rng.uniform(0, decades)) + rng.choice([0, 1, 2, 2, 3])) * rng.choice([-1, 1])
        for _ in range(NEIGHBOURS)
    ]
    powers = rng.uniform(-9, 1), 0, *(rng.uniform(0, decades) for _ in range(ELSEWHERE - 2))
    periods = [rng.choice([-1, 1]) * rng.random() * 10**power for power in powers]
    times = [float(period * number) for number in periods]
    for number in quarters:
        t = float(period * number / 4)
        times += [t, math.nextafter(t, math.inf), math.nextafter(t, -math.inf)]
    return times


def period_of(balls: BallReference) -> Fraction:
    """Return the nutation period; where there is none, about a unit of the motion."""
    ball = balls.record.get("T_nutation")
    if ball is not None:
        mantissa, exponent = ball.mid().man_exp()
        return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    scene = balls.scene
    sizes = (scene.b, scene.r0, scene.theta_rate, scene.psi_rate, math.sqrt(scene.a))
    return 1 / Fraction(max(abs(float(size)) for size in sizes) or 1.0) / 4


def check_angles(
    tally: Tally, balls: BallReference, motion: Motion, times: Sequence[float]
) -> None:
    """Check the angles and the quaternion of one motion."""
    points = ListedPoints([Fraction(t) for t in times])
    columns = ("theta", "phi", "psi", "quaternion", "dphi", "dpsi")
    _, blocks = rows(motion, points, columns, radians=True)
    computed = np.concatenate(list(blocks)).tolist()
    wrapped = zip(*(angle.tolist() for angle in motion.angles(times, wrap=True)[1:]), strict=True)
    for t, values, short in zip(times, computed, wrapped, strict=True):
        tally.counts["times"] += 1
        try:
            errors = balls.errors(t, tuple(values[:7]))
            remainders = balls.remainder_errors(t, tuple(values[7:]))
            turned = max(balls.wrapped_errors(t, short))
        except Undecided:
            tally.counts["undecided times"] += 1
            continue
        show = f"lagtop table {options_of(motion.top)} --columns {{}} --t-min {t!r} --n 1"
        shown = (*errors[:3], max(errors[3:]), *remainders, turned)
        for name, error in zip(NAMES, shown, strict=True):
            asked = "t,phi,psi --wrap" if name == "wrapped" else f"t,{name}"
            bound = WRAPPED if name == "wrapped" else UNITS
            tally.note(name, error, bound, show.format(asked))


def number_of(motion: Motion, key: str) -> float | None:
    """Return a number; one that is smaller than all doubles as 0."""
    try:
        value: float | None = getattr(motion, key)
        return value
    except OutOfRangeError as error:
        return 0.0 if "5e-324" in str(error) else math.inf


def check_record(tally: Tally, balls: BallReference, motion: Motion) -> None:
    """Check every number of a motion: the nearest double, or rightly none."""
    for key in NUMBERS:
        show = f"lagtop solve {options_of(motion.top)} --get {key}"
        tally.counts["numbers"] += 1
        if pair := tally.both(key, number_of(motion, key), balls.exact(key), show):
            value, exact = pair
            is_beyond = value == math.inf and bool(abs(exact) > arb(sys.float_info.max))
            if not is_beyond:
                tally.note("key", balls.ulps(key, value), HALF_ULP, f"{show}  # {key} {value!r}")


def check_digits(tally: Tally, balls: BallReference, motion: Motion, digits: int) -> None:
    """Check every number of a motion with `digits` digits."""
    found = motion.record(digits=digits, keys=list(NUMBERS))
    for key, text in found.items():
        show = f"{typed(motion.top)} --digits {digits} --get {key}  # {text}"
        tally.counts["numbers in digits"] += 1
        if not (pair := tally.both(key, text, balls.exact(key), show)):
            continue
        value, exact = pair
        if Decimal(value):
            last = Decimal(value).adjusted() + 1 - digits
            away = balls.away(key, Fraction(value), digits) / arb(10) ** last
            tally.note("digits", float(away.abs_upper()), HALF_ULP, show)
        elif not exact.contains(0):
            tally.violations.append(f"{key} is no zero: {show}")


def by_mpmath(top: Top, digits: int) -> tuple[dict[str, Any], Reference]:
    """Return numbers of a top in mpmath by the formulas of `Reference`, in a number of digits."""
    reference_module.DIGITS = digits
    of = Reference(inputs_in_mpmath(top))
    with mpmath.workdps(digits):
        plus, minus = (
            momentum * whole / (at_u2 * of.speed) / of.T
            for momentum, (_, at_u2), whole in zip(of.momenta, of.gaps, of.wholes, strict=True)
        )
        return {
            **{name: getattr(of, name) for name in ("u1", "u2", "u3", "K")},
            "T_nutation": of.T,
            "k": mpmath.sqrt(of.k2),
            "k_prime": mpmath.sqrt(of.k2_prime),
            "mean_spin_rate": 2 * of.drift + plus - minus,
            "mean_precession_rate": plus + minus,
        }, of


def check_by_mpmath(tally: Tally, motion: Motion, digits: int, times: Sequence[float]) -> None:
    """Check numbers and attitudes by `Reference`, which shares no formula with lagtop.

    Numbers that differ in 80 and in 240 digits, and zeros, are left out.  So are tops that pass so
    close to the vertical that the parts of Legendre's third integral cancel in all these digits.
    """
    facts = motion.facts
    if not (facts.a and facts.nutates) or facts.over_top or facts.over_bottom:
        return
    try:
        (exact, _), (rough, reference) = (by_mpmath(motion.top, count) for count in (240, 80))
        far = all(at_u1 < 10**60 * at_u2 for at_u1, at_u2 in reference.gaps)
    except ZeroDivisionError:  # next to a pole
        far = False
    if not far or any(isinstance(x, mpmath.mpc) for x in exact.values()):
        tally.counts["too few digits in mpmath"] += 1
        return
    record = motion.record(digits=digits or None, keys=list(exact))
    with mpmath.workdps(240):
        for key, value in exact.items():
            text = record[key]
            unit = _last_digit(text, digits) if digits else mpmath.mpf(math.ulp(text))
            if not value or abs(value - rough[key]) > unit / 10**9:
                tally.counts["too few digits in mpmath"] += 1
                continue
            tally.counts["numbers by mpmath"] += 1
            show = f"{typed(motion.top)} --digits {digits or 17} --get {key}  # {text}"
            tally.note("mpmath", float(abs(value - mpmath.mpf(text)) / unit), HALF_ULP, show)
        columns = motion.table(times, ["quaternion"]).values()
        rates = (exact[key] for key in ("mean_spin_rate", "mean_precession_rate"))
        speed = 2 * sum(abs(float(x)) for x in (*rates, 1 / reference.T))
        for time_, *computed in zip(times, *columns, strict=True):
            away = rotation_angle(computed, reference.attitude(time_))
            tau = float(mpmath.mpf(time_) - mpmath.nint(time_ / reference.T) * reference.T)
            size = 2.0**-52 * (1 + abs(tau) * speed)
            tally.counts["attitudes by mpmath"] += 1
            show = f"{options_of(motion.top)} --columns quaternion --t-min {time_!r} --n 1"
            tally.note("attitude", away / size, 2 * UNITS, f"lagtop table {show}")


def _last_digit(text: str, digits: int) -> Any:
    """Return a unit in the last digit of a number with some digits."""
    return mpmath.mpf(10) ** (Decimal(text).adjusted() + 1 - digits)


def check_path(tally: Tally, balls: BallReference, motion: Motion) -> None:
    """Check the path by the signs of b (beta - b u) at both turning points, where these tell."""
    if balls.facts.steady or motion.path is None:
        return
    scene = balls.scene
    for bits in (160, 640, 4000):
        with precision(bits):
            inner = Requested(scene, Fraction(1), Fraction(1))
            beta = (
                exact_arb(scene.psi_rate) * (1 - inner.u0 * inner.u0)
                + exact_arb(scene.b) * inner.u0
            )
            first, last = (
                (beta - exact_arb(scene.b) * u) * exact_arb(scene.b) for u in (inner.u1, inner.u2)
            )
        if (first < 0 or first > 0) and (last < 0 or last > 0):
            break
    tally.counts["paths"] += 1
    expected = None
    if first < 0 and last > 0:
        expected = "looping"
    elif first > 0 or last < 0:
        expected = "wavy"
    if expected not in (None, motion.path):
        tally.violations.append(f"path is {motion.path}, not {expected}: {typed(motion.top)}")


def typed(top: Top) -> str:
    """Return the command that solves a top, with all digits of its inputs."""
    names = {"theta0_deg": "theta0", "theta0_rad": "rad --theta0"}
    given = [(names.get(x, x), Fraction(y)) for x, y in top.as_dict().items() if y is not None]
    with localcontext() as context:
        context.prec = 2000
        words = [f"--{x} {(Decimal(y.numerator) / y.denominator).normalize():g}" for x, y in given]
    return f"lagtop solve {' '.join(words)}"


def check_sweep(tally: Tally, tilt: str, checks: Sequence[tuple[Scene, BallReference]]) -> None:
    """Check every number of a sweep of scenes, all with tilts in degrees or all in radians."""
    names = (*"m A C s g r0 thetadot0 psidot0".split(), tilt)
    inputs: Any = {x: [float(scene.get(x, 0)) for scene, _ in checks] for x in names}
    columns = sweep(keys=[*NUMBER_KEYS, "error"], **inputs)
    for i, (scene, balls) in enumerate(checks):
        if columns["error"][i] is not None:
            tally.counts["sweep refused"] += 1
            continue
        options = options_of(Top(**scene))
        for key in NUMBER_KEYS:
            value = float(columns[key][i])
            show, known = f"lagtop sweep {options} --keys {key}  # {value!r}", not math.isnan(value)
            if tally.both(f"sweep {key}", value if known else None, balls.record.get(key), show):
                tally.note("sweep", sweep_error(balls, key, value), SWEEP_EPS, show)


def sweep_error(balls: BallReference, key: str, value: float) -> float:
    """Return the error of a key of a sweep in eps of what its promise is measured by."""
    if key in COSINES:
        return balls.relative(key, value, absolute=1.0)
    if key.endswith("_half") and balls.half_parts is not None:
        parts = [abs(float(part)) for part in balls.half_parts]
        return balls.relative(key, value, absolute=max(abs(float(balls.scene.r0)), *parts))
    return balls.relative(key, value)


Task = tuple[str, int, int, int, str, int]
"""A kind, a seed, the first scene, how many, what is checked besides numbers and angles, and N: one
scene in N is checked by mpmath too."""


def run_chunk(task: Task) -> tuple[str, Tally]:
    """Check some scenes of one kind."""
    kind, seed, first, count, what, share = task
    tally, checks = Tally(), []
    for i in range(first, first + count):
        rng = random.Random(f"{seed} {kind} {i}")
        scene, digits = KINDS[kind](rng), 0
        if rng.random() < 1 / 3 or any(isinstance(x, Fraction) for x in scene.values()):
            scene, digits = as_decimals(rng, scene), rng.randrange(5, 40)
        tally.counts["scenes"] += 1
        try:
            motion, balls = solve(Top(**scene)), BallReference(Top(**scene).as_dict())
            balls.record, balls.requested  # noqa: B018 - made here, so that what is undecided is counted once
            check_path(tally, balls, motion)
            if share and i % share == 0:
                asks = not digits and what != "numbers"
                times = times_of(rng, period_of(balls)) if asks else []
                check_by_mpmath(tally, motion, digits, times)
            if digits:
                check_digits(tally, balls, motion, digits)
                continue
            check_record(tally, balls, motion)
            if what == "numbers":
                continue
            check_angles(tally, balls, motion, times_of(rng, period_of(balls)))
        except LagtopError as error:
            tally.counts["refused"] += 1
            tally.counts[f"refused: {str(error)[:60]}"] += 1
            continue
        except Undecided:
            tally.counts["undecided scenes"] += 1
            continue
        checks.append((scene, balls))
    for tilt in ("theta0_deg", "theta0_rad") if what == "sweep" else ():
        if some := [(scene, balls) for scene, balls in checks if tilt in scene]:
            check_sweep(tally, tilt, some)
    return kind, tally


def lines_of(tallies: dict[str, Tally]) -> Iterator[str]:
    """Yield the report, a line per kind and then what exceeds its bound."""
    columns = (*NAMES, "key", "digits", "sweep", "mpmath", "attitude")
    heads = " ".join(f"{name[:6]:>6}" for name in columns)
    yield f"{'kind':24} scenes  times {heads}  beyond"
    for kind, tally in tallies.items():
        counts = " ".join(f"{tally.counts[name]:6}" for name in ("scenes", "times"))
        shown = " ".join(f"{tally.worst.get(name, 0.0):6.3g}" for name in columns)
        yield f"{kind:24} {counts} {shown}  {len(tally.violations)}"
    for kind, tally in tallies.items():
        yield f"\n{kind}: " + ", ".join(f"{name} {n}" for name, n in tally.counts.items())
        yield from tally.violations[:MOST_SHOWN]


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=1000, help="how many, over all kinds")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", help="only these, with commas between: " + ", ".join(KINDS))
    parser.add_argument("--sweep", action="store_true", help="check `sweep` too")
    parser.add_argument("--numbers", action="store_true", help="check the keys of `solve` alone")
    parser.add_argument("--mpmath", type=int, default=0, help="check one scene in N by mpmath too")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    options = parser.parse_args()
    kinds = [kind.strip() for kind in options.kinds.split(",")] if options.kinds else list(KINDS)
    if unknown := set(kinds) - set(KINDS):
        parser.error(f"kinds must be among {', '.join(KINDS)}, got {min(unknown)!r}")
    tallies, begun = {kind: Tally() for kind in kinds}, time.monotonic()
    what = "numbers" if options.numbers else "sweep" if options.sweep else ""
    share = -(-options.scenes // len(kinds))
    tasks = [
        (kind, options.seed, first, min(CHUNK, share - first), what, options.mpmath)
        for first in range(0, share, CHUNK)
        for kind in kinds
    ]
    with ProcessPoolExecutor(options.jobs) as pool:
        for kind, tally in pool.map(run_chunk, tasks):
            tallies[kind].add(tally)
    print("\n".join(lines_of(tallies)))
    done = sum(tally.counts["scenes"] for tally in tallies.values())
    seconds = time.monotonic() - begun
    print(
        f"\n{done} scenes, seed {options.seed}, in {seconds:.0f} s: {done / seconds:.0f} a second"
    )
    return 1 if any(tally.violations for tally in tallies.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
