"""`fit`: the top behind data that an integrator made, with noise of a known size."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest
import recordings
from conftest import Lagtop, assert_one_line
from engines import Array, Body, dop853
from lagtop import LagtopError, Top, fit, read_scene, solve, sweep
from scipy.spatial.transform import Rotation
from uncertainties import ufloat

from lagrange_cli.fits import fit as fits
from lagrange_cli.fits.invert import TurningPoints, candidates, top_of
from lagrange_cli.fits.least_squares import Problem
from lagrange_cli.fits.model import residuals
from lagrange_cli.fits.parameters import FIT_QUANTITIES, KnownInputs, parameters_of
from lagrange_cli.fits.record import Outcome
from lagrange_cli.fits.recording import Reading, Recording, read_recordings

NOISE = math.radians(0.5)
SAMPLE = recordings.SAMPLES / recordings.SMALL_TOP.name


def motion_of(top: Top, t: Array) -> Rotation:
    """Return the attitude at times, by Euler's equations that scipy integrates."""
    return Rotation.from_quat(dop853(Body.of(top), t)[1][:, :4], scalar_first=True)


def angles_of(turns: Rotation) -> dict[str, Array]:
    psi, theta, phi = turns.as_euler("ZXZ").T
    return {"theta": theta, "phi": phi, "psi": psi}


@pytest.fixture(scope="module")
def sample() -> Outcome:
    """Return what the recording of sample_inputs tells, with the noise that it has."""
    degree = math.pi / 180
    sigma = {"theta": 0.3 * degree, "psi": 0.5 * degree, "phi": degree}
    recording = read_recordings(str(SAMPLE), Reading(sigma=sigma))
    return fits.fit_recordings(recording, KnownInputs({"m": 1.587, "g": 9.81, "s": 0.04}))[0]


def test_the_recording_is_what_the_script_writes() -> None:
    for camera in (recordings.SMALL_TOP, recordings.WHEEL):
        assert recordings.text(camera) == (recordings.SAMPLES / camera.name).read_text()


def test_the_sample_is_what_an_integrator_gives() -> None:
    rows = np.genfromtxt(SAMPLE, delimiter=",", skip_header=3)
    angles = angles_of(motion_of(recordings.TOP, rows[:, 0] - recordings.FIRST))
    assert abs(rows[:, 1] - np.degrees(angles["theta"])).max() < 1.2
    assert np.isnan(rows[:, 3]).sum() > 50


def test_the_sample_gives_the_body(sample: Outcome) -> None:
    record = sample.record()
    for key in ("A", "C", "r0", "theta0_deg", "thetadot0", "psidot0"):
        truth = float(getattr(recordings.TOP, key))
        assert abs(record[key] - truth) < 3 * record[f"{key}_std"], key
    assert record["A_std"] < 0.001 * record["A"]
    assert record["psi_zero_deg"] == pytest.approx(recordings.PSI_ZERO, abs=0.3)
    assert record["phi_zero_deg"] == pytest.approx(recordings.PHI_ZERO, abs=0.6)
    assert record["verdict"] == "good"
    assert record["remark"] is None


def test_periods_and_rates_have_the_spread_of_the_motions(sample: Outcome) -> None:
    """The judge draws tops from the covariance of the fit: 400 of them show 7 % of a spread."""
    names = ["a", "b", "theta0", "thetadot0", "psidot0", "r0"]
    rows = [sample.labels.index(name) for name in names]
    covariance = sample.covariance[np.ix_(rows, rows)]
    draws = np.random.default_rng(1).multivariate_normal(
        [sample.values[name] for name in names], covariance, 400
    )
    a, b, tilt, nutation, precession, r0 = draws.T
    body = {"m": 1.0, "A": 1.0, "s": 1.0, "C": b / r0, "r0": r0, "g": a / 2}
    tops = sweep(**body, theta0_rad=tilt, thetadot0=nutation, psidot0=precession)
    record = sample.record()
    keys = ["T_nutation", "T_precession", "mean_precession_rate", "mean_spin_rate"]
    for key in [*keys, "theta_min_deg", "theta_max_deg"]:
        assert record[f"{key}_std"] == pytest.approx(np.std(tops[key]), rel=0.2), key
    by_hand = {
        "stability_factor": b**2 / (2 * a),
        "T_nutation_elementary": 2 * math.pi / b,
        "precession_rate_elementary": a / (2 * b),
    }
    for key, values in by_hand.items():
        assert record[key] == pytest.approx(np.mean(values), rel=1e-3)
        assert record[f"{key}_std"] == pytest.approx(np.std(values), rel=0.2), key
    off = by_hand["precession_rate_elementary"] - tops["mean_precession_rate"]
    shown = record["precession_rate_elementary_off_sigma"]
    assert shown == pytest.approx(np.mean(off) / np.std(off), rel=0.2)
    truth = solve(recordings.TOP)
    for key in keys:
        assert abs(record[key] - getattr(truth, key)) < 4 * record[f"{key}_std"], key


def test_the_derivatives_are_those_of_what_is_left(sample: Outcome) -> None:
    recording = sample.recording
    for kind, names in (("angles", 3), ("axis", 2), ("attitude", 3)):
        one = Recording("", recording.t, 0.0, kind, filled(recording), {})
        sigma = np.ones((names, recording.t.size))
        problem = Problem([one], [sigma], sample.fit.parameters)
        at = sample.fit.values
        slopes = problem._at(at)[1]
        assert slopes.shape == (names * recording.t.size, at.size)
        step = 1e-5 * np.array([3, -7, 2, 5, -4, 6, 8, -9]) * np.maximum(abs(at), 1) / 10
        change = problem._at(at + step)[0] - problem._at(at - step)[0]
        same = np.abs(change) < 1  # but for a turn
        assert same.mean() > 0.95
        exact = 2 * slopes @ step
        assert np.allclose(change[same], exact[same], atol=1e-5 * np.abs(exact).max())


def filled(recording: Recording) -> Mapping[str, Array]:
    """Return the angles of a recording, with something in its missing cells."""
    return {name: np.nan_to_num(x, nan=1.0) for name, x in recording.angles.items()}


def test_residuals_of_directions_are_distances_on_the_sphere() -> None:
    rng = np.random.default_rng(3)
    turns = Rotation.from_quat(rng.normal(size=(50, 4)))
    off = 1e-3 * rng.normal(size=(50, 3))
    seen = angles_of(turns * Rotation.from_rotvec(off))
    exact = angles_of(turns)
    moved = np.stack([exact["theta"], exact["phi"], exact["psi"]])
    attitude = residuals(Recording("", np.arange(50.0), 0.0, "attitude", seen, {}), moved)
    assert np.linalg.norm(attitude.values, axis=0) == pytest.approx(
        np.linalg.norm(off, axis=1), rel=0.01
    )
    axis = residuals(Recording("", np.arange(50.0), 0.0, "axis", seen, {}), moved)
    assert np.linalg.norm(axis.values, axis=0) == pytest.approx(
        np.linalg.norm(off[:, :2], axis=1), rel=0.01
    )


def written(path: Path, names: str, columns: list[Any]) -> Path:
    """Write a file of columns."""
    rows = zip(*columns, strict=True)
    lines = [",".join("" if np.isnan(x) else str(x) for x in row) for row in rows]
    path.write_text("\n".join([names, *lines]) + "\n")
    return path


@pytest.mark.parametrize("kind", ["axis", pytest.param("quaternion", marks=pytest.mark.slow)])
def test_the_axis_and_the_attitude(lagtop: Lagtop, tmp_path: Path, kind: str) -> None:
    rng = np.random.default_rng(7)
    t = np.linspace(0, 2, 150)
    turns = motion_of(recordings.TOP, t) * Rotation.from_rotvec(
        NOISE * rng.normal(size=(t.size, 3))
    )
    turns = Rotation.from_euler("z", 1.0) * turns
    if kind == "axis":
        names, columns = "t,axis_x,axis_y,axis_z", turns.apply([0, 0, 1]).T
    else:
        names, columns = "t,qw,qx,qy,qz", turns.as_quat(scalar_first=True).T
    path = written(tmp_path / "data.csv", names, [t, *columns])
    shown = lagtop("fit", path, "--sigma", 0.5, "--format", "json")
    record = json.loads(shown.stdout)
    motion = solve(recordings.TOP)
    assert abs(record["a"] - motion.a) < 4 * record["a_std"]
    assert abs(record["b"] - motion.b) < 4 * record["b_std"]
    assert record["chi2_dof_low"] < record["chi2_dof"] < record["chi2_dof_high"]
    assert ("r0" in record) == (kind == "quaternion")
    assert record["psi_zero_deg"] == pytest.approx(math.degrees(1), abs=1)
    if kind == "quaternion":
        assert abs(record["r0"] - 50) < 4 * record["r0_std"]
        assert "C/A" in record


@pytest.mark.slow
def test_a_top_that_is_let_go_needs_no_precession() -> None:
    t = np.linspace(0, 2, 240)
    theta = angles_of(motion_of(Top(), t))["theta"]
    theta += np.random.default_rng(5).normal(scale=NOISE, size=t.size)
    found = fit(t, theta=theta, known={"psidot0": 0.0, "thetadot0": 0.0, "r0": 50.0})
    motion = solve(Top())
    assert abs(found.values["a"] - motion.a) < 4 * found.deviations["a"]
    assert abs(found.values["b"] - motion.b) < 4 * found.deviations["b"]


def trials(tmp_path: Path) -> Path:
    """Write a file of two recordings of one body, row by row in turn, named by a column."""
    rng = np.random.default_rng(11)
    t = np.linspace(0, 1.5, 100)
    rows = []
    for name, change in (("first", {}), ("second, fast", {"r0": 70, "theta0_deg": 60})):
        angles = angles_of(motion_of(recordings.TOP.replace(**change), t))
        for i in range(t.size):
            cells = [math.degrees(x[i]) + rng.normal(scale=0.5) for x in angles.values()]
            rows.append((t[i], f'"{name}"', cells))
    rows.sort(key=lambda row: row[0])
    lines = [f"{at},{name},{','.join(map(str, cells))}" for at, name, cells in rows]
    path = tmp_path / "trials.csv"
    path.write_text("\n".join(["t,trial,theta,phi,psi", *lines]).replace(", fast", " fast") + "\n")
    return path


@pytest.mark.slow
def test_a_start_next_to_an_upright_root_is_found() -> None:
    """Without psi nothing tells the modulus, and u3 = 1 is at an end of what it may be."""
    nutation, t = TurningPoints(1.5, 1.52, 1.0), np.linspace(0, 60, 300)
    exact = candidates(nutation, np.array(1e-6 * nutation.from_top[1]), (1, 1))
    top = top_of(nutation, exact).replace(C=0.7, r0=float(exact.b) / 0.7)
    angles, rng = solve(top).angles(t), np.random.default_rng(1)
    theta, phi = (x + 1e-4 * rng.standard_normal(t.size) for x in (angles.theta, angles.phi))
    found = fit(t, theta=theta, phi=phi)
    assert found.verdict == "good"
    assert found.record()["a"] == pytest.approx(float(exact.a), rel=1e-4)


@pytest.mark.slow
def test_several_recordings_in_one_file(lagtop: Lagtop, tmp_path: Path) -> None:
    path = trials(tmp_path)
    options = ("fit", path, "--by", "trial", "--sigma", 0.5, "--format", "json")
    apart = json.loads(lagtop(*options).stdout)
    together = json.loads(lagtop(*options, "--together").stdout)
    assert [row["name"] for row in apart] == ["first", "second fast"]
    assert apart[0]["a"] != apart[1]["a"]
    assert together[0]["a"] == together[1]["a"]
    assert together[0]["a_std"] < min(row["a_std"] for row in apart)
    motion = solve(recordings.TOP)
    for row, r0 in zip(together, (50, 70), strict=True):
        assert abs(row["a"] - motion.a) < 4 * row["a_std"]
        assert abs(row["r0"] - r0) < 4 * row["r0_std"]
        assert row["C/A"] == pytest.approx(1.7458e-3 / 3.9032e-3, abs=4 * row["C/A_std"])


def test_the_scene_is_read_by_other_commands(lagtop: Lagtop, tmp_path: Path) -> None:
    path = tmp_path / "fitted.toml"
    shown = lagtop("fit", SAMPLE, "--g", 9.81, "-o", path)
    assert shown.exit_code == 0, shown.stderr
    assert "m, s and A are known only as m*s/A" in shown.stdout
    assert shown.stderr == (
        f"Note: {path} has assumed inputs, because C/A and m*s/A are known only as products: give "
        "the inputs that you know, such as --A\n"
    )
    motion = solve(read_scene(str(path)))
    assert motion.top.caveat() is None
    truth = solve(recordings.TOP)
    assert motion.top.g == 9.81
    assert motion.a == pytest.approx(truth.a, rel=2e-3)
    assert motion.b == pytest.approx(truth.b, rel=2e-3)
    assert "# m, s and A are known only as m*s/A" in path.read_text()
    assert re.search(r'^r0 = "49.99\d+ \+/- 0.004\d+"$', path.read_text(), re.M)
    assert set(tomllib.loads(path.read_text())) >= {"m", "A", "C", "s", "g", "r0", "theta0_deg"}


DERIVED = (
    *("T_nutation", "T_precession", "mean_precession_rate", "mean_spin_rate"),
    *("theta_min_deg", "theta_max_deg", "stability_factor"),
)


def test_a_steady_word_is_no_known_rate(lagtop: Lagtop, tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text('r0 = 60\npsidot0 = "steady"\n')
    refused = lagtop("fit", SAMPLE, scene, "--fix", "psidot0")
    assert_one_line(refused, 2, "--psidot0 must be a real number, got 'steady'")


def test_the_moment_about_the_pivot_is_fixed_by_that_about_the_mass_centre(
    tmp_path: Path, lagtop: Lagtop
) -> None:
    """A scene that has A_cm, m and s has A too; nothing else of it is taken for known."""
    scene = tmp_path / "scene.toml"
    scene.write_text("A_cm = 1.364e-3\nm = 1.587\ns = 0.04\nC = 1.7458e-3\n")
    options = [scene, "--fix", "A,C", "--format", "json"]
    record = json.loads(lagtop("fit", SAMPLE, *options).stdout)
    assert record["A"] == pytest.approx(1.364e-3 + 1.587 * 0.04**2, rel=1e-15)
    assert {"m", "s"}.isdisjoint(record)
    scene.write_text("A_cm = 1.364e-3\nm = 1.587\n")
    assert_one_line(
        lagtop("fit", SAMPLE, *options), 2, "--fix A needs A: give it as an option or in a scene"
    )


@pytest.mark.slow
def test_what_is_no_noise_is_said(lagtop: Lagtop, tmp_path: Path) -> None:
    t = np.linspace(0, 3, 200)
    angles = angles_of(motion_of(recordings.TOP, t))
    rng = np.random.default_rng(2)
    theta = np.degrees(angles["theta"]) * np.exp(-0.03 * t) + rng.normal(scale=0.2, size=t.size)
    psi = np.degrees(angles["psi"]) + rng.normal(scale=0.2, size=t.size)
    path = written(tmp_path / "friction.csv", "t,theta,psi", [t, theta, psi])
    shown = lagtop("fit", path, "--sigma", 0.2)
    assert shown.exit_code == 0
    assert "Warning: chi2/dof = " in shown.stdout
    assert "Warning: the residuals of theta are not noise" in shown.stdout
    record = json.loads(lagtop("fit", path, "--format", "json").stdout)
    assert record["verdict"] == "doubtful"
    assert record["chi2_dof"] is None


@pytest.mark.slow
def test_standard_deviations_in_columns(lagtop: Lagtop, tmp_path: Path) -> None:
    t = np.linspace(0, 2, 200)
    angles = angles_of(motion_of(recordings.TOP, t))
    rng = np.random.default_rng(2)
    spread = np.where(np.arange(t.size) % 4, 0.1, 4.0)
    columns = [np.degrees(angles[x]) + spread * rng.normal(size=t.size) for x in ("theta", "psi")]
    names = "t,theta_deg,psi_deg,theta_deg_std,psi_std_deg"
    path = written(tmp_path / "data.csv", names, [t, *columns, spread, spread])
    record = json.loads(lagtop("fit", path, "--format", "json").stdout)
    assert record["chi2_dof_low"] < record["chi2_dof"] < record["chi2_dof_high"]
    plain = written(tmp_path / "plain.csv", "t,theta_deg,psi_deg", [t, *columns])
    assert (
        record["a_std"] < json.loads(lagtop("fit", plain, "--format", "json").stdout)["a_std"] / 4
    )


T = np.linspace(0, 2, 100)


@pytest.mark.parametrize(
    ("columns", "code", "message"),
    [
        ([T, 90 + 130 * np.sin(T), T], 65, "theta must be between 0 and pi rad (180 deg), got 3."),
        ([T[:5], T[:5], T[:5]], 65, "must have 12 rows or more, got 5"),
        ([T, 0 * T + 30, 0 * T], 65, "psi must precess: its mean rate is 0"),
        ([T, T * np.nan, T * np.nan], 65, "must have 12 rows or more with a number, got 0"),
        ([T[::-1] ** 2 % 0.5, 30 + T, T], 65, "t must not turn back"),
        ([T / 10, 30 + 5 * np.sin(T), T], 65, "a recording must last for a period"),
        ([0 * T + 1, 30 + T, T], 65, "t must increase, got 1 in all rows"),
    ],
)
def test_bad_data_get_a_line(
    lagtop: Lagtop, tmp_path: Path, columns: list[Array], code: int, message: str
) -> None:
    path = written(tmp_path / "data.csv", "t,theta,psi", columns)
    result = lagtop("fit", path)
    assert (result.exit_code, result.stdout) == (code, "")
    assert result.stderr.count("\n") == 1
    assert message in result.stderr


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ("--sigma 0", 2, "--sigma must be > 0"),
        ("--sigma theta=1", 2, "--sigma must be given for all angles or for none"),
        ("--fix m", 2, "--fix m needs m: give it as an option or in a scene"),
        ("--g 0", 2, "--g must not be 0 in a fit"),
        ("--phidot0 3", 2, "unknown option --phidot0"),
        ("--euler-sequence foo", 2, "--euler-sequence must be three axes"),
        ("--A-cm 3", 2, "--A-cm must be given with m and s"),
        ("--by nothing", 2, "--by must name a column"),
        ("--together", 2, "--together needs --by"),
        ("--plot fit.gif", 2, "--plot must end in .svg or .png"),
        ("-o /nowhere/x.toml", 74, "cannot write /nowhere/x.toml"),
    ],
)
def test_bad_commands(lagtop: Lagtop, words: str, code: int, message: str) -> None:
    assert_one_line(lagtop("fit", SAMPLE, *words.split()), code, message)


@pytest.mark.parametrize("fmt", ["csv", "json", "table"])
def test_a_failed_fit_leaves_no_scene(
    lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fmt: str
) -> None:
    monkeypatch.setattr(Outcome, "failures", lambda _: ["it is too bad"])
    path = tmp_path / "fitted.toml"
    result = lagtop("fit", SAMPLE, "--format", fmt, "-o", path)
    assert (result.exit_code, path.exists()) == (1, False)
    *_, note, last = result.stderr.splitlines()
    assert note == f"Warning: {path} is not written: the fit has failed"
    assert last == "Error: 1 of 1 fits failed; the first: it is too bad"
    assert "it is too bad" in (result.stdout if fmt == "table" else result.stderr)
    assert lagtop("fit", SAMPLE).stderr.endswith(last + "\n")


def test_a_fit_needs_an_unknown(lagtop: Lagtop, tmp_path: Path) -> None:
    path = written(tmp_path / "data.csv", "t,theta", [T, 40 + 5 * np.sin(20 * T)])
    start = ["--theta0", "40", "--thetadot0", "0", "--psidot0", "0"]
    result = lagtop("fit", "chrapan-1952", path, "--fix", "m,A,C,s,g,r0", *start)
    assert_one_line(result, 2, f"{path}: fit needs an unknown input, but all are known: leave one")


@pytest.mark.slow
def test_the_picture(lagtop: Lagtop, tmp_path: Path) -> None:
    path = tmp_path / "fit.svg"
    assert lagtop("fit", SAMPLE, "--plot", path).exit_code == 0
    assert path.read_text().count('<g id="axes_') == 6


def test_arrays_in_python() -> None:
    t = np.linspace(5, 7, 120)
    turns = motion_of(recordings.TOP, t - 5)
    found = fit(t, quaternion=turns.as_quat(scalar_first=True), known={"theta0_deg": 41})
    motion = solve(recordings.TOP)
    assert found.values["a"] == pytest.approx(motion.a, rel=1e-9)
    assert found.values["b"] == pytest.approx(motion.b, rel=1e-9)
    assert found.values["r0"] == pytest.approx(50, rel=1e-9)
    assert found.record()["t_start"] == 5
    assert found.verdict == "good"
    bad: list[tuple[dict[str, Any], str]] = [
        (
            {"theta": [1, 2]},
            r"theta must be real numbers of shape \(120, 1\), got the",
        ),
        ({"theta": "x"}, "theta must be real numbers"),
        ({"axis": t}, r"axis must be real numbers of shape \(120, 3\)"),
        ({"theta": t, "axis": turns.apply([0, 0, 1])}, "fit takes angles, or an axis"),
        ({}, "fit takes angles, or an axis, or a quaternion, got nothing"),
        ({"theta": t / 9, "psi": t, "known": {"mass": 1}}, "known must be among"),
        (
            {"theta": t / 9, "psi": t, "sigma": {"chi": 1}},
            "sigma must be for theta, psi, got 'chi'",
        ),
        ({"theta": t / 9, "psi": t, "sigma": -1}, "theta_std must be > 0, got -1"),
        (
            {"theta": np.degrees(angles_of(turns)["theta"]), "psi": t},
            r"theta must be between 0 and pi rad \(180 deg\), got 41 rad",
        ),
        ({"theta": -t / 9, "psi": t}, "theta must be between 0 and pi rad .*, got -0.5"),
    ]
    for arguments, message in bad:
        with pytest.raises(LagtopError, match=message):
            fit(t, **arguments)
    shuffled = np.concatenate([t[60:], t[:60]])
    with pytest.raises(LagtopError, match=r"t must not turn back, got 5\.0 after 7\.0"):
        fit(shuffled, theta=t / 9, psi=t)
    with pytest.raises(LagtopError, match="has neither psi nor phi"):
        fit(t, theta=t / 9, psi=np.full(t.size, np.nan))
    with pytest.raises(LagtopError, match="must have 12 rows or more, got 0"):
        fit([], theta=[], psi=[])


@pytest.mark.parametrize("names", ["", "r0", "A C", "m g s C", "m g s A", "m g s A C r0", "theta0"])
@pytest.mark.parametrize("seen", [("theta", "psi"), ("theta", "phi", "psi")])
def test_what_is_known_ties_the_rest(names: str, seen: tuple[str, ...]) -> None:
    true = {"m": 1.587, "A": 3.9032e-3, "C": 1.7458e-3, "s": 0.04, "g": 9.81, "r0": 50.0}
    known = KnownInputs({name: (true | {"theta0": 0.7})[name] for name in names.split()})
    none = np.zeros(20)
    recording = Recording("", none, 0.0, "angles", dict.fromkeys(seen, none), {})
    parameters = parameters_of(known, [recording])
    values = np.linspace(1, 2, len(parameters.names))
    found, slopes = parameters.quantities(values, 0)
    by = dict(zip(FIT_QUANTITIES, found, strict=True))
    for i in range(values.size):
        step = np.eye(values.size)[i] * 1e-6
        change = parameters.quantities(values + step, 0)[0]
        change = change - parameters.quantities(values - step, 0)[0]
        assert change / 2e-6 == pytest.approx(slopes[:, i], rel=1e-6, abs=1e-6)
    A = known.get("A", 2 * true["m"] * true["g"] * true["s"] / by["a"])
    if {"m", "g", "s", "A"} <= known.keys():
        assert by["a"] == pytest.approx(2 * true["m"] * true["g"] * true["s"] / A, rel=1e-14)
    if "C" in known:
        assert by["b"] == pytest.approx(true["C"] * by["r0"] / A, rel=1e-14)
    assert all(by[name] == x for name, x in known.items() if name in by)


def refitted(sample: Outcome, **known: Any) -> dict[str, Any]:
    """Return the record of the sample with other known inputs."""
    angles: dict[str, Any] = dict(sample.recording.angles)
    sigma = {name: math.radians(x) for name, x in (("theta", 0.3), ("psi", 0.5), ("phi", 1))}
    return fit(sample.recording.t, **angles, sigma=sigma, known=known).record()


def test_an_uncertain_known_input_widens_what_depends_on_it(sample: Outcome) -> None:
    """A = 2mgs/a: its relative variance is the sum of those of a and of m."""
    exact = sample.record()
    found = refitted(sample, m="1.587(2)", g=9.81, s=0.04)
    assert found["A"] == pytest.approx(exact["A"], rel=1e-6)
    both = math.hypot(exact["A_std"] / exact["A"], 0.002 / 1.587)
    assert found["A_std"] / found["A"] == pytest.approx(both, rel=1e-4)
    assert (found["m"], found["m_std"]) == pytest.approx((1.587, 0.002), rel=1e-6)
    assert found["a_std"] == pytest.approx(exact["a_std"], rel=1e-4)
    unit: Any = pint.UnitRegistry()
    mass = unit.Quantity(ufloat(1587, 2), "g")
    assert refitted(sample, m=mass, g="9.81 m/s^2", s=unit.Quantity(4, "cm")) == found


@pytest.mark.slow
def test_a_prior_is_between_a_known_input_and_none(sample: Outcome) -> None:
    body = {"m": 1.587, "g": 9.81, "s": 0.04}
    free, exact = sample.record(), refitted(sample, **body, C=1.7458e-3)
    assert abs(exact["A"] - 3.9032e-3) < 3 * exact["A_std"] < 3 * free["A_std"]
    assert exact["remark"] is None
    tight, loose, fair = (
        refitted(sample, **body, C=f"1.7458e-3 +- {std}") for std in ("1e-12", "1", "4e-7")
    )
    for key in ("A", "b", "r0"):
        for found, wanted in ((tight, exact), (loose, free)):
            assert found[key] == pytest.approx(wanted[key], abs=0.02 * wanted[f"{key}_std"])
            assert found[f"{key}_std"] == pytest.approx(wanted[f"{key}_std"], rel=0.02)
    weights = [1 / free["C_std"] ** 2, 1 / 4e-7**2]
    mean = (weights[0] * free["C"] + weights[1] * 1.7458e-3) / sum(weights)
    assert fair["C"] == pytest.approx(mean, abs=0.05 * fair["C_std"])
    assert fair["C_std"] == pytest.approx(sum(weights) ** -0.5, rel=0.02)


def test_the_moment_about_the_mass_centre_may_be_uncertain(lagtop: Lagtop) -> None:
    """The motion knows A five times better: A_cm follows it."""
    options = ["--m", 1.587, "--g", 9.81, "--s", 0.04, "--A-cm", "0.00137(3)"]
    shown = lagtop("fit", SAMPLE, *options, "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    record = json.loads(shown.stdout)
    assert record["A_cm"] == pytest.approx(3.9032e-3 - 1.587 * 0.0016, abs=4 * record["A_cm_std"])
    assert record["A_cm_std"] == pytest.approx(record["A_std"], rel=1e-6)
    assert record["A_cm_std"] < 0.1 * 3e-5
    refused = lagtop("fit", SAMPLE, "--A-cm", "0.00137(3)")
    assert_one_line(refused, 2, "--A-cm must be given with m and s")
