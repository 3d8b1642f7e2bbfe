"""What `solve` prints: remarks, and further keys on request.

`test_digits` checks the keys as the nearest doubles.
"""

from __future__ import annotations

import math

import mpmath
import pytest
from chrapan_top import ar
from conftest import Lagtop
from errata import FIGURES, round_alike, true_values
from lagtop import LagtopError, Top, solve
from record_reference import reference_record
from scenes import UNIT

from lagrange_cli.solver.keys import FURTHER_KEYS, derivation_keys

# Remarks


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


# Further keys: where they are accepted, and the worked example


def test_every_figure_of_section_8_is_in_the_derivation(lagtop: Lagtop) -> None:
    """To the digits printed, where the print is right; the others are the true ones."""
    header, cells = lagtop("solve", "--derivation", "--format", "csv").stdout.splitlines()
    assert header.startswith("m,A,C,s,g,r0,theta0_deg,a,")  # as section 8 begins
    assert cells.startswith("1587.0,39032.0,17458.0,4.0,981.0,50.0,30.0,319.0914")
    assert header.split(",") == [*derivation_keys()]
    steps = dict(zip(derivation_keys(), cells.split(","), strict=True))
    assert {x.key for x in FIGURES} == {*[*derivation_keys()][7:]}
    right, values = 0, true_values()
    with ar.workdps(40):
        for figure in FIGURES:
            true = round_alike(values[figure.key], figure.text)
            assert round_alike(ar.mpf(steps[figure.key]), figure.text) == true, figure.name
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
    with pytest.raises(LagtopError, match="keys must not repeat a name, got 'Lz' twice"):
        motion.record(keys=["Lz", "Lz"])
