"""Eight threads at once: the precision of Arb is global, and every result is that of one thread."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from typing import Any

import pytest
from flint import ctx
from lagtop import Top, solve
from scenes import EVERY_KIND

from lagrange_cli.motion.over_time.tables import ProvedTable

TOPS = [(scene, digits) for scene in EVERY_KIND.values() for digits in (None, 60)]


def record(task: tuple[dict[str, Any], int | None]) -> str:
    """Return a record with radii, and a row of a table, as text."""
    scene, digits = task
    motion = solve(Top(**scene))
    row = ProvedTable(motion, ["theta", "phi", "psi"], digits).row(Fraction(7, 3))
    found = motion.record(digits=digits, radii=True)
    return json.dumps([found, [str(x.value) for x in row]], default=str)


@pytest.mark.parametrize("precision", [77])
def test_records_of_eight_threads_are_those_of_one(precision: int) -> None:
    tasks = TOPS[::3]
    before, ctx.prec = ctx.prec, precision
    try:
        serial = [record(task) for task in tasks]
        with ThreadPoolExecutor(8) as pool:
            assert list(pool.map(record, tasks)) == serial
        assert ctx.prec == precision
    finally:
        ctx.prec = before
