"""Further keys: where they are accepted, and the worked example.

`test_digits` checks them as the nearest doubles.
"""

from __future__ import annotations

import pytest
from chrapan_top import ar
from conftest import Lagtop, assert_one_line
from errata import FIGURES, round_alike, true_values
from lagtop import LagtopError, Top, solve

from lagrange_cli.solver.keys import FURTHER_KEYS, derivation_keys


def test_every_figure_of_section_8_is_in_the_derivation(lagtop: Lagtop) -> None:
    """To the digits printed, where the print is right; the others are the true ones."""
    header, cells = lagtop("solve", "--derivation", "--format", "csv").stdout.splitlines()
    assert header.startswith("m,A,C,s,g,r0,theta0_deg,a,")  # as section 8 begins
    assert cells.startswith("1587.0,39032.0,17458.0,4.0,981.0,50.0,30.0,319.0914")
    assert header.split(",") == derivation_keys()
    steps = dict(zip(derivation_keys(), cells.split(","), strict=True))
    assert {x.key for x in FIGURES} == set(derivation_keys()[7:])
    right, values = 0, true_values()
    with ar.workdps(40):
        for figure in FIGURES:
            true = round_alike(values[figure.key], figure.text)
            assert round_alike(ar.mpf(steps[figure.key]), figure.text) == true, figure.name
            right += true == figure.text
    assert (right, len(FIGURES)) == (16, 30)


@pytest.mark.parametrize("options", ["--g 0", "--theta0 0", "--thetadot0 1", "--psidot0 2"])
def test_what_has_no_derivation_says_so(lagtop: Lagtop, options: str) -> None:
    found = lagtop("solve", "--derivation", *options.split())
    assert_one_line(found, 1, "--derivation needs a top that nutates after")


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
