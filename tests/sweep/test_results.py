"""Results of sweeps in pandas, polars, xarray and notebooks, and inputs that come from there."""

from __future__ import annotations

import math
import sys
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pandas
import pint
import polars
import pytest
import xarray
from lagtop import LagtopError, Top, sensitivities, solve, sweep, sweep_angles
from uncertainties import ufloat

from lagrange_cli.errors import UnavailableError

SPINS, TILTS = [20.0, 40.0, 60.0], [0.0, 30.0]
GRID = sweep(
    r0=np.reshape(SPINS, (3, 1)), theta0_deg=np.array(TILTS), keys=["T_nutation", "regime"]
)


def period(**inputs: Any) -> float:
    """Return the period of one top, NaN if it has none."""
    return solve(Top(**inputs)).T_nutation or math.nan


def test_rows_of_a_grid_begin_with_the_inputs_that_vary() -> None:
    table = GRID.to_pandas()
    assert list(table.columns) == ["r0", "theta0_deg", "T_nutation", "regime"]
    for row in table.itertuples():
        expected = period(r0=row.r0, theta0_deg=row.theta0_deg)
        assert row.T_nutation == pytest.approx(expected, rel=1e-14, nan_ok=True)
    assert table.regime.tolist() == ["sleeping", "regular"] * 3


def test_polars_has_the_same_rows() -> None:
    table = GRID.to_polars()
    assert table.schema["regime"] == polars.String
    pandas.testing.assert_frame_equal(
        pandas.DataFrame(table.to_dict(as_series=False)), GRID.to_pandas()
    )


def test_dimensions_of_a_grid_are_its_inputs() -> None:
    found = GRID.to_xarray()
    assert found.T_nutation.dims == ("r0", "theta0_deg")
    at = found.sel(r0=60.0, theta0_deg=30.0)
    assert float(at.T_nutation) == pytest.approx(period(r0=60.0, theta0_deg=30.0), rel=1e-14)
    assert found.r0.attrs["units"] == "rad/time"
    assert found.theta0_deg.attrs["units"] == "deg"
    on_request = sweep(keys=["phi_half_rad"], radians=True).to_xarray()
    assert on_request.phi_half_rad.attrs["units"] == "rad"


def test_paired_inputs_share_a_dimension() -> None:
    found = sweep(r0=pandas.Series(SPINS[1:]), theta0_deg=pandas.Series(TILTS), keys=["regime"])
    assert found.to_xarray().regime.dims == ("top",)
    assert found.to_pandas().columns.tolist() == ["r0", "theta0_deg", "regime"]


def test_labelled_inputs_are_broadcast_by_name() -> None:
    spins = xarray.DataArray(SPINS, dims="run")
    tilts = xarray.DataArray([10.0, 20.0], dims="angle")
    found = sweep(theta0_deg=tilts, r0=spins, keys=["T_nutation"]).to_xarray()
    assert dict(found.sizes) == {"angle": 2, "run": 3}
    assert found.r0.dims == ("run",)
    assert found.theta0_deg.dims == ("angle",)
    assert float(found.T_nutation.isel(run=2, angle=1)) == pytest.approx(
        period(r0=60.0, theta0_deg=20.0), rel=1e-14
    )


def test_labels_of_inputs_become_labels_of_results() -> None:
    spins = xarray.DataArray(SPINS, {"run": ["a", "b", "c"]}, "run")
    tilts = xarray.DataArray([[10.0], [20.0]], {"angle": [1, 2]}, ("angle", "one"))
    found = sweep(r0=spins, theta0_deg=tilts, keys=["T_nutation"])
    at = found.to_xarray().sel(run="c", angle=2).T_nutation
    assert at.dims == ("one",)
    assert float(at[0]) == pytest.approx(period(r0=60.0, theta0_deg=20.0), rel=1e-14)
    assert found.to_pandas().columns.tolist() == ["run", "angle", "r0", "theta0_deg", "T_nutation"]
    assert found.to_polars()["run"].to_list() == ["a", "a", "b", "b", "c", "c"]


@pytest.mark.parametrize("labels", [["a", "b", "d"], ["a", "c", "b"], ["a", "b"]])
def test_inputs_with_different_labels_are_refused(labels: list[str]) -> None:
    spins = xarray.DataArray(SPINS, {"run": ["a", "b", "c"]}, "run")
    tilts = xarray.DataArray([10.0, 20.0, 30.0][: len(labels)], {"run": labels}, "run")
    with pytest.raises(LagtopError) as refused:
        sweep(r0=spins, g=981.0, theta0_deg=tilts)
    assert str(refused.value) == (
        "theta0_deg must have the labels of r0 along run (see xarray.align)"
    )
    assert refused.value.key == "theta0_deg"


def test_an_input_of_another_name_is_refused() -> None:
    with pytest.raises(LagtopError, match=r"got 'theta0' \(did you mean 'theta0_deg'"):
        sweep(theta0=30.0)


def test_a_tilt_keeps_its_unit_and_zeros_need_none() -> None:
    unit: Any = pint.UnitRegistry()
    tilts = unit.Quantity([0.25, 0.5], "rad")
    body = {"m": unit.Quantity(1, "kg"), "s": np.zeros(2), "theta0_deg": tilts}
    found = sweep(**body, r0=unit.Quantity(ufloat(10, 1), "1/s"), keys=["a", "r0", "theta0_deg"])
    assert found["theta0_deg"] == pytest.approx(np.degrees([0.25, 0.5]), rel=1e-15)
    assert found["a"].tolist() == [0, 0]
    assert found["r0_std"].tolist() == [1, 1]
    assert found.to_xarray().theta0_rad.attrs["units"] == "rad"
    with pytest.raises(LagtopError, match="s must have a unit"):
        sweep(**body | {"s": np.array([0.0, 1.0])})


def test_an_array_without_names_does_not_go_with_labelled_ones() -> None:
    with pytest.raises(LagtopError, match=r"r0 must be a number or have named dimensions") as found:
        sweep(theta0_deg=xarray.DataArray([10.0, 20.0], dims="angle"), r0=SPINS[1:])
    assert found.value.key == "r0"


def test_quantities_are_converted_to_si() -> None:
    unit: Any = pint.UnitRegistry()
    found = sweep(
        r0=unit.Quantity([400.0, 500.0], "rpm"),
        theta0_deg=unit.Quantity(0.5, "rad"),
        m=unit.Quantity(350, "g"),
        keys=["r0", "m", "A", "theta0_deg"],
    )
    assert found["r0"] == pytest.approx(np.array([400, 500]) * math.pi / 30, rel=1e-15)
    assert found["theta0_deg"] == pytest.approx(np.full(2, math.degrees(0.5)), rel=1e-15)
    assert found["m"].tolist() == [0.35] * 2
    assert found["A"].tolist() == [0.0039032] * 2  # 39032 g cm^2 of the worked example
    assert found.to_xarray().m.attrs["units"] == "kg"


def test_a_number_beside_quantities_needs_a_unit() -> None:
    unit: Any = pint.UnitRegistry()
    with pytest.raises(LagtopError, match="s must have a unit") as found:
        sweep(m=unit.Quantity(350, "g"), s=4.0)
    assert found.value.key == "s"


def test_an_uncertain_input_adds_uncertainties() -> None:
    found = sweep(r0=ufloat(50, 2), theta0_deg=[20.0, 30.0], keys=["T_nutation"])
    assert list(found) == ["T_nutation", "T_nutation_std"]
    slope = sensitivities(Top(theta0_deg=30.0)).derivatives["T_nutation"]["r0"]
    assert found["T_nutation_std"][1] == pytest.approx(abs(slope) * 2, rel=1e-12)
    with pytest.raises(LagtopError, match="r0 must be certain"):
        sweep_angles([0.0, 1.0], r0=ufloat(50, 2))


def test_times_are_the_last_dimension() -> None:
    found = sweep_angles([0.0, 0.5, 1.0], r0=[20.0, 30.0])
    labelled = found.to_xarray()
    assert labelled.theta.dims == ("r0", "t")
    expected = solve(Top(r0=30.0)).angles(0.5).theta
    assert float(labelled.theta.sel(r0=30.0, t=0.5)) == pytest.approx(float(expected), rel=1e-14)
    rows = found.to_pandas()
    assert rows.columns.tolist() == ["r0", "t", "theta", "phi", "psi", "error"]
    assert rows.t.tolist() == [0.0, 0.5, 1.0] * 2


def test_each_top_may_have_its_own_times() -> None:
    found = sweep_angles([[0.0, 0.5], [1.0, 2.0]], r0=[20.0, 30.0]).to_xarray()
    assert found.theta.dims == ("r0", "sample")
    assert found.t.values.tolist() == [[0.0, 0.5], [1.0, 2.0]]


def test_shapes_that_do_not_go_together_are_named() -> None:
    with pytest.raises(LagtopError, match=r"got the shapes r0 \(2,\), theta0_deg \(3,\)"):
        sweep(r0=[1.0, 2.0], theta0_deg=[1.0, 2.0, 3.0])


def test_a_notebook_shows_the_first_rows() -> None:
    found = sweep(r0=np.linspace(1, 50, 100), keys=["T_nutation", "regime"])
    table = ElementTree.fromstring(found._repr_html_())
    assert [x.text for x in table.iter("caption")] == ["20 of 100 rows"]
    head, *rows = [[x.text for x in row] for row in table.iter("tr")]
    assert head == ["r0", "T_nutation", "regime"]
    assert rows[0] == ["1.0", str(found["T_nutation"][0]), "regular"]
    assert len(rows) == 20
    assert sweep(keys=["regime"])._repr_html_().count(">regular</td>") == 1


@pytest.mark.parametrize("library", ["pandas", "polars", "xarray"])
def test_a_library_that_is_missing_is_named(library: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(UnavailableError, match=f"pip install {library}"):
        getattr(GRID, f"to_{library}")()
