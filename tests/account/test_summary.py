"""The sentence before a record: what the axis does, in as many digits as that takes."""

from __future__ import annotations

import re

import pytest
from lagtop import Top, solve

from lagrange_cli.account.summary import summary


def test_numbers_differ_in_as_many_digits_as_that_takes() -> None:
    for r0 in (1e3, 1e5, 1e7):
        motion = solve(Top(r0=r0))
        record = motion.record()
        low, high = re.findall(r"[\d.]+(?= and| deg)", summary(record, motion.facts))[:2]
        assert float(low) == 30.0 < float(high)
        assert float(high) == pytest.approx(record["theta_max_deg"], rel=1e-3)
