"""Sweeps in parts: shards make the whole, and a folder never mixes two sweeps."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from click.testing import Result
from conftest import Lagtop, assert_one_line, joined
from pyarrow import dataset, parquet

from lagrange_cli.errors import UnavailableError
from lagrange_cli.sweeps.parts import _write_new

GRID = ["sweep", "--r0", "1:9:9", "--keys", "r0,K"]


@pytest.fixture(autouse=True)
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make parts of four tops, so that nine tops have three."""
    monkeypatch.setattr("lagrange_cli.sweeps.plan.BLOCK_ROWS", 4)


def test_shards_make_the_whole(tmp_path: Path, lagtop: Lagtop) -> None:
    whole = lagtop(*GRID).stdout_bytes
    for i in (3, 1, 2):
        assert lagtop(*GRID, "--shard", f"{i}/3", "--parts", tmp_path).exit_code == 0
        assert (tmp_path / f"part-{i - 1:06}.csv").exists()
    assert joined(tmp_path) == whole
    assert whole.splitlines()[-1].startswith(b"9.0,")
    alone = [lagtop(*GRID, "--shard", f"{i}/3").stdout.splitlines() for i in (1, 2, 3)]
    assert {lines[0] for lines in alone} == {"r0,K"}
    assert sum(len(lines) - 1 for lines in alone) == 9


def assert_refused(result: Result, folder: Path) -> None:
    assert_one_line(result, 74, f"cannot write {folder}: it holds parts of another sweep")


OTHERS = "--keys u1|--g 0|--rad|--format ndjson|--r0 1:9:8|--theta0 1,2".split("|")


def test_parts_of_another_sweep_are_refused(tmp_path: Path, lagtop: Lagtop) -> None:
    assert lagtop(*GRID, "--shard", "2/3", "--parts", tmp_path).exit_code == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    for options in OTHERS:
        assert_refused(lagtop(*GRID, *options.split(), "--parts", tmp_path), tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    description = tmp_path / "_sweep.json"
    for damage in (lambda: description.write_bytes(b""), description.unlink):
        damage()
        assert_refused(lagtop(*GRID, "--parts", tmp_path), tmp_path)


def test_of_two_sweeps_that_start_together_one_ends(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late(source: Path, target: Path, link: Callable[..., None] = os.link) -> None:
        target.write_text("of the other sweep")  # which was the first to create it
        link(source, target)

    monkeypatch.setattr("os.link", late)
    assert_refused(lagtop(*GRID, "--parts", tmp_path), tmp_path)
    assert [x.name for x in tmp_path.iterdir()] == ["_sweep.json"]


def test_a_damaged_part_is_computed_again(tmp_path: Path, lagtop: Lagtop) -> None:
    lagtop(*GRID, "--parts", tmp_path)
    parts, whole = [tmp_path / f"part-00000{i}.csv" for i in range(3)], joined(tmp_path)
    parts[0].write_bytes(parts[0].read_bytes()[:-5])
    for wrong in ('["a","b"]', "[null,null]", '[-5,"x"]', "[" * 100_000):
        (tmp_path / "_part-000001.json").write_text(wrong)
        again = lagtop(*GRID, "--parts", tmp_path)
        assert (again.exit_code, joined(tmp_path)) == (0, whole)
        assert json.loads((tmp_path / "_part-000001.json").read_text())[1:3] == [4, 4]
    parts[2].unlink()
    parts[2].mkdir()
    assert_one_line(lagtop(*GRID, "--parts", tmp_path), 74, f"cannot write {parts[2]}: Is a dir")


def test_a_sweep_is_resumed_with_its_errors(tmp_path: Path, lagtop: Lagtop) -> None:
    """The exit code and the last line count the errors of all parts, computed now or before."""
    file, parts = tmp_path / "tops.csv", tmp_path / "parts"
    file.write_text("r0\n" + "".join(f"{'x' if i in (3, 5) else i}\n" for i in range(9)))
    options = ["sweep", file, "--keys", "r0"]
    whole, first = lagtop(*options), lagtop(*options, "--parts", parts)
    again = lagtop(*options, "--parts", parts)
    (parts / "part-000001.csv").unlink()
    (parts / "_part-000000.json").write_text("damaged")  # then the part is computed again
    mended = lagtop(*options, "--parts", parts)
    last = "Error: 2 of 9 tops have an error; the first: line 5: r0 must be a finite decimal"
    for result, found in ((whole, 0), (first, 0), (again, 3), (mended, 1)):
        *resumed, said = result.stderr.splitlines()
        assert (result.exit_code, said[: len(last)]) == (1, last)
        assert resumed == ([f"Resumed: parts already in {parts}: {found}"] if found else [])
    assert joined(parts) == whole.stdout_bytes
    file.write_text("r0\n1\n")
    assert_refused(lagtop(*options, "--parts", parts), parts)


def test_a_part_appears_whole_or_not_at_all(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    part, why = tmp_path / "part-000000.csv", "No space left on device"

    def refuse(*_: object) -> None:
        raise OSError(28, why)

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", refuse)
        result = lagtop(*GRID, "--parts", tmp_path)
    assert_one_line(result, 74, f"cannot write {part}: {why}")
    assert [x.name for x in tmp_path.iterdir()] == ["_sweep.json"]


def test_a_folder_without_links_is_a_folder(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    """FAT and some network disks have no hard links."""

    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", refuse)
    for options, code in (([], 0), ([], 0), (["--keys", "u1"], 74)):
        assert lagtop(*GRID, *options, "--parts", tmp_path).exit_code == code
    assert joined(tmp_path) == lagtop(*GRID).stdout_bytes


def test_a_folder_of_parquet_is_a_data_set(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Readers of folders skip the other files; fields have units, and parts one row group."""
    monkeypatch.setattr("lagrange_cli.sweeps.plan.BLOCK_ROWS", 4096)
    grid = "sweep --r0 1:99:140000 --format parquet --keys r0,K,theta_max_rad,path --rad --certify"
    for options in (["--parts", tmp_path], ["-o", tmp_path / "_whole"]):
        assert lagtop(*grid.split(), *options).exit_code == 0
    table = parquet.read_table(tmp_path / "_whole")
    assert dataset.dataset(tmp_path).to_table().equals(table, check_metadata=True)
    units = [(x.metadata or {}).get(b"unit", b"") for x in table.schema]
    assert units == [b"rad/time", b"", b"rad", b"", b"", b"rad"]
    first = parquet.ParquetFile(tmp_path / "part-000000.parquet").metadata
    assert (first.num_row_groups, first.num_rows) == (1, 131_072)
    assert len(pytest.importorskip("pandas").read_parquet(tmp_path)) == 140_000
    some = tmp_path / "part-000001.parquet"
    rows = lagtop("sweep", some, "--rad", "--keys", "r0,K", "--format", "ndjson").stdout
    assert [json.loads(x)["K"] for x in rows.splitlines()] == table["K"].to_pylist()[131_072:]


def test_a_large_part_keeps_the_error_of_a_late_row(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tops of a part are computed in smaller blocks."""
    monkeypatch.setattr("lagrange_cli.sweeps.plan.BLOCK_ROWS", 4096)
    tops, parts = tmp_path / "tops.csv", tmp_path / "parts"
    tops.write_text("r0\n" + "50\n" * 9_000 + "x\n" + "50\n" * 9_000)
    done = lagtop("sweep", tops, "--keys", "K", "--format", "parquet", "--parts", parts)
    assert "1 of 18001 tops have an error; the first: line 9002: r0 must be" in done.stderr
    table = dataset.dataset(parts).to_table()
    assert table["K"].null_count == 1
    assert table["error"].null_count == 18_000


def test_odd_files_in_the_folder_stop_no_run(tmp_path: Path, lagtop: Lagtop) -> None:
    """A FIFO is not read, and what a killed run has half written is written again."""
    description, whole = tmp_path / "_sweep.json", lagtop(*GRID).stdout_bytes
    for _ in range(2):
        assert lagtop(*GRID, "--parts", tmp_path).exit_code == 0
        assert joined(tmp_path) == whole
        half = description.read_bytes()[:20]
        for path in tmp_path.glob("*part*"):
            path.unlink()
        description.write_bytes(half)
        os.mkfifo(tmp_path / "_part-000000.json")
    description.unlink()
    (tmp_path / "_part-000000.json").unlink()

    bad: Any = "no bytes"  # the write fails
    with pytest.raises(TypeError):
        _write_new(description, bad)
    assert not [*tmp_path.iterdir()]
    os.mkfifo(description)
    assert_refused(lagtop(*GRID, "--parts", tmp_path), tmp_path)


def test_a_lost_worker_leaves_parts_that_count(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lost(work: Any, blocks: Any, *_: Any) -> Any:
        yield from map(work, islice(blocks, 2))
        raise UnavailableError("a process was lost")

    said = "a process was lost; 2 of 3 parts are done: repeat the command"
    with monkeypatch.context() as patch:
        patch.setattr("lagrange_cli.sweeps.workers.in_order", lost)
        assert_one_line(lagtop(*GRID, "--parts", tmp_path), 69, said)
    assert f"Resumed: parts already in {tmp_path}: 2" in lagtop(*GRID, "--parts", tmp_path).stderr
    other = lagtop(*GRID, "--keys", "u1", "--parts", tmp_path)
    assert "another sweep, with --keys r0,K; take" in other.stderr
