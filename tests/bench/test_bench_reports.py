"""The reports of `bench` and `stability`: front, growth, verdicts, pictures, exit codes."""

from __future__ import annotations

import json
import math
import os
import time
from pathlib import Path
from typing import Any
from xml.dom import minidom

import numpy as np
import pytest
from conftest import Lagtop
from engines import Body, dop853
from lagtop import Top, solve

from lagrange_cli.bench import measure
from lagrange_cli.bench import stability as hard
from lagrange_cli.bench.measure import Row
from lagrange_cli.bench.methods import METHODS, Method
from lagrange_cli.bench.points import read_points
from lagrange_cli.bench.reference import exact_motion, rotation_angle
from lagrange_cli.bench.work_precision import bench, conclusions, marked, methods_figure
from lagrange_cli.output.report import Report

WORKED = {"worked": solve(Top())}


@pytest.fixture(autouse=True)
def runs_are_not_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measure, "SECONDS_OF_RUNS", 0.0)


def row(method: str, setting: Any, error: float | None, ns: float | None, span: float = 1) -> Row:
    """Return a row of a scene."""
    return Row("scene", method, setting, span, error, ns)


def test_the_front_holds_what_no_row_beats() -> None:
    rows = [row("DOP853", 1e-7, None, None), row("RK4", 50, 1e-3, 20)]
    rows += [row("lagtop", 0, 1e-15, 50), row("RK4", 100, 1e-3 / 16, 60)]
    found = [(x.method, x.setting, x.front) for x in marked(rows)]
    assert found[:2] == [("lagtop", 0, True), ("RK4", 100, False)]
    assert found[2:] == [("RK4", 50, True), ("DOP853", 1e-7, False)]


def test_growth_is_the_slope_over_the_spans() -> None:
    rows = [row("RK4", 800, 1e-9 * span**2, 1, span) for span in (1.0, 10.0, 100.0)]
    assert list(conclusions(rows, True)) == ["scene: the error of RK4 grows as span^2.0."]


def test_spans_use_the_tightest_setting() -> None:
    report = bench(WORKED, ["lagtop", "RK4"], [1, 2], 5)
    found = [(x.method, x.setting, x.periods) for x in report.rows]
    assert found == [(*x, n) for n in (1, 2) for x in (("lagtop", "quaternion"), ("RK4", 800))]


def test_points_of_other_methods_are_drawn_with_inputs(lagtop: Lagtop, tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text("method,error_rad,evaluations\nmine,1e-6,300\nmine,0,20\n")
    cost, points = read_points(str(tmp_path / "mine.csv"))
    report = bench(WORKED, ["DOP853"], count=5)
    (axes,) = methods_figure(report, cost, points).axes
    (mine,) = (x for x in axes.get_lines() if x.get_label() == "mine")
    assert np.array(mine.get_xydata()).tolist() == [[2.0**-54, 20], [1e-6, 300]]
    assert axes.get_ylabel() == "evaluations"
    picture = "--plot", str(tmp_path / "x.svg"), "--points", str(tmp_path / "mine.csv")
    done = lagtop("bench", "--r0", "60", "--methods", "lagtop", "--n", "5", *picture)
    assert (done.exit_code, done.stderr) == (0, "")
    assert "r0=60" in done.stdout.replace("\n", "").replace(" ", "")


@pytest.mark.parametrize("kind", hard.FIXED)
def test_each_kind_nutates_and_repeats_by_its_seed(kind: str) -> None:
    scenes = [[x.top for x in hard.motions(kind, 2, seed)] for seed in (1, 1, 2)]
    assert scenes[0] == scenes[1]
    assert scenes[0][-1] != scenes[2][-1]
    assert scenes[0][0] == scenes[2][0]
    if kind == "near-steady":
        steady = [solve(top) for tops in scenes for top in tops]
        assert max(x.theta_max_deg - x.theta_min_deg for x in steady) < 1.1


def test_input_rounding_is_the_effect_of_half_an_ulp() -> None:
    """Against finite differences of an integration of Euler's equations."""
    top = Top(m=1, s=1, g=1, A=1, C=0.5, r0=6, theta0_deg=60, psidot0=0.5)

    def attitude(moved: Top) -> Any:
        return dop853(Body.of(moved), np.array([0.0, 5.0]), 1e-13)[1][-1, :4]

    given = (name for name, value in top.as_dict().items() if value)
    moved = dict(zip(given, hard.neighbours(top), strict=True))
    h, exact = 1e-5, tuple(attitude(top))
    for name, value in (("r0", 6.0), ("theta0_deg", 60.0)):  # an ulp of the degrees
        found = rotation_angle(moved[name].attitude(5.0), exact_motion(solve(top)).attitude(5.0))
        wide = rotation_angle(attitude(Top(**top.as_dict() | {name: value + h})), exact)
        assert found / (math.ulp(value) / 2) == pytest.approx(wide / h, rel=1e-3)


def test_a_wrong_lagtop_is_seen(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    exact = METHODS["lagtop"].prepare

    def spoiled(motion: Any, setting: Any) -> Any:
        sample = exact(motion, setting)
        return lambda t, limit: sample(t * (1 + 1e-12), limit)

    monkeypatch.setitem(METHODS, "lagtop", METHODS["lagtop"]._replace(prepare=spoiled))
    monkeypatch.setattr(hard, "COMPARED", ("lagtop",))
    monkeypatch.setattr(hard, "SPANS", (1.0,))
    done = lagtop("stability", "--kinds", "near-hanging", "--format", "csv")
    assert done.exit_code == 1
    assert "near-hanging over 1 nutation period: inaccurate" in done.stderr.splitlines()[-1]


@pytest.mark.parametrize("kinds", [["fast-spin"], pytest.param(None, marks=pytest.mark.slow)])
def test_lagtop_is_at_rounding_level(kinds: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hard, "COMPARED", ("lagtop",))
    monkeypatch.setattr(hard, "SPANS", hard.SPANS[-1:] if kinds else hard.SPANS)
    assert hard.failures(hard.stability(kinds, 1 if kinds else 3, 7)) == []


def test_only_the_method_is_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    """The conversion to attitudes is no part of a run, nor is the set-up."""
    clock = [0.0]

    def taking(seconds: float, result: Any) -> Any:
        def call(*_: Any) -> Any:
            clock[0] += seconds
            return result

        return call

    run = taking(0.02, ([], None))
    monkeypatch.setattr(time, "process_time", lambda: clock[0])
    monkeypatch.setattr(measure, "attitudes", taking(9, np.eye(4)))
    monkeypatch.setitem(METHODS, "RK4", Method([50], taking(0.5, run), True))
    found = bench(WORKED, ["RK4"], count=4).rows[0]
    assert (found.ns_per_sample, found.setup_ms) == pytest.approx((0.02 / 4 * 1e9, 500))


def test_a_method_of_a_user_is_one_entry(
    lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Its name may hold mathematics; so may the names of scenes, which are cleaned."""
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    for name in ("$mine_{$", "yours"):
        monkeypatch.setitem(METHODS, name, Method([1, 2], METHODS["scipy.special"].prepare))
    scenes = "d$x_{$.toml", os.fsdecode(b"a\x1b\xffb.toml")
    for scene in scenes:
        Path(scene).write_text("m = 1500\n")
    args = ("--methods", "lagtop,yours,$mine_{$", "--n", 2, "--format", "json", "--plot", "b.svg")
    done = lagtop("bench", *scenes, *args)
    assert done.exit_code == 0
    assert done.stderr.count("\n") == 2  # the warnings of an incomplete body
    assert len(json.loads(done.stdout)["rows"]) == 2 * 6
    minidom.parse("b.svg")


def test_pictures_draw_each_method() -> None:
    pytest.importorskip("matplotlib")
    rows = [row("RK45", x, 10 * x, 1 / x) for x in (1e-7, 1e-3, 1e-5)]
    rows += [row("lagtop", x, 1e-15, 50) for x in ("angles", "quaternion")]
    axes = methods_figure(Report({}, [], rows, [])).axes[0]
    lines = {str(x.get_label()): x for x in axes.get_lines()}
    assert lines["RK45"].get_xdata() == pytest.approx([1e-6, 1e-4, 1e-2])
    assert [lines[x].get_linestyle() for x in ("RK45", "lagtop")] == ["-", "None"]
    found = [row("DOP853", 3e-14, 1e-3 * x, 1, x) for x in hard.SPANS]
    figure = hard.stability_figure(Report({}, [], found, []))
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == ["over 1 nutation period", "over 100 nutation periods"]
    assert figure.axes[1].get_lines()[2].get_ydata() == pytest.approx([0.1])
