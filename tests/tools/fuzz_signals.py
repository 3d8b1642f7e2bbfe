"""Signals and kills at any moment: nothing is left half written; not collected by pytest.

    python tests/tools/fuzz_signals.py --signals 200 --kills 60 --seed 1

A command gets a signal, or its whole process group does, at a random moment from its start to its
end.  It must die by that signal or have ended as ever, without a traceback, must leave an old file
as it was or replace it whole, and must leave no temporary file and no process.  A sweep of --parts
is killed by SIGKILL again and again; the run that finishes it must leave the bytes, the error line
and the exit code of a run that nobody disturbed.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from campaign import finish, options

LAGTOP = [sys.executable, "-m", "lagrange_cli"]
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1]
LINES = {
    "table": "table --n 3e5 -o out",
    "table to json": "table --n 1e5 --format json -o out",
    "sweep": "sweep --r0 1:100:60000 -o out",
    "sweep to stdout": "sweep --r0 1:100:60000",
    "find": "find --r0 10:200 --theta0 20:60 T_precession=1.66 T_nutation=0.1595 -o out",
    "digits": "table --n 100 --digits 40 -o out",
    "compare": "compare run.csv -o out",
    "plot": "plot -o out.png",
    "jobs": "sweep --r0 1:100:200000 --jobs 2 -o out",
    "more jobs": "sweep --r0 1:100:200000 --psidot0 1 --keys r0,K --jobs 3 -o out",
    "jobs to stdout": "sweep --r0 1:100:200000 --jobs 2",
    "tables by jobs": "table --tops few.csv --n 20000 --jobs 2 -o out",
    "stability by jobs": "stability --samples 6 --strata slow,units --jobs 2 -o out",
}
OLD = b"old\n"
PATIENCE = 300
"""Seconds after which a command hangs."""
PARTS = "sweep tops.csv --keys r0,T_nutation --parts parts"


class Ended(NamedTuple):
    """How a process ended."""

    code: int
    stderr: bytes


def prepare(folder: Path) -> None:
    """Write the files that the commands read."""
    (folder / "tmp").mkdir()
    run = subprocess.run([*LAGTOP, "table", "--n", "20000"], capture_output=True, check=True)
    (folder / "run.csv").write_bytes(run.stdout)
    (folder / "few.csv").write_text("r0\n" + "".join(f"{i}\n" for i in range(20, 40)))
    rows = (f"{i},{'x' if i % 7000 == 13 else 20 + i % 90},30\n" for i in range(60_000))
    (folder / "tops.csv").write_text("id,r0,theta0_deg\n" + "".join(rows))


def start(line: str, folder: Path) -> subprocess.Popen[bytes]:
    """Start a command in a process group of its own."""
    return subprocess.Popen(
        [*LAGTOP, *line.split()],
        cwd=folder,
        env=os.environ | {"TMPDIR": str(folder / "tmp")},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


def end_of(running: subprocess.Popen[bytes]) -> Ended:
    """Wait for a process and for the rest of its group; kill what is still there after a while."""
    try:
        said = running.communicate(timeout=PATIENCE)[1]
    except subprocess.TimeoutExpired:
        os.killpg(running.pid, signal.SIGKILL)
        return Ended(99, running.communicate()[1] + b"(hangs)")
    deadline = time.monotonic() + 10
    while time.monotonic() < deadline:
        try:
            os.killpg(running.pid, 0)
        except ProcessLookupError:
            return Ended(running.returncode, said)
        time.sleep(0.02)
    os.killpg(running.pid, signal.SIGKILL)
    return Ended(98, said + b"(leaves a process)")


def undisturbed(line: str, folder: Path) -> tuple[float, bytes]:
    """Return how long a command takes, and what it has written to its file."""
    begun, path = time.perf_counter(), folder / line.rsplit(maxsplit=1)[-1]
    ended = end_of(start(line, folder))
    assert ended.code in {0, 1}, (line, ended)
    return time.perf_counter() - begun, path.read_bytes() if path.is_file() else b""


def disturbed(
    line: str,
    number: signal.Signals,
    whole_group: bool,
    after: float,
    *,
    folder: Path,
    written: bytes,
) -> Iterator[str]:
    """Send a signal after some seconds; yield what is wrong with the end."""
    name = line.rsplit(maxsplit=1)[-1]
    to_file = name.startswith("out")
    if to_file:
        (folder / name).write_bytes(OLD)
    running = start(line, folder)
    time.sleep(after)
    had_ended = running.poll() is not None
    if not had_ended:
        (os.killpg if whole_group else os.kill)(running.pid, number)
    ended = end_of(running)
    usual = ended.code in {0, 1}
    if ended.code != -number and not usual:
        yield f"exit code {ended.code}: {ended.stderr[-300:]!r}"
    if b"Traceback" in ended.stderr or b".py" in ended.stderr:
        yield f"says {ended.stderr[-300:]!r}"
    if to_file and not usual and (folder / name).read_bytes() not in {OLD, written}:
        yield "has changed the file"
    if to_file and usual and (folder / name).read_bytes() == OLD:
        yield f"ended with {ended.code} and has not written"
    left = [x.name for x in [*folder.glob(".lagtop*"), *(folder / "tmp").iterdir()]]
    if left:
        yield f"leaves {left}"
        for path in [*folder.glob(".lagtop*"), *(folder / "tmp").iterdir()]:
            subprocess.run(["rm", "-rf", str(path)], check=True)


def signals(rng: random.Random, count: int, folder: Path) -> Iterator[str]:
    """Yield the faults of so many signals."""
    alone = {name: undisturbed(line, folder) for name, line in LINES.items() if count}
    seen: Counter[str] = Counter()
    for i in range(count):
        name = [*LINES][i % len(LINES)]
        number, whole = rng.choice(SIGNALS), rng.random() < 0.5
        seconds, written = alone[name]
        after = rng.uniform(0, 1.05) * seconds
        what = f"{number.name} to the {'group' if whole else 'process'} after {after:.2f} s"
        for wrong in disturbed(LINES[name], number, whole, after, folder=folder, written=written):
            yield f"{name}, {what}: {wrong}"
        seen[name] += 1
    print(f"{count} signals: {dict(seen)}")


def kills(rng: random.Random, count: int, folder: Path, more: Sequence[str]) -> Iterator[str]:
    """Yield the faults of a sweep that is killed again and again, and then finished."""
    whole = subprocess.run(
        [*LAGTOP, *PARTS.split()[:-2]], cwd=folder, capture_output=True, check=False
    )
    line, done = " ".join([PARTS, *more]), 0
    while done < count:
        subprocess.run(["rm", "-rf", str(folder / "parts")], check=True)
        for _ in range(min(12, count - done)):
            running = start(line, folder)
            time.sleep(rng.uniform(0, 1.2))
            os.kill(running.pid, signal.SIGKILL)
            ended = end_of(running)
            done += 1
            if ended.code not in {-9, 1}:
                yield f"killed: {ended}"
        last = end_of(start(line, folder))
        parts = sorted((folder / "parts").glob("part-*"))
        if b"".join(path.read_bytes() for path in parts) != whole.stdout:
            yield "the parts are not the whole"
        if (last.code, last.stderr) != (whole.returncode, whole.stderr):
            yield f"resumed: {last}, and not {whole.returncode} {whole.stderr!r}"
        if left := [x.name for x in (folder / "parts").iterdir() if x.name.startswith(".")]:
            yield f"leaves {left}"
    print(f"{done} kills{' ' if more else ''}{' '.join(more)}")


def faults(signal_count: int, kill_count: int, seed: int) -> Iterator[str]:
    """Yield the faults of signals to all commands, and of kills of a sweep in parts."""
    rng, half = random.Random(seed), kill_count // 2
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        prepare(folder)
        yield from signals(rng, signal_count, folder)
        yield from kills(rng, kill_count - half, folder, [])
        yield from kills(rng, half, folder, ["--jobs", "2"])


if __name__ == "__main__":
    given = options(__doc__, signals=26, kills=12).parse_args()
    finish(faults(given.signals, given.kills, given.seed))
