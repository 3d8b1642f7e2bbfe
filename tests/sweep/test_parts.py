"""Sweeps in parts: shards make the whole, and a folder never mixes two sweeps."""

from __future__ import annotations

import json
import os
import pickle
import signal
import subprocess
import time
from pathlib import Path

import pytest
from conftest import LAGTOP, Lagtop, assert_one_line, joined

from lagrange_cli.errors import CannotWriteError
from lagrange_cli.inputs.ranges import parse_values
from lagrange_cli.sweep.folder import Folder
from lagrange_cli.sweep.plan import plan


def test_shards_make_the_whole(tmp_path: Path, lagtop: Lagtop) -> None:
    options = ["sweep", "--r0", "1:100:3000", "--theta0", "10,20,30", "--keys", "r0,nome"]
    whole = lagtop(*options).stdout_bytes
    for i in (3, 1, 2):
        assert lagtop(*options, "--shard", f"{i}/3", "--parts", tmp_path).exit_code == 0
        assert (tmp_path / f"part-{i - 1:06}.csv").exists()
    parts = sorted(tmp_path.glob("part-*"))
    assert [part.name for part in parts] == [f"part-00000{i}.csv" for i in range(3)]
    assert b"".join(part.read_bytes() for part in parts) == whole
    alone = [lagtop(*options, "--shard", f"{i}/3").stdout.splitlines() for i in (1, 2, 3)]
    assert {lines[0] for lines in alone} == {"r0,nome"}
    assert sum(len(lines) - 1 for lines in alone) == 9000


def test_shards_of_a_file(tmp_path: Path, lagtop: Lagtop) -> None:
    file = tmp_path / "tops.ndjson"
    file.write_text("".join(f'{{"id": {i}, "r0": {i / 100}}}\n' for i in range(9000)))
    options = ["sweep", file, "--keys", "T_nutation", "--format", "ndjson"]
    whole = lagtop(*options).stdout_bytes
    parts = tmp_path / "parts"
    for i in (1, 2):
        lagtop(*options, "--shard", f"{i}/2", "--parts", parts)
    assert b"".join(part.read_bytes() for part in sorted(parts.glob("part-*"))) == whole


NINES = "9" * 5000


@pytest.mark.parametrize(
    "text", ["0/3", "4/3", "1", "a/b", "1/0", "-1/3", f"1/{NINES}", f"{NINES}/1", "\u0661/2"]
)
def test_wrong_shard(text: str, lagtop: Lagtop) -> None:
    result = lagtop("sweep", "--shard", text)
    assert result.exit_code == 2
    assert "--shard must be I/N" in result.stderr


def test_parts_that_cannot_be(tmp_path: Path, lagtop: Lagtop) -> None:
    (tmp_path / "file").write_text("")
    assert lagtop("sweep", "--parts", tmp_path / "file").exit_code == 74
    assert lagtop("sweep", "--parts", tmp_path, "-o", "x").exit_code == 2
    assert lagtop("sweep", "--parts", tmp_path, "--format", "json").exit_code == 2


LONG_FILE = "r0\n" + "".join(f"{i + 1}\n" for i in range(9000))
SHORT_FILE = "".join(line + "\n" for line in LONG_FILE.splitlines()[:5001])


@pytest.mark.parametrize(
    ("options", "difference"),
    [
        (["--keys", "r0,T_nutation"], "keys r0,K there and r0,T_nutation here"),
        (["--keys", "K,r0"], "keys r0,K there and K,r0 here"),
        (["--keys", "r0,K", "--g", "0"], "g 981.0 there and 0.0 here"),
        (["--keys", "r0,K", "--rad"], "radians False there and True here"),
        (["--keys", "r0,K", "--format", "ndjson"], "format csv there and ndjson here"),
        (["--keys", "r0,K", "--r0", "1:9:5001"], "r0 1:9:5000 there and 1:9:5001 here"),
        (["--keys", "r0,K", "--r0", "1:9:10"], "r0 1:9:5000 there and 1:9:10 here"),
        (["--keys", "r0,K", "--r0", "1:8:5000"], "r0 1:9:5000 there and 1:8:5000 here"),
        (["--keys", "r0,K", "--theta0", "1,2"], "theta0_deg 30.0 there and 1,2 here"),
    ],
)
def test_parts_of_another_sweep_are_refused(
    options: list[str], difference: str, tmp_path: Path, lagtop: Lagtop
) -> None:
    begin = ["sweep", "--parts", tmp_path, "--r0", "1:9:5000"]
    assert lagtop(*begin, "--keys", "r0,K", "--shard", "2/2").exit_code == 0
    result = lagtop(*begin, *options, "--shard", "1/2")
    assert (result.exit_code, result.stdout) == (74, "")
    assert result.stderr == (
        f"Error: cannot write {tmp_path}: it holds parts of another sweep, {difference}; "
        "take another folder or empty this one\n"
    )
    assert [path.name for path in tmp_path.glob("part-*")] == ["part-000001.csv"]


def test_parts_of_another_version_are_refused(tmp_path: Path, lagtop: Lagtop) -> None:
    options = ["sweep", "--keys", "r0", "--parts", tmp_path]
    lagtop(*options)
    description = json.loads((tmp_path / "sweep.json").read_text())
    (tmp_path / "sweep.json").write_text(json.dumps(description | {"lagtop": "0.0.9"}))
    assert "lagtop 0.0.9 there and" in lagtop(*options).stderr


def test_parts_without_a_description_are_refused(tmp_path: Path, lagtop: Lagtop) -> None:
    (tmp_path / "part-000000.csv").write_text("r0\n1\n")
    result = lagtop("sweep", "--keys", "r0", "--parts", tmp_path)
    assert result.exit_code == 74
    assert "part-000000.csv is there without a sweep.json" in result.stderr
    assert (tmp_path / "part-000000.csv").read_text() == "r0\n1\n"


def test_a_run_that_agrees_keeps_whole_parts_and_their_errors(
    tmp_path: Path, lagtop: Lagtop
) -> None:
    file = tmp_path / "tops.csv"
    file.write_text("r0\n" + "".join(f"{'x' if i % 3000 == 1 else i}\n" for i in range(9000)))
    options = ["sweep", file, "--keys", "T_nutation", "--parts", tmp_path / "out"]
    first = lagtop(*options)
    assert first.exit_code == 1
    assert first.stderr.startswith("Error: 3 of 9000 tops have an error; the first: line 3: r0")
    whole = joined(tmp_path / "out")
    (tmp_path / "out" / "part-000001.csv").unlink()
    kept = tmp_path / "out" / "part-000000.csv"
    kept.write_bytes(kept.read_bytes() + b"kept")
    again = lagtop(*options)
    resumed = f"Resumed: 2 parts were already in {tmp_path / 'out'}\n"
    assert (again.exit_code, again.stderr) == (1, resumed + first.stderr)
    assert joined(tmp_path / "out").replace(b"kept", b"") == whole
    assert kept.read_bytes().endswith(b"kept")


@pytest.mark.slow
def test_a_killed_run_is_resumed(tmp_path: Path, lagtop: Lagtop) -> None:
    """Five runs are killed in the middle; what they leave is finished by the sixth."""
    options = ["sweep", "--r0", "1:100:200000", "--keys", "r0,T_nutation"]
    options += ["--parts", str(tmp_path / "out")]
    parts = 0
    for _ in range(5):
        running = subprocess.Popen([*LAGTOP, *options])
        while running.poll() is None and len(list(tmp_path.glob("out/part-*"))) < parts + 3:
            time.sleep(0.001)
        running.kill()
        assert running.wait() == -signal.SIGKILL
        parts = len(list(tmp_path.glob("out/part-*")))
    left = tmp_path / "out" / f".lagtop-{running.pid}@{os.uname().nodename}@x"
    left.write_bytes(b"half")  # as a killed run leaves it, at times
    before = {path: path.stat().st_mtime_ns for path in tmp_path.glob("out/part-*")}
    assert len(before) < 49
    assert lagtop(*options).exit_code == 0
    assert all(path.stat().st_mtime_ns == time for path, time in before.items())
    assert joined(tmp_path / "out") == lagtop(*options[:-2]).stdout_bytes
    assert [path.name for path in (tmp_path / "out").iterdir() if path.name[0] == "."] == []


def test_leftovers_of_this_machine_alone_are_removed(tmp_path: Path, lagtop: Lagtop) -> None:
    """Files of running processes stay, and all files of other machines, which may be in use."""
    ended = subprocess.Popen(["true"])
    ended.wait()
    host = os.uname().nodename
    marks = f"{ended.pid}@{host}@x", f"{os.getpid()}@{host}@x", f"{ended.pid}@elsewhere@x", "x"
    ours, *others = (tmp_path / f".lagtop-{mark}" for mark in marks)
    for path in (ours, *others):
        path.write_bytes(b"")
    assert lagtop("sweep", "--parts", tmp_path).exit_code == 0
    assert sorted(tmp_path.glob(".lagtop-*")) == sorted(others)


@pytest.mark.slow
def test_two_runs_at_once(tmp_path: Path, lagtop: Lagtop) -> None:
    """Two shards and two runs of the whole, all at once, and then nothing is left to do."""
    options = ["sweep", "--r0", "1:100:60000", "--keys", "r0,nome"]
    out = ["--parts", str(tmp_path / "out")]
    commands = [
        [*options, *out, *more] for more in (["--shard", "1/2"], ["--shard", "2/2"], [], [])
    ]
    running = [subprocess.Popen([*LAGTOP, *command]) for command in commands]
    assert [process.wait() for process in running] == [0] * 4
    assert joined(tmp_path / "out") == lagtop(*options).stdout_bytes
    assert {path.name[0] for path in (tmp_path / "out").iterdir()} == {"p", "s"}


@pytest.mark.slow
def test_of_two_sweeps_at_once_one_is_refused(tmp_path: Path) -> None:
    """Many times, since it is the claim that they race for."""
    for i in range(8):
        out = tmp_path / str(i)
        begin = [*LAGTOP, "sweep", "--parts", str(out), "--r0"]
        running = [
            subprocess.Popen([*begin, spin], stderr=subprocess.DEVNULL) for spin in ("1", "2")
        ]
        assert sorted(process.wait() for process in running) == [0, 74]


def test_a_file_system_without_links(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise OSError(1, "Operation not permitted")

    monkeypatch.setattr("os.link", refuse)
    assert lagtop("sweep", "--r0", "1", "--parts", tmp_path).exit_code == 0
    assert lagtop("sweep", "--r0", "2", "--parts", tmp_path).exit_code == 74


@pytest.mark.parametrize("fmt", ["csv", "ndjson", "json"])
def test_fail_fast_prints_the_rows_before_the_error(fmt: str, lagtop: Lagtop) -> None:
    options = ["sweep", "-", "--keys", "r0", "--format", fmt]
    text = "r0\n" + "".join(f"{i}\n" for i in range(1, 4500))
    whole = lagtop(*options, input=text)
    cut = lagtop(*options, "--fail-fast", input=text + "x\n7\ny\n")
    assert (whole.exit_code, cut.exit_code) == (0, 1)
    assert cut.stdout == whole.stdout
    assert cut.stderr.startswith("Error: line 4501: r0 must be")
    first = lagtop(*options, "--fail-fast", input="r0\nx\n")
    assert first.stdout == {"csv": "r0,error\n", "ndjson": "", "json": "[]\n"}[fmt]


def test_fail_fast_says_nothing_of_a_sweep_without_errors(lagtop: Lagtop) -> None:
    assert lagtop("sweep", "--r0", "1,2", "--fail-fast").exit_code == 0


def test_a_part_is_written_where_its_folder_is_seen(tmp_path: Path) -> None:
    """What a worker does; it sees the token of the run, or it sends the part back."""
    todo = plan([], {"r0": parse_values("1:9:9")}, keys=["r0", "K"], described=True)
    folder = Folder(str(tmp_path), todo.sweep, todo.description)
    block = next(todo.blocks)
    with folder.made_by_workers() as make:
        written = make(block)
    sent = make(block)  # the run is over
    assert (written.text, written.is_written, sent.is_written) == (b"", True, False)
    assert (tmp_path / "part-000000.csv").read_bytes() == b"r0,K\n" + sent.text
    assert sorted(path.name for path in tmp_path.iterdir()) == ["part-000000.csv", "sweep.json"]
    full = tmp_path / "part-000001.csv"
    full.symlink_to("/dev/full")
    with (
        folder.made_by_workers() as make,
        pytest.raises(
            CannotWriteError, match=r"part-000001\.csv: No space left on device"
        ) as error,
    ):
        make((1, block[1]))
    assert str(pickle.loads(pickle.dumps(error.value))) == str(error.value)


FIVE = "r0\n" + "".join(f"{'x' if i == 3 else i + 1}\n" for i in range(5))
"""Tops of which one has an error."""


@pytest.mark.parametrize(
    "content", [b"", b"nothing", b"[]", b"\xff\xfe", b"{" * 100_000, b"[" * 100_000]
)
def test_a_damaged_description_is_refused(content: bytes, tmp_path: Path, lagtop: Lagtop) -> None:
    options = ["sweep", "--keys", "r0", "--parts", tmp_path]
    lagtop(*options)
    (tmp_path / "sweep.json").write_bytes(content)
    said = f"cannot write {tmp_path}: sweep.json describes no sweep"
    assert_one_line(lagtop(*options), 74, said)
