"""`python tests/tools/benchmark.py [--no-avx512] [SECTION]...`: costs as ratios, all in one run.

Each ratio stands beside its bar, if it has one: it is met or missed, without tolerance.  The exit
code is 1 if one is missed by more than 20 %.  `--no-avx512` measures in a process in which NumPy's
AVX-512 loops are switched off.  Peers: the floor sin + cos + 3 arctan2, scipy.special's
ellipj + 2 elliprj, heyoka's dense output.
"""

from __future__ import annotations

import decimal
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
import tracemalloc
from collections.abc import Callable, Mapping, Sequence
from compileall import compile_dir
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from lagtop import Top, solve
from scipy import special

from lagrange_cli.arithmetic.arrays import ARRAYS, BLOCK
from lagrange_cli.arithmetic.types import Array
from lagrange_cli.bench.closed_forms import CLOSED_FORMS
from lagrange_cli.bench.integrators import integrators
from lagrange_cli.bench.measure import common_conditions
from lagrange_cli.elliptic.carlson import carlson_rd, carlson_rf, carlson_rj
from lagrange_cli.elliptic.jacobi import jacobi
from lagrange_cli.elliptic.modulus import modulus
from lagrange_cli.inputs.trajectory import open_trajectory
from lagrange_cli.motion.over_time.columns import DEFAULT_COLUMNS
from lagrange_cli.motion.over_time.proved_table import ProvedTable
from lagrange_cli.output.formats import block_text
from lagrange_cli.sweep.angles import sweep_angles
from lagrange_cli.sweep.plan import runs_of
from lagrange_cli.sweep.records import BLOCK_ROWS, column_keys, sweep
from lagrange_cli.sweep.results import ResultColumn

NUMPY: Any = np._core._multiarray_umath  # type: ignore[attr-defined]
FEATURES: Mapping[str, bool] = NUMPY.__cpu_features__
"""Features of the processor that NumPy found and may use."""
WIDE = [name for name in NUMPY.__cpu_dispatch__ if name.startswith(("AVX512", "X86_V4"))]
"""The levels of AVX-512 for which NumPy has loops of their own."""
AVX512 = any(FEATURES[name] for name in WIDE)
SWITCH = "NPY_DISABLE_CPU_FEATURES"
TOLERATED = 1.2
"""Factor by which a bar may be missed before the exit code is 1."""
WORST: dict[str, float] = {}
"""Ratios over their bars, by name, of all that were missed."""

COUNT = 1_000_000
ROOT = Path(__file__).parents[2]
STARTS: dict[str, dict[str, float]] = {
    "worked example": {},
    "fast (trigonometric series)": {"r0": 200},
    "general start": {"psidot0": 3, "thetadot0": 2},
}


def judged(name: str, ratio: float) -> str:
    """Return a ratio beside the bar that its name ends in, such as `(<= 1.3)`, and the verdict."""
    bar = re.search(r"\((<=|>=) ([\d.]+)\)$", name)
    if bar is None:
        return f"{ratio:7.2f}"
    over = ratio / float(bar[2]) if bar[1] == "<=" else float(bar[2]) / ratio
    if over > 1:
        WORST[name] = over
    return f"{ratio:7.2f} {bar[1]} {bar[2]:<5} {'met' if over <= 1 else 'missed'}"


def machine() -> str:
    """Return the processor, and the widest loops that NumPy runs on it."""
    level = "AVX-512" if AVX512 else "AVX2" if FEATURES.get("AVX2") else "less than AVX2"
    return f"{common_conditions(0.0)['machine']}, {os.cpu_count()} CPUs, NumPy with {level}"


def nanoseconds(work: Callable[[], object], count: int = COUNT) -> float:
    """Return the least time of seven runs after a warm-up, per sample."""
    work()
    best = float("inf")
    for _ in range(7):
        begun = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begun)
    return best / count * 1e9


def floor(t: Array) -> None:
    for first in range(0, t.size, BLOCK):
        x = t[first : first + BLOCK]
        np.sin(x), np.cos(x)
        for _ in range(3):
            np.arctan2(x, 1.5)


def integrals(record: dict[str, ResultColumn]) -> None:
    """Compute what the record of a top needs at least of scipy.special, block by block."""
    k, k_prime, u3 = (np.asarray(record[key], dtype=float) for key in ("k", "k_prime", "u3"))
    mc, amplitude = k_prime * k_prime, np.radians(record["amplitude_deg"])
    gap = u3 - np.asarray(record["u2"], dtype=float)
    for first in range(0, k.size, BLOCK_ROWS):
        rows = slice(first, first + BLOCK_ROWS)
        special.ellipkm1(mc[rows])
        special.ellipkinc(amplitude[rows], mc[rows])
        special.ellipeinc(amplitude[rows], mc[rows])
        for p in ((u3 - 1) / gap, (u3 + 1) / gap):
            special.elliprj(0.0, mc[rows], 1.0, p[rows])


def sweeps(rng: np.random.Generator) -> None:
    """Compare `sweep()`, as users call it, with the integrals; and its memory with its result."""
    count = COUNT // 10
    rest = {"r0": rng.uniform(-100, 100, count), "theta0_deg": rng.uniform(1, 179, count)}
    record = sweep(r0=rest["r0"], theta0_deg=rest["theta0_deg"])
    moving = rest | {"psidot0": rng.uniform(-5, 5, count)}
    nodding = moving | {"thetadot0": rng.uniform(-5, 5, count)}

    def swept(tops: Mapping[str, Array], keys: Sequence[str] | None = None) -> Any:
        inputs: dict[str, Any] = {**tops, "keys": keys}
        return lambda: sweep(**inputs)

    costs = cpu_of(
        {
            "scipy.special, ellipkm1 + ellipkinc + ellipeinc + 2 elliprj": lambda: integrals(
                record
            ),
            "sweep() from rest, all keys (<= 1.3)": swept(rest),
            "from rest, T": swept(rest, ["T_nutation"]),
            "psidot0, all keys (<= 3)": swept(moving),
            "psidot0 and thetadot0, all keys (<= 3)": swept(nodding),
            "psidot0 and thetadot0, T": swept(nodding, ["T_nutation"]),
        },
        count,
    )
    shown("A sweep, CPU per top", costs, "scipy")
    print("\nMemory of sweep() over that of its result")
    measured = {"theta0_deg": rest["theta0_deg"], "phidot0": rest["r0"]}
    measured["psidot0"] = moving["psidot0"]
    starts = {"rest": rest, "psidot0": moving, "both rates": nodding, "phidot0": measured}
    for name, tops in starts.items():
        for keys in (None, ["T_nutation"], ["mean_precession_rate", "T_nutation"], ["remark"]):
            tracemalloc.start()
            found = swept(tops, keys)()
            peak = tracemalloc.get_traced_memory()[1] / sum(x.nbytes for x in found.values())
            tracemalloc.stop()
            title = f"{count} tops, {name}, {', '.join(keys or ['all keys'])} (<= 2.5)"
            print(f"{title:65} {judged(title, peak)}")


def shown(title: str, costs: Mapping[str, float], peer: str) -> None:
    """Print costs in nanoseconds, and their ratios to the first."""
    print(f"\n{title}")
    least = next(iter(costs.values()))
    for name, cost in costs.items():
        print(f"{name:65} {cost:10.1f} ns  {peer} x {judged(name, cost / least)}")


def text(rng: np.random.Generator) -> None:
    """Compare the text of rows with orjson's of their numbers: CSV <= 2, ndjson <= 5."""
    inputs = {name: rng.uniform(10, 170, BLOCK_ROWS) for name in ("r0", "theta0_deg")}
    keys = column_keys()[:-1]
    record = sweep(r0=inputs["r0"], theta0_deg=inputs["theta0_deg"], keys=keys)
    numbers = [key for key in keys if record[key].dtype == np.float64]
    tables = {"a sweep, all keys": keys, "four numbers": numbers[-4:], "one number": numbers[-1:]}
    bars = {"a sweep, all keys": {"csv": " (<= 2)", "ndjson": " (<= 5)"}}
    for title, names in tables.items():
        columns = runs_of([record[name] for name in names])
        only = np.stack([record[name] for name in names if name in numbers], axis=1)
        works: dict[str, Callable[[], object]] = {
            "orjson.dumps, flat": partial(
                orjson.dumps, only.ravel(), option=orjson.OPT_SERIALIZE_NUMPY
            )
        }
        for fmt in ("csv", "ndjson", "json"):
            bar = bars.get(title, {}).get(fmt, "")
            works[fmt + bar] = partial(block_text, columns, names, fmt)
        shown(f"Text of {title}, CPU per row", cpu_of(works, BLOCK_ROWS, 30), "orjson")


def start_up() -> None:
    """Compare whole commands with importing what they cannot do without."""
    peers = {
        "import click, rich.console, rich.table": {
            "lagtop solve (<= 1.2)": "solve",
            "lagtop jacobi --k 0.8 (<= 1.3)": "jacobi --k 0.8",
            "lagtop jacobi --k 0.8 --format json": "jacobi --k 0.8 --format json",
            "lagtop jacobi --k 0.8 --u 0.5 --format csv, without NumPy": (
                "jacobi --k 0.8 --u 0.5 --format csv"
            ),
            "lagtop jacobi --k 0.8 --u 0:1:7 --format csv, with NumPy": (
                "jacobi --k 0.8 --u 0:1:7 --format csv"
            ),
        },
        "import click": {
            "lagtop solve --format json (<= 1.25)": "solve --format json",
            "lagtop solve --get T_nutation (<= 1.25)": "solve --get T_nutation",
            "an input with a unit (<= 3)": "solve --r0 477(2)rpm",
        },
        "import numpy": {
            "lagtop table --t-max 1 (<= 1.5)": "table --t-max 1",
            "lagtop find, one unknown (<= 1.5)": "find --r0 10:200 T_precession=2",
        },
        "import matplotlib.figure": {
            **{
                f"lagtop plot {kind} (<= {1.8 if kind == 'angles' else 1.5})": (
                    f"plot {kind} -o {os.devnull} --format png"
                )
                for kind in ("sphere", "angles", "remainders", "cubic", "phase", "map")
            },
            "lagtop plot all (<= 3)": f"plot all -o {os.devnull} --format png",
        },
    }
    compile_dir(ROOT / "lagrange_cli", quiet=1)  # as pip does
    for peer, commands in peers.items():
        processes = {peer: ["-c", peer]}
        for name, command in commands.items():
            processes[name] = ["-m", "lagrange_cli", *command.split()]
        shown(f"Start-up against {peer}, CPU of a process", cpu_of_processes(processes), "that")


QUIET: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def cpu_of_processes(processes: Mapping[str, Sequence[str]]) -> dict[str, float]:
    """Return the least CPU time of 15 runs of Python with each list of arguments, in turns."""
    best = dict.fromkeys(processes, float("inf"))
    for _ in range(15):
        for name, arguments in processes.items():
            begun = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([sys.executable, *arguments], check=True, **QUIET)
            ended = resource.getrusage(resource.RUSAGE_CHILDREN)
            cost = ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
            best[name] = min(best[name], cost * 1e9)
    return best


def keys() -> None:
    """Compare some keys of one top with its full record."""
    for name, start in STARTS.items():
        works: dict[str, Callable[[], object]] = {
            "a full record": partial(lambda top: solve(top).record(), Top(**start))
        }
        for key in ("T_nutation", "a", "mean_precession_rate"):
            works[f"{key} alone{' (<= 0.4)' * (key == 'T_nutation')}"] = partial(
                lambda top, key: solve(top).record(keys=[key]), Top(**start), key
            )
        shown(f"Keys, {name}, CPU per top", cpu_of(works, 1, 30), "full")


def jobs() -> None:
    """Compare two processes with one for a million tops with all keys."""
    costs = {}
    with tempfile.NamedTemporaryFile(dir="/dev/shm") as file:
        command = [sys.executable, "-m", "lagrange_cli", "sweep", "--r0", "10:200:1e6"]
        for count in ("1", "2"):
            whole = [*command, "-o", file.name, "--jobs", count]
            seconds = []
            for _ in range(3):
                begun = time.perf_counter()
                subprocess.run(whole, check=True)
                seconds.append(time.perf_counter() - begun)
            costs[count] = min(seconds)
    print("\nA million tops with all keys as CSV, seconds")
    for count, cost in costs.items():
        name = f"--jobs {count}{' (>= 1.4)' * (count == '2')}"
        print(f"{name:65} {cost:8.2f} s   times as fast {judged(name, costs['1'] / cost)}")


def functions(rng: np.random.Generator) -> None:
    """Time arrays of elliptic functions; contract: at most what scipy.special takes."""
    u, m = rng.uniform(-10, 10, COUNT), rng.random(COUNT)
    sn, cn, dn, _ = special.ellipj(u, m)
    legendre = cn * cn, dn * dn, np.ones(COUNT), 1 - rng.uniform(-3, 0.9, COUNT) * sn * sn
    unbalanced = np.exp(rng.normal(0, 2, (4, COUNT)))
    pairs: dict[str, tuple[Callable[[], object], Callable[[], object]]] = {
        "am, sn, cn, dn, one modulus": (
            lambda: jacobi(ARRAYS, u, modulus(ARRAYS, m=0.58)),
            lambda: special.ellipj(u, 0.58),
        ),
        "am, sn, cn, dn, a modulus each": (
            lambda: jacobi(ARRAYS, u, modulus(ARRAYS, m=m)),
            lambda: special.ellipj(u, m),
        ),
        "R_J of Legendre's third integral": (
            lambda: carlson_rj(ARRAYS, *legendre),
            lambda: special.elliprj(*legendre),
        ),
        "R_J, lognormal arguments": (
            lambda: carlson_rj(ARRAYS, *unbalanced),
            lambda: special.elliprj(*unbalanced),
        ),
        "R_D": (
            lambda: carlson_rd(ARRAYS, *unbalanced[:3]),
            lambda: special.elliprd(*unbalanced[:3]),
        ),
        "R_F": (
            lambda: carlson_rf(ARRAYS, *unbalanced[:3]),
            lambda: special.elliprf(*unbalanced[:3]),
        ),
    }
    print("\nElliptic functions, per element")
    for name, (ours, theirs) in pairs.items():
        cost, least = nanoseconds(ours), nanoseconds(theirs)
        print(f"{name:65} {cost:8.1f} ns  {cost / least:6.2f} x scipy")


def writing(t: Array) -> None:
    """Compare `table` to a file, a whole process, with sampling and dumping."""
    sampler = solve(Top()).sampler()

    def least() -> None:
        angles = sampler.angles(t)
        block = np.stack([t, *map(np.degrees, angles)], axis=1)
        orjson.dumps(block, option=orjson.OPT_SERIALIZE_NUMPY)

    command = [sys.executable, "-m", "lagrange_cli", "table", "--t-max", "100", "--n", str(t.size)]
    with tempfile.NamedTemporaryFile(dir="/dev/shm") as file:
        process = nanoseconds(lambda: subprocess.run([*command, "-o", file.name], check=True))
    costs = {"sampling and orjson.dumps": nanoseconds(least)}
    costs["lagtop table, whole process (<= 1.4)"] = process
    shown("A table of 1e6 rows to a file, per row", costs, "that")


def reading() -> None:
    """Compare the rows of `compare`, from a CSV file, with NumPy's own reader."""
    command = [sys.executable, "-m", "lagrange_cli", "table", "--t-max", "100", "--n", str(COUNT)]
    with tempfile.NamedTemporaryFile(suffix=".csv") as file:
        subprocess.run([*command, "-o", file.name], check=True)

        def ours() -> None:
            with open_trajectory(file.name) as trajectory:
                for _ in trajectory.blocks():
                    pass

        works: dict[str, Callable[[], object]] = {
            "numpy.loadtxt": lambda: np.loadtxt(file.name, delimiter=",", skiprows=1),
            "the trajectory of lagtop compare (<= 2)": ours,
        }
        shown("Reading 1e6 rows of CSV, CPU per row", cpu_of(works, COUNT, 3), "numpy")


def cpu_of(
    works: Mapping[str, Callable[[], object]], count: int, rounds: int = 9
) -> dict[str, float]:
    """Return the least CPU time of each, in nanoseconds per one of `count`, in turns."""
    best = dict.fromkeys(works, float("inf"))
    for round_ in range(rounds + 1):
        for name, work in works.items():
            begun = time.process_time()
            work()
            if round_:
                best[name] = min(best[name], time.process_time() - begun)
    return {name: seconds / count * 1e9 for name, seconds in best.items()}


def columns(t: Array) -> None:
    """Compare single columns with all angles."""
    motion, three = solve(Top()), ["t", "theta", "phi", "psi"]
    titles = ["theta (<= 0.7)", "u (<= 0.6)", "t (<= 0.1)", "r (<= 0.1)", "thetadot", "psidot"]
    works: dict[str, Callable[[], object]] = {"t theta phi psi": partial(motion.table, t, three)}
    for title in [*titles, "phidot", "axis_z", "psi", "energy"]:
        works[title] = partial(motion.table, t, [title.partition(" ")[0]])
    shown("Columns of Motion.table, CPU per sample", cpu_of(works, t.size), "all angles")


FRESH = """
import sys, time
import numpy as np
from lagtop import Top, solve
sampler, n = solve(Top()).sampler(), int(sys.argv[1])
t, costs = np.sort(np.random.default_rng(0).uniform(0, 100, n)), []
sampler.angles(t[:2])
for _ in range(7):
    begun = time.process_time()
    sampler.angles(t)
    costs.append((time.process_time() - begun) / n * 1e9)
print(costs[0], min(costs[1:]))
"""


def fresh() -> None:
    """Compare few samples in a fresh process with many warm ones."""
    costs: dict[str, float] = {}
    for count in (1_000_000, 100_000, 10_000):
        command = [sys.executable, "-c", FRESH, str(count)]
        runs = [subprocess.run(command, capture_output=True, check=True).stdout for _ in range(5)]
        first, later = map(min, zip(*(map(float, x.split()) for x in runs), strict=True))
        costs[f"{count} samples, later calls{' (<= 1.5)' * (count == 10_000)}"] = later
        costs[f"{count} samples, first call"] = first
    shown("Samples in a process of their own, CPU per sample", costs, "many")


def set_up(rng: np.random.Generator) -> None:
    """Time what angles need of a motion: <= 2 ms for one, <= 20 us for each of many."""
    works = {
        name: partial(lambda top: solve(top).sampler(), Top(**start))
        for name, start in STARTS.items()
    }
    print("\nSet-up of the angles, CPU per top")
    for name, cost in cpu_of(works, 1).items():
        print(f"{name:65} {cost / 1e6:8.2f} ms")
    count, times = 10_000, np.linspace(0, 10, 100)
    rest = {"r0": rng.uniform(-100, 100, count), "theta0_deg": rng.uniform(1, 179, count)}
    moving = rest | {"psidot0": rng.uniform(-5, 5, count), "thetadot0": rng.uniform(-5, 5, count)}
    many: dict[str, Callable[[], object]] = {}
    for name, tops in (("released from rest", rest), ("general starts", moving)):
        inputs: dict[str, Any] = tops
        many[f"sweep_angles, {name}, a time"] = partial(sweep_angles, [1.0], **inputs)
        many[f"sweep_angles, {name}, 100 times"] = partial(sweep_angles, times, **inputs)
    for name, cost in cpu_of(many, count, 3).items():
        print(f"{name:65} {cost / 1e3:8.2f} us")


def angles(t: Array) -> None:
    """Compare the angles of a motion with the floor and with others."""
    by_legendre = CLOSED_FORMS["scipy.special"].prepare(Top(), "double")
    by_taylor = integrators(60)["Taylor-euler"].prepare(Top(), 1e-16)
    least = nanoseconds(lambda: floor(t))
    rows = {
        "sin + cos + 3 arctan2": least,
        "scipy.special, ellipj + 2 elliprj": nanoseconds(partial(by_legendre, t)),
        "heyoka, dense output over 233 periods": nanoseconds(partial(by_taylor, t)),
    }
    works: dict[str, Callable[[], object]] = {"sin + cos + 3 arctan2": partial(floor, t)}
    bars = (1.4, 1.8) if AVX512 else (2, 2)
    for name, start in STARTS.items():
        sampler = solve(Top(**start)).sampler()
        works[f"lagtop, {name} (<= {bars[0]})"] = partial(sampler.angles, t)
        works[f"lagtop, {name}, wrapped (<= {bars[1]})"] = partial(sampler.angles, t, wrap=True)
        works[f"lagtop, {name}, 1e9 s away"] = partial(sampler.angles, t + 1e9)
    shown("1e6 warm samples, CPU per sample", cpu_of(works, t.size, 5), "floor")
    shown("Others, time per sample", rows, "floor")
    for count in (1, 10, 100, 1000):
        few, x = t[:count].copy(), np.linspace(1.0, 2.0, count)
        calls: dict[str, Callable[[], object]] = {
            "sixty calls of np.multiply": lambda x=x: [np.multiply(x, x) for _ in range(60)],  # type: ignore[misc]
        }
        for name, start in STARTS.items():
            calls[f"{name} (<= 5)"] = partial(solve(Top(**start)).sampler().angles, few)
        shown(f"{count} samples, CPU per call", cpu_of(calls, 1, 400), "sixty")


def proofs() -> None:
    """Time proved numbers: rows of t and three angles, records, and their radii."""
    count, motion = 40, solve(Top(psidot0=3.0, thetadot0=2.0))
    times = [Fraction(i, 7) for i in range(count)]

    def rows_with(digits: int | None) -> Callable[[], object]:
        table = ProvedTable(motion, DEFAULT_COLUMNS, digits)
        return lambda: [table.row(t) for t in times]

    rows = {f"--digits {n}": rows_with(n) for n in (20, 50, 100)} | {"--certify": rows_with(None)}
    shown("A row, CPU", cpu_of(rows, count, 3), "--digits 20")
    records: dict[str, Callable[[], object]] = {
        "a record in doubles": lambda: solve(motion.top).record(),
        "--digits 50": lambda: solve(motion.top).record(digits=50),
        "--certify": lambda: solve(motion.top).record(radii=True),
    }
    shown("A record, CPU", cpu_of(records, 1, 9), "doubles")


def quotients() -> None:
    """Compute a thousand products and quotients of 60 digits: the peer of proved numbers."""
    context = decimal.Context(prec=60)
    x = z = context.sqrt(decimal.Decimal(2))
    for _ in range(1000):
        z = context.divide(context.multiply(z, x), x)


BEFORE = {"record": (1.78, 2.14), "T_nutation": (0.50, 0.67), "set-up": (1.70, 2.35)}
"""Costs at commit 39a276a over those of `quotients` in the same process: a release from rest, and a
start with both rates.  A bar is such a number times the factor that proofs may cost more."""
BEFORE_ROW, BEFORE_1000 = 0.79, 424.0
"""Costs at 39a276a, over `quotients`: a row of `table --digits 30`, and `solve --digits 1000`."""


def costs_of_proofs() -> None:
    """Compare what is proved with what it cost before it was, by way of a stable peer."""
    works: dict[str, Callable[[], object]] = {"1000 products and quotients": quotients}
    starts = {"from rest": {}, "both rates": STARTS["general start"]}
    factors = {"record": (3.2, 1.5), "T_nutation": (1.7, 1.7), "set-up": (1.3, 1.3)}
    for i, (name, start) in enumerate(starts.items()):
        bar = {key: f"(<= {factors[key][i] * BEFORE[key][i]:.2f})" for key in BEFORE}
        top = Top(**start)
        works |= {
            f"record, {name} {bar['record']}": lambda top=top: solve(top).record(),  # type: ignore[misc]
            f"T_nutation, {name} {bar['T_nutation']}": (
                lambda top=top: solve(top).record(keys=["T_nutation"])  # type: ignore[misc]
            ),
            f"set-up of angles, {name} {bar['set-up']}": lambda top=top: solve(top).sampler(),  # type: ignore[misc]
        }
    table = ProvedTable(solve(Top()), DEFAULT_COLUMNS, 30)
    row = f"a row of table --digits 30 (<= {1.7 * BEFORE_ROW:.2f})"
    times = iter(Fraction(i, 41) for i in range(1000))
    works[row] = lambda: table.row(next(times))
    many = f"solve --digits 1000 (<= {1.5 * BEFORE_1000:.0f})"
    works[many] = lambda: solve(Top()).record(digits=1000)
    shown("Proofs, CPU", cpu_of(works, 1, 12), "peer")


def main() -> None:
    """Run the sections that are named, or all; exit with 1 if a bar is missed by far."""
    if "--no-avx512" in sys.argv:
        names = [name for name in sys.argv[1:] if name != "--no-avx512"]
        off = " ".join(name for name in WIDE if FEATURES[name])
        command = [sys.executable, __file__, *names]
        sys.exit(subprocess.run(command, env=os.environ | {SWITCH: off}, check=False).returncode)
    print(machine())
    rng = np.random.default_rng(0)
    t = np.sort(rng.uniform(0, 100, COUNT))
    t[0] = 0.0
    sections: dict[str, Callable[[], object]] = {
        "angles": partial(angles, t),
        "columns": partial(columns, t),
        "fresh": fresh,
        "set_up": partial(set_up, rng),
        "functions": partial(functions, rng),
        "keys": keys,
        "sweeps": partial(sweeps, rng),
        "text": partial(text, rng),
        "writing": partial(writing, t),
        "start_up": start_up,
        "jobs": jobs,
        "reading": reading,
        "proofs": proofs,
        "costs_of_proofs": costs_of_proofs,
    }
    for name in sys.argv[1:] or sections:
        sections[name]()
    print(f"\n{len(WORST)} bars are missed; by more than 20 %:")
    far = [name for name, over in WORST.items() if over > TOLERATED]
    print("\n".join(far) or "none")
    sys.exit(1 if far else 0)


if __name__ == "__main__":
    main()
