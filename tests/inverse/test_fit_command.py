"""`lagtop fit`: the report, the picture, and windows, which show a decay."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Lagtop
from lagtop import read_scene
from noisy_recordings import LAB, TRUTH, fitted, recorded, recording_from

from lagrange_cli.inverse.decay import decay_of, fit_windows
from lagrange_cli.inverse.known import known_inputs
from lagrange_cli.inverse.outcome import Number
from lagrange_cli.inverse.report import fit_report
from lagrange_cli.inverse.residuals import CHANCE, chi2_bounds
from lagrange_cli.inverse.search import best_fit
from lagrange_cli.names import ANGLES
from lagrange_cli.top.given import gather
from lagrange_cli.top.values import values_of

DISC = ROOT / "tests" / "examples" / "disc.csv"


def test_the_command(lagtop: Lagtop, tmp_path: Path) -> None:
    scene, picture = tmp_path / "top.toml", tmp_path / "fit.svg"
    known = "--m 0.5 --g 9.81 --s 0.08 --C 0.0025".split()
    result = lagtop("fit", DISC, *known, "--sigma", 0.2, "-o", scene, "--plot", picture)
    assert result.exit_code == 0, result.stderr
    assert picture.read_text().startswith("<?xml")
    assert "Fit: good" in picture.read_text()
    top = read_scene(scene)
    assert (float(top.A), float(top.r0)) == pytest.approx((4.45e-3, 52.36), rel=0.01)
    assert "# r0 = 52." in scene.read_text()
    lagtop("fit", DISC, "-o", scene)
    doubtful = re.findall("^(.*) = .*# not determined", scene.read_text(), re.MULTILINE)
    assert doubtful == ["m", "s", "g", "A", "C", "r0"]  # only a and b are
    words = "--m 0.5 --g 9.81 --s 0.08 --A-cm 0.00125 --phidot0 52.36 --psidot0 0".split()
    lagtop("fit", DISC, *words, "-o", scene)
    assert "# not determined" not in scene.read_text()
    record = json.loads(lagtop("fit", DISC, *known, "--format", "json").stdout)
    assert abs(record["r0"] - 52.36) < 4 * record["r0_std"]
    assert (record["verdict"], record["theta_rms_deg"]) == ("good", pytest.approx(0.2, rel=0.3))


def test_a_failed_fit_writes_no_scene_and_marks_what_is_not_determined(
    lagtop: Lagtop, tmp_path: Path
) -> None:
    result = lagtop("fit", DISC, "--sigma", 0.1, "-o", tmp_path / "no.toml")
    assert (result.exit_code, (tmp_path / "no.toml").exists()) == (1, False)
    t, seen = recorded("theta", "phi", rows=40, noise=0.5, seed=1)
    outcome = best_fit(recording_from(t, **seen), {})
    assert outcome.is_open  # another top explains it as well
    rows = fit_report([outcome], "data", "").rows
    assert all(x.meaning.startswith("not determined: ") for x in rows)


def test_windows(lagtop: Lagtop, tmp_path: Path) -> None:
    result = lagtop("fit", DISC, "--window", 3, "--plot", tmp_path / "decay.svg")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.splitlines()[-1].startswith("b does not decay: its relative rate is")
    assert "b does not decay" in (tmp_path / "decay.svg").read_text()
    failed = lagtop("fit", DISC, "--window", 3, "--sigma", 0.1, "--format", "json")
    assert failed.exit_code == 1
    windows = json.loads(failed.stdout)["windows"]
    assert "failed" in {x["verdict"] for x in windows}
    bound = chi2_bounds(windows[0]["dof"], CHANCE / 3)[1]
    assert windows[0]["chi2_dof_high"] == pytest.approx(bound)


def test_windows_keep_the_time_and_have_rows_of_every_angle() -> None:
    t = 100 + np.arange(60) / 10
    parts = recording_from(t, theta=np.ones(60), psi=t).windows(3)
    assert [(x.name, x.t.size, x.t[0]) for x in parts] == [
        (f"window {i}", 20, 0) for i in (1, 2, 3)
    ]
    assert [x.t_start for x in parts] == pytest.approx([100, 102, 104], abs=0.11)
    assert [x.middle for x in parts] == pytest.approx([100.95, 102.95, 104.95], abs=0.11)


def test_a_decay_is_that_of_the_windows() -> None:
    def window(t: float, a_off: float) -> Any:
        """Return a good fit whose a is off, and with it its r0, by the correlation 0.6."""
        value = -50 * math.exp(-t / 20)
        numbers = {"r0": Number(value + 0.3 * a_off, 1.0, "", 0.5)}
        numbers["a"] = Number(90 + a_off, 1.0, "", 1.0)
        part = SimpleNamespace(middle=t)
        pairs = {"a and r0": 0.6}
        return SimpleNamespace(verdict="good", numbers=numbers, correlations=pairs, recording=part)

    t = np.array([1.0, 3.0, 5.0, 7.0])
    found: Any = decay_of([window(*x) for x in zip(t, (0.5, -0.7, 0.9, -0.7), strict=True)])
    assert (found.quantity, found.rate, found.time) == ("r0", *map(pytest.approx, (0.05, 20)))
    assert [found.value(x) for x in (0, 20)] == pytest.approx([-50, -50 / math.e])
    weights = (50 * np.exp(-t / 20) / 0.4) ** 2  # 0.4 is what the correlation leaves of 0.5
    middle = np.average(t, weights=weights)
    assert found.rate_std == pytest.approx(np.sum(weights * (t - middle) ** 2) ** -0.5)
    assert found.time_std == pytest.approx(20**2 * found.rate_std)
    assert found.chi2_dof == pytest.approx(0, abs=1e-9)
    assert decay_of([window(x, 0) for x in (1, 2)]) is None


@pytest.mark.slow
def test_a_decay_within_each_window_is_named() -> None:
    failure = fitted(
        *recorded(*ANGLES, rows=721, seconds=6, seed=12, sizes={"drag": 6 / 27})
    ).failure()
    found = re.search(r"the spin decays: (r0|b) falls from (\d+).* to (\d+).*within each", failure)
    assert found, failure
    shown = [int(x) for x in found.groups()[1:]]
    assert shown == pytest.approx([TRUTH["r0"], TRUTH["r0"] * math.exp(-6 / 27)], abs=2)


@pytest.mark.slow
def test_friction_fails_and_windows_give_the_decay() -> None:
    t, seen = recorded("theta", "psi", rows=361, seconds=12, seed=11, sizes={"drag": 12 / 60})
    failure = fitted(t, seen).failure()
    assert re.search(r"the spin decays: use window=(5|10)$", failure), failure
    windows = fit_windows(recording_from(t, **seen), 12, known_inputs(gather(values_of(LAB))))
    assert {x.verdict for x in windows} == {"good"}
    decay = decay_of(windows)
    assert decay is not None
    assert decay.time is not None
    assert abs(decay.time - 60) < 4 * (decay.time_std or 0) < 4
    assert decay.quantity == "b"
