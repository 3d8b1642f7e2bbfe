"""Pictures of the reports mark what they cannot show: points beyond the edge, and failures."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from lagrange_cli.bench.compare_methods import METHOD_FIELDS, with_front
from lagrange_cli.bench.method import MethodRow
from lagrange_cli.bench.pictures import draw_stability, draw_work_precision
from lagrange_cli.output.findings import Findings


@pytest.mark.slow
def test_points_beyond_the_edge_have_their_errors_beside_it(tmp_path: Path) -> None:
    errors = {"lagtop-digits": [5e-48, 5e-18], "lagtop": [5e-14], "DOP853-euler": [1e-10]}
    rows = [
        MethodRow(name, i, 20.3, error_max=error, ns_min=10.0 * (i + 1))
        for name, found in errors.items()
        for i, error in enumerate(found)
    ]
    path = tmp_path / "x.svg"
    draw_work_precision(Findings({"times": "9"}, METHOD_FIELDS, with_front(rows), []), str(path))
    text = path.read_text()
    assert text.count("beyond this edge") == 1
    assert ">← 5e-48, 5e-18: beyond this edge<" in text
    assert ">times: 9<" in text
    assert "<title>lagtop: Error against run time</title>" in text


@pytest.mark.slow
def test_failures_are_written_beside_their_stratum(tmp_path: Path) -> None:
    rows = [
        SimpleNamespace(
            stratum=name,
            scenes=4,
            angle_units=0.5,
            scipy_units=scipy,
            scipy_failed=failed,
            dop853_units=1e3,
            dop853_failed=0,
        )
        for name, scipy, failed in (("generic", 1e9, 0), ("top pass", None, 3))
    ]
    path = tmp_path / "x.svg"
    draw_stability(Findings({"scenes": "4 per stratum; odd"}, [], rows, []), str(path))
    text = path.read_text()
    assert text.count("× 3/4") == 1
    assert "× 0/4" not in text
    assert "promised: 4" in text
    assert "rounding errors, eps" in text
