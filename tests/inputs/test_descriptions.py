"""Descriptions above CSV and in Parquet, written and read back."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import Lagtop, assert_one_line
from lagtop import Top
from pyarrow import parquet

import lagrange_cli
from lagrange_cli.errors import DataError
from lagrange_cli.inputs.scene_file import describe, description_in, difference, scene_in

SCENE = ["--m", "0.35", "--A", "8.5e-4", "--C", "4e-4", "--s", "0.03", "--g", "9.81", "--r0", "200"]
TOP = Top(m=0.35, A=8.5e-4, C=4e-4, s=0.03, g=9.81, r0=200.0, theta0_deg=20.0)


def test_a_scene_is_read_back_as_it_was() -> None:
    steady = Top(r0=60.0, psidot0="steady-fast")
    assert steady.texts()["psidot0"] == "steady-fast"
    for top in (TOP, TOP.replace(theta0_rad=0.1), Top(r0=1e-99, psidot0=-1 / 3), steady):
        told = describe("0.1", top.texts(), None, radians=False)
        again = description_in(f"# {key}: {text}".strip("# ") for key, text in told.items())
        assert again == told
        assert scene_in(again, "file") == top
    exact = Top(r0=Fraction(1, 10))
    assert scene_in(describe("0.1", exact.texts(), None, radians=False), "file") == Top(r0=0.1)


def test_another_program_describes_nothing() -> None:
    assert description_in(["scene: m = 1, A = 2", "units: kg"]) == {}
    assert scene_in({}, "file") is None


@pytest.mark.parametrize("text", ["", "m", "mass = 1", "m = x", "m = -1, A = 2", "m = 1 = 2"])
def test_invalid_scenes_in_descriptions_are_refused(text: str) -> None:
    with pytest.raises(DataError, match=r"^file: the scene in its description is invalid: "):
        scene_in({"scene": text}, "file")


def test_differences() -> None:
    assert difference(TOP, TOP) == ""
    assert difference(TOP.replace(theta0_rad=0.3490658503988659), TOP) == ""
    assert difference(TOP.replace(r0=-200, s=0), TOP) == "s = 0.0, not 0.03; r0 = -200.0, not 200.0"


def test_comments_above_csv(lagtop: Lagtop) -> None:
    words = ["table", *SCENE, "--theta0", "20", "--t-max", "1", "--n", "3"]
    plain, told = lagtop(*words).stdout, lagtop(*words, "--header-comments").stdout
    assert told.endswith(plain)
    lines = told.removesuffix(plain).splitlines()
    assert lines[0] == f"# lagtop: {lagrange_cli.__version__}"
    assert lines[1] == (
        "# scene: m = 0.35, A = 0.00085, C = 0.0004, s = 0.03, g = 9.81, r0 = 200.0, "
        "theta0_deg = 20.0, thetadot0 = 0.0, psidot0 = 0.0"
    )
    assert lines[2] == "# units: those of the scene"
    assert lines[3].startswith("# conventions: angles are in degrees; theta is the tilt")
    assert "angles are in radians" in lagtop(*words[:-6], "--header-comments", "--rad").stdout
    united = ["table", "--units", "si", "--n", "2", "--header-comments"]
    assert "# units: kg, m, s\n" in lagtop(*united).stdout
    digits = lagtop(*words, "--header-comments", "--digits", "20").stdout
    assert digits.splitlines()[:4] == lines
    assert_one_line(
        lagtop(*words, "--header-comments", "--format", "json"),
        2,
        "--header-comments describes CSV and Parquet, got --format json",
    )


def test_parquet_always_has_a_description(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "a.parquet"
    lagtop("table", *SCENE, "--n", "3", "-o", path)
    metadata = parquet.read_schema(path).metadata
    assert metadata[b"lagtop"] == lagrange_cli.__version__.encode()
    assert metadata[b"scene"].startswith(b"m = 0.35, A = 0.00085, ")
    assert {b"units", b"conventions"} < metadata.keys()
    for words in (["--r0", "1:9:3"], ["--r0", "1:9:3", "--jobs", "2"]):
        lagtop("sweep", "--m", "3", *words, "-o", path)
        metadata = parquet.read_schema(path).metadata
        assert metadata[b"shared inputs"].startswith(b"m = 3.0, ")
        assert b"r0" not in metadata[b"shared inputs"]
    lagtop("sweep", "--r0", "1:9:3", "--format", "parquet", "--parts", tmp_path / "out")
    part = parquet.read_schema(tmp_path / "out" / "part-000000.parquet")
    assert b"shared inputs" in part.metadata


def test_sweeps_and_their_parts_have_comments(tmp_path: Path, lagtop: Lagtop) -> None:
    words = ["sweep", "--r0", "1:9:3", "--keys", "r0,a"]
    whole = lagtop(*words, "--header-comments").stdout
    assert whole.startswith("# lagtop: ")
    assert whole.endswith(lagtop(*words).stdout)
    lagtop(*words, "--header-comments", "--parts", tmp_path / "out")
    assert (tmp_path / "out" / "part-000000.csv").read_text() == whole
    other = lagtop(*words, "--parts", tmp_path / "out")
    assert other.exit_code != 0  # the folder belongs to a sweep with comments
    tops = lagtop("table", "--tops", "-", "--n", "2", "--header-comments", input="r0\n3\n").stdout
    assert "# shared inputs: m = 1587.0, " in tops


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_compare_takes_the_scene_of_a_file(ending: str, tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / f"a.{ending}"
    comments = ["--header-comments"] if ending == "csv" else []
    lagtop("table", *SCENE, "--n", "30", "--columns", "t,quaternion", *comments, "-o", path)
    alone = lagtop("compare", path, "--format", "json")
    assert (alone.exit_code, alone.stderr) == (0, "")
    assert "--m 0.35 " in json.loads(alone.stdout)["conditions"]["scene"]
    same = lagtop("compare", path, *SCENE)
    assert (same.exit_code, same.stderr) == (0, "")
    other = lagtop("compare", path, *SCENE[:-1], "-200")
    assert other.exit_code == 1
    warning = f"Warning: {path} describes another scene: r0 = 200.0, not -200.0\n"
    assert other.stderr.startswith(warning)
    another = tmp_path / f"b.{ending}"
    lagtop("table", *SCENE[:-1], "100", "--n", "30", *comments, "-o", another)
    both = lagtop("compare", path, another)
    assert f"{another} describes another scene: r0 = 100.0, not 200.0" in both.stderr


def test_fit_fixes_inputs_of_a_file(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "a.csv"
    words = ["--t-max", "0.5", "--n", "200", "--theta0", "20", "--thetadot0", "1"]
    lagtop("table", *SCENE, *words, "--header-comments", "-o", path)
    found = lagtop("fit", path, "--fix", "m,g,s", "--format", "json")
    assert (found.exit_code, found.stderr.count("Error")) == (0, 0)
    record = json.loads(found.stdout)
    assert (record["m"], record["g"], record["s"]) == (0.35, 9.81, 0.03)
    assert record["A"] == pytest.approx(8.5e-4, rel=1e-6)
