"""Recordings as loggers write them: what is read, what is said of it, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
import recordings
from conftest import Lagtop
from lagtop import Top, compare, fit, solve
from pyarrow import parquet
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from lagrange_cli.arithmetic.types import Array
from lagrange_cli.errors import DataError
from lagrange_cli.recordings.doubts import check_position, pivot_of, why_radians
from lagrange_cli.recordings.options import Reading
from lagrange_cli.recordings.reading import read_recording
from lagrange_cli.recordings.recording import Recording, recording_of
from lagrange_cli.solver.columns import COLUMNS

TOP = Top(m=0.3, s=0.04, g=9.81, A=8e-4, C=5e-4, theta0_deg=25, r0=120, psidot0=4, thetadot0=1)
OPTIONS = "--m .3 --s .04 --g 9.81 --A 8e-4 --C 5e-4 --theta0 25 --r0 120 --psidot0 4".split()
OPTIONS += ["--thetadot0", "1"]
MOTION, T = solve(TOP), np.arange(201) / 100
ANGLES = MOTION.angles(T)
QUATERNION = np.stack([*MOTION.table(T, ["quaternion"]).values()], axis=1)
AXIS = np.stack([*MOTION.table(T, ["axis"]).values()], axis=1)
TURNS = Rotation.from_quat(QUATERNION, scalar_first=True)


def read(path: Path, content: str, columns: list[str] | None = None, **options: Any) -> Recording:
    (path / "file").write_text(content, "utf-8")
    return read_recording(str(path / "file"), Reading.of(columns=columns, **options))


LISTS: dict[str, Any] = {"t": [0, 1], "q": [[1, 0, 0, 0], [0.8, 0.6, 0, 0]]}


@pytest.mark.parametrize(
    ("content", "columns"),
    [
        (json.dumps(LISTS), None),
        (json.dumps({"rate": 50, "names": ["a"], "data": LISTS}, indent=1), None),
        (json.dumps({"rows": [{"t": 0, "q": LISTS["q"][0]}, {"t": 1, "q": LISTS["q"][1]}]}), None),
        (json.dumps([[t, *q] for t, q in zip(*LISTS.values(), strict=True)]), "t,quaternion"),
        ("DataRate=9\nendheader\ntime\timu\n0\t1,0,0,0\n1\t0.8,0.6,0,0\n", "t,quaternion"),
        ("time\tquaternion\n0\t1,0,0,0\n1\t0.8,0.6,0,0\n", None),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 5 0 .28 -.96 5 0 .96 .28 5\n", "pose"),
        ("Time of day,qw (1),qx,qy,qz\n0,1,0,0,0\n1,.8,.6,0,0\n", "t,quaternion"),
    ],
)
def test_quaternions_in_many_forms(content: str, columns: str | None, tmp_path: Path) -> None:
    names = columns.split(",") if columns else None
    found = read(tmp_path, content, names, dt=1.0 if columns == "pose" else None)
    assert found.t.tolist() == [0, 1]
    assert found.observed().quaternion == pytest.approx(np.array(LISTS["q"]))


@pytest.mark.parametrize("mark", [",", ";", "\t", " "])
@pytest.mark.parametrize("word", ["NA", "NULL", "#N/A", "null", "-"])
def test_words_for_missing_cells(mark: str, word: str, tmp_path: Path) -> None:
    rows = ["t theta psi", "0 1 2", f"1 {word} 3", f"2 4 {word}", "3 5 6", f"{word} {word} {word}"]
    found = read(tmp_path, "\n".join(rows).replace(" ", mark))
    assert found.missing.tolist() == [False, True, True, False]
    assert np.isnan(found.given["theta"]).ravel().tolist() == [False, True, False, False]


def test_binary_tables_are_columns(tmp_path: Path, lagtop: Lagtop) -> None:
    """A column of texts is copied; an error has the number of a row, not of a line."""
    savemat(tmp_path / "a.mat", {"log": {"t": T, "q": QUATERNION, "note": "x"}})
    savemat(tmp_path / "b.mat", {"matrix": np.column_stack([T, QUATERNION])})
    parquet.write_table(pa.table({"time": [*map(str, T)], "theta": ANGLES.theta}), tmp_path / "c")
    for name, more in (("a.mat", []), ("b.mat", ["--columns", "t,quaternion"]), ("c", ["--rad"])):
        options = [x if x != "25" or "--rad" not in more else "0.4363323129985824" for x in OPTIONS]
        assert lagtop("compare", tmp_path / name, *options, *more).exit_code == 0
    columns = {"r0": [10.0, None, -1.0], "theta0_deg": [30, 40, 500], "run": ["a", "b", "a"]}
    parquet.write_table(pa.table(columns), tmp_path / "tops")
    savemat(tmp_path / "tops.mat", {"r0": [10.0, 50.0], "theta0_deg": [30.0, 40.0]})
    swept = lagtop("sweep", tmp_path / "tops", "--keys", "b")
    rows = swept.stdout.splitlines()
    assert [x.split(",")[0] for x in rows] == ["run", "a", "b", "a"]
    assert ["theta0_deg must be" in x for x in rows] == [False, False, False, True]
    swept = lagtop("sweep", tmp_path / "tops.mat", "--keys", "b", "--jobs", "2")
    assert len(swept.stdout.splitlines()) == 3
    parquet.write_table(pa.table({"t": [0.0, 1.0, 0.5], "theta": [1.0, 2.0, 3.0]}), tmp_path / "d")
    with pytest.raises(DataError, match="d, row 3: t must not turn back"):
        read_recording(str(tmp_path / "d"), Reading())
    parquet.write_table(pa.table({"t": [0.1, 0.2]}), tmp_path / "times")
    table = lagtop("table", "--times", tmp_path / "times", "--columns", "t")
    assert table.stdout == "t\n0.1\n0.2\n"


def csv(heading: str, *columns: Array) -> str:
    rows = np.column_stack([T, *columns]).tolist()
    return "\n".join([heading, *(",".join(f"{x:.6g}" for x in row) for row in rows)])


def test_what_was_read_is_said_alike(tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "a.csv"
    path.write_text(csv("t [s],x (cm),y (cm),z (cm),T", 12 * AXIS, 20 + T))
    words = ["compare", path, *OPTIONS, "--format", "json"]
    compared = json.loads(lagtop(*words).stdout)["rows"][0]
    fitted = json.loads(lagtop("fit", path, "--format", "json").stdout)
    keys = ("columns", "unused", "read")
    assert [compared[x] for x in keys] == [fitted[x] for x in keys]
    assert fitted["unused"] == "T"  # beside another time it is a temperature
    marker = "x (cm), y (cm), z (cm): position of a marker on the axis, in cm, 0.12 from the origin"
    assert fitted["read"] == f"time: column t [s], in s; {marker}"
    assert (
        f"\nread       time: column t [s], in s\n           {marker}\n"
        in lagtop("fit", path).stdout
    )
    assert f"Read {marker}.\n" in lagtop("compare", path, *OPTIONS).stdout


def test_angles_in_radians_are_known_by_their_turns(tmp_path: Path) -> None:
    """They jump by a whole turn, or, beyond pitch 90, by half a turn that is none in space."""
    euler = TURNS.as_euler("xyz")
    lines = read(tmp_path, csv("t,roll,pitch,yaw", euler)).source.lines
    assert lines[1].endswith("xyz, in radians (they jump by 6.28)")
    assert (
        read(tmp_path, csv("t,roll,pitch,yaw", np.degrees(euler))).source.lines[1].endswith("rees")
    )
    slow = Rotation.from_euler("yx", np.column_stack([1 + T / 2, 0 * T + 1e-3])).as_euler("xyz")
    assert np.abs(np.diff(slow, axis=0)).max() < 4
    assert why_radians({"euler": slow}, Reading()) == "only so do they turn smoothly"
    small = Rotation.from_euler("xyz", 0.1 * np.sin(np.outer(T, [3, 4, 5])))
    assert why_radians({"euler": small.as_euler("xyz", degrees=True)}, Reading()) == ""


def test_rates_are_no_position(tmp_path: Path, lagtop: Lagtop) -> None:
    rates = np.stack([*MOTION.table(T, [*"pqr"]).values()], axis=1)
    (tmp_path / "a.csv").write_text(csv("time,x,y,z", rates))
    refused = lagtop("fit", tmp_path / "a.csv")
    assert (refused.exit_code, "lie in a plane, not on a sphere" in refused.stderr) == (65, True)
    rng = np.random.default_rng(0)
    with pytest.raises(DataError, match="off the nearest sphere"):
        check_position(rng.normal(size=(201, 3)))
    for noise in (0, 1e-3, 0.02):
        check_position(AXIS + noise * rng.normal(size=AXIS.shape))
        check_position(AXIS + [3, 2, -1] + noise * rng.normal(size=AXIS.shape))
    slipping = AXIS * np.linspace(1, 1.5, 201)[:, np.newaxis]
    assert (compare(MOTION, T, position=slipping).pivot_slip or 0) == pytest.approx(0.5)


def test_a_marker_from_above(tmp_path: Path, lagtop: Lagtop) -> None:
    """Its circle is not about the origin, and nutation makes it no circle."""
    marks = 120 * AXIS[:, :2] + [300, 200] + np.random.default_rng(1).normal(0, 0.3, (201, 2))
    (tmp_path / "a.csv").write_text(csv("t,x,y", marks))
    failed = lagtop("fit", tmp_path / "a.csv")
    assert (failed.exit_code, "give --theta0" in failed.stderr) == (65, True)
    found = json.loads(lagtop("fit", tmp_path / "a.csv", *OPTIONS[8:12], "--format", "json").stdout)
    assert abs(found["a"] - 294.3) < 4 * found["a_std"] < 3
    assert "marker seen from above, which gives psi, about (299.9" in found["read"]
    seen = compare(MOTION, T, above=120 * AXIS[:, :2] + [300, 200], max_error=0.02)
    assert (seen.verdict, seen.compared) == ("fine", "angles")
    assert recording_of(T, {"above": marks, "axis": AXIS}).given.keys() == {"t", "axis", "missing"}


def test_a_pivot_is_named_only_where_it_is_determined() -> None:
    ring = np.column_stack([3 + np.cos(5 * T), 2 + np.sin(5 * T), 0 * T + 0.4])
    ring += np.random.default_rng(2).normal(0, 1e-3, ring.shape)
    pivot = pivot_of(ring)
    assert pivot
    assert pivot.is_determined.tolist() == [True, True, False]
    assert str(pivot).startswith("x = 3.0")
    assert "z" not in str(pivot)
    top = Top(m=0.5, A=4.45e-3, C=2.5e-3, s=0.08, g=9.81, r0=52.36, theta0_deg=75)
    marker = 0.15 * np.stack([*solve(top).table(T, ["axis"]).values()], axis=1)
    marker += np.random.default_rng(19).normal(scale=1e-3, size=marker.shape)
    for offset in ((0, 0, 0.05), (0.02, 0, 0)):
        found = pivot_of(marker + offset)
        assert found
        assert (abs(found.at - offset) < 4 * found.std).all()
        assert found.std.max() < 0.005
    assert pivot_of(marker) is None


def test_the_samples_are_what_the_script_writes() -> None:
    for camera in (recordings.SMALL_TOP, recordings.WHEEL):
        assert recordings.text(camera) == (recordings.SAMPLES / camera.name).read_text()


def test_every_name_that_table_writes_is_read(tmp_path: Path, lagtop: Lagtop) -> None:
    """Each quantity by itself, in the frame of its name; all others are said to be unused."""
    path = tmp_path / "a.csv"
    rates = {"p,q,r": "axis", "omega": "axis", "thetadot,phidot,psidot": "theta,phi,psi"}
    attitudes = ["theta", "phi", "psi", "axis", "quaternion", "matrix"]
    for names in [*attitudes, *(f"{y},{x}" for x, y in rates.items())]:
        lagtop("table", *OPTIONS, "--t-max", 2, "--columns", f"t,{names}", "-o", path)
        found = lagtop("compare", path, *OPTIONS, "--format", "json")
        row = json.loads(found.stdout)["rows"][0]
        assert (found.exit_code, row["unused"]) == (0, None), names
        assert row["error_max"] < 1e-11, names
        assert "," not in names or row["rates_error_max"] < 1e-11, names
    known = {*attitudes, "t", *",".join(rates).split(",")}
    others = [x for x in COLUMNS if x not in known]
    lagtop("table", *OPTIONS, "--columns", ",".join(["t", "theta", *others]), "-o", path)
    row = json.loads(lagtop("compare", path, *OPTIONS, "--format", "json").stdout)["rows"][0]
    assert row["unused"] == ", ".join(others).replace("dphi, dpsi", "dphi_deg, dpsi_deg")


def test_both_functions_take_the_same_options() -> None:
    noise = Rotation.from_rotvec(np.random.default_rng(3).normal(0, 1e-6, (201, 3)))
    inverse = {"matrix": (noise * TURNS).inv().as_matrix(), "align": "conjugate"}
    frames: dict[str, Any] = {"theta": ANGLES.theta, "phi": ANGLES.phi, "psi": ANGLES.psi}
    assert compare(MOTION, dt=0.01, **frames).verdict == "fine"
    for given in ({"t": T, **inverse}, {"t": 100 * T, "fps": 100} | frames):
        assert compare(MOTION, **given).verdict == "fine"
        found = fit(**given, t_min=0.4, t_max=1.405)
        assert (found.verdict, found.record()["t_start"], found.record()["rows"]) == (
            "good",
            pytest.approx(0.4),
            101,
        )
