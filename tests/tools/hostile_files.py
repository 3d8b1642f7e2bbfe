"""Files that are broken, hostile or unusual: each command must end with one line, in little memory.

    python tests/tools/hostile_files.py --count 150 --seed 1

Every file is given to `compare`, `fit`, `solve`, `sweep`, `table --times` and `table --tops`, each
in a process of its own with limited memory and time.  A run is a fault if it ends with a traceback,
a warning of a library or an undocumented exit code, or if it fails and no line says why.
"""

from __future__ import annotations

import io
import os
import random
import re
import resource
import signal
import struct
import sys
import tempfile
import traceback
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

import numpy as np
import pyarrow as pa
import scipy.optimize  # noqa: F401 - before the processes are started, which inherit it
from campaign import fault_of, finish, options
from pyarrow import parquet

from lagrange_cli.cli.app import main as command

ROWS = 40
TIMES = np.linspace(0, 1, ROWS)
TABLE = np.stack([TIMES, 30 + TIMES], axis=1)
Make = Callable[[], bytes]


def saved(write: Callable[[io.BytesIO], object]) -> bytes:
    """Return what a function writes."""
    stream = io.BytesIO()
    write(stream)
    return stream.getvalue()


def npy(array: np.ndarray[Any, Any], *, pickles: bool = False) -> bytes:
    """Return an array as an npy file."""
    return saved(lambda stream: np.save(stream, array, allow_pickle=pickles))


def header(text: str, data: bytes = b"", version: bytes = b"\x01\x00") -> bytes:
    """Return an npy file with a header that no library would write."""
    size = struct.pack("<H" if version == b"\x01\x00" else "<I", len(text))
    return b"\x93NUMPY" + version + size + text.encode("latin-1") + data


def shaped(shape: str, descr: str = "'<f8'", fortran: bool = False, data: bytes = b"") -> bytes:
    """Return an npy file that declares a shape and a type."""
    text = f"{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}}}"
    return header(f"{text:<117}\n", data)


def npz(method: int = zipfile.ZIP_DEFLATED, /, **members: bytes) -> bytes:
    """Return an npz file of members that are npy files, or are not."""

    def write(stream: io.BytesIO) -> None:
        with zipfile.ZipFile(stream, "w", method) as archive:
            for name, content in members.items():
                archive.writestr(f"{name}.npy", content)

    return saved(write)


def good_npz(method: int = zipfile.ZIP_DEFLATED) -> bytes:
    """Return an npz file of a trajectory."""
    return npz(method, t=npy(TIMES), theta=npy(TABLE[:, 1]))


def patched(content: bytes, old: bytes, new: bytes) -> bytes:
    """Return a file with some bytes replaced, of which there must be some."""
    assert old in content
    return content.replace(old, new)


def with_headers(content: bytes, places: Sequence[int], change: Callable[[int], int]) -> bytes:
    """Return an archive with one number changed in its local and central headers."""
    found = bytearray(content)
    for mark, place in zip((rb"PK\x03\x04", rb"PK\x01\x02"), places, strict=True):
        for match in re.finditer(mark, content):
            at = slice(match.start() + place, match.start() + place + 2)
            struct.pack_into("<H", found, at.start, change(*struct.unpack("<H", found[at])))
    return bytes(found)


def with_method(number: int) -> bytes:
    """Return an npz file that names another method of compression."""
    return with_headers(good_npz(zipfile.ZIP_STORED), (8, 10), lambda _: number)


def encrypted() -> bytes:
    """Return an npz file whose members are marked as encrypted."""
    return with_headers(good_npz(), (6, 8), lambda flags: flags | 1)


def table(**columns: object) -> bytes:
    """Return columns as a Parquet file."""
    return saved(lambda stream: parquet.write_table(pa.table(columns), stream))


def twice() -> bytes:
    """Return a Parquet file with two columns of one name."""
    whole = pa.Table.from_arrays([pa.array(TIMES)] * 3, names=["t", "theta", "theta"])
    return saved(lambda stream: parquet.write_table(whole, stream))


def lists_with_null() -> bytes:
    """Return a Parquet file whose lists of a fixed size are missing in places."""
    lists = pa.array([[0.0, 0.5, 0.8]] * (ROWS - 1) + [None], pa.list_(pa.float64(), 3))
    return table(t=TIMES, axis=lists)


def damaged(content: bytes, seed: int) -> bytes:
    """Return a file in which some bytes are others, or which is cut off."""
    rng, found = random.Random(seed), bytearray(content)
    for _ in range(rng.choice([1, 1, 3, 30])):
        found[rng.randrange(len(found))] = rng.randrange(256)
    return bytes(found[: rng.randrange(1, len(found))] if rng.random() < 0.3 else found)


CSV = b"t,theta\n" + b"".join(b"%.17g,%.17g\n" % tuple(row) for row in TABLE)
TOPS = b"id,r0,theta0_deg\n" + b"".join(b"%d,%d,%d\n" % (i, i, i) for i in range(ROWS))
SCENE = b"m = 1587.0\nr0 = 50\ntheta0_deg = 30\n"
DESCR = "[('t', '<f8'), ('theta', '<f8', ({},))]"
HOSTILE: dict[str, Make] = {
    "npz that is encrypted": encrypted,
    **{f"npz by method {n}": partial(with_method, n) for n in (1, 6, 9, 93, 95, 97, 99)},
    "npz by bzip2": lambda: good_npz(zipfile.ZIP_BZIP2),
    "npz by lzma": lambda: good_npz(zipfile.ZIP_LZMA),
    "npz with damaged lzma": lambda: damaged(good_npz(zipfile.ZIP_LZMA)[:-200], 3) + bytes(200),
    "npz without members": npz,
    "npz of text": lambda: npz(t=b"hello", theta=b"world"),
    "npz of pickles": lambda: npz(t=npy(np.array([{}] * ROWS, object), pickles=True)),
    "npz of many members": lambda: npz(t=npy(TIMES), **{f"a{i}": b"" for i in range(5000)}),
    "npz with one name twice": lambda: patched(good_npz(), b"theta.npy", b"t.npy.npy"),
    "npz of a bomb in Fortran order": lambda: npz(
        t=npy(np.zeros(8)), theta=shaped("(40000000, 8)", fortran=True, data=bytes(1 << 27))
    ),
    "npz of a bomb by rows": lambda: npz(t=shaped("(30000000,)", data=bytes(240_000_000))),
    "npy of minus signs": lambda: header("{'shape': (" + "-" * 9000 + "1,)}\n"),
    "npy of brackets": lambda: header("(" * 9000 + "\n"),
    "npy with an open text": lambda: header("{'descr': '''<f8\n"),
    "npy of a call": lambda: header("__import__('os').system('touch RAN')\n"),
    "npy with a long header": lambda: header(" " * 3_000_000 + "\n", version=b"\x02\x00"),
    "npy of version 3": lambda: b"\x93NUMPY\x03\x00" + npy(TABLE)[8:],
    "npy of version 9": lambda: b"\x93NUMPY\x09\x00" + npy(TABLE)[8:],
    "npy of pickles": lambda: npy(np.array([[{}, 1]], object), pickles=True),
    "npy of complex numbers": lambda: npy(TABLE.astype(complex)),
    "npy of texts": lambda: npy(TABLE.astype(str)),
    "npy of booleans": lambda: npy(TABLE > 0),
    "npy of dates": lambda: npy(TABLE.astype("datetime64[s]")),
    "npy of three dimensions": lambda: npy(np.zeros((2, 2, 2))),
    "npy of no dimension": lambda: npy(np.array(1.0)),
    "npy without rows": lambda: npy(np.zeros((0, 2))),
    "npy without columns": lambda: npy(np.zeros((5, 0))),
    "npy with a negative size": lambda: shaped("(-3, 2)", data=bytes(64)),
    "npy with a size that is no number": lambda: shaped("('a', 2)"),
    "npy of 1e12 rows": lambda: shaped("(1000000000000, 2)"),
    "npy of 1e23 rows": lambda: shaped("(100000000000000000000000, 2)"),
    "npy of 1e12 rows in Fortran order": lambda: shaped("(1000000000000, 2)", fortran=True),
    "npy of 1e23 rows in Fortran order": lambda: shaped(f"({10**23}, 2)", fortran=True),
    "npy of 1e9 columns": lambda: shaped("(2, 1000000000)", data=bytes(64)),
    "npy with a field of 2e8 numbers": lambda: shaped("(1,)", DESCR.format(200000000)),
    "npy with a field of 1e5 numbers": lambda: shaped("(1,)", DESCR.format(100000)),
    "npy with a field of no number": lambda: shaped("(1,)", DESCR.format(0), data=bytes(8)),
    "npy with a titled field": lambda: shaped("(1,)", "[(('long', 't'), '<f8')]", data=bytes(8)),
    "npy with one name twice": lambda: shaped("(1,)", "[('t', '<f8'), ('t', '<f8')]"),
    "npy with a field in a field": lambda: shaped("(1,)", "[('t', [('a', '<f8')])]"),
    "npy of an unknown type": lambda: shaped("(1,)", "'<q9'"),
    "npy of an offset": lambda: shaped("(1,)", "{'names': ['t'], 'formats': ['<f8']}"),
    "parquet with one name twice": twice,
    "parquet of lists with null": lists_with_null,
    "parquet of lists of no size": lambda: table(
        t=TIMES, axis=pa.array([[0.0]] * ROWS, pa.list_(pa.float64()))
    ),
    "parquet of nested lists": lambda: table(
        t=TIMES, matrix=pa.array([[[1.0]]] * ROWS, pa.list_(pa.list_(pa.float64(), 1), 1))
    ),
    "parquet of decimals": lambda: table(t=TIMES, theta=pa.array([1] * ROWS, pa.decimal128(9))),
    "parquet of words": lambda: table(t=["a"] * ROWS, theta=["b"] * ROWS),
    "parquet of nulls": lambda: table(t=pa.nulls(ROWS), theta=pa.nulls(ROWS)),
    "parquet of half numbers": lambda: table(t=TIMES, theta=TIMES.astype(np.float16)),
    "parquet of large integers": lambda: table(
        t=TIMES, theta=pa.array([2**63] * ROWS, pa.uint64())
    ),
    "parquet without rows": lambda: table(
        t=pa.array([], pa.float64()), theta=pa.array([], pa.float64())
    ),
    "parquet without columns": lambda: saved(lambda x: parquet.write_table(pa.table({}), x)),
    "a line without end": lambda: b"9" * 3_000_000,
    "a line of commas": lambda: b"," * 900_000 + b"\n" + b"," * 900_000,
    "a header of 1e5 columns": lambda: b",".join(b"c%d" % i for i in range(100_000)) + b"\n",
    "an open quote": lambda: b'id,r0\n"a,1\n' + b"b,2\n" * 5000,
    "NUL": lambda: CSV.replace(b"\n", b"\x00\n"),
    "UTF-16": lambda: CSV.decode().encode("utf-16"),
    "Latin-1": lambda: CSV.replace(b"\n", b" \xa0\xe9\n"),
    "a mark at the start alone": lambda: b"\xef\xbb\xbf",
    "old line ends": lambda: CSV.replace(b"\n", b"\r"),
    "nothing": lambda: b"",
    "blank lines": lambda: b"\n" * 100_000,
    "comments": lambda: b"# c\n" * 100_000,
    "brackets": lambda: b"[" * 900_000,
    "braces": lambda: b'{"a":' * 100_000,
    "an object of many keys": lambda: (
        b"{" + b",".join(b'"k%d":1' % i for i in range(60_000)) + b"}\n"
    ),
    "an object in an object": lambda: b'{"t": {"t": 1}, "theta": [[1]]}\n' * 9,
    "numbers of 1e5 digits": lambda: b"t,theta\n0," + b"9" * 100_000 + b"\n1,2\n",
    "great powers": lambda: b"t,theta\n0,1e999999999\n1,1e-999999999\n",
    "infinite numbers": lambda: b"t,theta\n0,inf\n1,nan\ninf,3\n",
    "times of 1.7e308": lambda: b"t,theta\n-1.7e308,30\n1.7e308,31\n",
    "TOML of many dots": lambda: b".".join([b"a"] * 5000) + b" = 1\n",
    "TOML of brackets": lambda: b"m = " + b"[" * 5000,
    "TOML of a large file": lambda: SCENE + b"#" * 100_000,
    "TOML of other types": lambda: b"m = true\nr0 = 1979-05-27\ns = [1]\n",
    "TOML of tables": lambda: b"[m]\nr0 = 1\n[[A]]\n",
    "GIF": lambda: b"GIF89a" + bytes(range(256)) * 40,
    "ELF": lambda: Path(sys.executable).read_bytes()[:100_000],
}
GOOD: dict[str, Make] = {
    "npz": good_npz,
    "npz by lzma": lambda: good_npz(zipfile.ZIP_LZMA),
    "npy": lambda: npy(TABLE),
    "npy with names": lambda: npy(np.rec.fromarrays(TABLE.T, names=["t", "theta"])),  # type: ignore[call-overload]
    "parquet": lambda: table(t=TIMES, theta=TABLE[:, 1]),
    "csv": lambda: CSV,
    "tops": lambda: TOPS,
    "scene": lambda: SCENE,
}
"""Files that are read; damaged at random they are hostile."""
COMMANDS = {
    "compare": ["compare", "{}"],
    "columns": ["compare", "{}", "--columns", "t,theta"],
    "fit": ["fit", "{}"],
    "solve": ["solve", "{}"],
    "sweep": ["sweep", "{}", "--keys", "r0,T_nutation"],
    "times": ["table", "--times", "{}"],
    "tops": ["table", "--tops", "{}", "--n", "2"],
}
CODES = {0, 1, 2, 65}
MEMORY, SECONDS = 3 << 29, 60
"""Limits of a run: bytes of address space beyond those after all imports, and processor time."""


def files(count: int, seed: int) -> dict[str, Make]:
    """Return so many hostile files by name: all of HOSTILE, and others damaged at random."""
    rng, found = random.Random(seed), dict(HOSTILE)
    while len(found) < count:
        name, number = rng.choice(sorted(GOOD)), rng.randrange(1 << 30)
        found[f"{name}, damaged by {number}"] = partial(damaged, GOOD[name](), number)
    return found


def run(words: list[str], said: BinaryIO) -> NoReturn:
    """Run a command in this process, with a limit of memory and time, and end it."""
    status = 99
    try:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115
        sys.stderr = open(said.fileno(), "w", errors="backslashreplace")  # noqa: SIM115
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY,) * 2)
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        signal.alarm(10 * SECONDS)
        command(prog_name="lagtop", args=words)
    except SystemExit as end:
        status = int(end.code or 0)
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(status)


def fault(words: list[str]) -> tuple[int, str]:
    """Run a command; return its exit code, and what is wrong with the run or an empty text."""
    with tempfile.TemporaryFile() as said:
        child = os.fork()
        if not child:
            run(words, said)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        said.seek(0)
        return code, fault_of(code, said.read().decode(), CODES)


def faults(count: int, seed: int) -> Iterator[str]:
    """Yield the faults of the files, then print the exit codes."""
    codes: Counter[tuple[str, int]] = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.chdir(folder)
        for number, (title, make) in enumerate(files(count, seed).items()):
            path = folder / f"{number}{'.toml' if 'TOML' in title else ''}"
            path.write_bytes(make())
            for kind, words in COMMANDS.items():
                filled = [word.format(path) for word in words]
                code, wrong = fault(filled)
                codes[kind, code] += 1
                if wrong:
                    yield f"{title}: lagtop {' '.join(filled)}: {wrong}"
            path.unlink()
        for left in folder.iterdir():
            yield f"leaves {left.name}"
        os.chdir("/")
    for (kind, code), number in sorted(codes.items()):
        print(f"  {kind:8} exit code {code:3}: {number}")


if __name__ == "__main__":
    given = options(__doc__, count=150).parse_args()
    finish(faults(given.count, given.seed))
