"""`lagtop stability`: the battery, its verdict, and the command lines of its worst cases."""

from __future__ import annotations

import csv
import io
import json
import math
import shlex
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from ball_judge import Judge
from conftest import Lagtop, assert_one_line
from lagtop import Top, solve

from lagrange_cli.arithmetic.text import value_text
from lagrange_cli.bench import battery, stability
from lagrange_cli.bench import method as methods
from lagrange_cli.bench.battery import HardScene, hard_scene
from lagrange_cli.bench.hard_scenes import STRATA, words_of
from lagrange_cli.bench.measure import settled_reference
from lagrange_cli.bench.peers import PEERS, VERDICTS, PeerRun, exact_spans, peer_run
from lagrange_cli.bench.reference import EPS, Reference
from lagrange_cli.motion.over_time.table import rows
from lagrange_cli.motion.record import NUMBER_KEYS
from lagrange_cli.motion.solve import Motion
from lagrange_cli.output.report import Report
from lagrange_cli.output.terminal import silent


@pytest.mark.slow
@pytest.mark.parametrize("stratum", STRATA)
def test_stratum(stratum: str) -> None:
    """A part of the battery; its worst cases, over 200 scenes a stratum, are the bounds here."""
    for i in range(3):
        case = battery.judged_case(hard_scene(stratum, 0, i, 2))
        assert case.angle_units <= 2.7, case
        assert case.quaternion_units <= 2.7, case
        assert case.key_ulps <= 0.5, case
        assert max(case.energy, case.Lz) <= 20 * EPS, case
        assert case.agreement < 1e-9


@pytest.mark.slow
def test_a_reference_with_too_few_digits_is_not_settled() -> None:
    """At 80 digits and at 110 the side of the pole is guessed, alike, and 60 times off."""
    top = Top(theta0_deg=1e-116, thetadot0=1, psidot0=1, r0=18, C=2, A=1, m=1, s=1, g=1)
    exact, guessed = Judge(top.as_dict()).record["T_spin"], Reference(top, 110).record()["T_spin"]
    settled = settled_reference(top)[0].record()["T_spin"]
    assert exact is not None
    assert abs(float(exact) / float(settled) - 1) < 1e-15
    assert abs(float(exact) / float(guessed) - 1) > 0.5


def test_scenes_and_times_are_those_of_the_seed() -> None:
    assert hard_scene("generic", 3, 1, 4) == hard_scene("generic", 3, 1, 4)
    assert hard_scene("generic", 3, 1, 4) != hard_scene("generic", 4, 1, 4)
    assert hard_scene("generic", 3, 1, 4) != hard_scene("generic", 3, 2, 4)
    assert all(1e11 <= abs(t) <= 1e14 for t in hard_scene("far times", 3, 1, 9).periods)


@pytest.mark.parametrize("stratum", STRATA)
def test_half_periods_and_their_neighbours_are_among_the_times(stratum: str) -> None:
    scenes = [hard_scene(stratum, 3, i, 2) for i in range(30)]
    quarters = [quarter for scene in scenes for quarter in scene.quarters]
    assert {abs(quarter) % 4 for quarter in quarters} == {0, 1, 2, 3}
    assert all(abs(scene.quarters[0]) % 4 == 2 for scene in scenes)
    assert all(min(scene.quarters) < 0 < max(scene.quarters) for scene in scenes)
    assert max(map(abs, quarters)) > 1e12
    if stratum != "far times":
        assert min(map(abs, quarters)) < 400
    times = scenes[0].times(1.75)
    nearest = [float(quarter) * 1.75 / 4 for quarter in scenes[0].quarters]
    for t, below, above in zip(nearest, times[4::3], times[3::3], strict=True):
        assert times.count(t) == 1
        assert {below, above} == {math.nextafter(t, -math.inf), math.nextafter(t, math.inf)}


def test_strata_are_what_their_names_say() -> None:
    scenes = {name: [hard_scene(name, 1, i, 1).inputs for i in range(40)] for name in STRATA}
    ratios = [x["C"] / x["A"] for x in scenes["generic"]]
    assert {1.0, 2.0} < set(ratios)
    assert any(0 < abs(ratio - 1) < 1e-5 for ratio in ratios)
    assert any(2 - 1e-5 < ratio < 2 for ratio in ratios)
    assert any(ratio < 0.02 for ratio in ratios)
    sizes = [abs(math.log10(x[key])) for x in scenes["units"] for key in ("m", "s")]
    assert 15 < max(sizes) <= 20
    gaps = [abs(solve(Top(**x)).modular_angle_deg or 0) for x in scenes["thresholds"]]
    assert any(0 < abs(gap - 45) < 1e-2 for gap in gaps)
    assert max(abs(x["r0"]) for x in scenes["any spin"]) > 1e80
    assert min(x["theta0_deg"] for x in scenes["tiny tilt with rates"]) < 1e-100
    assert any(0 < math.pi - x["theta0_rad"] < 1e-15 for x in scenes["radians"])
    assert all(2 * x == round(2 * x) for x in hard_scene("half periods", 1, 0, 9).periods)
    assert all(words_of(name)[0].islower() for name in STRATA)


FEW = ["--samples", 2, "--strata", "near a pole,slow"]


@pytest.mark.slow
def test_report_is_repeatable_in_every_format(
    lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The battery runs twice with one seed; the formats are written from the second run."""
    first = stability.run_battery(["near a pole", "slow"], 2, 1952, silent)
    second = stability.run_battery(["near a pole", "slow"], 2, 1952, silent)
    assert first.rows == second.rows
    assert {row.verdict for row in first.rows} <= set(VERDICTS)
    monkeypatch.setattr(stability, "run_battery", lambda *_, **__: second)
    picture = tmp_path / "error.svg"
    shown = lagtop("stability", *FEW, "--format", "json", "--plot", picture)
    assert shown.exit_code == bool(stability.exceeded(second))
    whole = json.loads(shown.stdout)
    assert [row["stratum"] for row in whole["rows"]] == ["near a pole"] * 6 + ["slow"] * 6
    assert "seed 1952" in whole["conditions"]["scenes"]
    listed = lagtop("stability", *FEW, "--format", "csv")
    lines = list(csv.DictReader(io.StringIO(listed.stdout)))
    for one, other in zip(lines, whole["rows"], strict=True):
        shown_there = {
            key: "" if value is None else value_text(value) for key, value in other.items()
        }
        assert shown_there == {key: text.replace("inf", "") for key, text in one.items()}
    assert "scenes: 2 per stratum" in listed.stderr
    assert ">near a pole<" in picture.read_text()
    assert "Worst cases:\nnear a pole: lagtop " in lagtop("stability", *FEW).stdout


def test_the_seed_and_the_samples_reach_the_battery(
    lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []

    def no_battery(*how: Any, certify: bool, is_long: bool) -> Report:
        asked.append((*how[:3], certify or is_long))
        return Report({}, [], [], ["nothing"])

    monkeypatch.setattr(stability, "run_battery", no_battery)
    for line in ("--seed 7 --samples 3", "--samples 200", "--certify"):
        assert lagtop("stability", "--strata", "slow", *line.split()).exit_code == 0
    whole, few = (["slow"], 200, 1952, False), (["slow"], 1, 1952, True)
    assert asked == [(["slow"], 3, 7, False), whole, few]


NEAR = [0.3, -7.1]


def near(inputs: dict[str, float]) -> HardScene:
    """Return a scene judged at times near its start."""
    return HardScene(inputs, NEAR, [])


@pytest.mark.slow
@pytest.mark.parametrize("stratum", ["near a pole", "units", "slow"])
def test_command_line_of_an_angle_shows_it(stratum: str, lagtop: Lagtop) -> None:
    case = battery.judged_case(near(hard_scene(stratum, 5, 0, 2).inputs))
    case = case._replace(key_ulps=0.0, quaternion_units=0.0)
    words = shlex.split(case.command(), comments=True)
    assert words[:2] == ["lagtop", "bench"]
    shown = json.loads(lagtop(*words[1:], "--format", "json").stdout)
    assert shown["rows"][0]["units_max"] == pytest.approx(case.angle_units, rel=1e-9)


def test_command_line_of_a_key_shows_it(lagtop: Lagtop) -> None:
    case = battery.judged_case(near(hard_scene("generic", 5, 0, 1).inputs))
    words = shlex.split(case._replace(key_ulps=9.0).command(), comments=True)
    record = json.loads(lagtop(*words[1:]).stdout)
    assert record[case.worst_key] == getattr(solve(case.top), case.worst_key)


def test_command_line_of_a_quaternion_shows_it(lagtop: Lagtop) -> None:
    case = battery.judged_case(near(hard_scene("generic", 5, 0, 1).inputs))
    words = shlex.split(case._replace(quaternion_units=9.0).command())
    header, values = lagtop(*words[1:], "--format", "csv").stdout.splitlines()
    assert header == "t,quaternion_w,quaternion_x,quaternion_y,quaternion_z"
    assert float(values.partition(",")[0]) == case.worst_attitude_time


UNIT = {"m": 1, "A": 1.3, "C": 1.7, "s": 1, "g": 1}
RELEASED = near(UNIT | {"r0": 2.3, "theta0_deg": 55})
MOVING = near(UNIT | {"r0": 2.3, "theta0_deg": 55, "thetadot0": 0.7, "psidot0": -0.4})


class Bent:
    """A motion in which one key, or what one method gives, has been changed."""

    def __init__(self, motion: Motion, name: str, change: Callable[[Any], Any]) -> None:
        self._motion, self._name, self._change = motion, name, change

    def __getattr__(self, name: str) -> Any:
        """Return what the motion has, changed under one name."""
        value = getattr(self._motion, name)
        return self._change(value) if name == self._name else value


def bend(monkeypatch: pytest.MonkeyPatch, name: str, change: Callable[[Any], Any]) -> None:
    """Let `solve` give motions that are changed under one name."""
    monkeypatch.setattr(battery, "solve", lambda top: Bent(solve(top), name, change))


def test_every_key_is_there_to_be_bent() -> None:
    record = solve(Top(**RELEASED.inputs))
    absent = {key for key in NUMBER_KEYS if not getattr(record, key)}
    assert absent == {"precession_rate_start"}  # 0 at rest; judged in the moving scene


@pytest.mark.slow
@pytest.mark.parametrize("key", NUMBER_KEYS)
def test_a_key_wrong_by_1e_15_is_seen(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = MOVING if key == "precession_rate_start" else RELEASED
    assert battery.judged_case(scene).excess <= 1
    bend(monkeypatch, key, lambda value: value * (1 + 1e-15))
    case = battery.judged_case(scene)
    assert case.excess > 1
    assert case.worst_key == key


@pytest.mark.slow
@pytest.mark.parametrize("key", ["a", "u_quarter", "amplitude_deg"])
def test_a_missing_or_a_needless_key_is_seen(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    bend(monkeypatch, key, lambda _: None)
    assert battery.judged_case(RELEASED).worst_key == key
    bend(monkeypatch, "alpha", lambda _: 1.0)
    assert battery.judged_case(MOVING).worst_key == "alpha"


def bend_columns(monkeypatch: pytest.MonkeyPatch, change: Callable[[Any], Any]) -> None:
    """Change the blocks of the table that is judged."""

    def bent(motion: Any, times: Any, columns: Any, **shown: Any) -> Any:
        header, blocks = rows(motion, times, columns, **shown)
        return header, (change(block) for block in blocks)

    monkeypatch.setattr(battery, "rows", bent)


@pytest.mark.parametrize("column", [1, 2])
def test_an_angle_wrong_by_a_turn_is_seen(column: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Phi and psi are the second and the third column."""
    turn = 2 * math.pi * (np.arange(9) == column)
    bend_columns(monkeypatch, lambda block: block + turn)
    case = battery.judged_case(RELEASED)
    assert (case.phi_units, case.psi_units)[column - 1] > 1e13
    assert case.command().startswith("lagtop bench ")


def test_a_quaternion_with_the_other_sign_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    signs = np.array([1, 1, 1, -1, -1, -1, -1, 1, 1])
    bend_columns(monkeypatch, lambda block: signs * block)
    case = battery.judged_case(RELEASED)
    assert case.quaternion_units > 1e13
    assert case.command().startswith("lagtop table ")


@pytest.mark.slow
def test_what_is_wrong_exits_with_1(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    bend(monkeypatch, "a", lambda value: value * (1 + 1e-15))
    line = ["--samples", 1, "--strata", "generic,slow", "--format", "json"]
    result = lagtop("stability", *line)
    assert result.exit_code == 1
    assert result.stderr.startswith(
        "Error: 2 of 2 strata failed; the first: generic: lagtop solve "
    )
    whole = json.loads(result.stdout)
    ours = [row for row in whole["rows"] if row["method"] == "lagtop"]
    assert [row["verdict"] for row in ours] == ["EXCEEDED"] * 2
    assert whole["conclusions"][0] == "Exceeded in: generic, slow."
    assert [row["worst_key"] for row in ours] == ["a", "a"]


def test_the_keys_of_the_reference_are_those_of_the_judge_in_balls() -> None:
    for scene in (RELEASED, MOVING):
        exact = Reference(Top(**scene.inputs), 50).record()
        judge = Judge(Top(**scene.inputs).as_dict())
        assert set(exact) == set(NUMBER_KEYS)
        for key, value in exact.items():
            assert (value is None) == (judge.record.get(key) is None), key
            if value is not None:
                assert judge.ulps(key, float(value)) <= 0.5, key


def test_without_scipy(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(methods, "find_spec", lambda _: None)
    result = lagtop("stability", "--samples", 1, "--strata", "generic", "--format", "json")
    assert result.exit_code == 0
    whole = json.loads(result.stdout)
    verdicts = {row["method"]: row["verdict"] for row in whole["rows"]}
    assert verdicts["scipy.special"] == verdicts["DOP853-quaternion"] == ""
    assert verdicts["lagtop"] == "exact"
    missing = "scipy.special (not applicable: needs scipy: pip install scipy)"
    assert f"Not compared: {missing}." in whole["conclusions"]


MOVING_TOP = Top(**UNIT, r0=2.3, theta0_deg=55, thetadot0=0.7, psidot0=-0.4)


@pytest.fixture(scope="module")
def runs() -> dict[str, PeerRun]:
    """Return the runs of all methods in one scene."""
    exact = exact_spans(MOVING_TOP, Reference(MOVING_TOP, 60))
    return {name: peer_run(name, exact) for name in PEERS}


@pytest.mark.slow
def test_the_condition_is_what_half_a_unit_of_each_input_does(runs: dict[str, PeerRun]) -> None:
    """The reference of inputs that differ by so much, in all its digits."""
    inputs = {name: x for name, x in MOVING_TOP.as_dict().items() if x}
    for t, bound in runs["lagtop"].bounds[::5]:
        time = t * float(Reference(MOVING_TOP, 60).T)
        exact, total = Reference(MOVING_TOP, 60).at(time), 0.0
        for name, x in inputs.items():
            moved = Fraction(x) + Fraction(math.ulp(float(x))) / 2
            other = Reference(Top(**MOVING_TOP.as_dict() | {name: moved}), 60).at(time)
            with mpmath.workdps(60):
                away = [a - b for a, b in zip(other.quaternion, exact.quaternion, strict=True)]
                total += float(2 * mpmath.sqrt(sum(x * x for x in away)))
        assert bound == pytest.approx(total, rel=0.01)


def test_verdicts(runs: dict[str, PeerRun]) -> None:
    assert {name: run.verdict for name, run in runs.items()} == {
        "lagtop": "exact",
        "scipy.special": "exact",
        "DOP853-quaternion": "drifting",
        "Radau-quaternion": "drifting",
        "Taylor-quaternion": "exact",
        "RK4-quaternion": "accurate",
    }
    run, times = runs["lagtop"], (1.0, 5.0, 100.0)

    def judged(errors: list[float], bound: float = 1e-12) -> str:
        points = list(zip(times, errors, strict=False))
        return run._replace(points=points, bounds=[(t, bound) for t in times]).verdict

    assert judged([1e-12, 1e-11, 1e-10]) == "exact"
    assert judged([1e-7, 5e-7, 1e-5]) == "accurate"
    assert judged([1e-7, 5e-6, 5e-4]) == "drifting"
    assert judged([1e-6, 1e-5, 2e-3]) == "drifting"
    assert judged([1e-6, 1e-5, 0.2]) == "lost"
    assert judged([1e-6]) == "lost"
    assert judged([1e-7, 5e-7]) == "accurate"
    assert judged([1e-7, 5e-7, 1e-5], 0.2) == "ill-conditioned"
    assert run._replace(points=[], remark="not applicable: needs x").verdict == ""
    assert run._replace(points=run.points[:8]).error(100) == math.inf


BAD = {
    "--strata hard": "--strata must be among generic, from rest, stiff (fast spin),",
    "--samples 0": "--samples must be in [1, 100000], got 0",
    "--seed x": "--seed must be a finite decimal number, got 'x'",
    "--plot x.gif": "--plot must end in .svg or .png, got 'x.gif'",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_input_is_one_line(line: str, lagtop: Lagtop) -> None:
    assert_one_line(lagtop("stability", *line.split()), 2, BAD[line])


def test_changes_are_over_the_size_of_the_terms() -> None:
    energy = 2 * 1587 * 4 * 981 * (1 + math.cos(math.pi / 6)) / 2 + 17458 * 50**2 / 2
    block = np.array([[0.0, 0.0], [3 * EPS * energy, -5 * EPS * 2 * 17458 * 50]])
    assert battery.conserved_changes(Top(), block) == pytest.approx((3 * EPS, 5 * EPS))
