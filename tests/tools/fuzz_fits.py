"""Random recordings for `fit`, made by an integrator and checked by the truth; not collected.

    python tests/tools/fuzz_fits.py --recordings 500 --seed 1
    python tests/tools/fuzz_fits.py --recordings 1 --seed 317 --show

A recording has theta, phi and psi, or two of them, at 80 to 400 frames over 1.5 to 8 periods of a
random top that nutates by at least three times the noise of 0.05 to 1 degree.  Frames may be
missing, angles are wrapped, phi and psi count from anywhere, psi may count backwards where phi is
there, and half of the recordings come with their standard deviations.  Euler's equations are
integrated by DOP853; nothing of the closed form is used.

A fit is right if each of a, b, r0 and of the start is within FAR of its own standard deviations of
the truth.  Modulo what no fit can know: the spin rate is known up to whole turns per frame.  The
exit code is 1 if a wrong fit is not called `failed`, or too few are right and called `good`, or if
the share of the fits within one or two standard deviations of the truth is not that of normal
errors: its binomial standard deviation times CHANCE is the bound, for each number.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))  # references and engines of the tests

from engines import Array, Body, dop853
from lagtop import LagtopError, Top, fit
from scipy.spatial.transform import Rotation

from lagrange_cli.inverse.outcome import FAILED, Outcome

CHANNELS = [("theta", "phi", "psi"), ("theta", "psi"), ("theta", "phi"), ("phi", "psi")]
FAR = 5.0
"""Standard deviations beyond which a number is wrong: noise does it once in two million."""
VISIBLE = 3.0
"""Least half range of the tilt over its noise."""
CHANCE = 3.3
COVERED = {1: 0.6827, 2: 0.9545}
"""Shares of normal errors within one and two standard deviations."""
GOOD_SHARE = 0.94
"""Share of the recordings whose fit must be right and called good."""


class Drawn(NamedTuple):
    """A recording and the truth behind it."""

    top: Top
    t: Array
    angles: Mapping[str, Any]
    sigma: Mapping[str, float] | None
    frame: float
    """Time between two frames."""


def any_top(rng: np.random.Generator) -> Top:
    """Return a random top: cusped, looping or wavy, of either spin."""
    a, b = 10 ** rng.uniform(1, 2.7), rng.choice([-1, 1]) * 10 ** rng.uniform(0, 1.7)
    ratio = rng.uniform(0.2, 1.9)
    start = {"theta0_deg": rng.uniform(5, 175)}
    if rng.random() < 2 / 3:
        start |= {"thetadot0": rng.normal(scale=2), "psidot0": rng.normal(scale=3)}
    return Top(m=1, s=1, g=a / 2, A=1, C=ratio, r0=b / ratio, **start)


def motion_of(top: Top, t: Array) -> dict[str, Array]:
    """Return the angles of a top at times, by Euler's equations."""
    states = dop853(Body.of(top), t)[1]
    psi, theta, phi = Rotation.from_quat(states[:, :4], scalar_first=True).as_euler("ZXZ").T
    return {"theta": theta, "phi": phi, "psi": psi}


def period_of(top: Top) -> tuple[float, float]:
    """Return the period of the nutation and its half range in radians, from an integration."""
    scale = math.sqrt(2 * float(top.g)) + abs(float(top.C * top.r0))
    t = np.linspace(0, 60 / scale, 6000)
    theta = motion_of(top, t)["theta"]
    turns = t[np.flatnonzero(np.diff(np.sign(np.diff(theta))) < 0)]
    if turns.size < 2:
        return math.nan, math.nan
    return float(turns[1] - turns[0]), float(np.ptp(theta)) / 2


def drawn(seed: int) -> Drawn:
    """Return the recording of a seed."""
    rng = np.random.default_rng(seed)
    noise = np.radians(10 ** rng.uniform(math.log10(0.05), 0, size=3))
    sizes = dict(zip(("theta", "phi", "psi"), noise.tolist(), strict=True))
    while True:
        top = any_top(rng)
        period, half_range = period_of(top)
        if half_range > VISIBLE * sizes["theta"]:
            break
    count = int(rng.integers(80, 401))
    t = np.linspace(0, period * rng.uniform(1.5, 8), count)
    frame = float(t[1])
    kept = rng.random(count) >= rng.choice([0.0, 0.05, 0.2])
    kept[0] = True
    exact = motion_of(top, t)
    names = CHANNELS[int(rng.integers(len(CHANNELS)))]
    angles = {name: exact[name] + rng.normal(scale=sizes[name], size=count) for name in names}
    for name in [name for name in names if name != "theta"]:  # zeros anywhere, within half a turn
        angles[name] = np.angle(np.exp(1j * (angles[name] + rng.uniform(-3, 3))))
    if "phi" in names and "psi" in names and rng.random() < 0.5:
        angles["psi"] = -angles["psi"]
    known = rng.random() < 0.5
    sigma = {name: sizes[name] for name in names} if known else None
    return Drawn(top, t[kept], {name: x[kept] for name, x in angles.items()}, sigma, frame)


def pulls(outcome: Outcome, case: Drawn) -> Mapping[str, float]:
    """Return how far each number is from the truth, in its own standard deviations."""
    top = case.top
    a, b, r0 = 2 * float(top.g), float(top.C * top.r0), float(top.r0)
    spin = outcome.numbers["r0"][0] if "r0" in outcome.numbers else r0
    turns = round((spin - r0) * case.frame / (2 * math.pi))
    truth = {
        **{"a": a, "b": b, "r0": r0 + turns * 2 * math.pi / case.frame},
        "theta0_deg": float(top.theta0_deg or 0),
        **{"thetadot0": float(top.thetadot0), "psidot0": float(top.psidot0)},
    }
    found = outcome.numbers
    return {x: (found[x][0] - y) / found[x][1] for x, y in truth.items() if x in found}


class Verdict(NamedTuple):
    """The result of one recording."""

    seed: int
    names: tuple[str, ...]
    is_right: bool
    word: str
    """The verdict of `fit`, or `refused`."""
    shown: str
    pulls: Mapping[str, float]


def checked(seed: int) -> Verdict:
    """Return what `fit` makes of the recording of a seed."""
    case = drawn(seed)
    names = tuple(case.angles)
    try:
        outcome = fit(case.t, **case.angles, sigma=case.sigma)
    except LagtopError as error:
        return Verdict(seed, names, False, "refused", str(error), {})
    off = pulls(outcome, case)
    right = all(abs(x) < FAR for x in off.values())
    shown = " ".join(f"{name} {x:.1f}" for name, x in off.items())
    return Verdict(seed, names, right, outcome.verdict, shown, off)


def main() -> int:
    """Check some recordings, write the counts, and return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    for name, default in {"recordings": 500, "jobs": 2, "seed": 1}.items():
        parser.add_argument(f"--{name}", type=int, default=default, help=f"[default: {default}]")
    parser.add_argument("--show", action="store_true", help="show every fit")
    given = parser.parse_args()
    seeds = range(given.seed, given.seed + given.recordings)
    begun = time.perf_counter()
    counts: Counter[tuple[str, str]] = Counter()
    bad, errors = 0, defaultdict[str, list[float]](list)
    with ProcessPoolExecutor(given.jobs) as pool:
        for one in pool.map(checked, seeds):
            fate = f"{'right' if one.is_right else 'wrong'}, {one.word}"
            counts["+".join(one.names), fate] += 1
            worst = not one.is_right and one.word not in {"failed", "refused"}
            bad += worst
            for name, x in one.pulls.items() if one.word != FAILED else ():
                errors[name].append(abs(x))
            if given.show or fate != "right, good":
                print(f"{one.seed:6} {'+'.join(one.names):14} {fate}: {one.shown}", flush=True)
    print(*_table(counts), sep="\n")
    print(f"{time.perf_counter() - begun:.0f} s")
    good = sum(n for (_, fate), n in counts.items() if fate == "right, good")
    off = [*_miscovered(errors)]
    return int(bad > 0 or good < GOOD_SHARE * given.recordings or any(off))


def _miscovered(errors: Mapping[str, list[float]]) -> Iterator[bool]:
    """Write the shares of small errors; yield whether they differ from those of normal errors."""
    for name, sizes in errors.items():
        count, shown = len(sizes), []
        for bound, share in COVERED.items():
            found = sum(x < bound for x in sizes) / count
            shown.append(f"within {bound} sigma {found:.3f}")
            yield abs(found - share) > CHANCE * math.sqrt(share * (1 - share) / count)
        print(f"{name:10} {', '.join(shown)} of {count}")


def _table(counts: Counter[tuple[str, str]]) -> Iterator[str]:
    fates = sorted({fate for _, fate in counts})
    yield "  ".join([f"{'channels':14}", *fates])
    for names in sorted({names for names, _ in counts}):
        cells = [f"{counts[names, fate]:{len(fate)}}" for fate in fates]
        yield "  ".join([f"{names:14}", *cells])


if __name__ == "__main__":
    sys.exit(main())
