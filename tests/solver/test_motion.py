"""A motion as an object: remarks, keys on request, attitudes for SciPy, pictures and names."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from conftest import Lagtop
from errata import FIGURES, round_alike, true_values
from lagtop import LagtopError, Top, solve
from matplotlib.figure import Figure
from record_reference import reference_record
from scenes import EVERY_KIND, UNIT
from scipy.spatial.transform import Rotation

from lagrange_cli.solver.keys import FURTHER_KEYS, derivation_keys

SEPARATRIX = EVERY_KIND["separatrix in a plane"]
MOTION = solve(Top(theta0_deg=30, psidot0=3))
TIMES = np.array([0.0, 0.1, 1.7])


@pytest.mark.parametrize("fall", [Fraction(1), Fraction(-1), Fraction(4, 5), Fraction(-4, 5)])
def test_the_swing_gives_the_tilt(fall: Fraction) -> None:
    """Here a = 1, beta = b = psi0' and alpha = 1: the separatrix from 90 degrees."""
    turn = Fraction(3, 5) if abs(fall) < 1 else Fraction(0)
    motion = solve(Top(**SEPARATRIX | {"thetadot0": fall, "psidot0": turn, "r0": 2 * turn}))
    swing, b = motion.swing, float(turn)
    assert swing is not None

    t = np.linspace(0, 4, 9)
    u2 = b * b - 1  # the roots 1, 1 and u2 have the sum (alpha + b^2)/a
    u = u2 + (1 - u2) * np.tanh(swing.rate * (t - swing.lowest)) ** 2
    assert u == pytest.approx(motion.table(t, ["u"])["u"], abs=1e-14)
    assert swing.lowest * fall > 0
    assert solve(Top()).swing is None


def test_rotations_and_axes_are_those_of_the_angles() -> None:
    """They are intrinsic rotations about z, x and z by psi, theta and phi."""
    theta, phi, psi = MOTION.angles(TIMES)
    turned = Rotation.from_euler("ZXZ", np.stack([psi, theta, phi], axis=-1))
    assert (MOTION.rotation(TIMES) * turned.inv()).magnitude().max() < 1e-14
    assert MOTION.axis(TIMES[:, np.newaxis]) == pytest.approx(
        turned.apply([0, 0, 1])[:, np.newaxis], abs=1e-14
    )
    assert MOTION.rotation(0.0).apply([1, 0, 0]) == pytest.approx([1, 0, 0], abs=4e-16)
    with pytest.raises(LagtopError, match=r"t must be .* one dimension, got the shape \(1, 3\)"):
        MOTION.rotation([TIMES])


def test_a_motion_draws_on_axes() -> None:
    axes = Figure().add_subplot()
    assert MOTION.plot("cubic", ax=axes) == [axes]
    assert axes.lines


def test_names_of_a_motion_are_public_and_known() -> None:
    names = dir(MOTION)
    assert {"T_nutation", "rotation", "top", "regime", "record"} <= set(names)
    assert [name for name in names if name.startswith("_")] == []
    assert all(hasattr(MOTION, name) for name in names)


@pytest.mark.parametrize(("sign", "tilt"), [(1, 1.0), (-1, 30.0), (1, 179.0)])
def test_pseudo_regular_precession_in_numbers(sign: int, tilt: float) -> None:
    """The threshold is (C r0)^2 = 100 A m g s, to the last bit; the numbers are the reference's."""
    unit = UNIT | {"theta0_deg": tilt}
    assert solve(Top(**unit, r0=sign * math.nextafter(10.0, 0.0))).remark is None
    for r0 in (10.0, 400.0):
        numbers = reference_record(Top(**unit, r0=sign * r0).as_dict())
        u2, mean, period = (numbers[key] for key in ("u2", "mean_precession_rate", "T_nutation"))
        with mpmath.workdps(40):
            nods = mpmath.degrees(mpmath.acos(u2)) - tilt
            rate = mpmath.mpf(sign) / mpmath.mpf(r0)
            parts = int(mpmath.nint((mean / rate - 1) * 10**6))
        where = "within 1 ppm of"
        if parts:
            where = f"{abs(parts)} ppm {'below' if parts < 0 else 'above'}"
        assert abs(parts) < 10_300
        assert 0 < nods < 1.15
        assert solve(Top(**unit, r0=sign * r0)).remark == (
            f"pseudo-regular precession: nutates by {float(nods):.3g} deg in {float(period):.3g} "
            f"time; the mean rate is {where} mgs/(C r0) = {float(rate):.3g} rad/time"
        )


def test_every_figure_of_section_8_is_in_the_derivation(lagtop: Lagtop) -> None:
    """To the digits printed, where the print is right; the others are the true ones."""
    header, cells = lagtop("solve", "--derivation", "--format", "csv").stdout.splitlines()
    assert header.startswith("m,A,C,s,g,r0,theta0_deg,a,")  # as section 8 begins
    assert cells.startswith("1587.0,39032.0,17458.0,4.0,981.0,50.0,30.0,319.0914")
    assert header.split(",") == [*derivation_keys()]
    steps = dict(zip(derivation_keys(), cells.split(","), strict=True))
    assert {x.key for x in FIGURES} == {*[*derivation_keys()][7:]}
    right, values = 0, true_values()
    with mpmath.workdps(40):
        for figure in FIGURES:
            true = round_alike(values[figure.key], figure.text)
            assert round_alike(mpmath.mpf(steps[figure.key]), figure.text) == true, figure.name
            right += true == figure.text
    assert (right, len(FIGURES)) == (16, 30)


def test_a_record_has_them_only_when_they_are_asked_for(lagtop: Lagtop) -> None:
    motion = solve(Top())
    assert not set(motion.record()) & set(FURTHER_KEYS)
    assert motion.record(keys=["Lz", "a"]) == {"a": motion.a, "Lz": motion.Lz}
    assert motion.record(keys=["psi_half_rad"], radians=True) == {
        "psi_half_rad": pytest.approx(1.715080720900244, rel=1e-15)
    }
    assert lagtop("solve", "--get", "Lz").stdout == f"{motion.Lz}\n"
    digits = lagtop("solve", "--get", "phi_half_rad", "--rad", "--digits", "25")
    assert digits.exit_code == 0
    assert set(FURTHER_KEYS) <= set(dir(motion))
