"""Broken, hostile and unusual files: one line and 65, and memory that does not grow with claims."""

from __future__ import annotations

import json
import os
import resource
from pathlib import Path

import numpy as np
import pyarrow
import pytest
from conftest import ROOT, Lagtop, assert_one_line, forked, process
from hostile_files import CSV, GOOD, HOSTILE, damaged, npy, npz, saved

from lagrange_cli.inputs import tops_file, trajectory_arrays

SAID = {
    "npz that is encrypted": "not an npz file: File 't.npy' is encrypted",
    "npz by method 99": "not an npz file: That compression method is not supported",
    "npz with damaged lzma": "not an npz file: ",
    "npz of text": "not an npz file: ",
    "npz of pickles": "array t must be an array of real numbers",
    "npz of many members": "must have at most 1000 arrays, got 5001",
    "npz of a bomb in Fortran order": "an array in Fortran order in an npz file must have at most",
    "npy of minus signs": "not an npy file: ",
    "npy of brackets": "not an npy file: ",
    "npy with an open text": "not an npy file: ",
    "npy of a call": "not an npy file: malformed node",
    "npy with a negative size": "must be an array of real numbers with 1 or 2 dimensions",
    "npy of 1e12 rows": "must have columns among",
    "npy of 1e23 rows in Fortran order": "must hold 1" + "0" * 23 + " rows, but ends early",
    "npy of 1e12 rows in Fortran order": "must hold 1000000000000 rows, but ends early",
    "npy of 1e9 columns": "a row must have at most 1048576 bytes",
    "npy with a field of 2e8 numbers": "a row must have at most 1048576 bytes",
    "npy with a field of no number": "must be an array of real numbers with 1 or 2 dimensions",
    "parquet with one name twice": "must name each column once, got 'theta' twice",
    "parquet of nested lists": "must have columns among",
    "a line without end": "line 1: a line must have less than 1048576 bytes",
}


@pytest.mark.parametrize("title", SAID)
@pytest.mark.parametrize("command", ["compare", "fit"])
def test_each_is_one_line(command: str, title: str, tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "file"
    path.write_bytes(HOSTILE[title]())
    words = ["--columns", "t,theta"] if title in {"npy of 1e12 rows"} else []
    result = lagtop(command, path, *words)
    said = "must hold 1000000000000 rows, but ends early" if words else SAID[title]
    assert_one_line(result, 65, str(path))
    assert said in result.stderr


@pytest.mark.parametrize("form", ["npz", "npz by lzma", "npy", "npy with names", "parquet"])
def test_damaged_files_never_end_otherwise(form: str, tmp_path: Path, lagtop: Lagtop) -> None:
    """Some are still read: a byte of a number is another one."""
    path, content = tmp_path / "file", GOOD[form]()
    codes = set()
    for seed in range(60):
        path.write_bytes(damaged(content, seed))
        result = lagtop("compare", path, "--theta0", 30)
        codes.add(result.exit_code)
        if result.exit_code == 65:
            assert_one_line(result, 65, str(path))
        assert result.exit_code in {0, 1, 65}, result.exception
    assert 65 in codes


@pytest.mark.skipif(int(pyarrow.__version__.partition(".")[0]) < 20, reason="it cannot read them")
def test_lists_that_are_missing_are_missing_numbers(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "a.parquet"
    path.write_bytes(HOSTILE["parquet of lists with null"]())
    result = lagtop("compare", path, "--format", "json")
    assert result.exit_code == 1
    assert json.loads(result.stdout)["rows"][0]["lost_at"] == 1.0


def test_fortran_order_is_mapped(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rows of a file and of a pipe are those of an array; an npz file holds it up to a size."""
    monkeypatch.chdir(tmp_path)
    table = np.stack([np.linspace(0, 1, 40), np.full(40, 30.0)], axis=1)
    words = ["--columns", "t,theta", "--format", "json"]
    for rows_at_once in (1 << 15, 7):
        monkeypatch.setattr(trajectory_arrays, "ROWS_AT_ONCE", rows_at_once)
        found = []
        for array in (table, np.asfortranarray(table)):
            np.save("a.npy", array)
            found.append(json.loads(lagtop("compare", "a.npy", *words).stdout)["rows"])
        assert found[0] == found[1]
        assert found[0][0]["rows"] == 40
        if rows_at_once > 40:
            content = Path("a.npy").read_bytes()
            piped = process("compare", "-", *words, check=False, input=content)
            assert [x | {"file": "a.npy"} for x in json.loads(piped.stdout)["rows"]] == found[0]


def test_the_largest_array_in_fortran_order_of_npz(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.npz"
    axis = np.asfortranarray(np.tile([0.0, 0.6, 0.8], (40, 1)))
    path.write_bytes(npz(t=npy(np.linspace(0, 1, 40)), axis=npy(axis)))
    monkeypatch.setattr(trajectory_arrays, "LARGEST_WHOLE", axis.nbytes)
    assert lagtop("compare", path, "--exit-zero").exit_code == 0
    monkeypatch.setattr(trajectory_arrays, "LARGEST_WHOLE", axis.nbytes - 1)
    assert_one_line(lagtop("compare", path), 65, f"{path}, array axis: an array in Fortran order")


def test_npz_files_by_other_methods_are_read(tmp_path: Path, lagtop: Lagtop) -> None:
    for title in ("npz by bzip2", "npz by lzma"):
        path = tmp_path / "a.npz"
        path.write_bytes(HOSTILE[title]())
        assert lagtop("compare", path, "--exit-zero").exit_code == 0


def test_a_file_without_line_ends_takes_no_memory(tmp_path: Path) -> None:
    """The file is /dev/zero, and a process may have 600 MB more than it starts with."""
    zeros = "/dev/zero"
    lines = ["sweep", "table --times", "table --tops", "compare", "fit", "solve"]
    limit = f"""if True:
        import resource
        used = int(open("/proc/self/statm").read().split()[0]) * {resource.getpagesize()}
        resource.setrlimit(resource.RLIMIT_AS, (used + 600_000_000,) * 2)
        os.dup2(os.open("{zeros}", os.O_RDONLY), 0)
    """
    words = [*(f"{line} {zeros}" for line in lines), "sweep -"]
    for word, end in zip(
        words,
        forked(words, tmp_path, before="import numpy, scipy.optimize", each=limit),
        strict=True,
    ):
        name = "standard input" if word.endswith("-") else zeros
        assert (end.code, end.stdout) == (65, b""), word
        assert end.stderr.startswith(f"Error: {name}".encode()), word
        assert end.stderr.count(b"\n") == 1, word


def test_lines_that_are_kept_are_bounded(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "tops.csv"
    path.write_text("r0,note\n" + f"40,{'x' * 95}\n" * 9)
    monkeypatch.setattr(tops_file, "LARGEST_BLOCK", 900)
    assert lagtop("sweep", path, "--keys", "r0").exit_code == 0
    monkeypatch.setattr(tops_file, "LARGEST_BLOCK", 890)
    result = lagtop("sweep", path, "--keys", "r0")
    assert_one_line(result, 65, f"{path}, line 10: 4096 lines must have at most 890 bytes")


def test_a_header_of_many_columns_is_read_at_once(tmp_path: Path, lagtop: Lagtop) -> None:
    """The time must not grow with the square of their number: it took minutes."""
    path = tmp_path / "tops.csv"
    path.write_text("r0," + ",".join(f"x{i}" for i in range(100_000)) + "\n")
    assert lagtop("sweep", path, "--keys", "r0").exit_code == 0


def test_an_object_of_many_keys_is_read_at_once(tmp_path: Path, lagtop: Lagtop) -> None:
    """The time must not grow with the square of their number: it took a minute."""
    path = tmp_path / "run.ndjson"
    path.write_text("{" + ",".join(f'"k{i}": 1' for i in range(100_000)) + "}\n")
    result = lagtop("compare", path)
    assert (result.exit_code, result.stderr.count("\n")) == (65, 1)


def test_times_that_are_far_apart(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"t,theta\n-1.7e308,30\n1.7e308,31\n")
    assert_one_line(lagtop("fit", path), 65, f"{path} must have 12 rows or more, got 2")
    path.write_bytes(b"t,theta\n1.7e308,30\n-1.7e308,31\n1.7e308,30\n")
    wrong = "line 4: t must not turn back, got 1.7e+308 after -1.7e+308"
    assert_one_line(lagtop("fit", path), 65, f"{path}, {wrong}")


def test_file_names_that_are_not_utf8(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    name = os.fsdecode(b"\xff.csv")
    Path(name).write_bytes(CSV)
    for form in ("json", "csv"):
        shown = lagtop("compare", name, "--exit-zero", "--format", form).stdout
        assert "udcff.csv" in shown
        assert json.loads(shown)["rows"][0]["file"] == "\\udcff.csv" if form == "json" else True
    done = process("compare", name, "--exit-zero", "--format", "table")
    assert "udcff.csv" in done.stdout.decode()
    assert b"Traceback" not in done.stderr


def test_a_scene_from_a_file_name_that_is_not_utf8(
    tmp_path: Path, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    name = os.fsdecode(b"\xff\x7f.csv")
    Path(name).write_bytes((ROOT / "sample_inputs" / "recording.csv").read_bytes())
    done = lagtop("fit", name, "-o", "found.toml")
    assert done.exit_code == 0
    assert done.stderr.startswith("Note: found.toml has assumed inputs")
    assert done.stderr.count("\n") == 1
    assert lagtop("solve", "found.toml").exit_code == 0


def test_the_generator_makes_what_it_says() -> None:
    assert saved(lambda stream: np.save(stream, np.zeros(2))) == npy(np.zeros(2))
    assert len({make() for make in HOSTILE.values()}) == len(HOSTILE)
