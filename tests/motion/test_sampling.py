"""Tables compute only the requested columns, and blocks share their arrays without harm."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from lagtop import Top, solve
from scenes import UNIT

from lagrange_cli.motion.over_time.columns import (
    ColumnConstants,
    chosen_columns,
)
from lagrange_cli.motion.over_time.tables import Sample, columns_at

STARTS: dict[str, dict[str, float]] = {
    "hyperbolic": {},
    "circular": {"r0": 200},
    "general": {"psidot0": 3, "thetadot0": 2},
    "pendulum": {"r0": 0},
    "over a pole": {"theta0_deg": 0, "thetadot0": 3},
    "sleeping": {"theta0_deg": 0},
    "steady": UNIT | {"r0": 1.5, "theta0_deg": 60, "psidot0": 1},
    "separatrix": UNIT | {"r0": 1, "theta0_deg": 90, "psidot0": 1, "thetadot0": 1},
}
T = np.linspace(-3, 40, 40_000)
CONSTANTS: Any = ColumnConstants(*np.ones(9))


@pytest.mark.parametrize(
    ("columns", "computed"),
    [
        ("t r", ""),
        ("theta", "functions parts squares tilt"),
        ("u theta psidot phidot axis_z moment Lz", "functions parts squares tilt moduli"),
        ("thetadot energy", "functions parts squares moduli rate"),
        ("phi psi dphi dpsi", "functions parts args"),
        ("p", "functions parts args squares moduli rate"),
    ],
)
@pytest.mark.parametrize("start", ["hyperbolic", "circular"])
def test_what_is_not_asked_for_is_not_computed(start: str, columns: str, computed: str) -> None:
    seen: set[str] = set()
    for _, attitude in solve(Top(**STARTS[start])).sampler().attitudes(T):
        sample = Sample(attitude, CONSTANTS, False)
        for column in chosen_columns(columns.split()):
            getattr(sample, column)
        seen |= vars(attitude).keys() & set("functions parts squares tilt moduli args rate".split())
    assert seen == set(computed.split())


def test_threads_share_no_arrays() -> None:
    motions = [solve(Top(r0=r0)) for r0 in (30, 40, 50, 200)]
    alone = [np.stack(motion.angles(T)) for motion in motions]

    def again(i: int) -> bool:
        return np.array_equal(np.stack(motions[i % 4].angles(T)), alone[i % 4])

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(again, range(40)))


def test_motions_may_be_sampled_in_turns() -> None:
    """Blocks of several motions do not share arrays, nor leave NumPy's settings changed."""
    one, other, before = solve(Top()), solve(Top(r0=200)), np.geterr()
    both = (columns_at(x, ["phi"], radians=True, wrap=False)(T) for x in (one, other))
    for (rows, mine), (_, theirs) in zip(*both, strict=True):
        np.testing.assert_array_equal(mine[0], one.angles(T).phi[rows])
        np.testing.assert_array_equal(theirs[0], other.angles(T).phi[rows])
    assert np.geterr() == before


@pytest.mark.parametrize("count", [0, 1, 16383, 16384, 16385, 40_000])
@pytest.mark.parametrize("start", ["hyperbolic", "circular"])
def test_blocks_fit_together(start: str, count: int) -> None:
    motion = solve(Top(**STARTS[start]))
    for whole, part in zip(motion.angles(T), motion.angles(T[:count]), strict=True):
        np.testing.assert_array_equal(whole[:count], part)
