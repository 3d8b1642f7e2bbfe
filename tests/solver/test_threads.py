"""Threads of lagtop and of a host program that uses Arb do not change a number or a radius."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import flint
import pytest
from flint import arb
from lagtop import Top, solve
from scenes import UNIT

NEAR_SEPARATRIX: dict[str, Any] = UNIT | {"r0": 1.5, "psidot0": 1, "theta0_deg": 60}
TOPS = [
    Top(),
    Top(**NEAR_SEPARATRIX, thetadot0=0.5 + 1e-13),
    Top(**NEAR_SEPARATRIX, thetadot0=0.5),
    Top(r0=60, psidot0="steady"),
    Top(phidot0=1, psidot0=1, theta0_deg=45),
]
TIMES = [0.0, 0.3, 1e13]


def work(top: Top) -> list[Any]:
    """Return numbers and radii of a record, a table, proved rows, and functions."""
    motion = solve(top)
    record = motion.record(radii=True)
    return [record]


@contextmanager
def disturbed() -> Iterator[None]:
    """Switch threads as often as possible, and change the precision of Arb all the time."""
    stop, interval, precision = threading.Event(), sys.getswitchinterval(), flint.ctx.prec

    def disturb() -> None:
        while not stop.is_set():
            with flint.ctx.workprec(60):
                arb(3).sqrt()
            flint.ctx.prec = 53

    sys.setswitchinterval(1e-6)
    host = threading.Thread(target=disturb)
    host.start()
    try:
        yield
    finally:
        stop.set()
        host.join()
        sys.setswitchinterval(interval)
        flint.ctx.prec = precision


@pytest.mark.slow
@pytest.mark.parametrize("top", TOPS, ids=range(len(TOPS)))
def test_numbers_and_radii_are_those_of_one_thread(top: Top) -> None:
    alone = work(top)
    with disturbed(), ThreadPoolExecutor(8) as pool:
        for together in pool.map(work, [top] * 40):
            assert together == alone
