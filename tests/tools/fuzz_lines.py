"""Random command lines, most of them wrong: each must end as documented; not collected by pytest.

    python tests/tools/fuzz_lines.py --lines 40000 --seed 1

Options and their values are drawn from what each command declares, and then spoilt in places.  A
line is a fault if it ends with a traceback, a warning of a library or an undocumented exit code, if
it fails and the last line on standard error does not say why, if it is refused and has written
something, or if infinite numbers or what is no number are printed.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import random
import re
import shlex
import signal
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

import click
from campaign import fault_of, finish, options
from click.testing import CliRunner, Result

from lagrange_cli.cli.app import NAMES as COMMANDS
from lagrange_cli.cli.app import main

WEIGHTS = {"solve": 30, "table": 25, "sweep": 18, "find": 8, "jacobi": 20, "eta": 15} | {
    **{"compare": 10, "fit": 0.5, "plot": 1, "view": 3, "bench": 1, "stability": 1}
}
SECONDS = 60
"""A line that takes longer is a fault: none asks for much."""
USUAL = "0 1 -1 2 3 5 7.5 30 40 50 90 0.5 1e-3 100".split()
NUMBERS = [
    *"180 181 -30 -1e-9 1e3 1e-300 1e300 1e308 1e999 -1e999 nan inf 0x10 1_0 1,5 ٣ 1e1e1".split(),
    *"1e 5. .5 - + 1/3 2**3 K K/2 1+2i i 0.3+0.7i".split(),
    *("", " ", "x", "1 2", "−1", "1\x1b[31m", "9" * 400, "0." + "3" * 400, "1e-400", "\udcff"),
    *"50(1) 50+-1 50±0.1% 1( 50(1)(2) 30+/- 480rpm 2s 30deg 0.5rad 350g [g] 0(0)".split(),
    *("50 rad/s", "3 kg", "5 furlong", "1 kg^0.5", "1e3 Hz"),
]
RANGES = "1:9:5 log:1:100:4 1,2,3 9:1:5 1:1:3 1:9:0 1:9 log:0:1:3 1:2:3:4 1,,2 , :".split()
RANGES += ["1:9:1e4", "0.1:0.9:7", "nan:1:3", "1:9:5 rpm", "10:200"]
COUNTS = ["0", "1", "2", "3", "20", "101", "1e2", "-1", "1.5", "1e30", "x", "", "50"]
NAMES = "t,theta axis quaternion,energy r0,T_nutation regime b,b , thta error u1,u2 K t,t".split()
NAMES += ["", "remark", "x" * 300, "moment,r", "A,C", "start", "axis=y", "time"]
WORDS = "sphere angles cubic map phase T_nutation=0.4 regime=regular b<20 theta_max_deg=60".split()
WORDS += ["K=", "=3", "T_nutation", "mean_spin_rate=0", "nowhere", "-", "-h"]
EXTENSIONS = ["", ".csv", ".json", ".ndjson", ".npy", ".parquet", ".txt", ".npz", ".xlsx", ".svg"]
EXTENSIONS += [".png", ".html", ".toml", ".CSV", ".csv.gz"]
FILES = {
    "top.toml": "m = 1587.0\nr0 = 40\ntheta0_deg = 60\n",
    "si.toml": 'm = "350(2) g"\nA = "8.5e-4 kg m^2"\nC = "4e-4 kg m^2"\ns = "3cm"\ng = "1m/s^2"\n',
    "bad.toml": "m = \n",
    "unknown.toml": "spin = 3\n",
    "tops.csv": "id,r0,theta0_deg\na,40,30\nb,x,30\nc,50,200\n",
    "few.ndjson": '{"r0": 40}\n{"r0": 50, "n": 1}\n',
    "times.txt": "# s\n0\n0.5\n1\n",
    "run.csv": "t,theta,psi\n" + "".join(f"{i / 20},{30 + i % 7},{i}\n" for i in range(30)),
    "binary": "\x01\x02PAR1",
    "empty": "",
}
OLD = "old content\n"
ALWAYS = {
    "bench": "--timeout 0.01 --n 3 --methods lagtop,theta-series".split(),
    "stability": "--samples 1 --strata fast".split(),
    "plot": "--size 3x2 --dpi 30".split(),
}
"""Options that keep a command short."""
OFTEN = {
    "jacobi": "--k 0.8".split(),
    "eta": "--delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4".split(),
    "find": "--r0 10:200 T_precession=2".split(),
    "compare": ["run.csv"],
    "fit": ["run.csv"],
    "view": "-o out/file.html".split(),
    "plot": "-o out/file.png".split(),
}
"""Words without which a command does nothing."""
LEFT_OUT = {
    "bench": {"--timeout", "--n", "--methods", "--long"},
    "view": {"--open"},
    "stability": {"--samples", "--strata", "--jobs"},
    "plot": {"--size", "--dpi", "--show", "--animate", "--x", "--y"},
    "sweep": {"--jobs"},
    "table": {"--jobs"},
    "solve": {"--samples"},
}
"""Options that take long, open windows or start processes."""


def value(rng: random.Random, option: click.Parameter) -> str:
    """Return a value for an option, which may fit its type."""
    kind, usual = option.type.name, rng.random() < 0.7
    pools: list[tuple[bool, Sequence[str]]] = [
        (kind == "choice", [*getattr(option.type, "choices", []), "nothing", ""]),
        (
            option.name in {"output", "plot", "animate", "folder"},
            [f"out/file{x}" for x in EXTENSIONS] + ["-", "/dev/full", "nowhere/x", "out", ""],
        ),
        (kind == "path", [*FILES, "nowhere.toml", "out", "-", "", "\udcff.csv"]),
        (option.name == "cluster", ["nowhere", "tls://1", "", "tcp://"]),
        (kind in {"integer", "N|auto"}, COUNTS),
        (kind in {"names", "numbers"}, NAMES + USUAL),
        (kind == "range", USUAL if usual else RANGES + NUMBERS),
        (kind == "number", USUAL if usual else NUMBERS),
    ]
    pool = next((pool for fits, pool in pools if fits), WORDS + RANGES + NAMES + USUAL)
    return spoilt(rng, str(rng.choice(pool)))


def spoilt(rng: random.Random, text: str) -> str:
    """Return a text, now and then with a letter more, less or another."""
    if rng.random() < 0.93 or not text:
        return text
    i = rng.randrange(len(text))
    return text[:i] + rng.choice(["", "x", "-", ".", "0", "e", "\t", "é", "'"]) + text[i + 1 :]


def line(rng: random.Random) -> list[str]:
    """Return a random command line."""
    name = rng.choices(list(WEIGHTS), list(WEIGHTS.values()))[0]
    command = main.get_command(click.Context(main), name)
    assert command is not None
    words = [*ALWAYS.get(name, []), *(OFTEN.get(name, []) if rng.random() < 0.7 else [])]
    avoided = {*LEFT_OUT.get(name, set()), "--help", "--version"}
    known = [x for x in command.params if isinstance(x, click.Option) and not avoided & {*x.opts}]
    for option in rng.sample(known, min(len(known), int(rng.expovariate(0.45)))):
        words.append(rng.choice(option.opts))
        if not option.is_flag:
            words.append(value(rng, option))
    for argument in (x for x in command.params if isinstance(x, click.Argument)):
        for _ in range(rng.choice([0, 0, 0, 1, 1, 2])):
            pool = WORDS if argument.name in {"conditions", "words"} else [*FILES]
            words.insert(rng.randrange(len(words) + 1), spoilt(rng, rng.choice(pool)))
    if rng.random() < 0.02:
        words.insert(rng.randrange(len(words) + 1), rng.choice(["--nothing", "-q", "--", "--r0"]))
    return [spoilt(rng, name) if rng.random() < 0.1 else name, *words]


def faults_of(words: Sequence[str], result: Result, folder: Path) -> Iterator[str]:
    """Yield what is wrong with the end of a command."""
    code = result.exit_code
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        yield f"ends with {result.exception!r}"
    elif wrong := fault_of(code, result.stderr):
        yield wrong
    if code in {2, 65, 69} and result.stdout_bytes:
        yield f"is refused with {code}, and prints {result.stdout[:80]!r}"
    is_page = result.stdout_bytes.startswith(b"<!DOCTYPE html>")  # its programs name NaN
    no_number = rb"(?<![\w\"\-])-?(?:inf|nan|NaN|Infinity)(?![\w])"
    if not is_page and re.search(no_number, result.stdout_bytes):
        yield "prints what is no number"
    if "json" in words and not code and result.stdout_bytes[:1] in {b"[", b"{"}:
        json.loads(result.stdout)
    yield from changes(code, folder)


def changes(code: int, folder: Path) -> Iterator[str]:
    """Yield what a command that was refused has written, and put everything back."""
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.name.startswith(".lagtop"):
            yield f"leaves {path.name}"
        if path.is_file() and path.parent.name == "out":
            if code in {2, 65, 69, 74} and path.read_bytes() != OLD.encode():
                yield f"is refused with {code}, and writes {path.name}"
            path.write_text(OLD)
        elif path.name not in {*FILES, "out"}:
            if code in {2, 65, 69}:
                yield f"is refused with {code}, and makes {path.name}"
            path.rmdir() if path.is_dir() else path.unlink()


def late(*_: int | FrameType | None) -> NoReturn:
    """Raise TimeoutError."""
    raise TimeoutError


Found = tuple[Counter[tuple[str, int]], list[str], list[tuple[float, str]]]
"""Counts by command and code, faults, and the slowest lines with their seconds."""


def run(job: tuple[int, int]) -> Found:
    """Run so many lines of a seed."""
    seed, count = job
    rng, counts, wrong = random.Random(seed), Counter[tuple[str, int]](), list[str]()
    times: list[tuple[float, str]] = []
    warnings.simplefilter("default")
    signal.signal(signal.SIGALRM, late)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.chdir(folder)
        (folder / "out").mkdir()
        for _ in range(count):
            for file, text in FILES.items():
                (folder / file).write_text(text)
            words, stdin = line(rng), rng.choice([*FILES.values()])
            shown = f"lagtop {shlex.join(words)} <<< {stdin[:40]!r}"
            begun = time.perf_counter()
            signal.alarm(SECONDS)
            result = CliRunner().invoke(main, words, input=stdin)
            signal.alarm(0)
            counts[words[0] if words[0] in COMMANDS else "?", result.exit_code] += 1
            times.append((time.perf_counter() - begun, shown))
            wrong += [f"{fault}: {shown}" for fault in faults_of(words, result, folder)]
        os.chdir("/")
    return counts, wrong, sorted(times)[-3:]


def script() -> None:
    """Print counts and faults; the exit code is 1 if there is a fault."""
    given = options(__doc__, lines=2000, jobs=2).parse_args()
    finish(faults(given.lines, given.seed, given.jobs), longest=10_000)


def faults(lines: int, seed: int, processes: int) -> Iterator[str]:
    """Yield the faults of random lines, then print counts and the slowest lines."""
    jobs = [(seed * 10**9 + i, min(250, lines - i)) for i in range(0, lines, 250)]
    counts, times = Counter[Any](), list[tuple[float, str]]()
    with multiprocessing.get_context("spawn").Pool(processes, maxtasksperchild=20) as pool:
        for found, wrong, slowest in pool.imap_unordered(run, jobs):
            counts += found
            times += slowest
            yield from wrong
    for name in [*COMMANDS, "?"]:
        codes = {code: n for (command, code), n in sorted(counts.items()) if command == name}
        print(f"  {name:9} {sum(codes.values()):6}  {codes}")
    for seconds, text in sorted(times)[-3:]:
        print(f"  {seconds:5.1f} s  {ascii(text)[:150]}")


if __name__ == "__main__":
    script()
