"""Tables compute only the requested columns, and blocks share their arrays without harm."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from lagtop import Motion, Top, solve
from scenes import UNIT

from lagrange_cli.arithmetic.arrays import ROWS, workspace
from lagrange_cli.motion.over_time import theta_sampler
from lagrange_cli.motion.over_time.columns import COLUMNS, SCALARS, chosen_columns
from lagrange_cli.motion.over_time.table import samples

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


@pytest.mark.slow
@pytest.mark.parametrize("start", STARTS, ids=str)
def test_a_column_is_the_same_whatever_stands_beside_it(start: str) -> None:
    motion = solve(Top(**STARTS[start]))
    together = motion.table(T, list(COLUMNS))
    for name in SCALARS:
        alone = motion.table(T, [name])[name]
        np.testing.assert_array_equal(alone, together[name])


def _forbidden(*_: Any) -> Any:
    pytest.fail("this was not asked for")


@pytest.mark.parametrize(
    ("columns", "forbidden"),
    [
        ("t r", "whole_periods _write_polynomial arguments_of moduli_of tilt_of"),
        ("u theta psidot phidot axis_z moment Lz", "arguments_of"),
        ("thetadot energy", "arguments_of tilt_of"),
        ("u psidot", "tilt_of"),
        ("phi psi dphi dpsi", "tilt_of moduli_of"),
    ],
)
@pytest.mark.parametrize("start", ["hyperbolic", "circular"])
def test_what_is_not_asked_for_is_not_computed(
    start: str, columns: str, forbidden: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = solve(Top(**STARTS[start]))
    expected = motion.table(T, list(COLUMNS))
    for name in forbidden.split():
        monkeypatch.setattr(theta_sampler, name, _forbidden)
    for name, values in motion.table(T, columns.split()).items():
        np.testing.assert_array_equal(values, expected[name])


@pytest.mark.parametrize("start", ["hyperbolic", "circular"])
def test_the_rate_is_computed_only_if_asked_for(start: str) -> None:
    motion = solve(Top(**STARTS[start]))
    expected = motion.table(T, list(COLUMNS))
    sampler = motion.sampler()
    frames = [frame._replace(rate=_Forbidden()) for frame in vars(sampler)["frames"]]
    vars(sampler)["frames"] = frames
    names = "theta phi psi dphi dpsi u phidot psidot axis_z axis_x quaternion_w moment Lz".split()
    for name, values in motion.table(T, names).items():
        np.testing.assert_array_equal(values, expected[name])
    with pytest.raises(pytest.fail.Exception):
        motion.table(T, ["thetadot"])


class _Forbidden:
    """Coefficients that must not be looked at."""

    def __getitem__(self, _: Any) -> Any:
        return _forbidden()


@pytest.mark.parametrize("name", ["arguments_of", "moduli_of", "whole_periods"])
def test_what_is_asked_for_is_computed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Else the test before would show nothing."""
    monkeypatch.setattr(theta_sampler, name, _forbidden)
    with pytest.raises(pytest.fail.Exception):
        solve(Top()).table(T, ["p"])


def test_threads_share_no_arrays() -> None:
    motions = [solve(Top(r0=r0)) for r0 in (30, 40, 50, 200)]
    alone = [np.stack(motion.angles(T)) for motion in motions]

    def again(i: int) -> bool:
        return np.array_equal(np.stack(motions[i % 4].angles(T)), alone[i % 4])

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(again, range(40)))


def test_motions_may_be_sampled_in_turns() -> None:
    def blocks(motion: Motion) -> Any:
        return samples(motion, T, chosen_columns(["phi"]), wrap=False)

    one, other = solve(Top()), solve(Top(r0=200))
    for (rows, mine), (_, theirs) in zip(blocks(one), blocks(other), strict=True):
        np.testing.assert_array_equal(mine.spin, one.angles(T).phi[rows])
        np.testing.assert_array_equal(theirs.spin, other.angles(T).phi[rows])


def test_a_workspace_is_lent_once() -> None:
    with workspace(10) as one, workspace(2, 3) as other:
        assert (one.shape, other.shape) == ((ROWS, 10), (ROWS, 2, 3))
        assert not np.shares_memory(one, other)
    with workspace(10) as again:
        assert np.shares_memory(again, one) or np.shares_memory(again, other)


@pytest.mark.parametrize("count", [0, 1, 16383, 16384, 16385, 40_000])
@pytest.mark.parametrize("start", ["hyperbolic", "circular"])
def test_blocks_fit_together(start: str, count: int) -> None:
    motion = solve(Top(**STARTS[start]))
    for whole, part in zip(motion.angles(T), motion.angles(T[:count]), strict=True):
        np.testing.assert_array_equal(whole[:count], part)


def _counts(motion: Motion) -> list[int]:
    frames = vars(motion.sampler())["frames"]
    return [len(part) for frame in frames for c in (frame.x, frame.y) for part in c[:2]]


def test_series_near_the_separatrix_are_short() -> None:
    """The nome of the complement is small there: fewer terms do, as few as for a fast top."""
    near, far = solve(Top(theta0_deg=1e-3, r0=37)), solve(Top())
    assert max(_counts(near)) == 2 < max(_counts(far)) == 4
    assert max(_counts(solve(Top(r0=2000)))) == 2


def test_times_are_left_as_they_were() -> None:
    times = T.copy()
    solve(Top()).table(times, list(COLUMNS))
    np.testing.assert_array_equal(times, T)
