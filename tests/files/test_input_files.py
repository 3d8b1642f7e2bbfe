"""Scene files, files of times and of tops, and files as other programs write them."""

from __future__ import annotations

import json
import math
import os
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import ROOT, Lagtop, assert_one_line
from lagtop import Top

import lagrange_cli
from lagrange_cli.top.given import read_scene


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


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"m = 1.{'0' * 5000}", "at most 2000 characters"),
        ("[" * 9000, "not a TOML file"),
        (f"r0 = {'1' * 5000}", "5000 digits"),
        ("r0 = 1\n" + "#" * 20_000, "at most 16384 bytes"),
    ],
)
def test_a_long_text_is_refused_in_a_short_line(
    text: str, said: str, tmp_path: Path, lagtop: Lagtop
) -> None:
    path = scene(tmp_path, text)
    result = lagtop("solve", path)
    assert_one_line(result, 65, path)
    assert said in result.stderr
    assert len(result.stderr) < 500 + len(path)
    recording = tmp_path / "long.csv"
    recording.write_text("t,theta\n" + "0,30\n" * 4000)
    assert "pass a recording to fit or compare" in lagtop("solve", recording).stderr


def test_standard_input_on_windows(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr("os.set_blocking")  # which it lacks before Python 3.12
    assert lagtop("sweep", "-", "--keys", "K", input="r0\n0\n").exit_code == 0


# The files in sample_inputs/files: the worked example at 26 times, or tops


FILES = ROOT / "sample_inputs" / "files"
TOPS = {
    "tops-excel-german.csv": [(477.5, 30.0), (954.9, 30.0), (477.5, 12.5)],
    "tops-pandas.csv": [
        (r0 * 30 / math.pi, tilt) for r0, tilt in ((50, 30), (100, 30), (50, 12.5))
    ],
}
"""Files of tops, with the spin in turns a minute and the tilt of each."""
COLUMNS = {"matlab.txt": "t,theta,psi,phi"}
"""The columns of files without headings."""
RUNS = sorted({x.name for x in FILES.iterdir()} - TOPS.keys())
ROUNDED = 2e-4
"""Radians that two decimals of degrees in three angles may be off."""


def words(path: Path) -> list[str]:
    """Return a file as an argument, with the names of its columns if it has no headings."""
    return [str(path), *(["--columns", COLUMNS[path.name]] if path.name in COLUMNS else [])]


@pytest.mark.parametrize("name", RUNS)
def test_compare_reads_it(name: str, lagtop: Lagtop) -> None:
    result = lagtop("compare", *words(FILES / name), "--format", "json")
    assert result.exit_code == 0, result.stderr
    row = json.loads(result.stdout)["rows"][0]
    assert (row["verdict"], row["rows"]) == ("fine", 26)
    assert row["error_max"] < ROUNDED


@pytest.mark.parametrize("name", TOPS)
def test_its_tops_are_read(name: str, lagtop: Lagtop) -> None:
    wanted = [(rpm * math.pi / 30, tilt) for rpm, tilt in TOPS[name]]
    swept = lagtop("sweep", FILES / name, "--keys", "r0,theta0_deg", "--format", "json")
    assert swept.exit_code == 0, swept.stderr
    found = [(row["r0"], row["theta0_deg"]) for row in json.loads(swept.stdout)]
    assert found == [pytest.approx(x, rel=1e-15) for x in wanted]


@pytest.mark.parametrize("command", ["sweep -", "fit -", "compare -", "table --times -"])
@pytest.mark.parametrize("levels", [30, 600, 1000, 5000])
def test_json_of_many_levels_is_refused(command: str, levels: int, lagtop: Lagtop) -> None:
    for begin, end in (("[", "]"), ('{"t":', "}")):
        text = f"{begin * levels}1{end * levels}"
        for content in (text, f'{{"r0": {text}}}\n'):
            result = lagtop(*command.split(), input=content)
            assert (result.exit_code, result.stderr.count("\n")) == (65, 1), result.stderr


def test_rows_of_json_are_as_long_as_their_names(lagtop: Lagtop) -> None:
    for names, said in (("r0", "row 1: a row must have 1 cells"), ("r0 r0", "each column once")):
        text = json.dumps({"columns": names.split(), "data": [[1, 2]]})
        assert said in lagtop("sweep", "-", input=text).stderr
