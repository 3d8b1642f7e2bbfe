"""The conventions of the README, each against scipy's rotations or by differences."""

from __future__ import annotations

import numpy as np
import pytest
from lagtop import LagtopError, Motion, Top, solve
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

TIMES, STEP = np.linspace(-3.0, 3.0, 25), 1e-6
X, _, Z = np.eye(3)
STARTS = [
    {"theta0_deg": 30.0},
    {"theta0_deg": 60.0, "r0": -40.0, "thetadot0": 2.0, "psidot0": 3.0},
    {"theta0_deg": 150.0, "r0": 12.0, "thetadot0": -1.0, "psidot0": -2.0},
]


def attitude(motion: Motion, t: NDArray[np.float64]) -> Rotation:
    """Return the rotation from body to space of the quaternion, read as the README says."""
    columns = motion.table(t, ["quaternion"])
    q = np.stack([columns[f"quaternion_{part}"] for part in "wxyz"], axis=-1)
    return Rotation.from_quat(q, scalar_first=True)


@pytest.mark.parametrize("inputs", STARTS, ids=str)
def test_columns_are_those_of_the_rotation(inputs: dict[str, float]) -> None:
    """Bounds are about twice the worst errors seen."""
    top = Top(**inputs)
    motion, tilt, weight = (
        solve(top),
        np.radians(inputs["theta0_deg"]),
        float(top.m * top.g * top.s),
    )
    names = "theta phi psi axis_x axis_y axis_z p q r moment".split()
    theta, phi, psi, x, y, z, p, q, r, moment = motion.table(TIMES, names).values()
    turned, start = attitude(motion, TIMES), attitude(motion, np.zeros(1))
    axis, nodes = np.stack([x, y, z], axis=-1), np.stack([np.cos(psi), np.sin(psi), 0 * psi])
    euler = Rotation.from_euler("ZXZ", np.stack([psi, theta, phi], axis=-1))
    change = attitude(motion, TIMES - STEP).inv() * attitude(motion, TIMES + STEP)
    checks = {
        "intrinsic rotations z, x, z": ((turned * euler.inv()).magnitude(), 0, 2e-14),
        "the x axes at the start": (start.apply(X), X, 4e-16),
        "the tilt at the start": (start.apply(Z), [0, -np.sin(tilt), np.cos(tilt)], 4e-16),
        "the figure axis is z of the body": (turned.apply(Z), axis, 1e-15),
        "tilt counts from z of space": (np.cos(theta), z, 5e-16),
        "angular velocity": (change.as_rotvec() / (2 * STEP), np.stack([p, q, r]).T, 3e-8),
        "moment s k' x (-mg k), section 4 a": (
            moment / weight * nodes,
            np.cross(axis, -Z).T,
            2e-14,
        ),
        "one rotation": ((motion.rotation(TIMES) * turned.inv()).magnitude(), 0, 1e-14),
        "a rotation of one time": (motion.rotation(0.0).apply(X), X, 4e-16),
    }
    for name, (found, wanted, most) in checks.items():
        assert np.abs(found - wanted).max() < most, name
    np.testing.assert_array_equal(motion.axis(TIMES.reshape(5, 5)), axis.reshape(5, 5, 3))
    assert [float(x[0]) for x in motion.angles([0.0])[1:]] == [0, 0]


def test_rotations_are_of_times_in_one_dimension() -> None:
    with pytest.raises(LagtopError, match=r"t must be .* one dimension, got the shape \(1, 25\)"):
        solve(Top()).rotation([TIMES])
