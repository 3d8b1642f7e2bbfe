"""The conventions of the README, each against scipy's rotations or by differences."""

from __future__ import annotations

import numpy as np
import pytest
from lagtop import LagtopError, Motion, Top, solve
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

TIMES = np.linspace(-3.0, 3.0, 25)
SPACE = np.eye(3)
STARTS = [
    {"theta0_deg": 30.0},
    {"theta0_deg": 60.0, "r0": -40.0, "thetadot0": 2.0, "psidot0": 3.0},
    {"theta0_deg": 150.0, "r0": 12.0, "thetadot0": -1.0, "psidot0": -2.0},
]


@pytest.fixture(params=STARTS, ids=str)
def motion(request: pytest.FixtureRequest) -> Motion:
    return solve(Top(**request.param))


def attitude(motion: Motion, t: NDArray[np.float64]) -> Rotation:
    """Return the rotation from body to space of the quaternion, read as the README says."""
    columns = motion.table(t, ["quaternion"])
    q = np.stack([columns[f"quaternion_{part}"] for part in "wxyz"], axis=-1)
    found = Rotation.from_quat(q, scalar_first=True)
    assert motion.rotation(t).approx_equal(found, atol=1e-14).all()
    return found


def test_the_angles_are_intrinsic_zxz(motion: Motion) -> None:
    """Worst seen: 1.3e-14, the rounding of angles of 138 rad."""
    at = motion.table(TIMES, ["theta", "phi", "psi"])
    euler = np.stack([at["psi"], at["theta"], at["phi"]], axis=-1)
    difference = attitude(motion, TIMES) * Rotation.from_euler("ZXZ", euler).inv()
    assert difference.magnitude().max() < 2e-14


def test_at_the_start_both_x_axes_are_the_line_of_nodes(motion: Motion) -> None:
    """Worst seen: 3.4e-16, by the product of scipy."""
    start = attitude(motion, np.zeros(1))[0]
    assert start.apply(SPACE[0]) == pytest.approx(SPACE[0], rel=0, abs=4e-16)
    tilt = np.radians(motion.top.inputs()["theta0_deg"])
    assert start.apply(SPACE[2]) == pytest.approx(
        [0, -np.sin(tilt), np.cos(tilt)], rel=0, abs=4e-16
    )
    at = motion.table([0.0], ["phi", "psi"])
    assert at["phi"] == at["psi"] == 0.0


def test_the_figure_axis_is_body_z_and_tilt_counts_from_space_z(motion: Motion) -> None:
    """Worst seen: 5.6e-16 and 2.2e-16."""
    at = motion.table(TIMES, ["axis", "theta"])
    axis = np.stack([at[f"axis_{part}"] for part in "xyz"], axis=-1)
    np.testing.assert_array_equal(motion.axis(TIMES.reshape(5, 5)), axis.reshape(5, 5, 3))
    assert np.abs(attitude(motion, TIMES).apply(SPACE[2]) - axis).max() < 1e-15
    assert np.abs(np.cos(at["theta"]) - axis[:, 2]).max() < 5e-16


def test_p_q_r_are_the_angular_velocity_along_body_axes(motion: Motion) -> None:
    """Central differences of the rotation: worst seen 7.1e-9 at steps of 1e-6."""
    step = 1e-6
    turn = attitude(motion, TIMES - step).inv() * attitude(motion, TIMES + step)
    at = motion.table(TIMES, ["p", "q", "r"])
    rates = np.stack([at["p"], at["q"], at["r"]], axis=-1)
    assert np.abs(turn.as_rotvec() / (2 * step) - rates).max() < 3e-8


def test_rotations_are_of_times_in_one_dimension(motion: Motion) -> None:
    assert motion.rotation(0.1).approx_equal(attitude(motion, np.array([0.1]))[0], atol=1e-14)
    with pytest.raises(LagtopError, match=r"t must be .* one dimension, got the shape \(1, 25\)"):
        motion.rotation([TIMES])


def test_the_moment_is_that_of_the_weight(motion: Motion) -> None:
    """The product s k' x (-mg k) by numpy, section 4 a: worst seen 2e-15 of mgs."""
    at = motion.table(TIMES, ["moment", "psi"])
    nodes = np.stack([np.cos(at["psi"]), np.sin(at["psi"]), np.zeros(TIMES.size)], axis=-1)
    m, s, g = (float(getattr(motion.top, name)) for name in "msg")
    arm = s * attitude(motion, TIMES).apply(SPACE[2])
    moment = np.cross(arm, -m * g * SPACE[2])
    assert np.abs(at["moment"][:, None] * nodes - moment).max() < 2e-14 * m * g * s
