"""Trajectories in every form in which engines write them, and the errors for bad ones."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from lagtop import LagtopError
from pyarrow import parquet

from lagrange_cli.errors import DataError
from lagrange_cli.inputs import text_tables as text_lines
from lagrange_cli.inputs.trajectory import open_trajectory
from lagrange_cli.inputs.trajectory_columns import QUANTITIES, expanded, quantities_in

ROWS = 50
DATA = np.random.default_rng(1).normal(size=(ROWS, 5))
DATA[:, 0] = np.linspace(-1, 3, ROWS)
NAMES = ["t", "qw", "qx", "qy", "qz"]

Found = dict[str, Any]


def read(path: Path | str, columns: list[str] | None = None) -> Found:
    """Return every quantity of a file, as one array each."""
    with open_trajectory(str(path), columns) as file:
        parts = [found for found, _ in file.blocks()]
    return {key: np.concatenate([part[key] for part in parts]) for key in file.quantities}


def lines(mark: str, rows: np.ndarray[Any, Any] = DATA) -> list[str]:
    return [mark.join(map(repr, row)) for row in rows.tolist()]


def text(mark: str, header: str | None = None) -> bytes:
    head = mark.join(NAMES) if header is None else header
    return "\n".join([*filter(None, [head]), *lines(mark), ""]).encode()


def json_lines(path: Path) -> None:
    rows = [json.dumps({"t": row[0], "note": "x", "quaternion": row[1:]}) for row in DATA.tolist()]
    path.write_text("\n".join(rows))


def json_array(path: Path) -> None:
    rows = [json.dumps(dict(zip(NAMES, row, strict=True))) for row in DATA.tolist()]
    path.write_text("[" + ",\n".join(rows) + "]\n")


def json_array_over_lines(path: Path) -> None:
    json_array(path)
    path.write_text(path.read_text().replace("[", "[\n").replace("]", "\n]"))


def structured(path: Path) -> None:
    np.save(path, np.rec.fromarrays(DATA.T, names=NAMES))  # type: ignore[call-overload]


def several_arrays(path: Path) -> None:
    np.savez(path, time=DATA[:, 0], quaternion=np.asfortranarray(DATA[:, 1:]), mass=np.ones(3))


def columns_of_parquet(path: Path) -> None:
    quaternions = pa.FixedSizeListArray.from_arrays(pa.array(DATA[:, 1:].ravel()), 4)
    names = pa.array(["x"] * ROWS)
    table = pa.table({"t": DATA[:, 0], "note": names, "quaternion": quaternions})
    parquet.write_table(table, path, row_group_size=7)


FORMS: dict[str, Callable[[Path], object]] = {
    "csv": lambda path: path.write_bytes(text(",")),
    "with a mark at the start": lambda path: path.write_bytes(b"\xef\xbb\xbf" + text(",")),
    "tsv": lambda path: path.write_bytes(text("\t")),
    "semicolons": lambda path: path.write_bytes(text(";")),
    "white space": lambda path: path.write_bytes(text("   ")),
    "header in a comment": lambda path: path.write_bytes(text(" ", "# made by\n# t qw qx qy qz")),
    "comments and blank lines": lambda path: path.write_bytes(
        b"# one\n\n" + text(",").replace(b"\n", b"\n\n# more\r\n")
    ),
    "ndjson": json_lines,
    "json": json_array,
    "json, brackets on lines of their own": json_array_over_lines,
    "npy": structured,
    "npz": several_arrays,
    "parquet": columns_of_parquet,
}


@pytest.fixture
def made(tmp_path: Path) -> Callable[[str], Path]:
    """Return a function that writes the data in a form."""

    def make(form: str) -> Path:
        ending = form if form in {"npy", "npz"} else "file"
        path = tmp_path / f"trajectory.{ending}"
        FORMS[form](path)
        return path

    return make


@pytest.mark.parametrize("at_once", [7, 1 << 15])
@pytest.mark.parametrize("form", FORMS)
def test_every_form_holds_the_same_numbers(
    form: str, at_once: int, made: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trajectory_arrays, "ROWS_AT_ONCE", at_once)
    monkeypatch.setattr(text_lines, "BYTES_AT_ONCE", 100 * at_once)
    found = read(made(form))
    assert np.array_equal(found["t"][:, 0], DATA[:, 0])
    assert np.array_equal(found["quaternion"], DATA[:, 1:])


@pytest.mark.parametrize("form", ["csv", "ndjson", "npy", "npz", "parquet"])
def test_pipes_hold_the_same_numbers(
    form: str, made: Callable[[str], Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Pipe(io.BytesIO):
        def seekable(self) -> bool:
            return False

        def seek(self, *_: Any) -> int:
            raise OSError(29, "Illegal seek")

    pipe = Pipe(made(form).read_bytes())
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=pipe))
    assert np.array_equal(read("-")["quaternion"], DATA[:, 1:])


def test_columns_are_named_from_the_left(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", DATA)
    assert np.array_equal(read(tmp_path / "a.npy", ["t", "quaternion"])["quaternion"], DATA[:, 1:])
    (tmp_path / "a.txt").write_text("\n".join(lines(" ")))
    found = read(tmp_path / "a.txt", ["t", "_", "axis"])
    assert np.array_equal(found["axis"], DATA[:, 2:])


def test_missing_numbers_are_nan(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t,theta,note\n0,1,x\n1,,y\n2,nan,z\n")
    assert np.isnan(read(tmp_path / "a.csv")["theta"][:, 0]).tolist() == [False, True, True]
    (tmp_path / "a.json").write_text('{"t":0,"axis":[1,2,3]}\n{"t":1,"axis":null}\n{"t":2}\n')
    assert np.isnan(read(tmp_path / "a.json")["axis"]).sum(axis=1).tolist() == [0, 3, 3]


EXUDYN = """#Exudyn explicit time integration (RK44) sensor output file
#measure Body number = 0
#OutputVariableType = {}
#number of sensor values = 9
#
"""


@pytest.mark.parametrize(
    ("kind", "cells", "found"),
    [
        ("RotationMatrix", 10, {"t": "", "matrix": ""}),
        ("Rotation", 4, {"t": "", "euler": "XYZ"}),
        ("AngularVelocityLocal", 4, {"t": "", "rates": "body"}),
        ("AngularVelocity", 4, {"t": "", "rates": "space"}),
        ("Position", 4, {"t": "", "position": ""}),
    ],
)
def test_sensor_files_of_exudyn(
    kind: str, cells: int, found: dict[str, str], tmp_path: Path
) -> None:
    (tmp_path / "a.txt").write_text(EXUDYN.format(kind) + ",".join(["0.5"] * cells) + "\n")
    with open_trajectory(str(tmp_path / "a.txt")) as file:
        assert {key: x.says for key, x in file.quantities.items()} == found
        assert file.quantities.get("euler", (0, 0, "rad"))[2] == "rad"


@pytest.mark.parametrize(
    ("header", "found"),
    [
        ("timestamp tx ty tz qx qy qz qw", {"quaternion": [7, 4, 5, 6], "position": [1, 2, 3]}),
        ("t p q r w x y z", {"quaternion": [4, 5, 6, 7], "rates": [1, 2, 3]}),
        ("time u0 u1 u2 u3 u4 u5 u6", {"quaternion": [4, 5, 6, 7]}),
        ("t R11 R12 R13 R21 R22 R23 R31 R32 R33", {"matrix": [*range(1, 10)]}),
        ("t q.x q.y q.z q.w omega[0] omega[1] omega[2]", {"quaternion": [4, 1, 2, 3]}),
        ("theta_deg phi_deg psi_deg t", {"theta": [0], "phi": [1], "psi": [2]}),
        ("t qpos_0 qpos_1 qpos_2 qpos_3 qvel_0 qvel_1 qvel_2", {"quaternion": [1, 2, 3, 4]}),
        ("t " + " ".join(f"qpos{i}" for i in range(7)), {"quaternion": [4, 5, 6, 7]}),
        ("t roll pitch yaw", {"euler": [1, 2, 3]}),
    ],
)
def test_names_of_columns(header: str, found: dict[str, list[int]]) -> None:
    seen = quantities_in(header.split())
    assert {key: list(seen[key].columns) for key in found} == found
    assert "t" in seen


def test_every_quantity_can_be_named_as_a_whole() -> None:
    for name, quantity in QUANTITIES.items():
        single = expanded([name])
        assert len(single) == quantity.size
        assert list(quantities_in(single)) == [name]
        assert {len(spelling.names) for spelling in quantity.spellings} == {quantity.size}


OPEN = "a quoted cell must end with its quote"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "must hold a trajectory, got no row"),
        (b"# only\n", "must hold a trajectory, got no row"),
        (b"t,theta\n0,1\n1,x\n", "line 3, column 2: theta must be a number, got 'x'"),
        (b"t,theta\n0,1\n\n# c\n1,1_0\n", "line 5, column 2: theta must be a number, got '1_0'"),
        (b"t,theta\n0,1\n1\n", "line 3: a row must have 2 cells, got 1"),
        (b"t,theta\n0,1\n1,2,3\n", "line 3: a row must have 2 cells, got 3"),
        (b"t,theta\n0,1,2\n1,2,3\n", "line 2: a row must have 2 cells, got 3"),
        (b"t,theta\n0,1\n1,\xff\n", "line 3: a row must be UTF-8 text"),
        (b"t,theta\n0,1\n,2\n", "line 3: t must be a finite number, got nan"),
        (b"t,theta\n0,1\n1,2\n# c\n0.5,3\n", "line 5: t must not turn back, got 0.5 after 1.0"),
        (b"x" * 2_000_000, "line 1: a line must have less than 1048576 bytes"),
        (b"t,theta\n0,1\n" + b"1" * 4_000_000, "line 3: a line must have less than 1048576 bytes"),
        (b"0 1\n", "has no header: name its 2 columns with --columns, such as t,quaternion"),
        (b"a,b\n0,1\n", "must have columns among the time (t, time, timestamp) and"),
        (b"t,qx,qy\n0,1,2\n", "must have columns among"),
        (b'{"t":0,"theta":1}\n{"t":1,"theta":"x"}\n', "line 2, column theta: must be a number"),
        (b'{"t":0,"axis":[1,2,3]}\n{"t":1,"axis":[1]}\n', "line 2, column axis: must be 3 numbers"),
        (
            b'{"t":0,"theta":1}\n{"t":1,',
            "line 2: a row must be a JSON object: unexpected end of data at character 8",
        ),
        (b't,theta\n0,1\n1,"2\n', f"line 3: {OPEN}, got '\"2' in column 2"),
        (b't,theta\n"0,1\n1,2\n', f"line 2: {OPEN}, got '\"0' in column 1"),
        (b't,"theta\n0,1\n', f"line 1: {OPEN}, got '\"theta' in column 2"),
        (b"t,theta\n0,1\n1,\xa02\n", "line 3: a row must be UTF-8 text"),
        (b"t,theta,note\n0,1,a\n1,2,caf\xe9\n", "line 3: a row must be UTF-8 text"),
        (b"t,theta\x00\n0,1\n", "line 1: a row must be text, got the character NUL"),
        (b"t,theta,note\n0,1,a\n1,2,b\x00\n", "line 3: a row must be text, got the character"),
        (b"t,theta,theta\n0,1,2\n", "must name each quantity once, got 'theta' and 'theta'"),
        (b"t,tilt,theta\n0,1,2\n", "must name each quantity once, got 'theta' and 'tilt'"),
        (b"t,theta,elevation\n0,1,2\n", "each quantity once, got 'theta' and 'elevation'"),
        (b"t,theta_deg,Theta [rad]\n0,1,2\n", "once, got 'theta_deg' and 'Theta [rad]'"),
        (b"t,qw,qx,qy,qz,qx\n0,1,0,0,0,1\n", "must name each quantity once, got 'qx' and 'qx'"),
        (b'{"t":0,"theta":1,"theta":2}\n', "must name each quantity once, got 'theta' and"),
        (b"\x93NUMPY\x01\x00\xff\xff", "not an npy file"),
        (b"PK\x03\x04", "not an npz file"),
        (b"PAR1", "not a Parquet file"),
    ],
)
def test_bad_files_get_one_line(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "bad"
    path.write_bytes(content)
    with pytest.raises(DataError) as error:
        read(path)
    assert str(error.value).startswith(str(path))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("form", ["npy", "npz", "parquet"])
def test_truncated_files(form: str, made: Callable[[str], Path]) -> None:
    path = made(form)
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.raises(DataError, match=r"ends early|not a"):
        read(path)


def test_a_place_is_right_after_the_first_block(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(trajectory_arrays, "ROWS_AT_ONCE", 2)
    np.save(tmp_path / "a.npy", np.array([[0, 0], [1, 0], [2, 0], [3, 0], [2.5, 0]]))
    with pytest.raises(DataError, match=r"row 5: t must not turn back, got 2\.5 after 3\.0"):
        read(tmp_path / "a.npy", ["t", "theta"])


def test_times_may_run_backwards(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("t,theta\n0,1\n-1,2\n-2,4\n")
    assert read(path)["t"][:, 0].tolist() == [0, -1, -2]
    path.write_text("t,theta\n0,1\n-1,2\n-0.5,3\n")
    with pytest.raises(DataError, match=r"line 4: t must not turn back, got -0\.5 after -1\.0"):
        read(path)


@pytest.mark.parametrize("rows", ["0,1\n1,2\n1,3\n", "0,1\n-1,2\n-1,3\n"])
def test_times_may_not_repeat_in_a_trajectory(rows: str, tmp_path: Path) -> None:
    """Two rows at one time cannot both be right; `fit` takes them for two measurements."""
    path = tmp_path / "a.csv"
    path.write_text(f"t,theta\n{rows}")
    with pytest.raises(DataError, match=r"line 4: t must not repeat, got -?1\.0 twice"):
        read(path)


def test_columns_that_nobody_reads_may_share_a_name(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text('t,note,theta,note\n0,"a",1,b\n1,"c, ""d""",2,d\n'.replace(", ", " "))
    with open_trajectory(str(path)) as file:
        assert sorted(file.quantities) == ["t", "theta"]


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (["t", "quaternion"], "columns must name all 2 columns of .* got 5 names"),
        (["t", "thta"], r"columns must be among .* got 'thta' \(did you mean 'theta'\?\)"),
        (["t", "qw"], "columns must be among .* got 'qw'"),
        (["t", "tilt", "theta"], "columns must name each quantity once, got 'theta' and 'tilt'"),
    ],
)
def test_bad_names_of_columns(columns: list[str], message: str, tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("0 1\n")
    with pytest.raises(LagtopError, match=message):
        read(tmp_path / "a.txt", columns)
