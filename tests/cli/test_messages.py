"""Messages name options in place of arguments, and never touch the name of a file."""

from __future__ import annotations

import doctest
import os
import re
from pathlib import Path

import pytest
from conftest import Lagtop
from hypothesis import given
from hypothesis import strategies as st

from lagrange_cli import errors
from lagrange_cli.errors import MARK, LagtopError, Message, arg, joined


def test_examples_of_messages_run() -> None:
    assert doctest.testmod(errors, extraglobs={"warnings": None}, name="errors").attempted >= 2


@given(st.binary(), st.text(st.characters(exclude_categories=["Cs"])))
def test_no_name_of_a_file_and_no_text_forges_a_mark(name: bytes, text: str) -> None:
    for each in (os.fsdecode(name), text):
        assert MARK not in each
        message = Message(f"{each}: use {arg('dt', each)} or {arg('C')}")
        assert message == f"{each}: use dt={each} or C"
        assert message.with_options({"dt": "--dt"}) == f"{each}: use --dt {each} or C"


def test_marks_survive_a_longer_message() -> None:
    inner = LagtopError("r0 must be > 0", "r0")
    outer = LagtopError.at("r0=5.csv, line 2", inner, f" ({arg('rad')})")
    assert (str(outer), outer.key) == ("r0=5.csv, line 2: r0 must be > 0 (rad)", "r0")
    both = joined([outer, inner]).with_options({"r0": "--r0", "rad": "--rad"})
    assert both == "r0=5.csv, line 2: --r0 must be > 0 (--rad); --r0 must be > 0"


FILES = {
    "recording": "t,theta,phi,psi\n0,30,0,0\n0.1,31,280,10\n",
    "tops": "r0,theta0\n10,20\n-1,500\n",
    "scene": "r0 = 'fast'\n",
    "text": "1 2 3 4\n",
    "empty": "",
}
NAMES = ("r0=50.csv", "theta0=31.csv", "keys=a.csv", "x/r0=5.toml", "columns \x1ddt\x1d.csv")
LINES = (
    *("fit FILE", "fit FILE --format json", "fit FILE --decimal comma", "fit FILE --columns t,x"),
    *("compare FILE", "compare FILE --r0 -50 --format csv", "compare FILE --format markdown"),
    *("sweep FILE --format csv", "sweep FILE --m -1", "solve FILE", "table --times FILE"),
)


@pytest.mark.parametrize("line", LINES)
def test_names_of_files_stay_as_they_are(
    line: str, lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x").mkdir()
    for name in NAMES[: -1 if "markdown" in line else None]:  # which joins words by one blank
        folder, _, base = name.rpartition("/")
        stem, dot, extension = base.rpartition(".")
        neutral = os.path.join(folder, re.sub("[^ ]", "z", stem) + dot + extension)
        for text in FILES.values():
            found = []
            for path in (name, neutral):
                Path(path).write_text(text)
                ended = lagtop(*(x.replace("FILE", path) for x in line.split(" ")))
                shown = path.replace("\x1d", r"\x1d")
                said = f"{ended.stdout}{ended.stderr}".replace(path, shown).replace(shown, "FILE")
                found.append([ended.exit_code, *re.split("[ ─]+", said)])  # widths of columns
                Path(path).unlink()
            assert found[0] == found[1]


@pytest.mark.parametrize("window", [(), pytest.param(("--window", "2"), marks=pytest.mark.slow)])
def test_a_report_holds_every_reason_that_the_last_line_does_not(
    window: tuple[str, ...], lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    header, *rows = lagtop("table", "--n", 60 if window else 20).stdout.splitlines()
    rows = [f"{x.partition(',')[0]},40,0,0" if i % 3 == 0 else x for i, x in enumerate(rows)]
    (tmp_path / "bad.csv").write_text("\n".join([header, *rows]))
    whole = lagtop("fit", "bad.csv", *window)
    reasons = [x for x in whole.stdout.splitlines() if x.startswith("Failed: ")]
    assert (len(reasons) > 1, whole.exit_code) == (True, 1)
    last = whole.stderr.splitlines()[-1]
    assert last.startswith("Error: ")
    assert last.endswith(reasons[0].removeprefix("Failed: ").removesuffix("."))
    for name in ("is_screen", "is_terminal"):
        monkeypatch.setattr(f"lagrange_cli.cli.fit.{name}", lambda _: True)
    seen = lagtop("fit", "bad.csv", *window)
    assert [x for x in seen.stdout.splitlines() if x.startswith("Failed: ")] == reasons[1:]
    assert seen.stderr == whole.stderr
