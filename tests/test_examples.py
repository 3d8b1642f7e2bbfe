"""Pages of examples: the wording of messages, and numbers that are known exactly.

`python tests/test_examples.py` rewrites the messages that no longer are as shown.  All other tests
ask for the type of an error and for its values.
"""

from __future__ import annotations

import math
import re
import shlex
import shutil
from contextlib import chdir
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import lagtop
import numpy as np
import pint
import pytest
import xarray
from click.testing import CliRunner, Result
from lagtop import LagtopError, Top, find, sensitivities, solve
from recordings import SAMPLES
from scenes import UNIT
from uncertainties import ufloat

from lagrange_cli.account.explanation import explanations
from lagrange_cli.arithmetic.enclosures import equal_digits, text_of
from lagrange_cli.bench.stability import verdict_of
from lagrange_cli.cli.app import main
from lagrange_cli.cli.shared import is_scene
from lagrange_cli.comparison.convergence import convergence
from lagrange_cli.elliptic.arguments import parse_arguments
from lagrange_cli.elliptic.eta import Quadrature, eta_record
from lagrange_cli.files.headings import name_and_unit
from lagrange_cli.inverse.known import compared
from lagrange_cli.names import check_names
from lagrange_cli.recordings.options import Reading
from lagrange_cli.recordings.quantities import quantities_in
from lagrange_cli.recordings.reading import read_recording
from lagrange_cli.solver.tables import ProvedTable
from lagrange_cli.top import values
from lagrange_cli.top.units import Units, conversion

PAGES = Path(__file__).parent / "examples"
WORDING, KNOWN = (
    (PAGES / f"{name}.txt").read_text(encoding="utf-8") for name in ("wording", "numbers")
)
MESSAGES = re.findall(r"^((?:\$|>>>) .*)\n(.*)", WORDING, re.MULTILINE)
"""Command lines and calls, and what they end with; `...` stands for any words."""
SLOW = WORDING.partition("\nSlow fits\n")[2].partition("\n\n\n")[0]
NUMBERS = re.findall(r"^((?:\$|>>>) .*)\n((?:.+\n)+)", KNOWN, re.MULTILINE)
"""Command lines and calls, and all that they print; `...` stands for any cell."""


def bytes_of(text: str) -> bytes:
    """Return the bytes that `printf` writes for a text with backslashes."""
    return text.encode().decode("unicode_escape").encode("latin-1")


FILES = {x: bytes_of(text) for x, text in re.findall(r"^File (\S+): (.*)", WORDING, re.MULTILINE)}
"""Files beside an empty `folder` and a link to itself, `loop`, where commands run; none changes."""


# Functions that the examples call


def sentence(words: str) -> str:
    """Return the sentence before the record that `lagtop solve` shows."""
    return " ".join(ended(f"lagtop solve {words}").stdout.partition("\n\n")[0].split())


def unit(**inputs: Any) -> Top:
    """Return a top whose body and gravity are 1, unless another is given."""
    return Top(**UNIT | inputs)


def numbers(top: Top, keys: str) -> str:
    """Return numbers of a motion, as doubles."""
    return " ".join(str(getattr(solve(top), key)) for key in keys.split())


def digits(top: Top, count: int, keys: str) -> str:
    """Return numbers of a motion, in decimals."""
    record = solve(top).record(digits=count, keys=keys.split())
    return " ".join(record[key] for key in keys.split())


def regimes(top: Top, **change: float) -> str:
    """Return the regime of a top, and that of a neighbour."""
    return f"{solve(top).regime.value} | {solve(top.replace(**change)).regime.value}"


def row(top: Top, t: str, columns: str) -> str:
    """Return columns at a time in one digit, with radians."""
    table = ProvedTable(solve(top), columns.split(), 1, units=Units(radians=True))
    return " ".join(number.value for number in table.row(Fraction(t)))


def derivative(top: Top, key: str, name: str) -> str:
    """Return a derivative by an input to 11 digits."""
    found = sensitivities(top, [key]).derivatives[key][name]
    return str(found if found is None else f"{found:.11g}")


def uncertain(text: str) -> str:
    """Return an uncertain number as fractions, read as one value and as the points of a range."""
    value = values.parse_value("m", text, uncertain=True)
    points = values.parse_value("m", text, values.parse_values, uncertain=True)
    assert (points.number.exact, points.std) == ([value.number], value.std)
    return f"{value.number} +/- {value.std}"


def size_of(key: str, unit: str) -> Fraction:
    """Return the size of a unit in SI, without the power of pi."""
    return conversion(key, unit)[0]


def argument(text: str) -> str:
    """Return the real and imaginary part of an argument, and its multiples of K, iK, K', iK'."""
    arguments = parse_arguments(text)
    [parts] = arguments.numbers(20)
    assert arguments.has_quarters is any(parts[2:])
    return " ".join(map(str, parts))


def columns_known(header: str) -> str:
    """Return the quantities that are known by names of columns, but the time, and their places."""
    found = sorted((name, of.columns) for name, of in quantities_in(header.split()).items())
    return ", ".join(f"{name} {' '.join(map(str, at))}" for name, at in found if name != "t")


def read(text: str, *columns: str) -> str:
    """Return the numbers that are read from a file, in SI, and what is said of its time."""
    with TemporaryDirectory() as place:
        (path := Path(place, "file")).write_text(text, encoding="utf-8")
        found = read_recording(str(path), Reading.of(columns=[*columns] or None))
    numbers = {"t": found.t} | {x: y for x, y in found.given.items() if x not in {"t", "missing"}}
    shown = (f"{x} {' '.join(f'{z:.12g}' for z in np.ravel(y))}" for x, y in numbers.items())
    return "\n".join([found.source.lines[0], *shown])


def said_of(*errors: float) -> str:
    """Return what is said of errors that grow over a second, at steps of 4, 2 and 1 ms."""
    t = np.linspace(0, 1, 201)
    steps = (4e-3, 2e-3, 1e-3)
    found = convergence([(x, t, y * t) for x, y in zip(steps, errors, strict=True)], 0.1)
    return f"{found.sentence} {found.converges}" if found else ""


def eta_zeros(lower: str, upper: str, *outer: str) -> str:
    """Return the constants of an eta that are 0 in digits, as in doubles."""
    of = Quadrature(Fraction(lower), Fraction(upper), tuple(map(Fraction, outer)), Fraction(1))
    zeros = [key for key, text in eta_record(of, 20).items() if text == "0.0"]
    assert zeros == [key for key, x in eta_record(of).items() if x == 0]
    return " ".join(zeros) or "none"


def tops_found(*conditions: str) -> list[float]:
    """Return r0 of the tops with the nutation period 0.45 and other conditions."""
    return [round(float(x.top.r0), 6) for x in find(["T_nutation=0.45", *conditions], r0="10:60")]


CALLED = (
    *(sentence, unit, numbers, digits, regimes, row, derivative, uncertain, size_of, argument),
    *(columns_known, explanations, read, said_of, tops_found, eta_zeros, compared, equal_digits),
    *(is_scene, parse_arguments, verdict_of, Quadrature, eta_record, check_names, name_and_unit),
    *(text_of, ufloat, lagtop, math, pint, xarray, Decimal, Fraction),
)
NAMES: dict[str, Any] = {name: getattr(lagtop, name) for name in dir(lagtop)}
NAMES |= vars(values) | {x.__name__: x for x in CALLED} | {"np": np}


# The tests


def ended(command: str) -> Result:
    """Return the end of a command line, perhaps after `printf ... |`."""
    printed, _, words = command.rpartition(" | ")
    given = bytes_of(shlex.split(printed)[1]) if printed else None
    return CliRunner(catch_exceptions=False).invoke(main, shlex.split(words)[1:], input=given)


def said_by(line: str) -> str:
    """Return the last line of a command, with its exit code if that is not 2, or an exception."""
    if line.startswith(">>> "):
        try:
            return str(eval(line[4:], NAMES))
        except (LagtopError, TypeError, AttributeError) as error:
            return f"{type(error).__name__}: {error}"
    end = ended(line.removeprefix("$ "))
    *_, said = end.stderr.splitlines()
    if not end.exit_code:
        assert said.startswith("Warning: ")
        return said
    assert said.startswith("Error: ")
    assert end.stdout == "" or line.startswith("$ lagtop fit ")  # the report of a failed fit
    return said if end.exit_code == 2 else f"{said} [{end.exit_code}]"


def matches(shown: str, found: str, blank: str) -> bool:
    """Return whether a text is as shown, with `blank` in place of three dots."""
    return bool(re.fullmatch(blank.join(map(re.escape, shown.split("..."))), found))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the files that the messages read."""
    return filled(tmp_path_factory.mktemp("messages"))


def filled(folder: Path) -> Path:
    """Write the files into a folder, beside an empty one and a link to itself."""
    (folder / "folder").mkdir()
    (folder / "loop").symlink_to("loop")
    for name, content in FILES.items():
        (folder / name).write_bytes(content)
    for path in [*PAGES.glob("*.csv"), SAMPLES / "tutorials" / "wheel.csv"]:
        shutil.copy(path, folder)
    return folder


def state_of(folder: Path) -> dict[Path, tuple[int, int]]:
    """Return which files a folder holds, and when each was last written."""
    found = ((x, x.lstat()) for x in folder.rglob("*"))
    return {x: (of.st_ino, of.st_mtime_ns) for x, of in found}


@pytest.mark.filterwarnings("ignore::lagrange_cli.MixedBodyWarning")
@pytest.mark.parametrize(
    ("line", "said"),
    [pytest.param(*x, marks=[pytest.mark.slow] * (x[0] in SLOW)) for x in MESSAGES],
)
def test_a_message(line: str, said: str, folder: Path) -> None:
    before = state_of(folder)
    with chdir(folder):
        found = said_by(line)
    assert found.isprintable()
    assert found == said or matches(said, found, ".*")
    assert state_of(folder) == before


@pytest.mark.parametrize(("line", "shown"), NUMBERS)
def test_numbers(line: str, shown: str) -> None:
    if line.startswith(">>> "):
        assert f"{eval(line[4:], NAMES)}\n" == shown
    else:
        end = ended(line.removeprefix("$ "))
        assert end.exit_code == 0, end.stderr
        assert matches(shown, end.stdout, "[^,\n]+")


def rewrite() -> None:
    """Put the messages that are no longer as shown into the file."""
    text = WORDING
    with TemporaryDirectory() as place:
        folder = filled(Path(place))
        for line, said in MESSAGES:
            try:
                test_a_message(line, said, folder)
            except AssertionError:
                with chdir(folder):
                    text = text.replace(f"{line}\n{said}\n", f"{line}\n{said_by(line)}\n", 1)
    (PAGES / "wording.txt").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    rewrite()
