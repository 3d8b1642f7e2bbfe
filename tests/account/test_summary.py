"""The sentence before a record: what the axis does, in as many digits as that takes."""

from __future__ import annotations

import re

import pytest
from conftest import Lagtop
from lagtop import Top, solve

from lagrange_cli.account.summary import summary

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
