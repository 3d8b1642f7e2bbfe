"""The files in sample_inputs/files, as other programs write them, read by compare and sweep.

Each shows the worked example at 26 times, rounded as its program rounds, or has tops.
"""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from conftest import ROOT, Lagtop

FILES = ROOT / "sample_inputs" / "files"
TOPS = {
    "tops-excel-german.csv": [(477.5, 30.0), (954.9, 30.0), (477.5, 12.5)],
    "tops-pandas.csv": [
        (r0 * 30 / math.pi, tilt) for r0, tilt in ((50, 30), (100, 30), (50, 12.5))
    ],
}
"""Files of tops, with the spin in turns a minute and the tilt of each."""
COLUMNS = {"matlab.txt": "t,theta,psi,phi"}
"""The columns of files without headings."""
RUNS = sorted({x.name for x in FILES.iterdir()} - TOPS.keys())
ROUNDED = 2e-4
"""Radians that two decimals of degrees in three angles may be off."""


def words(path: Path) -> list[str]:
    """Return a file as an argument, with the names of its columns if it has no headings."""
    return [str(path), *(["--columns", COLUMNS[path.name]] if path.name in COLUMNS else [])]


@pytest.mark.parametrize("name", RUNS)
def test_compare_reads_it(name: str, lagtop: Lagtop) -> None:
    result = lagtop("compare", *words(FILES / name), "--format", "json")
    assert result.exit_code == 0, result.stderr
    row = json.loads(result.stdout)["rows"][0]
    assert (row["verdict"], row["rows"]) == ("fine", 26)
    assert row["error_max"] < ROUNDED


@pytest.mark.parametrize("name", TOPS)
def test_its_tops_are_read(name: str, lagtop: Lagtop) -> None:
    wanted = [(rpm * math.pi / 30, tilt) for rpm, tilt in TOPS[name]]
    swept = lagtop("sweep", FILES / name, "--keys", "r0,theta0_deg", "--format", "json")
    assert swept.exit_code == 0, swept.stderr
    found = [(row["r0"], row["theta0_deg"]) for row in json.loads(swept.stdout)]
    assert found == [pytest.approx(x, rel=1e-15) for x in wanted]
