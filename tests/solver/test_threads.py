"""Threads of lagtop and of a host program that uses Arb do not change a number or a radius."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from typing import Any

import numpy as np
from lagtop import Top, solve
from scenes import EVERY_KIND

from lagrange_cli.elliptic.arguments import Arguments, ExactComplex
from lagrange_cli.elliptic.function_table import FunctionRequest, function_rows
from lagrange_cli.elliptic.modulus import GivenModulus
from lagrange_cli.names import ANGLES
from lagrange_cli.solver.tables import ProvedTable
from lagrange_cli.top.ranges import ListedPoints

TOPS = [*EVERY_KIND.values()][::3]
TIMES = np.linspace(-3, 40, 17_000)  # more than a block
FUNCTIONS = FunctionRequest(
    Arguments(ListedPoints([Fraction(3, 7)]), ListedPoints([Fraction(1)])),
    GivenModulus("k", ExactComplex(Fraction(4, 5), Fraction(0))),
    ("am", "theta", "omega"),
    ExactComplex(Fraction(1, 3), Fraction(0)),
)


def work(top: Top) -> list[Any]:
    """Return quaternions, numbers and radii of a record, proved rows, and elliptic functions."""
    motion = solve(top)
    found: list[Any] = [x.tolist() for x in motion.table(TIMES, ["quaternion"]).values()]
    for digits in (None, 60):
        proved = ProvedTable(motion, ANGLES, digits).row(Fraction(7, 3))
        found += [(x.value, x.radius) for x in proved]
        found.append(motion.record(digits=digits, radii=True))
        found.append([*function_rows(FUNCTIONS, digits)[1]])
    return found


def test_results_of_eight_threads_are_those_of_one() -> None:
    tops = [Top(**scene) for scene in TOPS[::2]]
    alone = [*map(work, tops)]
    with ThreadPoolExecutor(8) as pool:
        assert [*pool.map(work, tops)] == alone
