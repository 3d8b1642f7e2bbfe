"""`lagtop bench`: methods, errors, front, failures and pictures."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arb_balls import many_digits
from ball_judge import Judge
from conftest import ROOT, Lagtop, assert_one_line
from lagtop import LagtopError, Top, solve
from scipy.integrate import solve_ivp

from lagrange_cli.arithmetic.text import value_text
from lagrange_cli.bench import compare_methods
from lagrange_cli.bench import method as methods
from lagrange_cli.bench.closed_forms import CLOSED_FORMS
from lagrange_cli.bench.compare_methods import METHOD_FIELDS, conclusions, with_front
from lagrange_cli.bench.integrators import FORMS, integrators, problem_of
from lagrange_cli.bench.measure import Task, measure, reference_period, task
from lagrange_cli.bench.method import MethodRow
from lagrange_cli.bench.pictures import draw_methods
from lagrange_cli.output.report import Report

LOOPING = Top(psidot0=-4)
METHODS = CLOSED_FORMS | integrators(10)


@cache
def work_on(top: Top) -> Task:
    motion = solve(top)
    return task(motion, 3.3 * reference_period(motion), 40, judged=10)


def run(top: Top, name: str, setting: Any) -> MethodRow:
    return measure(work_on(top), name, METHODS[name], setting)


def error(row: MethodRow) -> float:
    if row.remark == "not applicable: needs heyoka: pip install heyoka":  # not on every system
        pytest.skip(row.remark)
    assert row.error_rad is not None, row.remark
    return row.error_rad


@pytest.mark.slow
@pytest.mark.parametrize("name", integrators(10))
def test_integrators_agree_with_the_reference_the_better_the_tighter(name: str) -> None:
    """Worst seen at the tightest tolerance: 1.2e-6 rad (Radau, quaternion)."""
    coarse, fine = (error(run(LOOPING, name, METHODS[name].settings[i])) for i in (1, -1))
    assert fine < coarse / 10
    assert fine < 2e-5


@pytest.mark.slow
@pytest.mark.parametrize("start", [{"r0": -50}, {"thetadot0": -2, "psidot0": 3}, {"r0": 200}])
@pytest.mark.parametrize("name", ["lagtop", "scipy.special", "DOP853-quaternion", "Taylor-euler"])
def test_other_starts(name: str, start: dict[str, float]) -> None:
    assert error(run(Top(**start), name, METHODS[name].settings[-1])) < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("r0", [50, -50])
def test_series_of_the_paper_gain_with_every_term(r0: float) -> None:
    errors = [error(run(Top(r0=r0), "theta-series", terms)) for terms in (1, 2, 3, 6, 12)]
    assert errors[0] < 2e-2
    assert all(later < sooner / 4 for sooner, later in pairwise(errors))
    assert errors[-1] < 1e-13
    assert 0.1 < error(run(Top(r0=r0), "mean-rates", "double")) < 1


def test_the_tilt_of_mean_rates_is_exact() -> None:
    """Three terms of the series are enough, two leave 3e-11."""
    times = np.linspace(0, 1, 300)
    tilt = CLOSED_FORMS["mean-rates"].prepare(Top(), "double")(times).angles[0]
    assert abs(np.asarray(tilt) - solve(Top()).angles(times).theta).max() < 1e-14


@pytest.mark.parametrize("digits", [20, 30, 50])
def test_digits_are_judged_with_more_of_them(digits: int) -> None:
    row = run(Top(), "lagtop-digits", digits)
    assert 0 < error(row) < 50 * 10.0**-digits  # of angles of up to 70 rad


@pytest.mark.slow
def test_the_exact_angles_are_those_of_the_judge() -> None:
    work, judge = task(solve(Top()), 3.0, 5), Judge(Top().as_dict())
    for t, exact in zip(work.times.tolist(), work.exact, strict=True):
        true = map(many_digits, judge.at(t, 50)[:3])
        assert max(abs(x - y) for x, y in zip(exact[:3], true, strict=True)) < 1e-45
    assert work.agreement < 1e-45


@pytest.mark.slow
def test_one_time_is_the_last_and_may_lie_before_the_start() -> None:
    work = task(solve(Top()), -2.5, 1)
    assert work.times.tolist() == [-2.5]
    assert error(measure(work, "lagtop", METHODS["lagtop"], "double")) < 1e-14
    assert error(measure(work, "RK45-euler", METHODS["RK45-euler"], 1e-12)) < 1e-9
    assert error(measure(work, "Taylor-euler", METHODS["Taylor-euler"], 1e-16)) < 1e-12


def row(method: str, error_rad: float | None, ns_min: float | None, **more: Any) -> MethodRow:
    return MethodRow(
        None, method, "", 1.0, error_rad=error_rad, ns_min=ns_min, units_max=9.0, **more
    )


def test_front_and_what_it_says() -> None:
    rows = [row("slow", 1e-9, 9.0), row("lagtop", 1e-15, 2.0), row("rough", 1e-3, 1.0)]
    rows += [row("none", None, None, remark="failed: stopped"), row("half", 1e-16, None)]
    marked = with_front(rows)
    assert [x.method for x in marked] == ["half", "lagtop", "slow", "rough", "none"]
    spread = with_front([row("a", 1e-3, 1.0), row("b", 1e-6, 9.0), row("a", 1e-9, 5.0)])
    assert [(x.method, x.error_rad) for x in spread] == [("a", 1e-9), ("a", 1e-3), ("b", 1e-6)]
    assert [x.method for x in marked if x.front] == ["lagtop", "rough"]
    table = {name: methods.Method([], ours) for name in ("lagtop", "slow", "rough", "none", "half")}
    assert list(conclusions(marked, table)) == [
        "None of slow, rough is both faster and more accurate than lagtop.",
        "Nothing from outside this package was compared.",
        "Not compared: half (None), none (failed: stopped).",
    ]
    table["slow"] = methods.Method([], ours, "scipy")
    assert "Nothing from outside this package was compared." not in conclusions(marked, table)
    marked = with_front([*rows, row("better", 1e-16, 1.5)])
    better = list(conclusions(marked, table | {"better": methods.Method([], ours)}))
    assert better[0].startswith("better at  beats lagtop: 1.0e-16 rad in 2 ns against 1.0e-15 rad")


def test_the_order_is_that_of_the_two_finest_settings_above_rounding() -> None:
    def runs(name: str, errors: list[float]) -> list[MethodRow]:
        return [row(name, e, 1.0, evaluations=100 * 2**i) for i, e in enumerate(errors)]

    fourth = [0.5, 1e-2, 1e-3, 1e-3 / 2**4, 1e-12]
    found = compare_methods.with_order([*runs("x", fourth), *runs("Taylor", fourth)])
    assert {x.method: x.order for x in found} == {"x": pytest.approx(4), "Taylor": None}
    assert compare_methods.with_order(runs("x", [1e-2, 1e-12]))[0].order is None
    alike = [x._replace(evaluations=400) for x in runs("x", [1e-3, 1e-3])]
    assert compare_methods.with_order(alike)[0].order is None


def test_the_exponent_of_growth() -> None:
    errors = [(10.0**i, 3e-9 * 10.0 ** (2 * i)) for i in range(4)]
    assert compare_methods.growth_of([*errors, (1e5, 2.0), (1e6, 0.0)]) == pytest.approx(2)
    assert compare_methods.growth_of(errors[:1]) is None


@pytest.mark.parametrize("name", ["DOP853-quaternion", "RK4-euler", "Radau-euler"])
def test_work_is_counted(name: str) -> None:
    """Tolerances act in the units of the scene: the run of scipy is that of a plain call."""
    method = METHODS[name]
    t = np.linspace(0, 1, 7)
    angles, work, _ = method.prepare(LOOPING, method.settings[0])(t)
    if name == "RK4-euler":
        period = solve(LOOPING).T_nutation
        steps = 6 * math.ceil(1 / 6 / period * 50)
        assert work == (4 * steps, steps, 0)
        return
    p, form = problem_of(LOOPING), FORMS[name.partition("-")[2]]
    rtol, way = method.settings[0], name.partition("-")[0]
    slope: Any = form.slope(p, math)
    flow = solve_ivp(slope, (0, 1), form.start(p), way, t_eval=t, rtol=rtol, atol=rtol)
    assert np.asarray(angles[0]) == pytest.approx(np.asarray(form.angles(flow.y)[0]), abs=1e-12)
    if way == "Radau":
        assert work.evaluations == flow.nfev
        assert work.jacobians == flow.njev > 0


def test_ties_on_the_front() -> None:
    """Equal rows do not beat each other; a tie in one number is decided by the other one."""
    twins = with_front([row("lagtop", 1e-12, 5.0), row("twin", 1e-12, 5.0)])
    assert [x.front for x in twins] == [True, True]
    for other in (row("as exact", 1e-12, 4.0), row("as fast", 1e-13, 5.0)):
        pair = with_front([row("lagtop", 1e-12, 5.0), other])
        assert [x.method for x in pair if x.front] == [other.method]
        table = {"lagtop": methods.Method([], ours), other.method: methods.Method([], ours)}
        assert next(iter(conclusions(pair, table))).startswith(f"{other.method} at  beats lagtop")


def ours(*_: Any) -> Any:
    """Raise AssertionError in place of a method that is not run."""
    raise AssertionError


def test_an_empty_field_beats_nothing() -> None:
    alone = with_front([row("lagtop", 1e-15, 2.0)])
    table = {"lagtop": methods.Method([], ours)}
    assert list(conclusions(alone, table)) == ["lagtop was compared with nothing."]
    away = row("scipy.special", None, None, remark="not applicable: needs scipy")
    assert list(conclusions([*alone, away], table)) == [
        "lagtop was compared with nothing.",
        "Not compared: scipy.special (not applicable: needs scipy).",
    ]
    partly = [*alone, row("rough", 1e-3, 9.0), row("rough", None, None, remark="failed: slow")]
    assert list(conclusions(partly, table | {"rough": methods.Method([], ours, "scipy")})) == [
        "None of rough is both faster and more accurate than lagtop.",
        "Settings without a result: 1 (see the remarks).",
    ]


@pytest.mark.slow
def test_what_fails_is_told() -> None:
    quick = integrators(1e-4)
    work = task(solve(Top()), 8.0, 100, judged=3)
    for name in ("RK45-euler", "LSODA-quaternion", "Radau-euler"):
        remark = measure(work, name, quick[name], 1e-7).remark
        assert remark == "failed: took more than 0.0001 s"
    if find_spec("heyoka"):
        remark = measure(work, "x", quick["Taylor-euler"], 1e-16).remark
        assert remark == "failed: took more than 10 steps"
    unfit = methods.Run([np.full(100, np.nan)] * 3)
    nothing = methods.Method(["x"], lambda _, __: lambda _: unfit)
    lost = measure(work, "x", nothing, "x")
    assert lost.remark == "failed: returned values that are not finite"
    assert lost.ns_min is not None
    lost = run(Top(r0=1e-3, theta0_deg=179.9999999), "scipy.special", "double")
    assert lost.remark == "failed: float division by zero"
    start = "not applicable: the paper's formulas are for a top released from rest"
    assert run(LOOPING, "mean-rates", "double").remark == start


def test_euler_angles_on_the_vertical() -> None:
    with pytest.raises(methods.NotApplicableError, match="singular on the vertical"):
        METHODS["RK45-euler"].prepare(Top(theta0_deg=0, thetadot0=1), 1e-3)


SMALL = ["--methods", "lagtop,theta-series,DOP853-euler", "--n", 10, "--timeout", 60]


@pytest.mark.slow
def test_formats_hold_the_same(lagtop: Lagtop) -> None:
    whole = json.loads(lagtop("bench", *SMALL, "--format", "json").stdout)
    listed = lagtop("bench", *SMALL, "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(listed.stdout)))
    assert list(whole["rows"][0]) == list(rows[0])
    assert len(whole["rows"]) == len(rows) == 1 + 5 + 4
    exact = {(x["method"], value_text(x["setting"])): x["error_rad"] for x in whole["rows"]}
    assert {(x["method"], x["setting"]): float(x["error_rad"]) for x in rows} == exact
    assert set(whole["conditions"]) <= set(re.findall(r"^(\w+):", listed.stderr, re.MULTILINE))
    table = lagtop("bench", *SMALL).stdout
    assert "with 30 digits fewer it differs by" in " ".join(table.split())
    assert all(name in table for name in ("lagtop", "theta-series", "DOP853-euler"))
    for name in ("lagtop", "theta-series", "DOP853-euler"):
        errors = [x["error_rad"] for x in whole["rows"] if x["method"] == name]
        assert errors == sorted(errors)


def test_missing_packages_are_rows(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(methods, "find_spec", lambda _: None)
    names = "lagtop,scipy.special,RK45-euler,Taylor-euler"
    result = lagtop("bench", "--methods", names, "--n", 5, "--format", "json")
    assert result.exit_code == 0
    whole = json.loads(result.stdout)
    assert whole["conclusions"][0] == "lagtop was compared with nothing."
    assert whole["conclusions"][1].startswith("Not compared: RK45-euler (not applicable: needs ")
    rows = whole["rows"]
    assert len(rows) == 4  # one for a method, not one for each of its settings
    remarks = {x["method"]: x["remark"] for x in rows}
    assert remarks["lagtop"] is None
    for name, package in {"scipy.special": "scipy", "Taylor-euler": "heyoka"}.items():
        assert remarks[name] == (f"not applicable: needs {package}: pip install {package}")


BAD = {
    "--methods euler": "--methods must be among 30 names, got 'euler' (did you mean",
    "--methods ,": "--methods must be among 30 names, got '': lagtop, ",
    "--n 0": "--n must be in [1, 10000000], got 0",
    "--n 2e7": "--n must be in [1, 10000000], got 20000000",
    "--t-max 0": "--t-max must not be 0",
    "--timeout 0": "--timeout must be > 0, got 0.0",
    "--plot x.pdf": "--plot must end in .svg or .png, got 'x.pdf'",
    "--long --t-max 1": "use --long or --t-max, not both",
    "--t-max 1e30": "t must be finite and within 2^50 periods",
    "--theta0 0": "the scene must nutate, got sleeping",
    "--g 0": "the scene must nutate, got torque-free",
    "--theta0 0 --thetadot0 1": "theta0 must be off the vertical",
    "--r0 0": "r0 or psidot0 must be other than 0",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_input_is_one_line(line: str, lagtop: Lagtop) -> None:
    assert_one_line(lagtop("bench", *line.split()), 2, BAD[line])


def test_plots_without_matplotlib(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    result = lagtop("bench", "--plot", "x.svg")
    assert result.exit_code == 69
    assert result.stderr == "Error: pictures need matplotlib: pip install 'lagtop[plot]'\n"


def test_what_cannot_be_written_is_known_before_the_work(lagtop: Lagtop, tmp_path: Path) -> None:
    for option, name in (("-o", "x.csv"), ("--plot", "x.svg")):
        result = lagtop("bench", "--n", "1e7", option, tmp_path / "none" / name)
        assert result.exit_code == 74
        assert result.stderr.startswith(f"Error: cannot write {tmp_path}")


@pytest.mark.slow
def test_pictures_are_the_same_twice(lagtop: Lagtop, tmp_path: Path) -> None:
    rows = with_front([row("lagtop", 1e-15, 2.0), row("x-euler", 1e-3, 9.0), row("y", None, None)])
    found = Report({"times": "5", "scenes": "3"}, METHOD_FIELDS, rows, [])
    for is_long in (False, True):
        pair = [tmp_path / f"{is_long}{i}.svg" for i in range(2)]
        for path in pair:
            draw_methods(found, str(path), is_long=is_long)
        assert pair[0].read_bytes() == pair[1].read_bytes()
        assert pair[0].read_text().count(">x-euler<") == 1
        assert (">front" in pair[0].read_text()) == (not is_long)
    target = tmp_path / "real.png"
    assert lagtop("bench", "--methods", "lagtop", "--n", 4, "--plot", target).exit_code == 0
    assert target.read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_long_view_stops_a_method_that_has_failed(
    lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(compare_methods, "SPANS", [1.3, 2e4 + 0.3, 1e5 + 0.3])
    names = "lagtop,mean-rates,DOP853-quaternion"
    line = ["--long", "--n", 50, "--timeout", 2]
    found = json.loads(lagtop("bench", *line, "--methods", names, "--format", "json").stdout)
    by_method: dict[str, list[Any]] = {name: [] for name in names.split(",")}
    for each in found["rows"]:
        by_method[each["method"]].append(each)
    assert [round(x["periods"], 1) for x in by_method["lagtop"]] == [1.3, 20000.3, 100000.3]
    assert all(x["units_max"] < 4 for x in by_method["lagtop"])
    assert [x["remark"] for x in by_method["DOP853-quaternion"]] == [
        None,
        "failed: took more than 2 s",
        "not run: it failed over a shorter span",
    ]
    assert any(line.startswith("lagtop: error in units") for line in found["conclusions"])
    shown = lagtop("bench", *line, "--methods", "lagtop").stdout
    assert "periods" in shown
    assert "1.3" not in shown.split("method")[0]


@pytest.mark.slow
def test_samples_are_taken_in_one_thread_and_scipy_stays_out_of_solve() -> None:
    code = (
        "import os, sys\nfrom click.testing import CliRunner\n"
        "from lagrange_cli.cli.app import main\n"
        "CliRunner().invoke(main, 'bench --n 3 --methods lagtop'.split())\n"
        "print(os.environ['OMP_NUM_THREADS'], {'scipy', 'heyoka', 'matplotlib'} & set(sys.modules))"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, cwd=ROOT)
    assert shown.stdout == b"1 set()\n"


def test_a_time_out_of_reach_is_refused_by_task() -> None:
    with pytest.raises(LagtopError, match="within 2\\^50 periods"):
        task(solve(Top()), 1e40, 3)
    assert math.isfinite(np.float64(task(solve(Top()), 1e9, 2).agreement))


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["stiff-top", "slow-top", "near-separatrix", "chrapan-1952"])
def test_sample_scenes(scene: str, lagtop: Lagtop) -> None:
    path = ROOT / "sample_inputs" / f"{scene}.toml"
    result = lagtop("bench", path, "--methods", "lagtop", "--n", 20, "--format", "json")
    (found,) = json.loads(result.stdout)["rows"]
    assert found["units_max"] < 4


@pytest.mark.slow
def test_scenes_make_one_report_and_one_picture(lagtop: Lagtop, tmp_path: Path) -> None:
    """Front, sorting and verdict belong to a scene; an option changes every scene."""
    scenes, picture = ["near-separatrix", "slow-top"], tmp_path / "x.svg"
    line = ["bench", *scenes, "--methods", "theta-series,lagtop", "--n", 5, "--plot", picture]
    found = json.loads(lagtop(*line, "--m", 1000, "--format", "json").stdout)
    assert [x["scene"] for x in found["rows"]] == [scenes[0]] * 6 + [scenes[1]] * 6
    first = [x for x in found["rows"] if x["method"] == "lagtop"]
    assert [found["rows"].index(x) for x in first] == [0, 6]
    assert all(x["front"] for x in first)
    assert found["conditions"]["scene"].startswith("near-separatrix: --m 1000.0 --A 39032.0 ")
    assert "; slow-top: --m 1000.0 " in found["conditions"]["scene"]
    assert [line.partition(": ")[0] for line in found["conclusions"][::2]] == scenes
    text = picture.read_text()
    assert all(text.count(f">{word}<") == 1 for word in (*scenes, "theta-series"))
    alone = lagtop("bench", "slow-top", "--methods", "lagtop", "--n", 2)
    assert "slow-top" not in alone.stdout
