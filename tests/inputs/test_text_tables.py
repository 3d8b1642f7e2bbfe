"""The one grammar of tables as text: delimiters, decimal marks and headings in each reader."""

from __future__ import annotations

import gzip
import pickle
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import pytest
from conftest import Lagtop, assert_one_line

from lagrange_cli.errors import DataError
from lagrange_cli.inputs.text_lines import UNDECIDED, Dialect
from lagrange_cli.inputs.tops_file import open_tops
from lagrange_cli.inputs.trajectory import TimesFile, open_trajectory


def times(path: Path, dialect: Dialect) -> list[float]:
    """Return the times of a file."""
    return [float(x) for x in TimesFile(str(path), dialect=dialect).decimals()]


def of_a_trajectory(path: Path, dialect: Dialect) -> list[float]:
    """Return the times of a trajectory."""
    with open_trajectory(str(path), dialect=dialect) as file:
        return [t for block, _ in file.blocks() for t in block["t"][:, 0].tolist()]


def of_tops(path: Path, dialect: Dialect) -> list[float]:
    """Return the spins of tops; what is wrong with a row is an error here."""

    def numbers() -> Iterator[float]:
        for block in open_tops(str(path), set(), 100, dialect=dialect)[1]:
            for row in block.rows():
                if row.error:
                    raise DataError(row.error)
                yield row.inputs["r0"]

    return list(numbers())


READERS = {"t": (times, of_a_trajectory), "r0": (of_tops,)}
"""The functions that return the first column of a file whose first heading this is."""


def read(path: Path, text: str, first: str, dialect: Dialect = UNDECIDED) -> list[float]:
    """Return the first column of a table, after the comparison of all its readers."""
    path.write_bytes(text.replace("FIRST", first).encode())
    one, *others = (reader(path, dialect) for reader in READERS[first])
    assert all(other == one for other in others)
    return one


SECOND = {"t": "theta", "r0": "theta0_deg"}

CLEAR = {
    "FIRST,SECOND\n0.5,30\n1.5,40\n": [0.5, 1.5],
    "FIRST;SECOND\n0.5;30\n1.5;40\n": [0.5, 1.5],
    "FIRST;SECOND\n0,5;30\n1,5;40\n": [0.5, 1.5],
    "FIRST\tSECOND\n0,5\t30,25\n1,5e0\t40\n": [0.5, 1.5],
    "FIRST   SECOND\n 0,5   30,25\n 1,5 \t 40\n": [0.5, 1.5],
    "FIRST SECOND\n0.5 30\n1.5 40\n": [0.5, 1.5],
    "\ufeff# made\r\n\r\nFIRST,SECOND\r\n# more\r\n0.5,30\r\n\r\n1.5,40\r\n": [0.5, 1.5],
    '"FIRST";"SECOND"\n"0,5";"30"\n1,5;40\n': [0.5, 1.5],
    'FIRST, "SECOND"\n0.5, "30"\n1.5, "40"\n': [0.5, 1.5],
    "mass A\nFIRST,SECOND\n0.5,30\n1.5,40\n": [0.5, 1.5],
    "mass A;;\n\n# x\nFIRST;SECOND;\n0,5;30;\n1,5;40;\n": [0.5, 1.5],
    "sep=;\nFIRST;SECOND\n0,5;30\n1,5;40\n": [0.5, 1.5],
    "FIRST;SECOND;note, more\n0,5;30;x\n1,5;40;y, z\n": [0.5, 1.5],
    "FIRST;SECOND\n1,234;30\n0,5;40\n": [1.234, 0.5],
    "FIRST;SECOND\n1.234;30\n2.345;40\n": [1.234, 2.345],
    '{"FIRST":0.5,"SECOND":30}\n{"FIRST":1.5,"SECOND":40}\n': [0.5, 1.5],
    '[{"FIRST":0.5,"SECOND":30},\n{"FIRST":1.5,"SECOND":40}]\n': [0.5, 1.5],
    '[\n{"FIRST":0.5,"SECOND":30},\n{"FIRST":1.5,"SECOND":40}\n]\n': [0.5, 1.5],
    "LabVIEW Measurement\nSeparator\tTab\nDecimal_Separator\t,\n***End_of_Header***\n\n"
    "Channels\t1\n***End_of_Header***\nFIRST\tSECOND\n1,234\t30\n2,345\t40\n": [1.234, 2.345],
}
UNCLEAR = {
    "FIRST;SECOND\n0,5;30\n1.5;40\n": "line 3: a file must have one decimal mark, got '1.5'",
    "FIRST;SECOND\n0.5;30\n1;4,5\n": "line 3: a file must have one decimal mark, got '4,5'",
    "FIRST;SECOND\n1,234;30\n": "line 2: a comma may be a decimal mark or separate thousands",
    "FIRST;SECOND\n1.234,5;30\n": "line 2: a number must have no thousands separators, got '1.23",
    "FIRST\tSECOND\n1,234.5\t30\n": "line 2: a number must have no thousands separators",
    "FIRST\tSECOND\n1.234.567\t30\n": "line 2: a number must have no thousands separators",
    "FIRST;x,FIRST\n1;2,3\n": "line 1: the delimiter must be clear, got",
}


@pytest.mark.parametrize("first", READERS)
@pytest.mark.parametrize("text", CLEAR)
def test_each_reader_takes_the_same_files(text: str, first: str, tmp_path: Path) -> None:
    table = text.replace("SECOND", SECOND[first])
    assert read(tmp_path / "file", table, first) == CLEAR[text]


@pytest.mark.parametrize("first", READERS)
@pytest.mark.parametrize("text", UNCLEAR)
def test_what_can_be_read_in_two_ways_is_refused(text: str, first: str, tmp_path: Path) -> None:
    for reader in READERS[first]:
        path = tmp_path / "file"
        path.write_text(text.replace("FIRST", first).replace("SECOND", SECOND[first]))
        with pytest.raises(DataError, match=r"pass --de") as error:
            reader(path, UNDECIDED)
        assert str(error.value).startswith(f"{path}, {UNCLEAR[text]}")


@pytest.mark.parametrize("first", READERS)
def test_options_decide(first: str, tmp_path: Path) -> None:
    path, text = tmp_path / "file", f"FIRST;{SECOND[first]}\n1,234;30\n"
    assert read(path, text, first, Dialect(decimal=",")) == [1.234]
    for reader in READERS[first]:
        with pytest.raises(DataError, match=r"got '1,234' \(use --decimal comma\)"):
            reader(path, Dialect(decimal="."))
    path.write_text(f"{first};x,{first}\n5;2,3\n")
    assert READERS[first][0](path, Dialect(";")) == [5.0]


@pytest.mark.parametrize("encoded", ["utf-16", "utf-16-be", "gzip", "utf-16 in gzip"])
def test_other_encodings(encoded: str, tmp_path: Path, lagtop: Lagtop) -> None:
    path = tmp_path / "file"
    for first, readers in READERS.items():
        text = "".join([f"{first},{SECOND[first]}\n", *(f"{i},30\n" for i in range(20_000))])
        raw = ("\ufeff" + text).encode("utf-16-be") if encoded == "utf-16-be" else text.encode()
        raw = text.encode("utf-16") if encoded.startswith("utf-16") and raw[:1] == b"t" else raw
        path.write_bytes(gzip.compress(raw) if "gzip" in encoded else raw)
        for reader in readers:
            assert reader(path, UNDECIDED) == list(range(20_000))
        path.write_bytes(path.read_bytes()[:-3])
        if "gzip" in encoded:
            with pytest.raises(DataError, match="not a gzip file: Compressed file ended"):
                readers[0](path, UNDECIDED)


def test_columns_need_no_headings(tmp_path: Path) -> None:
    path = tmp_path / "file"
    for text in ("0,5;30\n1;40\n", "mass A\nx;y\n0,5;30\n1;40\n", "0,5 30,5\n1,0 40\n"):
        path.write_text(text)
        with open_trajectory(str(path), ["t", "theta"]) as file:
            assert next(file.blocks())[0]["t"][:, 0].tolist() == [0.5, 1.0]


def test_a_comma_between_two_numbers_is_unclear(lagtop: Lagtop) -> None:
    words = ["table", "--times", "-", "--columns", "t"]
    unclear = lagtop(*words, input="0,5\n1,0\n")
    assert_one_line(unclear, 65, "standard input, line 1: the delimiter must be clear, got '0,5'")
    assert lagtop(*words, "--decimal", "comma", input="0,5\n1,0\n").stdout == "t\n0.5\n1.0\n"
    assert lagtop(*words, "--decimal", ",", input="0,5\n1,0\n").stdout == "t\n0.5\n1.0\n"
    both = lagtop(*words, "--decimal", ",", "--delimiter", "comma", input="0,5\n")
    assert_one_line(both, 2, "use --delimiter comma or --decimal comma, not both")


def test_the_decision_is_made_once(tmp_path: Path) -> None:
    """A decimal comma below the rows that decide is an error in its place."""
    path = tmp_path / "file"
    path.write_text("t;theta\n" + "".join(f"{i};30\n" for i in range(2000)) + "2000,5;30\n")
    for reader in READERS["t"]:
        with pytest.raises(DataError, match=r"line 2002.*got '2000,5' \(use --decimal comma"):
            reader(path, UNDECIDED)


def test_times_of_json_are_exact(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text('{"t":0.1}\n{"t":1e-3}\n')
    assert [str(x) for x in islice(TimesFile(str(path)).decimals(), 2)] == ["1/10", "1/1000"]


@pytest.mark.parametrize("text", ["r0,id\n1,x\n", '{"r0":1,"id":"x"}\n', "r0 [rpm];id\n1,5;x\n"])
def test_lines_go_to_other_processes(text: str, tmp_path: Path) -> None:
    """JSON lines could not be pickled."""
    path = tmp_path / "file"
    path.write_text(text)
    block = next(open_tops(str(path), set(), 10)[1])
    again = pickle.loads(pickle.dumps(block))
    assert list(again.rows()) == list(block.rows())


def test_text_in_another_encoding_names_the_remedy(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes("t;theta [°]\n0;30\n".encode("cp1252"))
    for reader in READERS["t"]:
        with pytest.raises(DataError, match="line 1: a row must be UTF-8 text: save the file as"):
            reader(path, UNDECIDED)
