"""`lagtop fit`: bad data, bad commands, the report, the picture and windows."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
import recordings
from conftest import Lagtop, assert_one_line
from engines import Array
from lagtop import read_scene
from noisy_recordings import recorded, recording_from

from lagrange_cli.inverse.checks import CHANCE, chi2_bounds
from lagrange_cli.inverse.report import fit_report
from lagrange_cli.inverse.search import best_fit


@pytest.mark.parametrize(
    ("header", "row", "message"),
    [
        ("t,theta,psi", "{t},40,10", "the precession rate is not determined"),
        ("t,p,q,r", "{t},1,2,3", "must have columns for angles, an axis or an attitude"),
        ("t,x,y", "{t},1,2", r"psi alone \(from t, x, y\) does not determine a top: give --theta0"),
        ("t,phi", "{t},3", "must have theta or psi too: phi alone does not determine a top"),
        (
            "t,theta",
            "{t},40",
            r"theta alone \(from t, theta\) does not determine a top: give --psidot0, 0 if",
        ),
        ("t,theta,psi", "0,40,{t}", "t must span"),
        ("t,theta,psi", "{t},240,{t}", "theta must be between 0 and 180 deg"),
        ("t,theta,psi", "-{t},,", r"theta is empty \(theta\): remove its columns, or skip"),
    ],
)
def test_bad_data_get_a_line(
    lagtop: Lagtop, tmp_path: Path, header: str, row: str, message: str
) -> None:
    path = tmp_path / "data.csv"
    rows = [row.format(t=i) for i in range(20)]
    path.write_text("\n".join([header, *rows, ""]))
    result = lagtop("fit", path)
    assert result.exit_code in {1, 65}
    assert result.stderr.splitlines()[-1].startswith("Error: ")
    assert re.search(message, result.stderr)


SAMPLE = str(recordings.SAMPLES / "recording.csv")


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (f"{SAMPLE} {SAMPLE}", 2, "fit takes one recording, got 2: fit each file alone"),
        (f"{SAMPLE} --sigma -1", 2, "--sigma must be > 0, got -1"),
        (f"{SAMPLE} --sigma theta=1", 2, "--sigma must be given for all of theta, phi, psi"),
        (f"{SAMPLE} --window 1", 2, "--window must be at least 2, got 1"),
        (
            f"{SAMPLE} --window 1e9",
            2,
            "--window must leave 12 rows or more in each window, got 0",
        ),
        (f"{SAMPLE} --window 3 --r0 50", 2, "--r0 is not the same in all windows: leave it out"),
        (f"{SAMPLE} --g 0", 2, "--g must not be 0 in a fit: leave it out"),
        (f"{SAMPLE} --spin-period 0", 2, "--spin-period must not be 0 in a fit: leave it out"),
        (f"{SAMPLE} --phidot0 1e300", 2, "--phidot0 must be within 1e100 in magnitude, got 1e+300"),
        (f"{SAMPLE} --A-cm 1", 2, "--A-cm must be given with m and s, as A = A_cm + m s^2"),
    ],
)
def test_bad_commands(lagtop: Lagtop, words: str, code: int, message: str) -> None:
    assert_one_line(lagtop("fit", *words.split()), code, message)


def written(path: Path, recording: tuple[Array, dict[str, Array]]) -> Path:
    """Write a recording of theta and psi in degrees."""
    t, seen = recording
    columns = zip(t, np.degrees(seen["theta"]), np.degrees(seen["psi"]), strict=True)
    lines = ["t,theta,psi", *(f"{x:.5f},{y:.4f},{z:.4f}" for x, y, z in columns), ""]
    path.write_text("\n".join(lines))
    return path


def test_the_command(lagtop: Lagtop, tmp_path: Path) -> None:
    path = written(tmp_path / "data.csv", recorded("theta", "psi", seed=20))
    scene = tmp_path / "top.toml"
    known = "--m 0.5 --g 9.81 --s 0.08 --C 0.0025".split()
    result = lagtop("fit", path, *known, "--sigma", 0.3, "-o", scene)
    assert result.exit_code == 0, result.stderr
    shown = (
        "Verdict: good.",
        "chi2/dof = ",
        "RMS residual (deg): theta 0.",
        "Correlation: a and b ",
        "as given",
    )
    for text in shown:
        assert text in result.stdout
    top = read_scene(scene)
    assert (float(top.A), float(top.r0)) == pytest.approx((4.45e-3, 52.36), rel=0.01)
    assert "# r0 = 52." in scene.read_text()
    lagtop("fit", path, "-o", scene)
    doubtful = re.findall("^(.*) = .*# not determined", scene.read_text(), re.MULTILINE)
    assert doubtful == ["m", "s", "g", "A", "C", "r0"]  # only a and b are
    words = "--m 0.5 --g 9.81 --s 0.08 --A-cm 0.00125 --phidot0 52.36 --psidot0 0".split()
    lagtop("fit", path, *words, "-o", scene)
    assert "# not determined" not in scene.read_text()


def test_the_record_and_the_picture(lagtop: Lagtop, tmp_path: Path) -> None:
    path = written(tmp_path / "data.csv", recorded("theta", "psi", seed=20))
    picture = tmp_path / "fit.svg"
    words = "--m 0.5 --g 9.81 --s 0.08 --C 0.0025 --format json --plot".split()
    record = json.loads(lagtop("fit", path, *words, picture).stdout)
    assert record["verdict"] == "good"
    assert picture.read_text().startswith("<?xml")
    assert "Fit: good" in picture.read_text()
    assert abs(record["r0"] - 52.36) < 4 * record["r0_std"]
    assert record["theta_rms_deg"] == pytest.approx(0.3, rel=0.3)


def test_windows(lagtop: Lagtop, tmp_path: Path) -> None:
    path = written(tmp_path / "one.csv", recorded("theta", "psi", rows=75, seconds=1.5, seed=23))
    result = lagtop("fit", path, "--window", 3, "--plot", tmp_path / "decay.svg")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines()[-1].startswith("b does not decay: its relative rate is")
    assert "b does not decay" in (tmp_path / "decay.svg").read_text()
    failed = lagtop("fit", path, "--window", 3, "--sigma", 0.1, "--format", "json")
    assert failed.exit_code == 1
    windows = json.loads(failed.stdout)["windows"]
    assert "failed" in {x["verdict"] for x in windows}
    bound = chi2_bounds(windows[0]["dof"], CHANCE / 3)[1]
    assert windows[0]["chi2_dof_high"] == pytest.approx(bound)


def test_a_failed_fit_writes_no_scene_and_marks_what_is_not_determined(
    lagtop: Lagtop, tmp_path: Path
) -> None:
    path = written(tmp_path / "one.csv", recorded("theta", "psi", seed=23))
    result = lagtop("fit", path, "--sigma", 0.1, "-o", tmp_path / "no.toml")
    assert (result.exit_code, (tmp_path / "no.toml").exists()) == (1, False)
    t, seen = recorded("theta", "phi", rows=40, noise=0.5, seed=1)
    outcome = best_fit(recording_from(t, **seen), {})
    assert outcome.is_open  # another top explains it as well
    rows = fit_report([outcome], "data", "").rows
    assert all(x.meaning.startswith("not determined: ") for x in rows)


@pytest.mark.parametrize("rows", [13, 12])
def test_a_recording_of_few_rows(lagtop: Lagtop, tmp_path: Path, rows: int) -> None:
    """In which every row is next to an end."""
    lines = Path(SAMPLE).read_text().splitlines()
    (tmp_path / "few.csv").write_text("\n".join(lines[: 3 + rows]))
    assert lagtop("fit", str(tmp_path / "few.csv")).exit_code in {0, 1}
