"""Headings in ASCII and Greek, with units in every place, as each reader takes them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from conftest import Lagtop, assert_one_line

from lagrange_cli.errors import DataError
from lagrange_cli.inputs.headings import name_and_unit
from lagrange_cli.inputs.seen import Conventions, angles_in
from lagrange_cli.inputs.trajectory import TimesFile, open_trajectory


@pytest.mark.parametrize(
    ("heading", "found"),
    [
        ("t", ("t", "")),
        ("t [ms]", ("t", "ms")),
        ("t[ms]", ("t", "ms")),
        ("theta (deg)", ("theta", "deg")),
        ("ϑ (°)", ("theta", "deg")),
        ("θ in space", ("theta in space", "")),
        ("ω_x (rpm)", ("omega_x", "rpm")),
        ("r0 rpm", ("r0", "rpm")),
        ("r0 rev/min", ("r0", "rpm")),
        ("φ'0 [rad/s]", ("phidot0", "rad/s")),
        ("ψ\u0307", ("psidot", "")),
        ("ϑ₀ (degrees)", ("theta0", "deg")),
        ("A kg*m^2", ("A", "kg*m^2")),
        ("g m/s^2", ("g", "m/s^2")),
        ("omega[0]", ("omega[0]", "")),
        ("R(1, 2)", ("R(1, 2)", "")),
        ("angle of s", ("angle of", "s")),
    ],
)
def test_names_and_units(heading: str, found: tuple[str, str]) -> None:
    assert name_and_unit(heading) == found


TILTS = np.array([0.5, 1.25])
"""Tilts in radians at the times 0.25 and 0.5."""


@pytest.mark.parametrize(
    ("header", "t", "tilt"),
    [
        ("t,theta_rad", 1, 1),
        ("time [s],θ (rad)", 1, 1),
        ("t [ms],ϑ [°]", 1e3, 180 / math.pi),
        ("t ms,tilt deg", 1e3, 180 / math.pi),
        ("Time (min),Tilt (mrad)", 1 / 60, 1e3),
        ("t (us),theta [turn]", 1e6, 0.5 / math.pi),
        ("t,theta.degrees", 1, 180 / math.pi),
    ],
)
def test_units_of_a_trajectory(header: str, t: float, tilt: float, tmp_path: Path) -> None:
    path = tmp_path / "file"
    rows = zip((0.25, 0.5), TILTS.tolist(), strict=True)
    path.write_text(f"{header}\n" + "".join(f"{a * t!r},{b * tilt!r}\n" for a, b in rows))
    with open_trajectory(str(path)) as file:
        given, _ = next(file.blocks())
    assert given["t"][:, 0] == pytest.approx([0.25, 0.5], rel=1e-15)
    assert angles_in(given, Conventions(), file.quantities)["theta"] == pytest.approx(
        TILTS, rel=1e-15
    )
    assert [float(x) for x in TimesFile(str(path)).decimals()] == pytest.approx([0.25, 0.5])


def test_a_time_in_milliseconds_is_rounded_once(tmp_path: Path) -> None:
    """1.1e-3 is not 1.1 times the double 0.001."""
    path = tmp_path / "file"
    cells = [f"{i}.1" for i in range(1000)]
    path.write_text("t [ms],theta\n" + "".join(f"{x},30\n" for x in cells))
    with open_trajectory(str(path)) as file:
        found = [x for block, _ in file.blocks() for x in block["t"][:, 0].tolist()]
    assert found == [float(x) / 1000 for x in cells]


def test_rates_have_units(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("t;ω_x (rpm);ω_y (rpm);ω_z (rpm)\n0;30;-60;90\n")
    with open_trajectory(str(path)) as file:
        rates = next(file.blocks())[0]["rates"][0]
    assert rates == pytest.approx([math.pi, -2 * math.pi, 3 * math.pi], rel=1e-15)


def test_names_imply_the_frame_of_rates(lagtop: Lagtop) -> None:
    """p, q and r are about axes of the body, with any --rates-frame."""
    output = lagtop("table", "--t-max", "1", "--n", "5", "--columns", "t,quaternion,p,q,r").stdout
    assert lagtop("compare", "-", "--rates-frame", "space", input=output).exit_code == 0
    unclear = output.replace(",p,q,r", ",w_x,w_y,w_z")
    assert lagtop("compare", "-", input=unclear).exit_code == 0
    assert lagtop("compare", "-", "--rates-frame", "space", input=unclear).exit_code == 1


def test_an_elevation_is_the_rest_of_a_right_angle(tmp_path: Path, lagtop: Lagtop) -> None:
    """The tilts of both files are those of the worked example."""
    for heading, cell in (("elevation", 60.0), ("elevation [rad]", math.pi / 3)):
        path = tmp_path / "file"
        path.write_text(f"t,{heading}\n0,{cell!r}\n")
        assert lagtop("compare", path).exit_code == 0
        path.write_text(f"t,{heading}\n0,{cell + 0.1!r}\n")
        assert lagtop("compare", path).exit_code == 1


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("t [kg],theta", ": t must have a unit as in 2s, got the unit 'kg'"),
        ("t,theta [ms]", ": theta must have a unit as in 30deg or 0.5rad, got the unit 'ms'"),
        ("t,theta (furlong)", ": theta must have a unit as in 30deg or 0.5rad, got the unit"),
        ("t,x [m],y [m],z [cm]", ": the parts of position must have one unit, got 'x [m]' and"),
        ("t,x [mm],y [mm],z [mm]", ": position must have no unit, got 'mm'"),
        ("t,rotvec_x_deg,rotvec_y_deg,rotvec_z_deg", ": rotvec must have no unit, got 'deg'"),
        ("t,thta", " must have columns among the time (t, time, timestamp) and quaternion"),
    ],
)
def test_wrong_units(header: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text(f"{header}\n" + ",".join("0" * (header.count(",") + 1)) + "\n")
    with pytest.raises(DataError) as error, open_trajectory(str(path)):
        pass
    assert str(error.value).startswith(f"{path}{message}")


def test_an_unknown_heading_lists_what_was_found(lagtop: Lagtop) -> None:
    refused = lagtop("compare", "-", input="when;how far\n1;2\n")
    assert_one_line(refused, 65, "standard input must have columns among")
    assert "got 'when', 'how far': name them with --columns" in refused.stderr


def test_inputs_in_greek_and_with_units(lagtop: Lagtop) -> None:
    words = ["--m", "350g", "--A", "1e-3 kg*m^2", "--C", "4e-4 kg*m^2", "--g", "9.81 m/s^2"]
    words += ["--keys", "r0,s,theta0_deg"]
    expected = lagtop("sweep", "-", *words, input="r0 [rpm],s [cm],theta0 [deg]\n300,3,25\n")
    assert expected.stdout == "r0,s,theta0_deg,error\n31.41592653589793,0.03,25.0,\n"
    for header in ("r0 (rpm);s cm;ϑ₀ (°)", "r0 (rpm) s [cm]  θ0 [deg]"):
        cells = "300;3;25" if ";" in header else "300  3 25"
        found = lagtop("sweep", "-", *words, input=f"{header}\n{cells}\n")
        assert (found.stdout, found.stderr) == (expected.stdout, "")


OUTPUTS = {
    "table --t-max 1 --n 4 --columns t": "table --times - --columns t",
    "table --t-max 1 --n 4": "table --times - --columns t",
    "table --t-max 1 --n 4 --format json": "table --times - --columns t",
    "table --t-max 1 --n 20": "compare -",
    "table --t-max 1 --n 20 --rad": "compare -",
    "table --t-max 1 --n 20 --format table": "compare -",
    "table --t-max 1 --n 20 --columns t,theta,psidot --units si --format table": "compare -",
    "table --t-max 1 --n 20 --columns t,quaternion,p,q,r --format json": "compare -",
    "table --t-max 1 --n 20 --columns t,axis,energy,psidot": "compare -",
    "table --t-max 1 --n 20 --r0 50(1) --format csv": "compare -",
    "sweep --r0 40:60:3 --keys r0,T_nutation,path": "sweep - --keys r0,T_nutation,path",
    "sweep --r0 40:60:3 --keys r0,a --format ndjson": "sweep - --keys r0,a",
    "sweep --r0 40:60:3 --keys r0,a --format json": "sweep - --keys r0,a",
    "solve --r0 40 --format json": "sweep - --keys r0,a",
    "solve --r0 40 --format csv": "table --tops - --n 2",
    "find --r0 10:200 T_precession=2": "sweep - --keys r0,a",
}


@pytest.mark.parametrize("made", OUTPUTS)
def test_the_output_of_a_command_is_input(made: str, lagtop: Lagtop) -> None:
    output = lagtop(*made.split())
    again = lagtop(*OUTPUTS[made].split(), input=output.stdout)
    warning = "Warning: no scene and no inputs: compared with the worked example\n"
    assert (again.exit_code, again.stderr.replace(warning, "")) == (0, "")
    if "sweep --r0 40:60:3 --keys r0,T" in made:
        assert [x.removesuffix(",") for x in again.stdout.split("\n")[1:]] == (
            output.stdout.split("\n")[1:]
        )


@pytest.mark.parametrize("heading", ["ϑ", "θ", "tilt", "tilt [deg]", "elevation", "ϑ (Grad)"])
def test_a_tilt_of_trajectories_is_no_input_of_tops(lagtop: Lagtop, heading: str) -> None:
    wrong = lagtop("sweep", "-", "--keys", "theta0_deg", input=f"{heading};r0\n10;20\n")
    assert wrong.exit_code == 65
    assert wrong.stdout == ""
    assert "must be spelt theta0_deg" in wrong.stderr


@pytest.mark.parametrize("heading", ["A comment", "s note", "tilt of the table"])
def test_a_column_of_remarks_is_carried(lagtop: Lagtop, heading: str) -> None:
    carried = lagtop("sweep", "-", "--keys", "a", input=f"r0,{heading}\n50,good\n")
    assert (carried.exit_code, carried.stderr) == (0, "")
    assert carried.stdout.startswith(f"{heading},a,error\ngood,")
