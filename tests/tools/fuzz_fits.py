"""Random recordings for `fit`, made by an integrator and checked by the truth; not collected.

    python tests/tools/fuzz_fits.py --recordings 500 --seed 1
    python tests/tools/fuzz_fits.py --recordings 1 --seed 317 --show
    python tests/tools/fuzz_fits.py --recordings 500 --easy
    python tests/tools/fuzz_fits.py --recordings 500 --machines

Each recording is of one of the kinds in LOOKS: C/A from 0.02 to 2, 2 to 100 periods, 3 to 2,000
rows per period, up to 5 turns of the spin per row, any unit of time, and known inputs that are
right or wrong.  `--easy` draws ordinary tops over 1.5 to 8 periods.  `--machines` draws the
machines and faults of `machines.py`, of 1 to 30 per cent: there a wrong fit is held if its standard
deviations and its model error, times the size in per cent, hold the error.

A fit is right if each of its numbers is within FAR of its own standard deviations of the truth.
No fit can know whole turns of the spin per row, nor, if psi may count in either direction, which
one it is if the spin exceeds a quarter of a turn per row; these are no errors.  A recording
determines a top if a and b are determined to a tenth, by the slopes of the motion at the truth.
The exit code is 1 if a share is worse than it must be.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from multiprocessing import Pool
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import odeint

sys.path.append(str(Path(__file__).parents[1]))  # references and engines of the tests

from engines import Array
from lagtop import LagtopError, fit
from machines import MACHINES, disturbed, filtered, rows_of
from noisy_recordings import axis_of

CHANNELS = [("theta", "phi", "psi"), ("theta", "psi"), ("theta", "phi"), ("phi", "psi")]
LOOKS = (
    *("white", "white", "white", "encoder", "smooth", "correlated", "pendulum", "pole"),
    *("small", "steady", "steady", "known", "known", "wrong", "wrong", "units", "attitude", "axis"),
)
FAR = 5.0
"""Standard deviations beyond which a number is wrong: noise does it once in two million."""
GOOD_SHARE = {False: 0.93, True: 0.95}
"""Share of the determined recordings, hard and easy, whose fit must be right and good."""
HELD_SHARE, FIRST_SHARE = 0.9, 0.75
"""Shares of wrong and good fits of machines that are held, and of failures with a right name."""
MOST_ROWS = 20_000
QUARTER = 0.25


@dataclass
class Top:
    """A top with m g s = a/2, A = 1 and C = `ratio`, and its state in the first row."""

    a: float
    b: float
    r0: float
    theta0: float
    thetadot0: float
    psidot0: float

    def motion(self, t: Any) -> dict[str, Array]:
        """Return the angles at times: Euler's equations in a frame that does not turn about the
        axis, to which the spin r0 t is added."""
        half, b = self.a / 2, self.b

        def slope(_: float, y: Array) -> list[float]:
            w, x, v, z, p, q = y.tolist()
            up_x, up_y = 2 * (x * z - w * v), 2 * (v * z + w * x)
            turn = (-x * p - v * q, w * p - z * q, w * q + z * p, x * q - v * p)
            return [*(i / 2 for i in turn), half * up_y - b * q, b * p - half * up_x]

        rates = [self.thetadot0, self.psidot0 * math.sin(self.theta0)]
        start = [math.cos(self.theta0 / 2), math.sin(self.theta0 / 2), 0.0, 0.0, *rates]
        precision = {"rtol": 1e-12, "atol": 1e-13, "mxstep": 1_000_000}
        w, x, v, z, *_ = odeint(slope, start, t, tfirst=True, **precision).T
        upper, lower = np.arctan2(z, w), np.arctan2(v, x)
        theta = 2 * np.arctan2(np.hypot(x, v), np.hypot(w, z))
        return {"theta": theta, "phi": upper - lower + self.r0 * t, "psi": upper + lower}


@dataclass
class Drawn:
    """A recording and the truth behind it."""

    look: str
    top: Top
    t: Array
    arrays: dict[str, Array]
    noise: dict[str, float]
    frame: float
    """Seconds between two frames."""
    half_range: float
    sigma: dict[str, float] | None = None
    known: dict[str, Any] = field(default_factory=dict)
    unit: float = 1.0
    """Seconds in the unit of time."""
    flipped: bool = False
    size: float = 0.0
    """The size of the machine or fault."""
    means: dict[str, float] = field(default_factory=dict)

    @property
    def turns(self) -> float:
        """Turns of the spin per row."""
        return abs(self.top.r0) * self.frame / (2 * math.pi)


def any_top(rng: np.random.Generator, look: str, noise: float, *, easy: bool) -> Top:
    """Return a random top: cusped, looping or wavy, of either spin."""
    a, b = 10 ** rng.uniform(1, 2.7), float(rng.choice([-1, 1]) * 10 ** rng.uniform(0, 1.7))
    ratio = rng.uniform(0.2, 1.9) if easy else 10 ** rng.uniform(math.log10(0.02), math.log10(2))
    theta0, thetadot0, psidot0 = math.radians(rng.uniform(5, 175)), 0.0, 0.0
    if rng.random() < 2 / 3:
        thetadot0, psidot0 = rng.normal(scale=2), rng.normal(scale=3)
    if look == "pendulum":
        return Top(a, 0.0, 0.0, theta0, thetadot0, psidot0 or 1.0)
    if look == "pole":
        theta0, psidot0 = math.radians(rng.uniform(0.005, 0.05)), 0.0
        theta0 = math.pi - theta0 if rng.random() < 0.5 else theta0
        thetadot0 = rng.normal(scale=3)
    if look in {"small", "steady"}:  # next to the slow steady precession
        b = math.copysign(math.sqrt(a) * 10 ** rng.uniform(0.4, 1.2), b)
        rate = a / (b + math.copysign(math.sqrt(b * b - 2 * a * math.cos(theta0)), b))
        swing = noise * 10 ** rng.uniform(*((-2.0, -1.2) if look == "steady" else (0.7, 1.4)))
        thetadot0 = 0.0
        psidot0 = rate + swing * abs(b) / math.sin(theta0) * rng.choice([-1, 1])
    return Top(a, b, b / ratio, theta0, thetadot0, psidot0)


def period_of(top: Top) -> tuple[float, float]:
    """Return the period of the nutation and its half range in radians, from an integration."""
    t = np.linspace(0, 60 / (math.sqrt(top.a) + abs(top.b)), 6000)
    theta = top.motion(t)["theta"]
    turns = t[np.flatnonzero(np.diff(np.sign(np.diff(theta))) < 0)]
    if turns.size < 2:
        return math.nan, math.nan
    return float(turns[1] - turns[0]), float(np.ptp(theta)) / 2


def drawn(seed: int, *, easy: bool = False, look: str = "") -> Drawn:
    """Return the recording of a seed, of any look or of a certain one."""
    rng = np.random.default_rng(seed)
    look = look or ("white" if easy else LOOKS[int(rng.integers(len(LOOKS)))])
    noises = np.radians(10 ** rng.uniform(math.log10(0.05), 0, size=3)).tolist()
    sizes = dict(zip(CHANNELS[0], noises, strict=True))
    step = math.radians(float(rng.choice([0.1, 0.25, 0.5, 0.9, 1.8])))
    while True:
        top = any_top(rng, look, sizes["theta"], easy=easy)
        period, half_range = period_of(top)
        least = max(sizes["theta"] * 3, step * (look == "encoder"))
        steady = look == "steady" and half_range < sizes["theta"] / 10
        if not (half_range > least or steady):
            continue
        if easy:
            count = int(rng.integers(80, 401))
            frame = period * rng.uniform(1.5, 8) / (count - 1)
        else:
            frame = period / 10 ** rng.uniform(math.log10(3), math.log10(2000))
            count = int(period * 10 ** rng.uniform(math.log10(2), 2) / frame) + 1
        if 24 <= count <= MOST_ROWS and abs(top.r0) * frame < 10 * math.pi:
            break
    t = np.arange(count) * frame
    exact = top.motion(t)
    noise = {name: _noise(rng, look, count, size) for name, size in sizes.items()}
    kept = rng.random(count) >= rng.choice([0.0, 0.05, 0.2] if count > 40 else [0.0])
    kept[0] = True
    names, is_angles = CHANNELS[int(rng.integers(len(CHANNELS)))], look not in {"attitude", "axis"}
    if not is_angles:
        names = CHANNELS[0] if look == "attitude" else CHANNELS[1]
    angles = {name: exact[name] + noise[name] for name in names}
    for name in [name for name in names if name != "theta"]:  # zeros anywhere, within half a turn
        angles[name] = np.angle(np.exp(1j * (angles[name] + rng.uniform(-3, 3))))
    flipped = bool({"phi", "psi"} <= {*names} and is_angles and rng.random() < 0.5)
    if flipped:
        angles["psi"] = -angles["psi"]
    if look == "encoder":
        angles = {name: np.round(x / step) * step for name, x in angles.items()}
    given = rng.random() < 0.5 and look != "encoder" and is_angles
    sigma = {name: sizes[name] for name in names} if given else None
    known = _known(rng, top, look, names) if look in {"known", "wrong"} else {}
    unit = float(rng.choice([1e-9, 1e-6, 1e-3, frame, 1e3])) if look == "units" else 1.0
    arrays = {name: x[kept] for name, x in angles.items()}
    if not is_angles:
        arrays = _arrays(rng, look, {name: x[kept] for name, x in exact.items()}, sizes["theta"])
    spin, turn = np.unwrap(exact["phi"] - top.r0 * t), np.unwrap(exact["psi"])
    means = {"mean_tilt_deg": math.degrees(float(exact["theta"].mean()))}
    means["mean_precession_rate"] = float(np.polyfit(t, turn, 1)[0])
    means["mean_spin_rate"] = float(np.polyfit(t, spin, 1)[0]) + top.r0
    about: dict[str, Any] = {"sigma": sigma, "known": known, "unit": unit}
    about |= {"flipped": flipped, "means": means}
    return Drawn(look, top, t[kept] / unit, arrays, sizes, frame, half_range, **about)


def other(seed: int, name: str = "") -> Drawn:
    """Return the recording of a machine or with a fault of `MACHINES`."""
    rng = np.random.default_rng(seed)
    name = name or str(rng.choice([*MACHINES]))
    machine = MACHINES[name]
    size = float(10 ** rng.uniform(-2, math.log10(0.3)))
    noise = math.radians(float(rng.choice([0.1, 0.3, 0.8])))
    names = CHANNELS[int(rng.integers(len(CHANNELS)))]
    while machine.needs not in {*names, ""}:
        names = CHANNELS[int(rng.integers(len(CHANNELS)))]
    is_angles = name in {"zero", "jump", "scale"}
    kind = "angles" if is_angles else str(rng.choice(["angles", "axis", "attitude"]))
    while True:
        top = any_top(rng, "white", noise, easy=True)
        period, half_range = period_of(top)
        frame = period / float(rng.choice([12, 20, 35, 60]))
        count = int(period * rng.uniform(2, 6) / frame)
        t = np.asarray(np.arange(count) * frame)
        if not (half_range > 3 * noise and 30 <= count <= 400 and abs(top.r0) * frame < 1.5):
            continue
        exact = top.motion(t)
        if np.sin(exact["theta"]).min() < 0.05:  # a gimbal locks at a pole
            continue
        if machine.motion is not None:
            start = np.array([top.theta0, top.thetadot0, top.psidot0])
            exact = machine.motion(top.a, top.b, top.r0, start, t, **{machine.size: size})
        if 0.15 < exact["theta"].min() and exact["theta"].max() < math.pi - 0.15:
            break
    seen = disturbed(name, size, t, {x: exact[x] for x in names}, rng)
    rows = rows_of(name, count, rng)
    if kind == "angles":
        arrays = {x: y + rng.normal(scale=noise, size=count) for x, y in seen.items()}
    else:
        arrays = _arrays(rng, kind, exact | seen, noise)
    if name == "filter":
        width, way = int(rng.choice([3, 5, 9])), str(rng.choice(["mean", "cubic", "lag"]))
        size = width * frame / period / math.sqrt(12)
        arrays = {x: np.apply_along_axis(filtered, 0, y, width, way) for x, y in arrays.items()}
    arrays = {x: y[rows] for x, y in arrays.items()}
    t = np.asarray(np.arange(rows.size) * frame)
    if name == "clock":
        t = t - size * t**2 / (2 * t[-1])
    sizes = dict.fromkeys(CHANNELS[0], noise)
    return Drawn(name, top, t, arrays, sizes, frame, half_range, size=size)


def _noise(rng: np.random.Generator, look: str, count: int, size: float) -> Array:
    """Return white noise, or smoothed or correlated noise, of about a standard deviation."""
    noise = rng.normal(scale=size, size=count)
    if look == "smooth":
        width = int(rng.choice([3, 5]))
        return np.convolve(noise, np.ones(width) / width, "same")
    if look == "correlated":
        rho = rng.uniform(0.3, 0.7)
        for i in range(1, count):
            noise[i] = rho * noise[i - 1] + math.sqrt(1 - rho**2) * noise[i]
    return noise


def _known(rng: np.random.Generator, top: Top, look: str, names: tuple[str, ...]) -> dict[str, Any]:
    """Return inputs of a body with A = 1; one of them is 2 to 20 per cent wrong."""
    body = {"m": 0.5, "g": 9.81, "s": top.a / 9.81, "A": 1.0, "C": top.b / top.r0}
    choices = [("m", "g", "s", "A"), ("m", "g", "s", "A", "C")]
    if "phi" in names:
        choices.append(("A", "C"))
    known: dict[str, Any] = {name: body[name] for name in choices[int(rng.integers(len(choices)))]}
    if "C" in known and "phi" not in names:
        known["r0"] = top.r0
    if look == "wrong":
        name = str(rng.choice([x for x in ("A", "C", "s") if x in known]))
        known[name] *= 1 + rng.choice([-1, 1]) * rng.uniform(0.02, 0.2)
    elif rng.random() < 0.5:
        name = str(rng.choice(list(known)))
        std = 0.01 * abs(known[name])
        value = float(known[name] + rng.normal(scale=std))
        known[name] = f"{value!r} +/- {std!r}"
    return known


def _arrays(
    rng: np.random.Generator, look: str, exact: dict[str, Array], size: float
) -> dict[str, Array]:
    """Return a noisy axis or a noisy quaternion."""
    theta, phi, psi = (exact[name] for name in CHANNELS[0])
    if look == "axis":
        axis = axis_of(theta, psi)
        return {"axis": axis + rng.normal(scale=size, size=axis.shape)}
    plus, minus = (psi + phi) / 2, (psi - phi) / 2
    upper, lower = np.cos(theta / 2), np.sin(theta / 2)
    real, along = upper * np.cos(plus), upper * np.sin(plus)
    parts = np.stack([real, lower * np.cos(minus), lower * np.sin(minus), along], axis=-1)
    return {"quaternion": parts + rng.normal(scale=size / 2, size=parts.shape)}


def determined(case: Drawn) -> bool:
    """Return whether the recording determines a and b to a tenth, to first order at the truth."""
    top, rows = case.top, np.unique(np.linspace(0, case.t.size - 1, 400).astype(int))
    t, (first, *_) = case.t[rows] * case.unit, case.arrays
    names = {"quaternion": CHANNELS[0], "axis": CHANNELS[1]}.get(first, tuple(case.arrays))
    noise = {x: case.noise["theta" if len(case.arrays) == 1 else x] for x in names}
    weights = {x: np.ones(t.size) / y for x, y in noise.items()}
    if first == "axis":
        weights["psi"] *= np.abs(np.sin(top.motion(t)["theta"]))
    changes = []
    for name in ("a", "b", "theta0", "thetadot0", "psidot0"):
        value = getattr(top, name)
        h = 1e-4 * max(abs(value), 0.01)
        after, before = (replace(top, **{name: value + x}).motion(t) for x in (h, -h))
        changes.append({x: np.angle(np.exp(1j * (after[x] - before[x]))) / (2 * h) for x in names})
    changes += [{x: np.ones(t.size)} for x in names if x != "theta"]
    changes += [{x: t} for x in names if x == "phi"]
    columns = [np.concatenate([x.get(y, 0 * t) * weights[y] for y in names]) for x in changes]
    matrix = np.stack(columns, axis=1) * math.sqrt(case.t.size / rows.size)
    size = np.linalg.norm(matrix, axis=0) + 1e-300
    values, axes = np.linalg.svd(matrix / size, full_matrices=False)[1:]
    stds = np.linalg.norm(axes.T / np.maximum(values, 1e-14), axis=1) / size
    return bool(stds[0] < 0.1 * top.a and stds[1] < 0.1 * math.sqrt(top.a))


def pulls(outcome: Any, case: Drawn, *, mirrored: bool) -> dict[str, float]:
    """Return how far each number is from the truth, in its own standard deviations.

    The mirror image of a top has the other sign of b and of psi', and the same mean rate of phi.
    """
    top, unit, sign = case.top, case.unit, -1 if mirrored else 1
    r0 = 2 * case.means["mean_spin_rate"] - top.r0 if mirrored else top.r0
    truth = {"a": top.a * unit**2, "b": sign * top.b * unit, "b/a": sign * top.b / top.a / unit}
    truth |= {"thetadot0": top.thetadot0 * unit, "psidot0": sign * top.psidot0 * unit, "A": 1.0}
    truth["theta0_deg"] = math.degrees(top.theta0)
    if not (mirrored and case.look == "pole"):  # a pass of the pole may count as a turn of the spin
        truth["r0"] = r0 * unit
    if outcome.verdict == "good, no nutation":
        truth |= {x: y * (unit if "rate" in x else 1.0) for x, y in case.means.items()}
        truth["mean_precession_rate"] *= sign
    if case.turns < QUARTER:
        truth["C"] = top.b / (top.r0 or math.inf)
    whole, found = 2 * math.pi / case.frame * unit, {}
    for key in truth.keys() & outcome.numbers.keys():
        value, std = outcome.numbers[key][:2]
        off = value - truth[key]
        if key in {"r0", "mean_spin_rate"}:
            off -= whole * round(off / whole)
        found[key] = off / max(std, 1e-9 * abs(truth[key]))
    return found


def held(outcome: Any, case: Drawn) -> bool:
    """Return whether a and b are within standard deviations and model errors of the size."""
    for name in ("a", "b"):
        value, std = outcome.numbers[name][:2]
        model = outcome.model_errors.get(name, 0.0) * abs(value) * 100 * case.size
        if abs(value - getattr(case.top, name)) > FAR * std + 2 * model:
            return False
    return True


def named(outcome: Any, case: Drawn) -> str:
    """Return `right first`, `right` among others, `wrong name` or `no name`."""
    first, *others = outcome.failure().split(" or ")
    words = MACHINES[case.look].words.split("|")
    if any(x in first for x in words):
        return "right first"
    if any(x in y for y in others for x in words):
        return "right"
    return "wrong name" if outcome.neighbour else "no name"


class Result(NamedTuple):
    """The result of one recording."""

    seed: int
    look: str
    names: str
    determined: bool
    is_right: bool
    word: str
    """The verdict of `fit`, or `refused`, and what is said of it."""
    shown: str
    pulls: Mapping[str, float]
    seconds: float

    @property
    def fate(self) -> str:
        """Whether it is right, and the verdict."""
        return f"{'right' if self.is_right else 'wrong'}, {self.word}"

    def __str__(self) -> str:
        doubt = "" if self.determined else "(not determined) "
        about = f"{self.fate}: {doubt}{self.seconds:.1f} s; {self.look}; {self.shown}"
        return f"{self.seed:6} {self.names:14} {about}"


def checked(seed: int, *, easy: bool = False, machines: bool = False, look: str = "") -> Result:
    """Return what `fit` makes of the recording of a seed."""
    case = other(seed, look) if machines else drawn(seed, easy=easy, look=look)
    begun, given = time.process_time(), dict[str, Any](case.arrays)
    off, shown, outcome = dict[str, float](), "", None
    try:
        outcome = fit(case.t, **given, sigma=case.sigma, known=case.known)
        word = outcome.verdict
    except LagtopError as error:
        word, shown = "refused", str(error)
    seconds = time.process_time() - begun
    if outcome is not None:
        is_open = case.turns > QUARTER or case.top.r0 == 0
        is_open |= case.flipped and word == "good, no nutation"  # psi' as recorded
        ways = [False, *[True] * (is_open and not machines)]
        each = (pulls(outcome, case, mirrored=x) for x in ways)
        off = min(each, key=lambda x: max(map(abs, x.values()), default=0.0))
        off = {x: y for x, y in off.items() if x in {"a", "b", "r0"} or not machines}
        shown = " ".join(f"{name} {x:.1f}" for name, x in off.items())
        shown += f" | {outcome.failure()[:200]}" if word == "failed" else ""
    is_right = outcome is not None and all(abs(x) < FAR for x in off.values())
    text = f"{case.look} T={case.t[-1]:.3g} n={case.t.size} turns={case.turns:.3g}"
    text += f" range/noise={case.half_range / case.noise['theta']:.3g}"
    if machines and outcome is not None:
        text += f" size={100 * case.size:.2g} %"
        if word == "failed":
            word = f"failed, {named(outcome, case)}"
        elif word == "good" and not is_right:
            word = "good, held" if held(outcome, case) else "good, not held"
    elif case.look == "wrong" and outcome is not None:  # a contradiction must be named
        is_right = word == "failed" and "contradicts" in outcome.failure()
        word = "named" if is_right else f"not named, {word}"
    sure = machines or (is_right and word == "good") or determined(case)
    return Result(seed, text, "+".join(given), sure, is_right, word, shown, off, seconds)


def main() -> int:
    """Check some recordings, write the counts, and return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    for name, default in (("recordings", 500), ("jobs", 2), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=default, help=f"[default: {default}]")
    for name, text in {
        "show": "show every fit",
        "easy": "draw ordinary tops only",
        "machines": "draw machines and faults",
    }.items():
        parser.add_argument(f"--{name}", action="store_true", help=text)
    parser.add_argument("--look", default="", help="draw one kind only")
    given = parser.parse_args()
    seeds = range(given.seed, given.seed + given.recordings)
    work = partial(checked, easy=given.easy, machines=given.machines, look=given.look)
    results: list[Result] = []
    with Pool(given.jobs) as pool:
        for one in pool.imap(work, seeds) if given.jobs > 1 else map(work, seeds):
            results.append(one)
            if given.show or not (one.is_right and one.word != "failed"):
                print(one, flush=True)
    counts = Counter(f"{one.look.split()[0]:12} {one.fate}" for one in results)
    print(*(f"{name} {counts[name]}" for name in sorted(counts)), sep="\n")
    times = np.array([x.seconds for x in results])
    failed = max([x.seconds for x in results if "failed" in x.word], default=0.0)
    middle, most = np.quantile(times, (0.5, 0.95))
    print(f"{middle:.2f} s (median), {most:.1f} s (95 %)", end=", ")
    print(f"{times.max():.1f} s (most), failed {failed:.1f} s (most)")
    return _of_machines(results) if given.machines else _of_tops(results, GOOD_SHARE[given.easy])


def _of_tops(results: list[Result], least: float) -> int:
    """Print the shares of right fits and of their errors, and return the exit code."""
    ordinary = [x for x in results if not x.look.startswith("wrong ")]
    sure = [x for x in ordinary if x.determined and not x.look.startswith("steady ")]
    good = sum(x.is_right and x.word == "good" for x in sure)
    bad = sum(not x.is_right and x.word.startswith("good") for x in ordinary)
    print(f"{bad} wrong and good; right and good: {good} of {len(sure)} that determine a top")
    errors = defaultdict[str, list[float]](list)
    for one in ordinary:
        for name, x in one.pulls.items() if one.word == "good" else ():
            errors[name].append(abs(x))
    for name, sizes in errors.items():
        shares = ", ".join(f"within {n} sigma {np.mean(np.array(sizes) < n):.3f}" for n in (1, 2))
        print(f"{name:12} {shares} of {len(sizes)}")
    return int(bad > 0 or good < least * len(sure))


def _of_machines(results: list[Result]) -> int:
    """Print the shares of machines that are held and named, and return the exit code."""
    words = Counter(x.word for x in results)
    good, wrong = words["good, held"], words["good, held"] + words["good, not held"]
    named = Counter(x.word for x in results if not x.look.startswith("filter"))
    count = sum(y for x, y in named.items() if "failed" in x)
    first = named["failed, right first"]
    alike = first + named["failed, right"]
    print(f"{wrong} wrong and good, {good / max(wrong, 1):.0%} held")
    print(f"of {count} failures {first} right first, {alike} with others")
    return int(good < HELD_SHARE * wrong or first < FIRST_SHARE * count)


if __name__ == "__main__":
    sys.exit(main())
