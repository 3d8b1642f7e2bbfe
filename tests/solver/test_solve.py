"""What `solve` prints: a sentence for each regime, remarks, and further keys on request.

`test_digits` checks the keys as the nearest doubles.
"""

from __future__ import annotations

import math
import re

import mpmath
import pytest
from chrapan_top import ar
from conftest import Lagtop, assert_one_line
from errata import FIGURES, round_alike, true_values
from lagtop import LagtopError, Top, solve
from record_reference import reference_record
from scenes import UNIT

from lagrange_cli.account.summary import summary
from lagrange_cli.solver.keys import FURTHER_KEYS, derivation_keys

SENTENCES = {
    "": "The axis nutates between 30.00 and 73.92 deg every 0.4293 time units and precesses at "
    "7.991 rad per time unit on average; its path has cusps.",
    "--rad --theta0 1": "The axis nutates between 1.000 and 1.663 rad every 0.2963 time units and "
    "precesses at 6.925 rad per time unit on average; its path has cusps.",
    "--theta0 0": "The axis stays upright, and this is unstable. The top spins at 50.00 rad per "
    "time unit.",
    "--theta0 0 --r0 80": "The axis stays upright, and this is stable. The top spins at 80.00 rad "
    "per time unit.",
    "--theta0 180 --r0 0": "The axis hangs straight down. The top does not spin.",
    "--r0 0": "The axis swings between 30.00 and 180.0 deg in a vertical plane every 0.4383 time "
    "units.",
    "--r0 0 --thetadot0 50": "The axis turns over in a vertical plane every 0.1195 time units.",
    "--r0 0 --g 0 --thetadot0 5": "The axis turns over in a vertical plane every 1.257 time units.",
    "--r0 1e12": "The axis keeps a tilt of 30.00 deg and precesses at 3.567e-10 rad per time unit.",
    "--g 0": "The axis keeps a tilt of 30.00 deg and does not precess.",
    "--g 0 --digits 20": "The axis keeps a tilt of 30.00 deg and does not precess.",
    "kinon-betsch-cone": "The axis keeps a tilt of 60.00 deg and precesses at 10.00 rad per time "
    "unit.",
    "stiff-top": "The axis nutates between 30.00 and 30.01 deg every 0.004975 time units and "
    "precesses at 0.1263 rad per time unit on average; its path has cusps.",
    "--m 1 --A 2 --C 1 --s 1 --g 1 --r0 0 --theta0 90 --thetadot0 1": "The axis rises to the "
    "vertical in infinite time; its tilt is at most 180.0 deg.",
}


@pytest.mark.parametrize("line", SENTENCES)
def test_a_record_begins_with_a_sentence(line: str, lagtop: Lagtop) -> None:
    shown = lagtop("solve", *line.split()).stdout.partition("\n\n")[0]
    assert " ".join(shown.split()) == SENTENCES[line]
    assert max(map(len, shown.splitlines())) <= 80


def test_numbers_differ_in_as_many_digits_as_that_takes() -> None:
    for r0 in (1e3, 1e5, 1e7):
        motion = solve(Top(r0=r0))
        record = motion.record()
        low, high = re.findall(r"[\d.]+(?= and| deg)", summary(record, motion.facts))[:2]
        assert float(low) == 30.0 < float(high)
        assert float(high) == pytest.approx(record["theta_max_deg"], rel=1e-3)


def test_units_are_named(lagtop: Lagtop) -> None:
    shown = " ".join(lagtop("solve", "--r0", "477 rpm").stdout.partition("\n\n")[0].split())
    assert shown.endswith(
        "every 0.4295 s and precesses at 7.994 rad/s on average; its path has cusps."
    )


# Remarks


def test_sleeping_says_whether_it_is_stable() -> None:
    """lambda = r0^2/4 here."""
    below = solve(Top(**UNIT, r0=math.nextafter(2, 0), theta0_deg=0))
    above = solve(Top(**UNIT, r0=2, theta0_deg=0))
    assert below.remark == "only phi + psi is defined; unstable (lambda = b^2/2a < 1)"
    assert above.remark == "only phi + psi is defined; stable (lambda = b^2/2a >= 1)"
    hanging = solve(Top(**UNIT, r0=2, theta0_deg=180))
    assert hanging.remark == "only phi - psi is defined; stable"


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
