"""The one grammar of tables as text: delimiters, decimal marks, headings and places in messages."""

from __future__ import annotations

import gzip
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from lagrange_cli.errors import DataError
from lagrange_cli.files import text_tables
from lagrange_cli.files.tops import read_tops
from lagrange_cli.recordings.options import Reading
from lagrange_cli.recordings.reading import read_recording
from lagrange_cli.recordings.times import read_times
from lagrange_cli.top.units import RADIANS


def times(path: Path, decimal: str) -> list[float]:
    """Return the times of a file."""
    return [float(x) for x in read_times(str(path), decimal).exact]


def of_a_trajectory(path: Path, decimal: str) -> list[float]:
    """Return the times of a trajectory."""
    return [*map(float, read_recording(str(path), Reading(decimal=decimal)).t)]


def of_tops(path: Path, decimal: str) -> list[float]:
    """Return the spins of tops; an error of a row is an error here."""
    tops = read_tops(str(path), set(), decimal).arrays({})
    for error in tops.errors.values():
        raise DataError(error)
    found: list[float] = np.asarray(tops.inputs["r0"]).tolist()
    return found


READERS = {"t": (times, of_a_trajectory), "r0": (of_tops,)}
"""The functions that return the first column of a file whose first heading this is."""
SECOND = {"t": "theta", "r0": "theta0_deg"}

TABLES = {
    "FIRST,SECOND\n-0.5,30\n1.5,40\n": [-0.5, 1.5],
    "FIRST;SECOND\n0,5;30\n1,5;40\n": [0.5, 1.5],
    "FIRST\tSECOND\n0,5\t30,25\n1,5e0\t40\n": [0.5, 1.5],
    "FIRST   SECOND\n 0,5   30,25\n 1,5 \t 40\n": [0.5, 1.5],
    "\ufeff# made\r\n\r\nFIRST,SECOND\r\n# more\r\n0.5,30\r\n\r\n1.5,40\r\n": [0.5, 1.5],
    '"FIRST";"SECOND"\n"0,5";"30"\n1,5;40\n': [0.5, 1.5],
    "mass A\nFIRST,SECOND\n0.5,30\n1.5,40\n": [0.5, 1.5],
    "run 5 of 7;;\n\n# x\nFIRST;SECOND;\n0,5;30;\n1,5;40;\n": [0.5, 1.5],
    "FIRST;SECOND;note, more\n0,5;30;x\n1,5;40;y, z\n": [0.5, 1.5],
    "FIRST;SECOND\n1,234;30\n0,5;40\n": [1.234, 0.5],
    "FIRST;SECOND\n1.234;30\n2.345;40\n": [1.234, 2.345],
    '{"FIRST":0.5,"SECOND":30}\n\n{"FIRST":1.5,"SECOND":40}\n': [0.5, 1.5],
    '[\n {"FIRST":0.5,\n"SECOND":30},{"FIRST":1.5,"SECOND":40}\n]\n': [0.5, 1.5],
    "FIRST   SECOND\n\u2500\u2500\u2500\u2500\n0.5   30\n1.5   40\n": [0.5, 1.5],
    'FIRST,SECOND\n"0,50","30,0"\n"1,5", "40"\n': [0.5, 1.5],
    "FIRST is a time: see below\nFIRST,SECOND,note\n0.5,30,a b\n1.5,40,\n": [0.5, 1.5],
    "// FIRST = 3\n% mass, A\nFIRST;SECOND\n0.5;30\n1.5;40\n": [0.5, 1.5],
    "#FIRST,SECOND\n0.5,30\n1.5,40\n": [0.5, 1.5],
}


@pytest.mark.parametrize("first", READERS)
@pytest.mark.parametrize("text", TABLES)
def test_every_reader_takes_the_same_tables(text: str, first: str, tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(text.replace("FIRST", first).replace("SECOND", SECOND[first]).encode())
    for reader in READERS[first]:
        assert reader(path, "") == TABLES[text]


@pytest.mark.parametrize("first", READERS)
def test_the_user_decides_about_commas(first: str, tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text(f"{first};{SECOND[first]}\n1,234;30\n")
    for reader in READERS[first]:
        assert reader(path, ",") == [1.234]
        with pytest.raises(DataError, match=r"got '1,234' \(use decimal=comma\)"):
            reader(path, ".")


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-be", "gzip"])
def test_encodings(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "file"
    for first, readers in READERS.items():
        text = f"{first},{SECOND[first]},ångström\n0.5,30,1\n"
        raw = text.encode("utf-8" if encoding == "gzip" else encoding)
        raw = ("\ufeff" + text).encode(encoding) if encoding == "utf-16-be" else raw
        path.write_bytes(gzip.compress(raw) if encoding == "gzip" else raw)
        for reader in readers:
            assert reader(path, "") == [0.5]


def test_a_file_beyond_the_limit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file"
    path.write_text("t,theta\n0.5,30\n")
    path.with_suffix(".gz").write_bytes(gzip.compress(path.read_bytes()))
    monkeypatch.setattr("lagrange_cli.file_bytes.read_bytes.__defaults__", (14,))
    for each in (path, path.with_suffix(".gz")):
        with pytest.raises(DataError, match="must have at most 14 bytes, has more"):
            read_times(str(each))
    monkeypatch.setattr("lagrange_cli.file_bytes.read_bytes.__defaults__", (15,))
    assert times(path, "") == [0.5]


def test_a_file_of_too_many_lines_or_values_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A small archive may hold hundreds of millions of comments, or of empty objects."""
    path = tmp_path / "file"
    monkeypatch.setattr(text_tables, "_MOST_LINES", 5)
    monkeypatch.setattr(text_tables, "_MOST_VALUES", 3)
    monkeypatch.setattr(text_tables, "_LONGEST_LINE", 9)
    for text, wrong in {
        "#\n" * 4 + "t\n0.5\n": "a file must have at most 5 lines: split it",
        "t\n0.50000000\n": "line 2: a row must have at most 9 characters",
        '[{"t":0.5},{},{},{},{}]': "characters and 3 values: write one object per line",
    }.items():
        path.write_text(text)
        with pytest.raises(DataError, match=wrong):
            read_times(str(path))
    path.write_text("#\n" * 3 + "t\n0.5\n")
    assert times(path, "") == [0.5]


def test_times_are_exact(tmp_path: Path) -> None:
    path = tmp_path / "file"
    objects = '{"t":0.1}\n{"t":1e-3}\n'
    for text in (objects, "t\n0.1\n1e-3\n", "t ms,x\n100,\n1,\n", "t ms\n100\n1\n"):
        path.write_text(text)
        assert [*read_times(str(path)).exact] == [Fraction(1, 10), Fraction(1, 1000)]


def test_numpy_and_the_careful_reader_read_the_same_numbers(tmp_path: Path) -> None:
    """A cell in quotes changes the way but no number; places stay right."""
    path = tmp_path / "file"
    cells = ["0.1", "-1e-320", "1.7976931348623157e308", "3.", ".5", "+7", "2e22"] * 30
    rows = [f"{i},{x}" for i, x in enumerate(cells)]
    for first in ("0", '"0"'):
        path.write_text("t,theta\n" + "\n".join([f"{first},{cells[0]}", *rows[1:]]))
        found = read_recording(str(path), Reading(units=RADIANS)).given["theta"][:, 0]
        assert found.tolist() == list(map(float, cells))
    rows[100] = "100,x"
    path.write_text("t,theta\n# note\n" + "\n".join(rows))
    with pytest.raises(DataError, match="line 103, column 2: theta must be a finite decimal"):
        read_recording(str(path), Reading())


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_missing_cells_and_words_are_read_at_once_as_one_by_one(mark: str, tmp_path: Path) -> None:
    """A cell in quotes makes NumPy give up; -nan is a lost number and no missing cell."""
    path, found = tmp_path / "file", []
    rows = "0,1,a,2 1,,b,3 2,4,,5 3,nan,c, ,,d, 5,,e, 6,-nan,f,6".split()
    for texts in (rows, rows[:-1], [*rows[:-1], '"7",,,'], [*rows, '"7",,,']):
        path.write_text("\n".join(["t,theta,note,psi", *texts]).replace(",", mark))
        file = read_recording(str(path), Reading(units=RADIANS))
        values = np.concatenate([file.given[x] for x in ("t", "theta", "psi", "missing")], axis=1)
        missing = file.missing[:, np.newaxis]
        found.append((values[:5], missing[:5]))
        assert len(values) == len(texts) - 1
    for values, missing in found[1:]:
        assert np.array_equal(values, found[0][0], equal_nan=True)
        assert np.array_equal(missing, found[0][1])
    assert missing[:, 0].tolist() == [False, True, False, True, True]


NAMED = {
    "Start time: unknown\nClock,Tilt,Azimuth\n0.5,30,1\n1.5,40,2\n": "t theta psi",
    "run 1 of 2, tilt\nt1;tilt1;t2;tilt2\n0,5;30;0,5;7\n1,5;40;1,5;8\n2,5;50;;\n": "_ _ t theta",
    "a,b\n0.5,30\n1.5,40\n": "t theta",
    "a,b,c\n0.5,30\n1.5,40\n": "t theta",
}


@pytest.mark.parametrize("text", NAMED)
def test_columns_that_are_named(text: str, tmp_path: Path) -> None:
    """Titles in words do not count; a run that ends before the other one has no more rows."""
    (tmp_path / "file").write_text(text)
    file = read_recording(str(tmp_path / "file"), Reading(names := NAMED[text].split()))
    assert file.source.used == [x for x in names if x != "_"]
    assert file.t.tolist() == [0.5, 1.5]
    assert file.given["t"][:, 0].tolist() == [0, 1]


def test_units_below_headings_that_are_renamed(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("Clock,Tilt\nms,rad\n500,0.5\n1500,0.6\n")
    file = read_recording(str(tmp_path / "file"), Reading(["t", "theta"]))
    assert file.t.tolist() == [0.5, 1.5]
    assert file.given["theta"][:, 0].tolist() == [0.5, 0.6]


def test_what_was_read(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text(
        '{"t":1,"rotation":{"x":0,"y":0,"z":0,"w":1},"angularVelocity":[1,2,null],"n":3}\n'
    )
    file = read_recording(str(path), Reading())
    assert {*file.given} == {"t", "quaternion", "rates", "missing"}
    assert file.source.unused == ["n"]
    assert file.source.used[1:5] == [f"rotation.{x}" for x in "xyzw"]
    assert file.missing.tolist() == [True]
    path.write_text('{"t":1,"q":[1,0,0,0]}\n')
    assert {*read_recording(str(path), Reading()).given} == {"t", "quaternion", "missing"}


def test_unix_times_keep_their_digits(tmp_path: Path) -> None:
    """Neighbouring doubles are 2e-7 apart at 1.7e9, and 256 at 1.7e18."""
    for heading, start, zeros in (("t", "1700000000.", 0), ("t [ns]", "1700000000", 9)):
        digits = [f"{i:09}" for i in (5, 1_000_006, 2_000_007)]
        rows = "".join(f"{start}{x},30\n" for x in digits)
        (tmp_path / "file").write_text(f"{heading},theta\n{rows}")
        found = read_recording(str(tmp_path / "file"), Reading()).given["t"][:, 0]
        assert found.tolist() == pytest.approx([0, 0.001000001, 0.002000002], rel=1e-14), zeros
