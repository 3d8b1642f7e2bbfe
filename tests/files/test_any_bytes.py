"""Any bytes to any reader end in rows, or in one line."""

from __future__ import annotations

import io
import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from conftest import LAGTOP, ROOT
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pyarrow import parquet
from scipy.io import savemat

from lagrange_cli.errors import DataError, LagtopError
from lagrange_cli.files.tops import read_tops
from lagrange_cli.recordings.options import Reading
from lagrange_cli.recordings.reading import read_recording
from lagrange_cli.recordings.times import read_times
from lagrange_cli.top.given import read_scene


def written(write: Callable[[io.BytesIO], object]) -> bytes:
    write(stream := io.BytesIO())
    return stream.getvalue()


COLUMNS = {"t": np.arange(8.0), "theta": np.linspace(30, 40, 8)}
LISTS = {x: y.tolist() for x, y in COLUMNS.items()}
GOOD = [
    *(x.read_bytes() for x in sorted((ROOT / "sample_inputs" / "files").iterdir())),
    (ROOT / "sample_inputs" / "hanging-top.toml").read_bytes(),
    written(lambda stream: parquet.write_table(pa.table(COLUMNS), stream)),
    written(lambda stream: savemat(stream, COLUMNS)),
    *(json.dumps(x).encode() for x in (LISTS, {"data": LISTS}, [*LISTS.values()])),
    b"time\tquaternion\n10:59:59.5\t1,0,0,0\n11:00:00.25\t1,0,0,1\n",
    b"stamp.sec,stamp.nanosec,x,y\n1700000000,5,1D0,NA\n1700000001,6,2D0,#N/A\n",
    b"timestamp,theta\n2024-05-31T10:59:59.123456789Z,1\n2024-05-31T11:00:00Z,2\n",
]
PIECES = [b"\n", b",", b";", b"\t", b'"', b"#", b"[", b"{", b"}", b"\0", b"\xff", b"1e999", b"nan"]
PIECES += [b"1700000000000000000,1\n", b"10:59:59,1\n", b"-", b'{"t":[0,1],"theta":[1,2]}']
PIECES += [b"t,theta\n", b"r0,theta0_deg\n", b"1,2\n", b"1,5;2\n", b"PK\x03\x04", b"\x1f\x8b"]


@st.composite
def damaged(draw: st.DrawFn) -> bytes:
    """Return a good file with some bytes replaced, removed or added."""
    content = draw(st.sampled_from(GOOD))
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(content)))
        removed = draw(st.sampled_from([0, 1, 2, 8, 1000]))
        added = draw(st.one_of(st.binary(max_size=4), st.sampled_from(PIECES)))
        content = content[:at] + added + content[at + removed :]
    return content


CONTENTS = st.one_of(
    damaged(),
    damaged(),
    st.binary(max_size=60),
    st.lists(st.sampled_from(PIECES), max_size=12).map(b"".join),
)


def read_by_all(path: str) -> None:
    """Read a file in every way; a LagtopError must be one line."""

    def tops() -> None:
        for block in read_tops(path, {"error"}).blocks(5):
            assert "\n" not in "".join(block.arrays({}).errors.values())

    def trajectory(columns: list[str] | None) -> None:
        found = read_recording(path, Reading(columns))
        assert len({len(x) for x in found.given.values()}) == 1

    readers: list[Callable[[], object]] = [tops, lambda: read_times(path), lambda: read_scene(path)]
    readers += [lambda: trajectory(None), lambda: trajectory(["t", "theta"])]
    for reader in readers:
        found = None
        try:
            reader()
        except LagtopError as error:
            found = error
        assert found is None or isinstance(found, DataError) or found.key == "columns", found
        assert "\n" not in str(found)  # the command line escapes other characters


@pytest.mark.filterwarnings("ignore::lagrange_cli.errors.MixedBodyWarning")
@pytest.mark.parametrize("count", [30, pytest.param(2_000, marks=pytest.mark.slow)])
def test_any_bytes_end_in_rows_or_in_one_line(count: int, tmp_path: Path) -> None:
    @given(CONTENTS)
    @example(b"{}")
    @settings(max_examples=count, derandomize=True)
    def read_any(content: bytes) -> None:
        (tmp_path / "file").write_bytes(content)
        read_by_all(str(tmp_path / "file"))

    read_any()


@pytest.mark.slow
@pytest.mark.parametrize("words", ["sweep", "table --times", "compare", "fit", "solve", "sweep -"])
def test_a_file_without_end_is_refused(words: str) -> None:
    with open("/dev/zero", "rb") as zeros:
        command = [*LAGTOP, *words.split(), *([] if words.endswith("-") else ["/dev/zero"])]
        done = subprocess.run(command, stdin=zeros, capture_output=True, check=False)
    assert (done.returncode, done.stdout) == (65, b"")
    assert done.stderr.count(b"\n") == 1
    assert b"must have at most" in done.stderr


@pytest.mark.parametrize(("at", "value"), [(144, 5), (144, 3), (145, 8), (176, 200), (177, 9)])
def test_a_matlab_file_at_which_scipy_crashes_is_refused(
    at: int, value: int, tmp_path: Path
) -> None:
    """The class, the flag of complex numbers and the type of data of an array are changed."""
    content = bytearray(written(lambda stream: savemat(stream, COLUMNS)))
    content[at] = value
    (tmp_path / "a.mat").write_bytes(content)
    with pytest.raises(DataError, match=r"a\.mat: bad MATLAB file: "):
        read_times(str(tmp_path / "a.mat"))
