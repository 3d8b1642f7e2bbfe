"""Scenes to draw, and ways to draw them, shared by the tests of the pictures."""

from __future__ import annotations

from pathlib import Path

from lagtop import Motion, Top, solve
from scenes import SAMPLES, UNIT

from lagrange_cli.inputs.given import read_scene
from lagrange_cli.plot.curves import tilt_period

REGIMES: dict[str, dict[str, float]] = {
    "sleeping": {"theta0_deg": 0},
    "hanging": {"theta0_deg": 180},
    "torque-free": {"g": 0},
    "torque-free, nodding": {"g": 0, "psidot0": 3},
    "plane pendulum": {"r0": 0},
    "spherical pendulum": {"r0": 0, "psidot0": 3},
    "over the upper pole": {"theta0_deg": 0, "thetadot0": 2, "r0": 20},
    "over the lower pole": {"theta0_deg": 180, "thetadot0": -2, "r0": 20},
    "separatrix": {**UNIT, "A": 2, "theta0_deg": 90, "thetadot0": 1, "r0": 0},
    "steady precession": {**UNIT, "theta0_deg": 90, "r0": 1, "psidot0": 1},
    "nothing but noise": {"r0": 1e9},
}
"""Inputs of one scene per way of moving."""


def sample_motion(path: Path) -> Motion:
    """Return the motion of a scene file."""
    return solve(read_scene(str(path)))


NUTATING = [path for path in SAMPLES if tilt_period(sample_motion(path))]
"""The shipped scenes whose tilt has a period."""


def regime_motion(name: str) -> Motion:
    """Return the motion of one of REGIMES."""
    return solve(Top(**REGIMES[name]))
