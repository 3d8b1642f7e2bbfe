"""Engines as methods of `lagtop bench`: right models, and processes that fail without harm."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Lagtop, assert_one_line
from lagtop import LagtopError, Top, compare, solve

from lagrange_cli.bench import compare_methods
from lagrange_cli.bench import engines as engines_module
from lagrange_cli.bench import method as methods
from lagrange_cli.bench.engines import IMPORTS, SCHEMES, engine_attitudes, engines, scaled_body
from lagrange_cli.bench.measure import chosen_methods, measure, task
from lagrange_cli.bench.method import FailedError, NotApplicableError
from lagrange_cli.judge.compare import convergence
from lagrange_cli.judge.judgement import Judgement

GENERAL = Top(theta0_deg=50, thetadot0=-2, psidot0=3, r0=-40)
PERIODS, GAPS = 2, 50
"""Span, and gaps between its times, 25 to a period: all steps below fit into them."""

ORDERS = {
    "mujoco-euler": (1, [800, 1600, 3200]),
    "mujoco-rk4": (4, [50, 100, 200]),
    "exudyn-rk44": (4, [50, 100, 200]),
    "exudyn-rk67": (6, [50, 75, 100]),
    "exudyn-alpha": (2, [200, 400, 800]),
    "pybullet": (1, [800, 1600, 3200]),
    "drake-discrete": (1, [800, 1600, 3200]),
}
"""Orders that the schemes with a fixed step should have, and steps that show them."""
ERRORS = {"drake-rk3": 1e-6, "drake-rk5": 1e-7}
"""Errors that the schemes with a tolerance stay below at their tightest one."""


def engine(name: str) -> tuple[str, str]:
    """Return package and scheme of a method; skip the test where the package is missing."""
    package, scheme, _ = SCHEMES[name]
    if find_spec(IMPORTS.get(package, package)) is None:
        pytest.skip(f"{package} is not installed: pip install {package}")
    return package, scheme


def judged(name: str, top: Top, setting: Any) -> Judgement:
    """Return what the judge of trajectories says of an engine."""
    package, scheme = engine(name)
    t = np.linspace(0, PERIODS * float(solve(top).T_nutation or 0), GAPS + 1)
    attitudes = engine_attitudes(package, scheme, top, setting, 60.0)(t)
    fixed = name in ORDERS
    return compare(top, t, quaternion=attitudes, step=1 / setting if fixed else None)


@pytest.mark.slow
@pytest.mark.parametrize("name", ORDERS)
@pytest.mark.parametrize("top", [Top(), GENERAL], ids=["released", "general"])
def test_order_of_convergence(name: str, top: Top) -> None:
    """A wrong model would keep its error, whatever the step; orders seen are in bench/README."""
    order, steps = ORDERS[name]
    found = convergence([judged(name, top, n) for n in steps])
    assert found is not None
    assert found.falls
    assert found.order == pytest.approx(order, abs=0.25 * order)


@pytest.mark.slow
@pytest.mark.parametrize("name", ERRORS)
@pytest.mark.parametrize("top", [Top(), GENERAL], ids=["released", "general"])
def test_error_falls_with_the_tolerance(name: str, top: Top) -> None:
    coarse, *_, fine = engines(9)[name].settings
    error = judged(name, top, fine).attitude_error_max or 0
    assert error < ERRORS[name]
    assert error < (judged(name, top, coarse).attitude_error_max or 0) / 100


def test_every_scheme_is_validated() -> None:
    assert {*ORDERS, *ERRORS} == set(engines(1))


@pytest.mark.slow
@pytest.mark.parametrize("name", [*ORDERS, *ERRORS])
def test_row_of_an_engine(name: str) -> None:
    """Rows have the version; one time does too, and a run begins at the start each time."""
    package, _ = engine(name)
    method = engines(60.0)[name]
    motion = solve(GENERAL)
    one = measure(task(motion, 0.1, 1), name, method, method.settings[-1])
    many = measure(task(motion, 0.1, 5), name, method, method.settings[-1])
    assert one.remark == many.remark == method.mark()
    assert one.remark is not None
    assert one.remark.startswith(f"{package} ")
    assert one.error_rad is not None
    assert one.error_rad < 0.02
    assert many.error_end == pytest.approx(one.error_rad, rel=0.5, abs=1e-9)
    assert many.runs is not None
    back = measure(task(motion, -0.1, 1), name, method, method.settings[0])
    assert back.remark == "not applicable: engines only run forwards"


FAKE = """
import os, sys, time
def build(body, scheme, setting):
    if scheme == "refuses":
        raise RuntimeError("no such thing\\nand more")
    print("engines are talkative", flush=True)
    def simulate(times):
        open("ENGINE_LOG.TXT", "w").write(os.getcwd())
        if scheme == "crashes":
            os.abort()
        if scheme == "hangs":
            time.sleep(60)
        return __import__("numpy").tile([1.0, 0, 0, 0], (len(times), 1))
    return simulate
"""


@pytest.fixture
def fake(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, float], Any]:
    """Return a function that makes an engine of our own which behaves badly."""
    (tmp_path / "fakes").mkdir()
    (tmp_path / "fakes" / "fake.py").write_text(FAKE)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(engines_module, "MODELS", "fakes.fake")
    return lambda scheme, limit: engine_attitudes("build", scheme, Top(), 1, limit)


@pytest.mark.slow
def test_engines_that_go_wrong(
    fake: Callable[[str, float], Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A crash harms nobody, and neither do prints and files."""
    monkeypatch.chdir(tmp_path)
    times = np.linspace(0, 1, 3)
    assert np.array(fake("talks", 20.0)(times)).tolist() == [[1.0, 0.0, 0.0, 0.0]] * 3
    with pytest.raises(FailedError, match=r"^RuntimeError: no such thing$"):
        fake("refuses", 20.0)
    crashed = fake("crashes", 20.0)
    for _ in range(2):  # asked again it says the same
        with pytest.raises(FailedError, match=r"^its process ended with exit code -6$"):
            crashed(times)
    with pytest.raises(FailedError, match=r"^took more than 0.2 s$"):
        fake("hangs", 0.2)(times)
    assert [path.name for path in tmp_path.iterdir()] == ["fakes"]


def test_bodies_that_cannot_be_built() -> None:
    for top in (Top(C=60000), Top(s=5)):
        with pytest.raises(NotApplicableError, match="refuse a body"):
            scaled_body(top, 1.0)
    body, clock = scaled_body(Top(C=2 * (39032 - 1587 * 16)), 1.0)
    assert body.C == pytest.approx(2 * body.central)
    assert body.period == clock


def test_steps_of_a_gap_that_rounding_makes_longer() -> None:
    """A gap of so many whole steps takes so many, and any more takes another one."""
    body, _ = scaled_body(Top(), 1.0)
    for count in range(1, 2000):
        exact = body.period * count / 800
        for gap in (exact, np.nextafter(exact, np.inf), exact * (1 + 1e-13)):
            assert body.steps(float(gap), 800) == count
        assert body.steps(exact * (1 + 1e-6), 800) == count + 1


def test_groups_stand_for_their_methods(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(methods, "find_spec", lambda _: True)  # as if all engines were installed
    names = list(engines(1))
    assert list(chosen_methods(["engines"], 1)) == names
    assert list(chosen_methods(["pybullet", "mujoco"], 1)) == [
        *("pybullet", "mujoco-euler", "mujoco-rk4")
    ]
    assert not set(names) & set(chosen_methods(None, 1))
    with pytest.raises(LagtopError, match=r"got 'bullet' \(did you mean 'pybullet'"):
        chosen_methods(["bullet"], 1)


def test_the_extra_installs_every_engine() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    wanted = project["optional-dependencies"]["engines"]
    assert {text.partition(">")[0] for text in wanted} == {x.package for x in SCHEMES.values()}


@pytest.mark.parametrize("is_long", [False, True])
def test_missing_engines_are_named(
    is_long: bool, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(methods, "find_spec", lambda _: None)
    monkeypatch.setattr(compare_methods, "SPANS", [1.3, 2.3])
    line = ["--methods", "lagtop,engines", "--n", 5, "--format", "json", *(["--long"] * is_long)]
    whole = json.loads(lagtop("bench", *line).stdout)
    said = whole["conclusions"]
    assert is_long or said[0] == "lagtop was compared with nothing."
    assert "drake-rk3 (not applicable: needs drake: pip install drake)" in said[1]
    needs = "not applicable: needs pybullet: pip install pybullet"
    assert said[1].endswith(f", pybullet ({needs}).")
    assert len(whole["rows"]) == 1 + is_long + len(engines(1))


def test_only_missing_engines_are_an_error(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(methods, "find_spec", lambda _: None)
    result = lagtop("bench", "--methods", "drake,pybullet")
    assert_one_line(result, 69, "none of these methods is installed: pip install drake pybullet\n")
