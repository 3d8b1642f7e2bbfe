"""`lagtop compare`: files, options, reports, pictures and exit codes."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from conftest import Lagtop
from engines import Body, Run, rk4
from lagtop import Top

from lagrange_cli.comparison.compare import COMPARISON_KEYS, Comparison
from lagrange_cli.comparison.report import _few_rows

TOP = Top(psidot0=3)
OPTIONS = ["--psidot0", 3]


def write(path: Path, run: Run, header: str = "t,qw,qx,qy,qz,p,q,r") -> Path:
    np.savetxt(path, np.column_stack(run), delimiter=",", header=header, comments="", fmt="%.17g")
    return path


@pytest.fixture
def right(tmp_path: Path) -> Path:
    """Return the file of a good trajectory."""
    return write(tmp_path / "right.csv", rk4(Body.of(TOP), 2e-3, 0.5))


def test_reports_and_exit_codes(lagtop: Lagtop, right: Path, tmp_path: Path) -> None:
    run = rk4(Body.of(TOP.replace(r0=-50)), 2e-3, 0.5)
    run[1][:, :4] *= 1.00001
    other = write(tmp_path / "other.csv", run)
    result = lagtop("compare", right, other, *OPTIONS)
    assert result.exit_code == 1
    said = f"{other}: off from the start, at most 3.1e+00 rad off, its rates by 1.6e+00 (relative)"
    said += "; most likely cause: r0 has the wrong sign"
    assert result.stderr == f"Error: 1 of 2 trajectories failed; the first: {said}\n"
    assert lagtop("compare", other, *OPTIONS).stderr == f"Error: {said}\n"
    assert "right.csv: fine, at most" in result.stdout
    assert "The norm of its quaternion or matrix differs from 1 by up to 1.0e-05." in result.stdout
    assert "Most likely cause: r0 has the wrong sign. With" in result.stdout
    rows = json.loads(lagtop("compare", right, other, *OPTIONS, "--format", "json").stdout)["rows"]
    assert [row["verdict"] for row in rows] == ["fine", "off from the start"]
    assert [list(row) for row in rows] == [[*COMPARISON_KEYS]] * 2
    assert lagtop("compare", "-", *OPTIONS, input=right.read_bytes()).exit_code == 0
    strict = lagtop("compare", right, *OPTIONS, "--max-error", "1e-9")
    hint = "The motion is that of the given top, to "
    assert (strict.exit_code, hint in strict.stdout) == (1, True)
    assert "file verdict rows max error at the end energy ─" in " ".join(strict.stdout.split())
    assert "rad off, its rates by 2.1e-07 (relative)." in strict.stdout


def test_a_few_wrong_rows_are_named(lagtop: Lagtop, tmp_path: Path) -> None:
    t, states = rk4(Body.of(TOP), 2e-3, 0.5)
    states[[70, 71]] = states[[170, 171]]
    shown = lagtop("compare", write(tmp_path / "x.csv", (t, states)), *OPTIONS).stdout
    assert "The limit is exceeded in only 2 of 251 rows, at t = 0.14, 0.142.\n" in shown
    last = Comparison(rows=251, t=t, error=np.where(t < t[-1], 0.0, 1.0))
    assert _few_rows(last, 1e-3) == ""  # the error may have begun to grow


def test_the_worked_example_is_not_assumed_in_silence(lagtop: Lagtop, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("t,theta\n0,30\n")
    done = lagtop("compare", tmp_path / "run.csv")
    assert done.stderr == "Warning: no scene and no inputs: compared with the worked example\n"


@pytest.mark.slow
def test_pictures(lagtop: Lagtop, right: Path, tmp_path: Path) -> None:
    sizes = []
    for how in ([], ["--step-sizes", "1e-3,2e-3"]):  # a second panel
        command = ["compare", right, right, *OPTIONS, "--plot", tmp_path / "a.svg", *how]
        assert lagtop(*command).exit_code == 0
        sizes.append((tmp_path / "a.svg").stat().st_size)
    assert sizes[0] < sizes[1]


def test_steps(lagtop: Lagtop, right: Path, tmp_path: Path) -> None:
    coarse = write(tmp_path / "coarse.csv", rk4(Body.of(TOP), 4e-3, 0.5))
    shown = lagtop("compare", coarse, right, *OPTIONS, "--step-sizes", "4e-3,2e-3").stdout
    assert "The error falls with the step; the order of convergence is 4." in shown
    sizes = "--step-sizes", "1/250", "--step-sizes", "1/500"
    again = lagtop("compare", right, right, *OPTIONS, *sizes).stdout
    assert "does not fall with the step: the numbers may have been rounded." in again


def test_conventions_by_options(lagtop: Lagtop, right: Path, tmp_path: Path) -> None:
    """An option overrides what p, q and r say of their frame."""
    table = np.loadtxt(right, delimiter=",", skiprows=1)
    rolled = np.column_stack([table[:, 0] + 3, np.roll(table[:, 1:5], -1, 1)])
    np.savetxt(tmp_path / "a.txt", rolled, "%.17g")
    how = ["--columns", "t,quaternion", "--align", "time", "--quaternion-order", "xyzw"]
    result = lagtop("compare", tmp_path / "a.txt", *OPTIONS, *how)
    assert result.exit_code == 0
    wrong = lagtop("compare", right, *OPTIONS, "--rates-frame", "space")
    assert "the rates are in the body frame (--rates-frame body)" in wrong.stdout


def test_quantities_that_agree_at_first_are_compared(lagtop: Lagtop, tmp_path: Path) -> None:
    """The first quantity counts, even if the first row gives the same motion without it."""
    t, states = (x[[0, -1]] for x in rk4(Body.of(TOP), 2e-3, 0.5))
    angle_rates = [0, 50 - 3 * math.cos(math.radians(30)), 3]
    constant = np.tile([*states[0, 4:], *angle_rates], (2, 1))
    names = "t,qw,qx,qy,qz,p,q,r,thetadot,phidot,psidot"
    twice = write(tmp_path / "twice.csv", (t, np.hstack([states[:, :4], constant])), names)
    found = lagtop("compare", twice, *OPTIONS)
    used = "Columns: t, qw, qx, qy, qz, p, q, r. Not used: thetadot, phidot, psidot."
    assert (found.exit_code, used in found.stdout) == (1, True)
    row = f"t,theta,phi,psi,rv0,rv1,rv2\n0,30,0,0,{math.pi / 6},0,0\n"
    found = lagtop("compare", "-", *OPTIONS, input=row)
    used = "Columns: t, theta, phi, psi. Not used: rv0, rv1, rv2."
    assert (found.exit_code, used in found.stdout) == (0, True)


def test_a_hint_names_the_options_of_the_command_line(lagtop: Lagtop, tmp_path: Path) -> None:
    path, turn = tmp_path / "other.csv", np.array([0.0, 9.0])
    rows = np.stack([turn, np.cos(turn**2), np.sin(turn**2), 0 * turn, 0 * turn], axis=1)
    np.savetxt(path, rows, delimiter=",", header="t,qw,qx,qy,qz", comments="")
    assert "(--align, --quaternion-order)" in lagtop("compare", path).stdout.replace("\n", " ")
