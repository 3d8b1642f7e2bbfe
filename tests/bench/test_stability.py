"""`lagtop stability`: the battery, its verdict, and the command lines of its worst cases."""

from __future__ import annotations

import csv
import io
import json
import math
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Lagtop, assert_one_line

from lagrange_cli import Top, solve
from lagrange_cli.bench import method as methods
from lagrange_cli.bench import stability
from lagrange_cli.bench.hard_scenes import STRATA, scene_and_times
from lagrange_cli.bench.reference import EPS, Reference
from lagrange_cli.motion import make_sampler as samplers
from lagrange_cli.motion.general import theta_constants


@pytest.mark.parametrize("stratum", STRATA)
def test_stratum(stratum: str) -> None:
    """A part of the battery; its worst cases, over 200 scenes a stratum, are the bounds here."""
    for i in range(3):
        case = stability.judge(*scene_and_times(stratum, 0, i, 4), peers=False)
        assert case.angle <= 2.7, case
        assert case.key_eps <= 0.5, case
        assert max(case.energy_eps, case.Lz_eps) <= 20, case
        assert case.agreement < 1e-9


def test_scenes_and_times_are_those_of_the_seed() -> None:
    assert scene_and_times("generic", 3, 1, 4) == scene_and_times("generic", 3, 1, 4)
    assert scene_and_times("generic", 3, 1, 4) != scene_and_times("generic", 4, 1, 4)
    assert scene_and_times("generic", 3, 1, 4) != scene_and_times("generic", 3, 2, 4)
    assert all(1e11 <= abs(t) <= 1e12 for t in scene_and_times("far times", 3, 1, 9)[1])


def test_strata_are_what_their_names_say() -> None:
    scenes = {name: [scene_and_times(name, 1, i, 1)[0] for i in range(40)] for name in STRATA}
    assert all(0 < abs(x["C"] / x["A"] - 1) < 1e-5 for x in scenes["sphere limit"])
    ratios = [x["C"] / x["A"] for x in scenes["disc limit"]]
    assert any(2 - 1e-5 < ratio < 2 for ratio in ratios)
    assert any(ratio < 0.02 for ratio in ratios)
    sizes = [abs(math.log10(x[key])) for x in scenes["units"] for key in ("m", "s")]
    assert 25 < max(sizes) <= 30
    gaps = [abs(solve(Top(**x)).modular_angle_deg or 0) for x in scenes["thresholds"]]
    assert any(0 < abs(gap - 45) < 1e-6 for gap in gaps)


FEW = ["--samples", 2, "--strata", "bottom pass,fast"]


def test_report_is_repeatable_and_fine(lagtop: Lagtop, tmp_path: Path) -> None:
    picture = tmp_path / "error.svg"
    first = lagtop("stability", *FEW, "--format", "json", "--plot", picture)
    assert first.exit_code == 0
    whole = json.loads(first.stdout)
    assert [row["stratum"] for row in whole["rows"]] == ["bottom pass", "fast"]
    assert "seed 1952" in whole["conditions"]["scenes"]
    assert whole["conclusions"][0] == "All strata are within the contract."
    listed = lagtop("stability", *FEW, "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(listed.stdout)))
    for one, other in zip(rows, whole["rows"], strict=True):
        assert {key: str(value) for key, value in other.items()} == one
    assert "scenes: 2 a stratum" in listed.stderr
    assert "<!-- bottom pass -->" in picture.read_text()
    table = lagtop("stability", *FEW, "--seed", 7).stdout
    assert "seed 7" in table
    assert "Worst cases:\nbottom pass: lagtop " in table


@pytest.mark.parametrize("stratum", ["bottom pass", "units", "fast"])
def test_command_line_of_an_angle_shows_it(stratum: str, lagtop: Lagtop) -> None:
    case = stability.judge(*scene_and_times(stratum, 5, 0, 2), peers=False)
    case = case._replace(key_eps=0.0)
    words = shlex.split(case.command(), comments=True)
    assert words[:2] == ["lagtop", "bench"]
    shown = json.loads(lagtop(*words[1:], "--format", "json").stdout)
    assert shown["rows"][0]["units_max"] == pytest.approx(case.angle, rel=1e-9)


def test_command_line_of_a_key_shows_it(lagtop: Lagtop) -> None:
    case = stability.judge(*scene_and_times("generic", 5, 0, 1), peers=False)
    words = shlex.split(case._replace(key_eps=9.0).command(), comments=True)
    record = json.loads(lagtop(*words[1:]).stdout)
    assert record[case.key] == getattr(solve(case.top), case.key)


@pytest.fixture
def flipped(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A program with a sign wrong: the parameter of Y lies on the other side."""

    def wrong(*given: Any) -> Any:
        constants = theta_constants(*given)
        return constants._replace(sign_minus=-constants.sign_minus)

    monkeypatch.setattr("lagrange_cli.motion.make_sampler.theta_constants", wrong)
    samplers.sampler_of.cache_clear()
    yield
    samplers.sampler_of.cache_clear()


@pytest.mark.usefixtures("flipped")
def test_a_wrong_sign_exits_with_1(lagtop: Lagtop) -> None:
    result = lagtop("stability", "--samples", 1, "--strata", "generic,sphere")
    assert result.exit_code == 1
    assert result.stdout.count("EXCEEDED") == 2
    assert "Exceeded in: generic, sphere." in result.stdout
    assert result.stderr == ""


def test_a_wrong_key_exits_with_1(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    right = Reference.record
    monkeypatch.setattr(
        Reference, "record", lambda self: right(self) | {"mean_spin_rate": right(self)["K"]}
    )
    result = lagtop("stability", "--samples", 1, "--strata", "generic", "--format", "json")
    assert result.exit_code == 1
    (row,) = json.loads(result.stdout)["rows"]
    assert row["worst_key"] == "mean_spin_rate"
    assert row["worst_case"].endswith("# mean_spin_rate")


def test_without_scipy(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(methods, "find_spec", lambda _: None)
    result = lagtop("stability", "--samples", 1, "--strata", "generic", "--format", "json")
    assert result.exit_code == 0
    whole = json.loads(result.stdout)
    assert whole["rows"][0]["scipy_units"] is None
    assert whole["rows"][0]["dop853_failed"] is None
    assert whole["conditions"]["missing"].endswith("needs scipy: pip install 'lagtop[bench]'")


def test_failures_of_others_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stability, "INTEGRATOR_SECONDS", 1e-6)
    scene, periods = scene_and_times("generic", 1, 0, 1)
    case = stability.judge(scene, periods)
    assert case.integrated == math.inf
    assert stability._worst_and_failed([1.0, 3.0, math.inf, math.inf]) == (3.0, 2)
    assert stability._worst_and_failed([math.inf]) == (None, 1)


BAD = {
    "--strata hard": "--strata must be among generic, fast,",
    "--samples 0": "--samples must be in [1, 100000], got 0",
    "--samples 3 --thorough": "--samples and --thorough exclude each other",
    "--seed x": "--seed must be a finite decimal number, got 'x'",
    "--plot x.gif": "--plot must end in .svg or .png, got 'x.gif'",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_input_is_one_line(line: str, lagtop: Lagtop) -> None:
    assert_one_line(lagtop("stability", *line.split()), 2, BAD[line])


def test_drift_is_over_the_size_of_the_terms(monkeypatch: pytest.MonkeyPatch) -> None:
    energy = 2 * 1587 * 4 * 981 * (1 + math.cos(math.pi / 6)) / 2 + 17458 * 50**2 / 2
    block = np.array([[0.0, 0.0], [3 * EPS * energy, -5 * EPS * 2 * 17458 * 50]])
    monkeypatch.setattr(stability, "rows", lambda *_: ([], iter([block])))
    drifts = stability.drifts(solve(Top()), np.array([1.0]))
    assert drifts == pytest.approx((3.0, 5.0))
