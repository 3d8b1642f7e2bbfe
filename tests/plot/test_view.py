"""The page of `lagtop view` as a document, the command, and what notebooks show."""

from __future__ import annotations

import re
import webbrowser
from html import unescape
from pathlib import Path
from xml.etree import ElementTree

import pytest
from conftest import ROOT, Lagtop, assert_one_line
from lagtop import LagtopError, Top, solve, view

from lagrange_cli.plot.browser import joined_script

FOLDER = ROOT / "lagrange_cli" / "plot" / "browser"
SCRIPTS = sorted(FOLDER.rglob("*.js"))


def test_the_page_is_one_small_file_that_needs_no_other() -> None:
    page = view(solve(Top(r0=33.25)))
    assert len(page.encode()) < 300_000
    assert '"r0": 33.25' in page
    assert "{{" not in page
    assert not re.search(r"https?://|<script src|<link rel=.stylesheet|@import|fetch\(", page)


def test_every_module_is_in_the_page_once_and_after_those_it_needs() -> None:
    script = joined_script("const DATA = {};\n")
    assert script.startswith("const DATA = {};\n")
    assert not re.search("^(import|export) ", script, re.MULTILINE)
    names = re.findall(r"^(?:async )?(?:function|class|const) (\w+)", script, re.MULTILINE)
    assert len(names) == len(set(names)) > 100  # one scope holds them
    starts = {path: script.index(path.read_text().partition("\n")[0]) for path in SCRIPTS}
    for path, start in starts.items():
        needed = re.findall(r'^import [^;]* from "(.*)";$', path.read_text(), re.MULTILINE)
        others = [(path.parent / other).resolve() for other in needed]
        assert all(starts[x] < start for x in others if x.name != "data.js"), path


def test_modules_of_the_page_are_small() -> None:
    for path in SCRIPTS:
        lines = path.read_text().splitlines()
        assert len(lines) <= 300, path.name
        assert max(map(len, lines)) <= 100, path.name
        assert lines[0].startswith("// "), path.name
    numerics = (FOLDER / "numerics").glob("*.js")
    assert sum(len(path.read_text().splitlines()) for path in numerics) <= 800


def test_numerical_modules_do_not_touch_the_document() -> None:
    for path in (FOLDER / "numerics").glob("*.js"):
        assert not re.search(r"document|window|\.\./(?!data\.js)", path.read_text()), path.name


def test_the_command_writes_the_page(lagtop: Lagtop, tmp_path: Path) -> None:
    target = tmp_path / "top.html"
    scene = ROOT / "sample_inputs" / "looping-top.toml"
    result = lagtop("view", scene, "--r0", 40, "-o", target)
    assert (result.exit_code, result.output) == (0, "")
    assert target.read_text() == view(solve(Top(r0=40, psidot0=-4)))
    assert lagtop("view", "--r0", 40, "-o", "-").stdout.startswith("<!DOCTYPE html>")


def test_the_page_names_the_units_of_its_inputs(lagtop: Lagtop) -> None:
    assert 'const UNITS = {"mass": "mass", "len": "len"' in view(solve(Top()))
    body = ["--m", "1587 g", "--A", "39032 g*cm^2", "--C", "17458 g*cm^2", "--s", "4 cm"]
    start = ["--g", "981 cm/s^2", "--r0", "50 rad/s"]
    page = lagtop("view", *body, *start, "-o", "-").stdout
    assert 'const UNITS = {"mass": "kg", "len": "m", "time": "s"};' in page
    assert '"m": 1.587' in page


def test_the_command_opens_the_page(
    lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened: list[str] = []

    def note(url: str) -> bool:
        opened.append(url)
        return True

    monkeypatch.setattr(webbrowser, "open", note)
    target = tmp_path / "top.html"
    assert lagtop("view", "--open", "-o", target).exit_code == 0
    assert opened == [target.as_uri()]
    assert lagtop("view", "--open").exit_code == 0
    written = Path(opened[1].removeprefix("file://"))
    assert written.read_text().startswith("<!DOCTYPE html>")
    written.unlink()
    written.parent.rmdir()
    monkeypatch.setattr(webbrowser, "open", lambda url: False)
    assert_one_line(
        lagtop("view", "--open", "-o", target), 2, f"--open found no browser; the page is {target}"
    )


REFUSED = [
    ("", 2, "nothing to do: give -o FILE.html or --open"),
    ("--open -o -", 2, "a page on standard output is not to open"),
    ("-o x.png", 2, "-o must be a file that ends in .html, got 'x.png': a page is HTML"),
    ("nowhere.toml -o x.html", 65, "nowhere.toml: No such file"),
    ("--r0 1e40 -o x.html", 2, "--r0 must be from 1e-30 to 1e30 for a page, got 1e+40"),
    ("--m 1e-40 --A 1 --C 1 --s 1 --g 1 -o x.html", 2, "--m must be from 1e-30 to 1e30 for a"),
    ("--theta0 1e-14 -o x.html", 2, "--theta0 must be 0, 180 or 1e-12 from both for a page"),
    ("-o no/where.html", 74, "cannot write no/where.html: No such file"),
]


def test_bad_input(lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for line, code, message in REFUSED:
        assert_one_line(lagtop("view", *line.split()), code, message)
    assert list(tmp_path.iterdir()) == []


def test_a_tilt_that_rounds_to_the_vertical_does_not_precess() -> None:
    with pytest.raises(LagtopError, match="psidot0 must be 0 if the axis is vertical"):
        view(solve(Top(theta0_rad=3.141592653589793, psidot0=1)))


def test_a_notebook_shows_the_page_in_a_frame() -> None:
    motion = solve(Top(r0=20))
    page = motion.view()
    assert page == view(motion)
    frame = page._repr_html_()
    inside = re.fullmatch(r'<iframe style="[^"]*" srcdoc="([^"]*)"></iframe>', frame)
    assert inside
    assert unescape(inside[1]) == page


def test_a_notebook_shows_the_record_with_symbols_and_units() -> None:
    motion = solve(Top())
    table = ElementTree.fromstring(motion._repr_html_())
    rows = {row[0].text: [cell.text for cell in row[1:]] for row in table.iter("tr")}
    record = motion.record()
    assert list(rows) == [key for key, value in record.items() if value is not None]
    assert [row[2] for row in rows.values()] == [str(record[str(key)]) for key in rows]
    assert rows["mean_spin_rate"] == [
        *("φ' mean", "mean spin rate", str(motion.mean_spin_rate), "rad/time")
    ]
