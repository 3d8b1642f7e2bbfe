"""The command `lagtop plot`: its words, its refusals, its window, and the README's pictures."""

from __future__ import annotations

import math
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT, Lagtop, process
from lagtop import LagtopError, Top, solve

from lagrange_cli.plot import draw_map
from lagrange_cli.plot.kinds import help_lines


def test_the_help_lists_the_kinds(lagtop: Lagtop) -> None:
    text = lagtop("plot", "--help").output
    for line in help_lines():
        assert re.sub(r"\s+", " ", line) in re.sub(r"\s+", " ", text)


@pytest.mark.slow
def test_kinds_and_scene_in_any_order(lagtop: Lagtop, tmp_path: Path) -> None:
    scene = str(ROOT / "sample_inputs" / "looping-top.toml")
    files = [tmp_path / "a.svg", tmp_path / "b.svg"]
    for words, file in (([scene, "cubic"], files[0]), (["cubic", scene], files[1])):
        result = lagtop("plot", *words, "-o", file)
        assert (result.exit_code, result.output) == (0, "")
    assert files[0].read_bytes() == files[1].read_bytes()


REFUSED = [
    ("", "nothing to do: give -o FILE.png or --animate FILE.gif"),
    ("spere", "got 'spere' (did you mean 'sphere'?)"),
    ("--duration 3", "--duration needs --animate FILE.gif"),
    ("sphere --camera 30", "--camera must be AZIMUTH,ELEVATION"),
    ("nowhere.toml -o x.png", "nowhere.toml: No such file", 65),
    ("-o x.jpg", "-o must be a file that ends in .png, .svg or .pdf, got 'x.jpg'"),
    ("-o x.png --dpi 1e9", "--dpi must be in [20, 571] for 15.3 x 10 inches, got 1e+09"),
    ("-o x.png --animate x.avi", "--animate must be a file that ends in .gif or .mp4"),
    ("-o x.png --t-max 0", "--t-max must be > 0, got 0"),
    ("-o x.png --t-max 1e6", "--t-max must be at most 1000 nutation periods = 429.25"),
    ("-o no/where.png cubic", "cannot write no/where.png: No such file", 74),
    ("remainders --theta0 0 -o x.png", "no remainders: the tilt is constant (sleeping)"),
    ("map --key colour -o x.png", "--key must be among"),
    ("map --x r0=1:2 -o x.png", "--x must be a range [log:]start:stop:count, got '1:2'"),
    (["map", "--m", "1kg", "--x", "r0=1:2:3", "-o", "x.png"], "--x: r0 must have a unit such as"),
    (["map", "--x", "s=1:6:4 s", "-o", "x.png"], "--x: s must have a unit as in 4cm"),
    (["map", "--x", "s=1cm:6cm:4", "-o", "x.png"], "--x must have its unit once, at the end"),
    ("map --x q=1:2:3 -o x.png", "--x must begin with one of m A C s g r0"),
    ("map --x r0=2:1:3 -o x.png", "--x must have start < stop"),
    ("map --x r0=1:2:1 -o x.png", "--x must have a count of 2 or more between"),
    ("map --x r0=1:2:3000 -o x.png", "--x must have a count in [2, 2000], got 3000"),
    ("map --x r0=1:z:9 -o x.png", "--x must be a finite decimal number, got 'z'"),
    ("map --x theta0=1:2:3 -o x.png", "--x must differ from y, got theta0 for both"),
    ("-o x.png sphere --camera 30", "--camera must be AZIMUTH,ELEVATION in [-360, 360] and [-90"),
    ("-o x.png sphere --camera 30,95", "[-90, 90] deg, got '30,95'"),
    ("-o x.png sphere --camera 30,nan", "[-90, 90] deg, got '30,nan'"),
    ("-o x.png sphere --rad --camera 3,2", "[-2π, 2π] and [-π/2, π/2] rad, got '3,2'"),
    ("--animate x.gif --duration 1e4", "--duration must be in [0.08, 120] seconds, got"),
    ("--animate x.gif --duration 0", "--duration must be in [0.08, 120] seconds"),
    ("--x r0=1:2:3 -o x.png", "--x needs map, got sphere, angles, remainders, cubic"),
    ("sphere --key b --animate x.gif", "--key needs map, got sphere"),
    ("cubic phase --camera 30,15 -o x.png", "needs sphere or --animate FILE.gif, got cubic, phase"),
    ("cubic --t-max 1 -o x.png", "--t-max needs sphere or angles or remainders or --animate"),
    ("--animate x.avi", "--animate must be a file that ends in .gif or .mp4, got 'x.avi'"),
]
"""Options, the message, and the exit code if it is not 2."""


@pytest.mark.parametrize("row", REFUSED, ids=lambda row: str(row[0]))
def test_bad_input(
    lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, row: tuple[Any, ...]
) -> None:
    line, message, code = (*row, 2)[:3]
    monkeypatch.chdir(tmp_path)
    result = lagtop("plot", *(line.split() if isinstance(line, str) else line))
    assert (result.exit_code, result.stdout) == (code, "")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_axes_of_a_map_have_units(lagtop: Lagtop, tmp_path: Path) -> None:
    """Equal ranges in other units give the same picture, which names the units of the system."""
    same = [
        ("r0=30:300:4 rpm", "theta0=10:90:3"),
        ("r0=180:1800:4 deg/s", f"theta0={math.pi / 18}:{math.pi / 2}:3 rad"),
    ]
    pictures = []
    for i, (x, y) in enumerate(same):
        path = tmp_path / f"{i}.svg"
        done = lagtop("plot", "map", "--x", x, "--y", y, "--key", "b", "-o", path)
        assert (done.exit_code, done.stderr) == (0, "")
        pictures.append(re.sub(r"<dc:date>.*?</dc:date>", "", path.read_text()))
    assert pictures[0] == pictures[1]
    with pytest.raises(LagtopError, match="x must have no unit, as the motion has none"):
        draw_map(solve(Top()), x="r0=30:300:4 rpm")


def test_the_help_needs_no_matplotlib_and_a_picture_says_how_to_get_it(tmp_path: Path) -> None:
    code = "import sys; sys.modules['matplotlib'] = sys.modules['numpy'] = None; "
    code += "import lagrange_cli.cli.app as cli; cli.main()"
    line = [sys.executable, "-c", code, "plot"]
    helped = subprocess.run([*line, "--help"], capture_output=True, check=True)
    assert helped.stdout.startswith(b"Usage:")
    target = tmp_path / "x.png"
    target.write_text("old")
    failed = subprocess.run([*line, "-o", str(target)], capture_output=True, check=False)
    assert failed.returncode == 69
    assert failed.stderr == b"Error: pictures need matplotlib: pip install 'lagtop[plot]'\n"
    assert target.read_text() == "old"


@pytest.mark.slow
def test_no_window_without_a_display(tmp_path: Path) -> None:
    bare = {key: x for key, x in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
    for backend in ({}, {"MPLBACKEND": "tkagg"}):
        words = ["plot", "--show", "-o", "x.png", "--animate", "x.gif"]
        result = process(*words, check=False, cwd=tmp_path, env=bare | backend)
        assert result.returncode == 2
        assert result.stderr.startswith(b"Error: --show")
        assert result.stderr.count(b"\n") == 1
        assert list(tmp_path.iterdir()) == []  # no file is written first


@pytest.mark.slow
def test_the_pictures_of_the_readme(lagtop: Lagtop, tmp_path: Path) -> None:
    """Each is what the command beside it makes, and small."""
    page = (ROOT / "lagrange_cli" / "plot" / "README.md").read_text()
    lines = re.findall(r"^lagtop (plot .*-o (sample_inputs/images/\S+))$", page, re.MULTILINE)
    assert len(lines) == 3
    for line, name in lines:
        words = shlex.split(line)
        words[-1] = str(tmp_path / Path(name).name)
        words = [str(ROOT / word) if word.endswith(".toml") else word for word in words]
        assert lagtop(*words).exit_code == 0
        assert (ROOT / name).stat().st_size < 150_000
        assert f"(../../{name})" in page
        assert Path(words[-1]).stat().st_size == pytest.approx(
            (ROOT / name).stat().st_size, rel=0.3
        )
