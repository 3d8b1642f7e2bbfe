"""The reports of `bench` and `stability`: front, orders, growth, verdicts, exit codes."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Lagtop
from lagtop import Top, solve

from lagrange_cli.bench import stability as hard
from lagrange_cli.bench import work_precision
from lagrange_cli.bench.methods import METHODS, Run, problem_of
from lagrange_cli.bench.reference import inputs_of, rotation_angle
from lagrange_cli.bench.work_precision import (
    Row,
    bench,
    conclusions,
    exact_motion,
    marked,
    methods_figure,
)

WORKED = {"worked": solve(Top())}


def row(method: str, setting: float, error: float | None, ns: float | None, **more: Any) -> Row:
    """Return a row of a scene."""
    return Row("scene", method, setting, **{"periods": 1.0, "error_rad": error} | more)._replace(
        ns_per_sample=ns
    )


def test_the_front_holds_what_no_row_beats() -> None:
    rows = marked(
        [
            row("lagtop", 0, 1e-15, 50),
            row("RK4", 50, 1e-3, 20),
            row("RK4", 100, 1e-3 / 16, 60),
            row("DOP853", 1e-7, None, None),
        ]
    )
    assert [(x.method, x.setting, x.front) for x in rows] == [
        ("lagtop", 0, True),
        ("RK4", 100, False),
        ("RK4", 50, True),
        ("DOP853", 1e-7, False),
    ]
    assert [x.order for x in rows] == [None, pytest.approx(4), None, None]


def test_growth_is_the_slope_over_the_spans() -> None:
    rows = [row("RK4", 800, 1e-9 * span**2, 1, periods=span) for span in (1.0, 10.0, 100.0)]
    assert list(conclusions(rows, True)) == ["scene: the error of RK4 grows as span^2.0."]


def test_spans_use_the_tightest_setting() -> None:
    report = bench(WORKED, ["lagtop", "RK4"], [1, 2], 5)
    assert [(x.method, x.setting, x.periods) for x in report.rows] == [
        ("lagtop", "quaternion", 1),
        ("RK4", 800, 1),
        ("lagtop", "quaternion", 2),
        ("RK4", 800, 2),
    ]


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (["bench", "sleeping-top"], "must nutate, got sleeping"),
        (["bench", "--methods", "euler"], "--methods must be among lagtop"),
        (["bench", "--spans", "0,1"], "--spans must increase from above 0"),
        (["bench", "--spans", "1,0"], "--spans must increase from above 0"),
        (["bench", "nothing"], "nothing"),
        (["stability", "--kinds", "hard"], "--kinds must be among fast-spin"),
        (["stability", "--samples", "0"], "--samples must be in [1, 1000]"),
    ],
)
def test_bad_requests_end_in_one_line(lagtop: Lagtop, args: list[str], said: str) -> None:
    done = lagtop(*args)
    assert done.exit_code in {2, 65}
    assert done.stdout == ""
    assert said in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.slow
def test_the_command_compares_scenes(lagtop: Lagtop, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    picture = tmp_path / "methods.svg"
    done = lagtop(
        *("bench", "chrapan-1952", "slow-top", "--methods", "lagtop,scipy.special"),
        *("--n", 20, "--format", "json", "--plot", picture),
    )
    report = json.loads(done.stdout)
    assert {x["scene"] for x in report["rows"]} == {"chrapan-1952", "slow-top"}
    assert all(x["error_rad"] < 1e-7 for x in report["rows"])
    assert picture.stat().st_size > 10_000


@pytest.mark.parametrize("kind", hard.KINDS)
def test_each_kind_nutates_and_repeats_by_its_seed(kind: str) -> None:
    scenes = [[x.top for x in hard.motions(kind, 2, seed)] for seed in (1, 1, 2)]
    assert scenes[0] == scenes[1]
    assert scenes[0][-1] != scenes[2][-1]
    assert scenes[0][0] == scenes[2][0]


@pytest.mark.parametrize(
    ("error", "rounding", "verdict"),
    [(1e-13, 1e-15, "rounding level"), (1.1e-13, 1e-15, "inaccurate"), (2e-3, 1e-15, "lost")],
)
def test_verdicts(error: float, rounding: float, verdict: str) -> None:
    assert hard.verdict_of(error, rounding) == verdict


def test_input_rounding_is_the_effect_of_half_an_ulp() -> None:
    """Against finite differences of an integration of Euler's equations."""
    from scipy.integrate import solve_ivp

    top = Top(m=1, s=1, g=1, A=1, C=0.5, r0=6, theta0_deg=60, psidot0=0.5)

    def attitude(moved: Top) -> Any:
        start, slope = problem_of(moved)
        flow = solve_ivp(slope, (0.0, 5.0), start, "DOP853", rtol=1e-13, atol=1e-13)
        return flow.y[2:, -1]

    names = list(inputs_of(top))
    moved = dict(zip(names, hard.neighbours(top), strict=False))
    found = rotation_angle(moved["r0"].attitude(5.0), exact_motion(solve(top)).attitude(5.0))
    h = 1e-5
    exact = tuple(attitude(top))
    wide = rotation_angle(attitude(Top(**top.as_dict() | {"r0": 6 + h})), exact)
    half_ulp = math.ulp(6.0) / 2
    assert found / half_ulp == pytest.approx(wide / h, rel=1e-3)


def test_a_wrong_lagtop_is_seen(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = METHODS["lagtop"].prepare

    def spoiled(motion: Any, setting: Any) -> Any:
        sample = exact(motion, setting)

        def run(t: Any, limit: float) -> Run:
            return sample(t * (1 + 1e-12), limit)

        return run

    monkeypatch.setitem(METHODS, "lagtop", METHODS["lagtop"]._replace(prepare=spoiled))
    monkeypatch.setattr(hard, "COMPARED", ("lagtop",))
    monkeypatch.setattr(hard, "SPANS", (1.0,))
    done = lagtop("stability", "--kinds", "near-hanging", "--format", "csv")
    assert done.exit_code == 1
    assert "near-hanging over 1 periods: inaccurate" in done.stderr.splitlines()[-1]


@pytest.mark.parametrize("kinds", [["fast-spin"], pytest.param(None, marks=pytest.mark.slow)])
def test_lagtop_is_at_rounding_level(kinds: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hard, "COMPARED", ("lagtop",))
    assert hard.failures(hard.stability(kinds, 2 if kinds else 3, 7)) == []


def test_only_the_method_is_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The conversion to attitudes is no part of a run."""

    def slow(columns: Any) -> Any:
        return np.tile([1.0, 0, 0, 0], (sum(i * 0 for i in range(300_000)) + len(columns), 1))

    method = METHODS["RK4"]._replace(prepare=lambda *_: lambda t, _: (t, None))
    monkeypatch.setitem(METHODS, "RK4", method)
    monkeypatch.setattr(work_precision, "attitudes", slow)
    report = bench(WORKED, ["RK4"], count=10)
    assert report.rows[0].ns_per_sample < 1e5


@pytest.mark.slow
def test_pictures_draw_each_method(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.setattr(hard, "COMPARED", ("lagtop", "Taylor"))
    report = bench(WORKED, ["lagtop", "RK45"], count=5)
    _, curve = methods_figure(report).axes[0].get_lines()[-2:]
    errors = sorted(x.error_rad for x in report.rows if x.method == "RK45")
    assert sorted(np.asarray(curve.get_xdata()).tolist()) == errors
    figure = hard.stability_figure(hard.stability(["near-hanging"], 0))
    assert [axes.get_title() for axes in figure.axes] == ["span of 1 T", "span of 100 T"]
