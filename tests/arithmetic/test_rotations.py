"""Rotations as quaternions, checked by SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lagrange_cli.arithmetic import rotations


def test_rotations_are_those_of_scipy() -> None:
    rng = np.random.default_rng(2)
    theta, phi, psi = rng.uniform(0, np.pi, 9), *rng.uniform(-np.pi, np.pi, (2, 9))
    exact = Rotation.from_euler("ZXZ", np.stack([psi, theta, phi], axis=1))
    other, vectors = Rotation.random(9, rng), rng.normal(size=(9, 3))
    found, second = rotations.of_angles(theta, phi, psi), other.as_quat(scalar_first=True)
    for ours, scipys in (
        (rotations.product(found, 3 * second), exact * other),
        (rotations.of_matrix(exact.as_matrix().reshape(9, 9))[0], exact),
        (rotations.of_scipy("euler", "XYZ", exact.as_euler("XYZ")), exact),
        (rotations.of_scipy("rotvec", exact.as_rotvec()), exact),
        (rotations.about_z(psi), Rotation.from_rotvec([[0, 0, x] for x in psi])),
    ):
        assert rotations.angle_between(ours, scipys.as_quat(scalar_first=True)).max() < 1e-7
    angles = exact.inv() * other
    assert rotations.angle_between(found, second) == pytest.approx(angles.magnitude())
    axis = exact.apply([0, 0, 1])
    assert rotations.axis_of(found) == pytest.approx(axis)
    assert rotations.rotated(2 * found, vectors) == pytest.approx(exact.apply(vectors))
    between = rotations.angle_between_vectors(vectors, rotations.rotated(second, vectors))
    cosines = np.sum(vectors * other.apply(vectors), axis=1) / np.sum(vectors**2, axis=1)
    assert np.cos(between) == pytest.approx(cosines)
    for name, angle in {"theta": theta, "phi": phi, "psi": psi}.items():
        off = rotations.angles_of(found)[name] - angle
        assert rotations.within_half_turn(off) == pytest.approx(0, abs=1e-12)
        if name != "phi":
            assert rotations.angles_of_axis(axis)[name] == pytest.approx(angle)
    for word, start in {"x": [1, 0, 0], "-y": [0, -1, 0], "-z": [0, 0, -1], "z": [0, 0, 1]}.items():
        turned = rotations.rotated(rotations.to_z(word), np.array([start]))
        assert turned == pytest.approx(np.array([[0, 0, 1]]))
    ahead = rotations.of_angles(theta + 1e-7, phi + 2e-7, psi - 3e-7)
    turn = rotations.product(rotations.conjugate(found), ahead)
    rates = rotations.body_rates(theta, phi, np.full(9, 1.0), np.full(9, 2.0), np.full(9, -3.0))
    assert 2e7 * turn[:, 1:] == pytest.approx(np.stack(rates, axis=1), abs=1e-5)
