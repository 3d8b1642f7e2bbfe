"""What is said of a motion: a sentence for each regime, with its numbers, and remarks."""

from __future__ import annotations

import math
import re

import mpmath
import pytest
from conftest import Lagtop
from lagtop import Top, solve
from record_reference import reference_record
from scenes import UNIT

from lagrange_cli.solver.summary import summary

SENTENCES = {
    "": "The axis nutates between 30.00 and 73.92 deg every 0.4293 time units and precesses at "
    "7.991 rad per time unit on average; its path has cusps.",
    "--rad --theta0 1": "The axis nutates between 1.000 and 1.663 rad every 0.2963 time units and "
    "precesses at 6.925 rad per time unit on average; its path has cusps.",
    "--theta0 0": "The axis stays upright, which is unstable, and the top spins at 50.00 rad per "
    "time unit.",
    "--theta0 0 --r0 80": "The axis stays upright, which is stable, and the top spins at 80.00 rad "
    "per time unit.",
    "--theta0 180 --r0 0": "The axis hangs straight down and the top does not spin.",
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
