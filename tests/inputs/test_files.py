"""Scene files, files of times and files of tops: what is read, what is refused, what it costs."""

from __future__ import annotations

import json
import os
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, Lagtop, assert_one_line
from lagtop import LagtopError, Top

import lagrange_cli
from lagrange_cli.errors import SceneError
from lagrange_cli.inputs.given import read_scene
from lagrange_cli.inputs.tops_file import read_tops


def scene(folder: Path, text: str) -> str:
    path = folder / "scene.toml"
    path.write_bytes(os.fsencode(text))
    return str(path)


# Scenes


def test_a_scene_is_a_top(tmp_path: Path) -> None:
    path = scene(tmp_path, "r0 = 60\ntheta0_rad = 0.1\n")
    assert lagrange_cli.read_scene(path) == Top(r0=60, theta0_rad=0.1)
    assert read_scene(path, {"r0": 7, "theta0_deg": 3}) == Top(r0=7, theta0_deg=3)
    assert read_scene(path, exact=True).theta0_rad == Fraction(1, 10)
    known = read_scene(str(ROOT / "sample_inputs" / "chrapan-1952.toml"))
    assert known == Top()


def test_errors_name_the_scene_file_or_the_argument(tmp_path: Path) -> None:
    path = scene(tmp_path, "r0 = 60\nm = -1\n")
    with pytest.raises(SceneError, match=r"scene.toml, line 2: m must be > 0, got -1.0$"):
        read_scene(path)
    with pytest.raises(LagtopError, match=r"^A must be > 0") as refused:
        read_scene(path, {"m": 1, "A": -1})
    assert not isinstance(refused.value, SceneError)
    with pytest.raises(SceneError, match="No such file"):
        read_scene(str(tmp_path / "nowhere.toml"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mm = 1", "unknown key 'mm' (did you mean 'm'?) (known: m, A, C"),
        ("theta0 = 1", "theta0 must have a unit, such as '30 deg', or be called theta0_deg"),
        ('r0 = "3"', "r0 must have a unit between quotes, got '3': leave out the quotes"),
        (f"m = 1.{'0' * 5000}", "m must have at most 2000 characters"),
        ("g = 9.81\nm = 1,5\n", "(at line 2, column 6) (write a decimal point, not a comma)\n"),
        ("[" * 9000, "not a TOML file"),
        ("r0 = 1\n" + "#" * 20_000, "must have at most 16384 bytes, has more"),
        ("r0 = 1\n\udcff\udcfe\x00", "line 2: the text must be UTF-8 or UTF-16"),
        ("m = 1\nA == 2\n", "not a TOML file: Invalid value (at line 2, column 4)"),
        ("\nr0 = 'fast'\n", "line 2: r0 must be a finite decimal number, got 'fast'"),
        ("A = 1\nC = 3\n", "line 2: C must be <= 2 A = 2.0, got 3.0"),
        ("theta0_deg = 1\ntheta0_rad = 1\n", "line 2: theta0_rad and theta0_deg are both given"),
    ],
)
def test_invalid_scene_files_are_refused(
    text: str, message: str, tmp_path: Path, lagtop: Lagtop
) -> None:
    path = scene(tmp_path, text)
    result = lagtop("solve", path)
    assert_one_line(result, 65, path)
    assert message in result.stderr
    assert len(result.stderr) < 500 + len(path)


def test_standard_input_is_read_once(lagtop: Lagtop) -> None:
    result = lagtop("table", "-", "--times", "-", input="r0 = 1\n")
    assert_one_line(result, 2, "")
    assert "not both" in result.stderr


def test_a_scene_without_inputs_is_told(tmp_path: Path, lagtop: Lagtop) -> None:
    path = scene(tmp_path, "# nothing yet\n")
    for words in (["solve", path, "--get", "r0"], ["sweep", path, "--keys", "r0"]):
        result = lagtop(*words)
        assert result.exit_code == 0
        assert result.stderr == (f"Warning: {path} has no inputs: using the worked example\n")


@pytest.mark.parametrize(
    "line",
    ["solve FILE.toml", "sweep FILE.csv", "compare FILE.csv", "table --times FILE"],
)
def test_a_file_that_cannot_be_read_ends_with_65(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lagtop: Lagtop
) -> None:
    monkeypatch.chdir(tmp_path)
    name = line.rsplit(maxsplit=1)[-1]
    assert_one_line(lagtop(*line.split()), 65, f"{name}: No such file or directory")
    Path(name).mkdir()
    assert_one_line(lagtop(*line.split()), 65, f"{name}: Is a directory")


# Times


def test_a_time_out_of_reach(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "times.txt"
    path.write_text("1\n2\n1e30\n")
    result = lagtop("table", "--times", path)
    assert_one_line(result, 65, f"{path}: t must be finite and within 2^50 periods")


# Tables as text: one grammar for tops, times and trajectories


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_extra_columns_are_copied_with_any_delimiter(
    delimiter: str, tmp_path: Path, lagtop: Lagtop
) -> None:
    path = tmp_path / "file"
    rows = [["r0", "theta0_deg", "id"], ["40", "30", '"x, y; z"'], ["50", "60", "w"]]
    lines = [delimiter.join(row) for row in rows]
    path.write_text("\ufeff# measured\r\n" + "\r\n\r\n# more\r\n".join(lines))
    assert lagtop("sweep", path, "--keys", "r0,theta0_deg").stdout == (
        'id,r0,theta0_deg,error\n"x, y; z",40.0,30.0,\nw,50.0,60.0,\n'
    )


# Tops


def test_a_file_without_tops_is_told(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "tops.csv"
    path.write_text("r0\n")
    for words, header in (
        (["sweep", path, "--keys", "k"], "k,error\n"),
        (["sweep", path, "--keys", "k", "--format", "json"], "[]\n"),
    ):
        result = lagtop(*words)
        assert (result.exit_code, result.stdout) == (0, header)
        assert result.stderr == f"Warning: {path} holds no tops\n"
    shard = lagtop("sweep", path, "--shard", "2/2")
    assert (shard.exit_code, shard.stderr) == (0, "")


def test_keys_of_json_rows_may_differ(tmp_path: Path) -> None:
    path = tmp_path / "tops.ndjson"
    rows = [{"id": 4, "r0": 4}, {"id": 5, "r0": 5, "T_nutation": 1}, {"theta0_deg": 6, "name": "x"}]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    file = read_tops(str(path), {"T_nutation"})
    assert file.carried == ["id", "name"]
    shared = {"r0": 9.0, "theta0_rad": 1.0}
    first, second = (block.arrays(shared) for block in file.blocks(2))
    assert (first.lines, second.lines) == ([1, 2], [3])
    assert (first.carried, second.carried) == ([(4, 5), (None, None)], [(None,), ("x",)])
    given = {name: float(np.asarray(x)[0]) for name, x in second.inputs.items()}
    merged = {name: x for name, x in given.items() if not np.isnan(x)}
    assert merged == {"r0": 9.0, "theta0_deg": 6.0}
    assert np.asarray(first.inputs["r0"]).tolist() == [4, 5]
