"""The equation of the axis: a, b and up in any frame, with noise and decay."""

from __future__ import annotations

import numpy as np
import pytest
from engines import Array, Body, dop853
from lagtop import Top
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from lagrange_cli.recordings.axis_equation import from_spline

T = np.linspace(0, 2, 400)
TOP = Top(m=1, A=0.02, C=0.006, s=0.08, g=9.81, r0=40, theta0_deg=55, thetadot0=0.7)
A_B = 2 * 0.08 * 9.81 / 0.02, 12.0


def axis_of(top: Top) -> Array:
    _, states = dop853(Body.of(top), T)
    turns = Rotation.from_quat(states[:, :4], scalar_first=True)
    return np.asarray(turns.apply([0.0, 0.0, 1.0]))


def test_a_b_and_up_in_any_frame() -> None:
    space = Rotation.from_rotvec([0.3, -1.2, 0.4])
    axis, t = space.apply(axis_of(TOP)), T.copy()
    axis[7], axis[9], t[9] = np.nan, axis[8], t[8]
    for rows in (slice(None), slice(None, None, -1)):
        found = from_spline(t[rows], axis[rows])
        assert found
        assert (found.a, found.b) == pytest.approx(A_B, rel=1e-4)
        assert found.up == pytest.approx(space.apply([0, 0, 1]), abs=1e-4)
    assert from_spline(T[:31], axis[:31]) is None


def test_decay() -> None:
    """The spin decays by 5 % per unit of time, and the rates across the axis by 3 %."""

    def slope(t: float, y: Array) -> Array:
        n, v = y[:3], y[3:]  # n' = v; n x v' = -b v - n x G - d n x v
        turn = (
            -A_B[1] * (1 - 0.05 * t) * v - np.cross(n, [0, 0, A_B[0] / 2]) - 0.03 * np.cross(n, v)
        )
        return np.concatenate([v, np.cross(turn, n) - (v @ v) * n])

    start = [np.sin(1.0), 0.0, np.cos(1.0), 0.0, 1.3, 0.0]
    axis = solve_ivp(slope, (0, 2), start, "DOP853", T, rtol=1e-11, atol=1e-12).y[:3].T
    found = from_spline(T, axis)
    assert found
    assert (found.a, found.b) == pytest.approx((A_B[0], 0.95 * A_B[1]), rel=1e-5)
    assert (found.b_slope, found.damping) == pytest.approx((-0.05 * A_B[1], 0.03), rel=1e-4)
