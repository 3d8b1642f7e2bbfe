"""Windows of recordings of a top that friction slows, made by an integrator."""

from __future__ import annotations

import json
import math
from pathlib import Path

import fuzz_windows
import numpy as np
import pytest
from conftest import Lagtop, assert_one_line
from lagtop import LagtopError
from test_fit import written

from lagrange_cli.fits.parameters import KnownInputs
from lagrange_cli.fits.recording import recording_from
from lagrange_cli.fits.windows import WindowedFit, fit_windows, split


@pytest.fixture(scope="module")
def short() -> fuzz_windows.Slowed:
    """Return the first seven seconds of a recording."""
    case = fuzz_windows.drawn(102)
    rows = case.t < 7
    angles = {name: x[rows] for name, x in case.angles.items()}
    return case._replace(t=case.t[rows], angles=angles)


@pytest.fixture(scope="module")
def found(short: fuzz_windows.Slowed) -> WindowedFit:
    return fuzz_windows.fitted(short)


@pytest.mark.slow
def test_the_decay_and_the_body(short: fuzz_windows.Slowed, found: WindowedFit) -> None:
    record = found.record()
    assert abs(record["decay_rate"] - 1 / fuzz_windows.DECAY) < 4 * record["decay_rate_std"]
    assert record["decay_time"] == pytest.approx(1 / record["decay_rate"])
    relative = record["decay_time_std"] / record["decay_time"]
    assert relative == pytest.approx(record["decay_rate_std"] / record["decay_rate"])
    assert abs(record["a"] - short.a) < 4 * record["a_std"]
    assert abs(record["C/A"] - short.ratio) < 4 * record["C/A_std"]
    assert 0.9 < record["chi2_dof"] < 1.1
    rows = record["windows"]
    assert len(rows) == 8
    for row in rows:
        truth = short.b / short.ratio * math.exp(-row["t"] / fuzz_windows.DECAY)
        assert abs(row["r0"] - truth) < 4.5 * row["r0_std"]
    assert sum(row["verdict"] == "good" for row in rows) >= 7


@pytest.mark.slow
def test_without_the_spin_b_decays(short: fuzz_windows.Slowed) -> None:
    angles = {name: short.angles[name] for name in ("theta", "psi")}
    sigma = {name: fuzz_windows.NOISE[name] for name in angles}
    recording = recording_from(short.t, **angles, sigma=sigma)
    parts = split(recording, 4, is_time=False, where="data")
    found = fit_windows(parts, KnownInputs({}), "data")
    assert found.decay.quantity == "b"
    assert abs(found.decay.rate - 1 / fuzz_windows.DECAY) < 4 * found.decay.rate_std
    assert "r0" not in found.record()["windows"][0]


def test_windows_hold_all_rows_once(short: fuzz_windows.Slowed) -> None:
    recording = recording_from(short.t, **short.angles)
    for window, is_time, count in ((5, False, 5), (1.6, True, 4), (7.0 / 3, True, 2)):
        parts = split(recording, window, is_time=is_time, where="data")
        assert len(parts) == count
        assert sum(part.t.size for part in parts) == short.t.size
        t = np.concatenate([part.t + part.t_start for part in parts])
        assert t == pytest.approx(short.t)


@pytest.mark.parametrize(
    ("window", "is_time", "message"),
    [
        (1, False, r"window must give 2 to \d+ windows of data, got 1"),
        (6.0, True, r"window must give 2 to \d+ windows of data, got 1"),
        (1e-9, True, r"window must give 2 to \d+ windows of data"),
        (100, False, "window 1 must have 12 rows or more, got"),
    ],
)
def test_bad_windows(
    short: fuzz_windows.Slowed, window: float, is_time: bool, message: str
) -> None:
    recording = recording_from(short.t, **short.angles)
    with pytest.raises(LagtopError, match=message):
        split(recording, window, is_time=is_time, where="data")


@pytest.mark.slow
def test_the_command(lagtop: Lagtop, tmp_path: Path, short: fuzz_windows.Slowed) -> None:
    angles = [np.degrees(short.angles[x]) for x in ("theta", "psi", "phi")]
    path = written(tmp_path / "slow.csv", "t,theta,psi,phi", [short.t, *angles])
    options = ["fit", path, "--sigma", "theta=0.3,psi=0.5,phi=1", "--window", 5]
    shown = lagtop(*options)
    assert shown.exit_code == 0, shown.stderr
    assert "r0 decays with a time of " in shown.stdout
    assert "The closed form describes " in shown.stdout
    record = json.loads(lagtop(*options, "--format", "json").stdout)
    assert len(record["windows"]) == 5
    assert abs(record["decay_rate"] - 1 / fuzz_windows.DECAY) < 4 * record["decay_rate_std"]
    lines = lagtop(*options, "--format", "csv").stdout.splitlines()
    assert lines[0].startswith("t,t_start,rows,r0,r0_std,b,b_std,theta0_deg")
    assert len(lines) == 6
    for words, message in (
        (["--by", "t"], "use --window or --by, not both"),
        (["--r0", 10], "--r0 is an unknown of a fit in windows: leave it out"),
        (["-o", tmp_path / "x.toml"], "use --window or --output"),
    ):
        assert_one_line(lagtop(*options, *words), 2, message)
    assert_one_line(lagtop(*options[:-1], 0), 2, "--window must be > 0, got 0")


@pytest.mark.slow
def test_one_motion_for_a_decaying_spin_fails(lagtop: Lagtop, tmp_path: Path) -> None:
    """The spin loses a fourth in 20 s, so one motion without friction misses by tens of turns."""
    spin, t = 50 * fuzz_windows.DECAY, np.arange(0, 20, 0.02)
    psi, phi = 7 * t + t**2 / 20, spin * (1 - np.exp(-t / fuzz_windows.DECAY))
    theta = 0.6 + 0.05 * np.cos(21 * t - t**2 / 20)
    angles = np.degrees([theta, psi, phi])
    path = written(tmp_path / "decay.csv", "t,theta,psi,phi", [t, *angles])
    for sigma in (["--sigma", 0.3], []):
        shown = lagtop("fit", path, *sigma)
        assert shown.exit_code == 1
        assert "the spin may decay: try --window" in shown.stderr
    for sigma in (["--sigma", 0.3], []):
        shown = lagtop("fit", path, *sigma, "--window", 3)
        assert shown.exit_code == 1
        assert "use shorter windows" in shown.stderr
        assert "decays with" not in shown.stdout
        assert "does not decay" not in shown.stdout
