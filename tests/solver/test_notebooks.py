"""A motion in a notebook: attitudes for SciPy, pictures, names and suggestions."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import tables_of
from lagtop import LagtopError, Top, compare, fit, solve
from matplotlib.figure import Figure
from scenes import EVERY_KIND
from scipy.spatial.transform import Rotation

from lagrange_cli.output.document import shown_text

SEPARATRIX = EVERY_KIND["separatrix in a plane"]
MOTION = solve(Top(theta0_deg=30, psidot0=3))
TIMES = np.array([0.0, 0.1, 1.7])


@pytest.mark.parametrize("fall", [Fraction(1), Fraction(-1), Fraction(4, 5), Fraction(-4, 5)])
def test_the_swing_gives_the_tilt(fall: Fraction) -> None:
    """Here a = 1, beta = b = psi0' and alpha = 1: the separatrix from 90 degrees."""
    turn = Fraction(3, 5) if abs(fall) < 1 else Fraction(0)
    motion = solve(Top(**SEPARATRIX | {"thetadot0": fall, "psidot0": turn, "r0": 2 * turn}))
    swing, b = motion.swing, float(turn)
    assert swing is not None

    t = np.linspace(0, 4, 9)
    u2 = b * b - 1  # the roots 1, 1 and u2 have the sum (alpha + b^2)/a
    u = u2 + (1 - u2) * np.tanh(swing.rate * (t - swing.lowest)) ** 2
    assert u == pytest.approx(motion.table(t, ["u"])["u"], abs=1e-14)
    assert swing.lowest * fall > 0
    assert solve(Top()).swing is None


def test_rotations_and_axes_are_those_of_the_angles() -> None:
    """They are intrinsic rotations about z, x and z by psi, theta and phi."""
    theta, phi, psi = MOTION.angles(TIMES)
    turned = Rotation.from_euler("ZXZ", np.stack([psi, theta, phi], axis=-1))
    assert (MOTION.rotation(TIMES) * turned.inv()).magnitude().max() < 1e-14
    assert MOTION.axis(TIMES[:, np.newaxis]) == pytest.approx(
        turned.apply([0, 0, 1])[:, np.newaxis], abs=1e-14
    )
    assert MOTION.rotation(0.0).apply([1, 0, 0]) == pytest.approx([1, 0, 0], abs=4e-16)
    with pytest.raises(LagtopError, match=r"t must be .* one dimension, got the shape \(1, 3\)"):
        MOTION.rotation([TIMES])


def test_a_motion_draws_on_axes() -> None:
    axes = Figure().add_subplot()
    assert MOTION.plot("cubic", ax=axes) == [axes]
    assert axes.lines
    with pytest.raises(LagtopError, match="did you mean 'sphere'"):
        MOTION.plot("spheer")


def test_names_of_a_motion_are_public_and_known() -> None:
    names = dir(MOTION)
    assert {"T_nutation", "rotation", "top", "regime", "record"} <= set(names)
    assert [name for name in names if name.startswith("_")] == []
    assert all(hasattr(MOTION, name) for name in names)


@pytest.mark.slow
def test_a_fit_and_a_judgement_show_themselves() -> None:
    t = np.linspace(0, 1, 60)
    theta, phi, psi = MOTION.angles(t)
    noise = np.random.default_rng(1).normal(scale=1e-3, size=(3, t.size))
    outcome = fit(t, theta=theta + noise[0], phi=phi + noise[1], psi=psi + noise[2])
    comparison = compare(MOTION, t, theta=theta + 1e-6, phi=phi, psi=psi)
    for shown in (outcome, comparison):
        figure = shown.plot(Figure())
        assert len(figure.axes) == (6 if shown is outcome else 1)
        assert all(axes.lines for axes in figure.axes)
        assert shown._repr_markdown_().startswith(f"Verdict: {shown.verdict}\n\n")
        ((_, *rows),) = tables_of(shown._repr_markdown_())
        assert dict(rows) == {x: shown_text(y) for x, y in shown.record().items() if y is not None}
