"""Results of sweeps in pandas and xarray, and inputs that come from there."""

from __future__ import annotations

import math
import sys

import numpy as np
import pandas
import pytest
from lagtop import LagtopError, Top, solve, sweep

from lagrange_cli.errors import UnavailableError

SPINS, TILTS = [20.0, 40.0, 60.0], [0.0, 30.0]
GRID = sweep(
    r0=np.reshape(SPINS, (3, 1)), theta0_deg=np.array(TILTS), keys=["T_nutation", "regime"]
)


def test_dimensions_of_a_grid_are_its_inputs() -> None:
    table, cube = GRID.to_pandas(), GRID.to_xarray()
    assert list(table.columns) == ["r0", "theta0_deg", "T_nutation", "regime"]
    assert cube.T_nutation.dims == ("r0", "theta0_deg")
    for row in table.itertuples():
        exact = solve(Top(r0=row.r0, theta0_deg=row.theta0_deg)).T_nutation or math.nan
        at = cube.sel(r0=row.r0, theta0_deg=row.theta0_deg)
        for found in (row.T_nutation, float(at.T_nutation)):
            assert found == pytest.approx(exact, rel=1e-14, nan_ok=True)
    assert table.regime.tolist() == ["sleeping", "regular"] * 3
    assert sweep(keys=["a"]).to_xarray().a.dims == ()


def test_paired_inputs_share_a_dimension() -> None:
    columns = pandas.DataFrame({"r0": SPINS[1:], "theta0_deg": TILTS})
    found = sweep(**columns, keys=["regime"])
    assert found.to_xarray().regime.dims == ("top",)
    assert found.to_pandas().columns.tolist() == ["r0", "theta0_deg", "regime"]
    with pytest.raises(LagtopError, match=r"pass columns by name: sweep\(\*\*df\)"):
        sweep(columns)


def test_the_index_of_a_frame_is_kept() -> None:
    frame = pandas.DataFrame({"r0": SPINS, "theta0_deg": 30.0}, index=["slow", "mid", "fast"])
    assert sweep(**frame, keys=["K"]).to_pandas().index.tolist() == ["slow", "mid", "fast"]
    assert sweep(r0=frame.r0, theta0_deg=[[30], [60]], keys=["K"]).to_pandas().index[-1] == 5
    with pytest.raises(LagtopError, match="r0 and theta0_deg are Series with different indices"):
        sweep(r0=frame.r0, theta0_deg=frame.theta0_deg[::-1])


@pytest.mark.parametrize("library", ["pandas", "xarray"])
def test_a_library_that_is_missing_is_named(library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(UnavailableError, match=f"pip install {library}"):
        getattr(GRID, f"to_{library}")()
