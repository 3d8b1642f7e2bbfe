"""`lagtop compare`: files, options, reports, pictures and exit codes."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Lagtop, assert_one_line
from engines import Body, Run, rk4, semi_implicit_euler
from lagtop import Top, solve
from scipy.spatial.transform import Rotation

from lagrange_cli.judge.judgement import JUDGEMENT_KEYS
from lagrange_cli.plot.reports import ErrorCurve, draw_errors

TOP = Top(psidot0=3)
OPTIONS = ["--psidot0", 3]
HEADER = "t,qw,qx,qy,qz,p,q,r"


def write(path: Path, run: Run, header: str = HEADER) -> Path:
    np.savetxt(path, np.column_stack(run), delimiter=",", header=header, comments="", fmt="%.17g")
    return path


@pytest.fixture
def right(tmp_path: Path) -> Path:
    """Return the file of a good trajectory."""
    return write(tmp_path / "right.csv", rk4(Body.of(TOP), 1e-3, 1))


@pytest.fixture
def coarse(tmp_path: Path) -> Path:
    """Return the file of a trajectory that drifts."""
    return write(tmp_path / "coarse.csv", semi_implicit_euler(Body.of(TOP), 1e-3, 1))


def rows_of(text: str) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads(text)["rows"]
    return rows


@pytest.mark.slow
def test_formats_say_the_same(lagtop: Lagtop, right: Path, coarse: Path) -> None:
    shown = {
        fmt: lagtop("compare", right, coarse, *OPTIONS, "--format", fmt)
        for fmt in ("json", "csv", "table")
    }
    assert {result.exit_code for result in shown.values()} == {1}
    rows = rows_of(shown["json"].stdout)
    assert [row["verdict"] for row in rows] == ["fine", "drifts"]
    assert [list(row) for row in rows] == [[*JUDGEMENT_KEYS]] * 2
    for row, cells in zip(rows, csv.DictReader(io.StringIO(shown["csv"].stdout)), strict=True):
        known = {key: "" if x is None else str(x) for key, x in row.items()}
        assert cells["verdict"] == known["verdict"]
        assert float(cells["psi_drift"]) == row["psi_drift"]
        assert [key for key, x in cells.items() if not x] == [
            key for key in known if not known[key]
        ]
    table = shown["table"].stdout
    assert "coarse.csv: drifts, at most 7.5e-01 rad off; psi drifts" in table
    assert "None of the common mistakes explains it." in table
    assert "scene      --m 1587.0" in table
    assert "lost at" not in table


@pytest.mark.parametrize(("limit", "code"), [(None, 0), ("1e-4", 0), ("1e-9", 1)])
def test_a_limit_for_tests_of_others(
    lagtop: Lagtop, right: Path, limit: str | None, code: int
) -> None:
    given = [] if limit is None else ["--max-error", limit]
    result = lagtop("compare", right, *OPTIONS, *given, "--format", "json")
    assert result.exit_code == code
    (row,) = rows_of(result.stdout)
    assert row["verdict"] == ("drifts" if code else "fine")
    why = f"Error: 1 of 1 trajectories failed; the first: {right}: drifts, at most 6.7e-07 rad off"
    assert result.stderr.startswith(why if code else "")
    assert result.stderr.count("\n") == code


@pytest.mark.parametrize("fmt", ["json", "csv", "table"])
def test_a_trajectory_that_is_not_fine_is_a_failure(
    lagtop: Lagtop, right: Path, tmp_path: Path, fmt: str
) -> None:
    """A check in somebody's pipeline must not stay green because no limit was typed."""
    other = write(tmp_path / "other.csv", rk4(Body.of(TOP.replace(r0=-50)), 1e-3, 0.5))
    options = [right, other, *OPTIONS, "--format", fmt]
    result = lagtop("compare", *options)
    assert result.exit_code == 1
    last = result.stderr.splitlines()[-1]
    assert last.startswith(
        f"Error: 1 of 2 trajectories failed; the first: {other}: moves like another top, at most "
    )
    assert last.endswith("; use --exit-zero to look only")
    looked = lagtop("compare", *options, "--exit-zero")
    assert (looked.exit_code, looked.stdout) == (0, result.stdout)
    assert "Error" not in looked.stderr
    both = lagtop("compare", other, other, *OPTIONS)
    assert "Error: 2 of 2 trajectories failed; the first: " in both.stderr


def test_wrong_rates_of_a_right_attitude_are_named(lagtop: Lagtop, tmp_path: Path) -> None:
    t, states = rk4(Body.of(TOP), 1e-3, 1)
    states[:, 4:] = [7, 8, 9]
    path = write(tmp_path / "rates.csv", (t, states))
    shown = lagtop("compare", path, *OPTIONS)
    assert shown.exit_code == 1
    assert " rad per unit of time off, its attitude at most " in shown.stderr
    assert "its angular velocities are " in shown.stdout
    assert "common mistakes" not in shown.stdout


def test_an_angle_whose_turns_cannot_be_counted_is_named(lagtop: Lagtop, tmp_path: Path) -> None:
    """The last line named psi, which drifts by 1e-17 rad, where it is phi that drifts."""
    t, path = np.linspace(0, 20, 200), tmp_path / "run.csv"
    theta, phi, psi = solve(TOP).angles(t)
    run = np.column_stack([t, theta, phi + 33.6 * t, psi])
    np.savetxt(
        path, run, delimiter=",", header="t,theta_rad,phi_rad,psi_rad", comments="", fmt="%.17g"
    )
    result = lagtop("compare", path, *OPTIONS)
    assert "rows are too far apart to count whole turns of phi" in result.stderr
    assert "drifts by" not in result.stdout + result.stderr


def test_steps_and_the_motion_of_another_top(lagtop: Lagtop, tmp_path: Path) -> None:
    """The engine takes the moment about the pivot as that about the mass centre."""
    steps, wrong = [4e-3, 2e-3], TOP.replace(A=39032 + 1587 * 16)
    for top, name in ((TOP, "right"), (wrong, "wrong")):
        for h in steps:
            write(tmp_path / f"{name}-{h}.csv", rk4(Body.of(top), h, 1))
    how = [*OPTIONS, "--step-sizes", "4e-3,2e-3"]
    right = lagtop("compare", *sorted(tmp_path.glob("right*"))[::-1], *how, "--format", "json")
    (coarse, fine) = rows_of(right.stdout)
    assert 3.5 < fine["order"] == coarse["order"] < 5
    assert [row["step"] for row in (coarse, fine)] == steps
    told = lagtop("compare", *sorted(tmp_path.glob("right*"))[::-1], *how, "--format", "table")
    assert "the order of convergence is" in told.stdout
    assert "common mistakes" not in told.stdout
    result = lagtop("compare", *sorted(tmp_path.glob("wrong*"))[::-1], *how)
    assert (
        "The error does not fall with the step: this is the motion of another top." in result.stdout
    )
    assert "taken as about the mass centre (A + m s^2). If that is corrected" in result.stdout


def test_steps_of_rounded_numbers(lagtop: Lagtop, tmp_path: Path) -> None:
    q = solve(Top()).table(np.linspace(0, 2, 101), ["t", "quaternion"])
    np.savetxt(tmp_path / "q", np.column_stack(list(q.values())), "%.6f", header=" ".join(q))
    result = lagtop("compare", tmp_path / "q", tmp_path / "q", "--step-sizes", "1e-2,5e-3")
    assert "fine, at most" in result.stdout
    assert "does not fall with the step: the numbers may have been rounded." in result.stdout


def test_rows_that_are_not_finite(lagtop: Lagtop, right: Path) -> None:
    lines = right.read_text().splitlines()
    lines[501:] = [line.replace(line.split(",")[2], "nan") for line in lines[501:]]
    right.write_text("\n".join(lines))
    result = lagtop("compare", right, *OPTIONS)
    assert result.exit_code == 1
    assert "right.csv: lost at t = 0.5, at most" in result.stdout
    said = f"Error: 1 of 1 trajectories failed; the first: {right}: lost at t = 0.5, at most "
    assert result.stderr.splitlines()[-1].startswith(said)


def test_order_frames_and_units_by_options(lagtop: Lagtop, tmp_path: Path) -> None:
    t, states = rk4(Body.of(TOP), 1e-3, 0.5)
    turn = Rotation.from_quat(states[:, :4], scalar_first=True)
    moved = turn * Rotation.from_matrix(np.eye(3)[[2, 0, 1]])
    np.save(tmp_path / "a.npy", np.column_stack([t + 3, moved.as_quat(), states[:, 4]]))
    how = ["--columns", "t,quaternion,_", "--align", "axis=y,time"]
    result = lagtop("compare", tmp_path / "a.npy", *OPTIONS, *how)
    assert "xyzw, as the first row proves" in result.stdout
    assert "a.npy: fine" in result.stdout
    for rad, angles in (("", turn.as_euler("XYZ", degrees=True)), ("--rad", turn.as_euler("XYZ"))):
        np.save(tmp_path / "b.npy", np.column_stack([t, angles]))
        how = ["--columns", "t,euler", "--euler-sequence", "XYZ", *filter(None, [rad])]
        assert "b.npy: fine" in lagtop("compare", tmp_path / "b.npy", *OPTIONS, *how).stdout


def test_the_scene_may_be_a_file(lagtop: Lagtop, right: Path, tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text("psidot0 = 3\nr0 = 7\n")
    how = [tmp_path / "scene.toml", "--r0", 50]
    assert "right.csv: fine" in lagtop("compare", right, *how).stdout


def test_the_report_names_the_units_of_the_inputs(lagtop: Lagtop, tmp_path: Path) -> None:
    body = ["--m", "2kg", "--A", "5kg*m^2", "--C", "3kg*m^2", "--s", "1m", "--g", "10m/s^2"]
    words = [*body, "--r0", "20rpm", "--theta0", "30deg"]
    path = tmp_path / "own.csv"
    lagtop("table", *words, "--columns", "t,theta,phi,psi", "-o", path)
    result = lagtop("compare", path, *words)
    assert result.stdout.startswith("inputs     in kg, m and s\nscene      --m 2.0 ")


def test_standard_input(lagtop: Lagtop, right: Path) -> None:
    result = lagtop("compare", "-", *OPTIONS, input=right.read_bytes())
    assert "\nstandard input: fine, at most" in result.stdout


@pytest.mark.slow
def test_pictures(lagtop: Lagtop, right: Path, coarse: Path, tmp_path: Path) -> None:
    how = [*OPTIONS, "--exit-zero", "--plot", tmp_path / "a.svg"]
    plain = lagtop("compare", right, coarse, *how)
    assert plain.exit_code == 0
    text = (tmp_path / "a.svg").read_text()
    assert "</svg>" in text
    lagtop("compare", right, coarse, *how, "--step-sizes", "1e-3,2e-3")
    assert len((tmp_path / "a.svg").read_text()) > len(text)
    assert_one_line(
        lagtop("compare", right, "--plot", "a.pdf"), 2, "--plot must end in .svg or .png"
    )


@pytest.mark.slow
def test_a_picture_without_a_single_error() -> None:
    t = np.linspace(0, 1, 5)
    for error in (np.zeros(5), np.full(5, np.nan)):
        assert draw_errors([ErrorCurve("a", t, error, 0.1, 0.0)], 1e-3, "a.png")[:4] == b"\x89PNG"


@pytest.fixture
def small_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a folder with some files of one row."""
    monkeypatch.chdir(tmp_path)
    Path("a.csv").write_text("t,theta\n0,30\n")
    Path("b.csv").write_text("t,theta\n0,x\n")
    Path("c.csv").write_text("t,theta\n1e99,30\n")
    Path("e.csv").write_text("t,thetadot,phidot,psidot\n0,0,50,0\n")
    Path("d.csv").write_text("t,q0,q1,q2,q3\n0,0.5,0.5,0.5,0.5\n")


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        ([], 2, "missing argument '[SCENE] TRAJECTORY...': see lagtop compare --help"),
        (["nowhere.csv"], 65, "nowhere.csv: No such file or directory"),
        (["-", "-"], 2, "standard input can be read once, got - twice"),
        (
            ["a.csv", "--step-sizes", "1,2"],
            2,
            "--step-sizes must have one number per trajectory (1), got 2",
        ),
        (["a.csv", "--step-sizes", "-1"], 2, "--step-sizes must be > 0, got -1.0"),
        (
            ["a.csv", "--step-sizes", "x"],
            2,
            "--step-sizes must be a finite decimal number, got 'x'",
        ),
        (["a.csv", "--max-error", "0"], 2, "--max-error must be > 0, got 0.0"),
        (["a.csv", "--align", "axis=w"], 2, "--align must be among axis=y, up=y, start"),
        (["a.csv", "--euler-sequence", "xxy"], 2, "--euler-sequence must be three axes"),
        (
            ["a.csv", "--quaternion-order", "xyz"],
            2,
            "--quaternion-order must be one of wxyz, xyzw, got 'xyz'",
        ),
        (["a.csv", "--columns", "t,thta"], 2, "--columns must be among t, quaternion"),
        (["a.csv", "--columns", "t"], 2, "--columns must name all 2 columns of a.csv"),
        (["b.csv"], 65, "b.csv, line 2, column 2: theta must be a number, got 'x'"),
        (["c.csv"], 65, "c.csv: t must be finite and within 2^50 periods"),
        (["d.csv"], 2, "d.csv: the first row does not prove the order of the quaternion"),
        (["e.csv"], 65, "e.csv: angle_rates must come with an attitude or a part of it"),
        (["a.csv", "--theta0", "200"], 2, "--theta0 must be in [0, 180]"),
    ],
)
@pytest.mark.usefixtures("small_files")
def test_bad_requests_get_one_line(
    lagtop: Lagtop, arguments: list[str], code: int, message: str
) -> None:
    assert_one_line(lagtop("compare", *arguments), code, message)


def test_a_header_without_rows_is_bad_data(lagtop: Lagtop) -> None:
    result = lagtop("compare", "-", input="t,theta\n")
    assert_one_line(result, 65, "standard input: t must have at least one row")


def test_nothing_is_written_for_a_bad_file(lagtop: Lagtop, right: Path, tmp_path: Path) -> None:
    (tmp_path / "out.csv").write_text("old")
    right.write_text(right.read_text()[:-30])
    assert lagtop("compare", right, "-o", tmp_path / "out.csv").exit_code == 65
    assert (tmp_path / "out.csv").read_text() == "old"
