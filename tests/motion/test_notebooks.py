"""A motion in a notebook: attitudes for SciPy, pictures, names and suggestions."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.spatial.transform import Rotation

from lagrange_cli import LagtopError, Top, compare, fit, solve

MOTION = solve(Top(theta0_deg=30, psidot0=3))
TIMES = np.array([0.0, 0.1, 1.7])


def test_rotations_are_those_of_the_angles() -> None:
    theta, phi, psi = MOTION.angles(TIMES)
    expected = Rotation.from_euler("ZXZ", np.transpose([psi, theta, phi]))
    assert (MOTION.rotation(TIMES).inv() * expected).magnitude() == pytest.approx(0, abs=1e-14)
    assert MOTION.rotation(0.1).approx_equal(expected[1], atol=1e-14)
    with pytest.raises(LagtopError, match=r"t must be .* one dimension, got the shape \(1, 3\)"):
        MOTION.rotation([TIMES])


def test_the_axis_is_the_body_axis_in_space() -> None:
    assert MOTION.axis(TIMES) == pytest.approx(MOTION.rotation(TIMES).apply([0, 0, 1]), abs=1e-14)
    assert MOTION.axis(0.1).shape == (3,)
    assert MOTION.axis([TIMES, TIMES]).shape == (2, 3, 3)


def test_a_motion_draws_on_axes() -> None:
    axes = Figure().add_subplot()
    assert MOTION.plot("cubic", ax=axes) == [axes]
    assert axes.lines
    with pytest.raises(LagtopError, match="did you mean 'sphere'"):
        MOTION.plot("spheer")


def test_a_misspelt_key_gets_a_suggestion() -> None:
    with pytest.raises(AttributeError, match="did you mean 'T_nutation'"):
        _ = MOTION.T_nutatoin


def test_names_of_a_motion_are_public_and_known() -> None:
    names = dir(MOTION)
    assert {"T_nutation", "rotation", "top", "regime", "record"} <= set(names)
    assert [name for name in names if name.startswith("_")] == []
    assert all(hasattr(MOTION, name) for name in names)


def test_a_fit_and_a_judgement_show_themselves() -> None:
    t = np.linspace(0, 1, 60)
    theta, phi, psi = MOTION.angles(t)
    noise = np.random.default_rng(1).normal(scale=1e-3, size=(3, t.size))
    outcome = fit(t, theta=theta + noise[0], phi=phi + noise[1], psi=psi + noise[2])
    judgement = compare(MOTION, t, theta=theta + 1e-6, phi=phi, psi=psi)
    for shown in (outcome, judgement):
        assert shown.to_dict() == shown.record()
        figure = shown.plot(Figure())
        assert len(figure.axes) == (6 if shown is outcome else 1)
        assert all(axes.lines for axes in figure.axes)
    assert f"<td>{judgement.rows}</td>" in judgement._repr_html_()
    assert "<caption>good</caption>" in outcome._repr_html_()
