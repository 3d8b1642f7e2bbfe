"""Shapes and blocks of the angles over time; columns on request.

`test_columns` compares the numbers with the reference.
"""

from __future__ import annotations

import math
import random
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np
import pytest
from lagtop import LagtopError, Top, solve
from scenes import UNIT

from lagrange_cli.arithmetic.enclosures import at_precision
from lagrange_cli.arithmetic.enclosures import exact as ball_of
from lagrange_cli.solver import sampling
from lagrange_cli.solver.columns import Columns
from lagrange_cli.solver.sampling import period_of, whole_periods

T = np.linspace(-3, 40, 40_000)
SERIES = [50, 200]
"""Spins whose series are hyperbolic and circular."""


@pytest.mark.parametrize("shape", [(), (0,), (2, 3, 4)])
def test_shapes(shape: tuple[int, ...]) -> None:
    for angle in solve(Top()).angles(np.ones(shape, int)):
        assert angle.shape == shape
        assert angle.dtype == np.float64
    columns = solve(Top()).angles(np.arange(6).reshape(2, 3).T)
    assert columns.theta.shape == (3, 2)


@pytest.mark.parametrize("t", [math.nan, math.inf, 1e15, -1e300])
def test_times_out_of_reach(t: float) -> None:
    with pytest.raises(LagtopError, match=r"t must be finite and within 2\^50 periods"):
        solve(Top()).angles([0.0, t])


def test_wrapped_angles_stay_in_their_interval() -> None:
    motion = solve(Top(**(UNIT | {"g": 0}), r0=1, theta0_deg=40))
    around = [math.nextafter(math.pi, up) for up in (0, 9)] + [math.pi, -math.pi, 3 * math.pi]
    phi = motion.angles([*around, *(-x for x in around)], wrap=True).phi
    assert ((phi > -math.pi) & (phi <= math.pi)).all()
    assert motion.angles([3.0], wrap=True).phi[0] == 3.0


@pytest.mark.parametrize(
    ("columns", "computed"),
    [
        ("t r", ""),
        ("theta", "re_X XX tilt"),
        ("u theta psidot phidot axis_z moment Lz", "re_X XX tilt"),
        ("thetadot energy", "re_X XX scaled_rate"),
        ("phi psi dphi dpsi", "re_X arg_X"),
        ("p", "re_X XX scaled_rate arg_X"),
    ],
)
@pytest.mark.parametrize("r0", SERIES)
def test_columns_that_are_not_requested_are_not_computed(
    monkeypatch: pytest.MonkeyPatch, r0: float, columns: str, computed: str
) -> None:
    made: list[Columns] = []

    def recorded(*items: Any) -> Columns:
        made.append(Columns(*items))
        return made[-1]

    monkeypatch.setattr(sampling, "Columns", recorded)
    solve(Top(r0=r0)).table(T, columns.split())
    seen = set().union(*made) & set("re_X XX tilt scaled_rate arg_X".split())
    assert seen == set(computed.split())


@pytest.mark.parametrize("count", [0, 1, 16383, 16384, 16385])
@pytest.mark.parametrize("r0", SERIES)
def test_blocks_fit_together(r0: float, count: int) -> None:
    motion, times = solve(Top(r0=r0)), T.copy()
    for whole, part in zip(motion.angles(times), motion.angles(T[:count]), strict=True):
        np.testing.assert_array_equal(whole[:count], part)
    np.testing.assert_array_equal(times, T)


def times_at(rng: random.Random, exact: Fraction, power: float) -> list[float]:
    """Return times up to 2^power periods away: any, next to whole periods and next to halves."""
    found = []
    for _ in range(20):
        n = int(2 ** rng.uniform(0, power))
        for part in (Fraction(rng.random()), Fraction(0), Fraction(1, 2)):
            t = rng.choice([-1, 1]) * float((n + part) * exact)
            found += [t, math.nextafter(t, math.inf)]
    return found


@pytest.mark.parametrize("power", [3, 20, 25.9, 40, 51, 52])
@pytest.mark.parametrize("offset", [0.0, -0.5, 0.31])
def test_whole_periods_are_taken_off_exactly(power: float, offset: float) -> None:
    """What is left has an error of 2^-100 of the time, and of 2^-52 of itself; n is the nearest."""
    rng = random.Random(f"{power} {offset}")
    for _ in range(10):
        # a length with more digits than two doubles have
        exact = Fraction(rng.getrandbits(200) + 1, 2 ** rng.randrange(100, 300))
        period = at_precision(80, partial(lambda x: period_of(ball_of(x)), exact))
        t = np.array(times_at(rng, exact, power))
        whole, rest, lost = whole_periods(t, period, float(np.abs(t).max()), offset)
        for time, n, left in zip(t.tolist(), whole.tolist(), (rest - lost).tolist(), strict=True):
            true = Fraction(time) - int(n) * exact
            assert abs(Fraction(left) - true) <= abs(true) / 2**52 + abs(Fraction(time)) / 2**100
            assert abs(true / exact + Fraction(offset)) <= Fraction(1, 2) + Fraction(1, 2**19)
