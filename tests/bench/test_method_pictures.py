"""The pictures of the reports, and the hues and marks of methods in them."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from colour_vision import VISIONS, seen

from lagrange_cli.bench.compare_methods import METHOD_FIELDS, with_front
from lagrange_cli.bench.measure import all_methods
from lagrange_cli.bench.method import MethodRow
from lagrange_cli.bench.peers import PeerRun
from lagrange_cli.bench.pictures import HUES, draw_methods, draw_stability, method_looks
from lagrange_cli.output.report import Report
from lagrange_cli.plot.style import LIGHT


@pytest.mark.slow
def test_points_beyond_the_edge_have_their_errors_beside_it(tmp_path: Path) -> None:
    errors = {"lagtop-digits": [5e-48, 5e-18], "lagtop": [5e-14], "DOP853-euler": [1e-10]}
    rows = [
        MethodRow(None, name, i, 20.3, error_rad=error, ns_min=10.0 * (i + 1))
        for name, found in errors.items()
        for i, error in enumerate(found)
    ]
    path = tmp_path / "x.svg"
    draw_methods(Report({"times": "9"}, METHOD_FIELDS, with_front(rows), []), str(path))
    text = path.read_text()
    assert text.count("beyond this edge") == 1
    assert ">← 5e-48, 5e-18: beyond this edge<" in text
    assert ">times: 9<" in text
    assert "<title>lagtop: Error against run time</title>" in text


@pytest.mark.slow
def test_a_stratum_is_a_panel_with_its_condition(tmp_path: Path) -> None:
    rows = []
    for name in ("generic", "slow"):
        bounds = [(1.0, 1e-15), (10.0, 1e-14)]
        run = PeerRun("lagtop", [(1.0, 1e-16), (10.0, 0.0)], bounds)
        gone = PeerRun("RK4-quaternion", [], bounds, remark="failed: slow")
        rows += [SimpleNamespace(stratum=name, method=run.method, run=run) for run in (run, gone)]
    path = tmp_path / "x.svg"
    draw_stability(Report({"scenes": "4 per stratum; odd"}, [], rows, []), str(path))
    text = path.read_text()
    for word in ("generic", "slow", "RK4-quaternion", "condition"):
        assert text.count(f">{word}<") == 1


@pytest.mark.parametrize("vision", VISIONS)
def test_the_hues_of_the_families_differ_for_everybody(vision: str) -> None:
    """Least distance seen: 27 (the ink and the darkest green, protan)."""
    colours = [seen(colour, VISIONS[vision]) for colour in (*HUES.values(), LIGHT.paper)]
    assert min(np.linalg.norm(p - q) for p, q in combinations(colours, 2)) > 20


def test_no_two_methods_look_alike() -> None:
    found = method_looks(all_methods(1))
    assert len({x[1:] for x in found.values()}) == len(found)  # without any colour
    assert {x.family for x in found.values()} == set(HUES)


def test_forms_of_an_integrator_share_a_mark_and_schemes_of_an_engine_do_not() -> None:
    found = method_looks(
        ["mujoco-euler", "mujoco-rk4", "RK45-euler", "RK45-quaternion", "lagtop", "x"]
    )
    assert next(iter(found)) == "lagtop"
    assert found["RK45-euler"].mark == found["RK45-quaternion"].mark
    assert [name for name, x in found.items() if x.is_dashed] == ["RK45-euler"]
    assert found["mujoco-euler"].mark != found["mujoco-rk4"].mark
    assert found["x"].look()["color"] == LIGHT.quiet
