"""A scene of every kind of motion; `lagrange_cli/bench/hard_scenes.py` has random ones."""

from __future__ import annotations

from typing import Any

EPS = 2.0**-52
"""Distance from 1 to the next double."""

UNIT: dict[str, float] = {"m": 1, "A": 1, "C": 1, "s": 1, "g": 1}
"""A spherical top with a = 2, b = r0 and lambda = r0^2/4."""

EVERY_KIND: dict[str, dict[str, Any]] = {
    "worked example": {},
    "fast": {"r0": 2000.0},
    "slow": UNIT | {"r0": 0.5, "theta0_deg": 130},
    "any start": UNIT | {"r0": 2, "theta0_deg": 70, "thetadot0": 0.75, "psidot0": 0.5},
    "looping": UNIT | {"r0": -3, "theta0_deg": 110, "thetadot0": 1.5, "psidot0": 1},
    "starts lowest": UNIT | {"r0": 3, "theta0_deg": 40, "psidot0": 2},
    "radians": UNIT | {"r0": 3, "theta0_rad": 0.7, "psidot0": 2},
    **{
        f"over the top{more}": UNIT | {"theta0_deg": 120, "psidot0": 1, "r0": 0.5, "thetadot0": x}
        for more, x in {"": 2.5, ", level start": 0, ", back": -1.7, ", slow": 0.5}.items()
    },
    "over the bottom": UNIT | {"theta0_deg": 60, "psidot0": -2, "r0": 1, "thetadot0": 0.7},
    "pendulum": UNIT | {"theta0_deg": 60, "r0": 0},
    "pendulum from above": UNIT | {"theta0_deg": 150, "r0": 0},
    "pendulum, let fall": UNIT | {"theta0_deg": 60, "r0": 0, "thetadot0": 0.5},
    "pendulum, held up": UNIT | {"theta0_deg": 60, "r0": 0, "thetadot0": -0.5},
    "spherical pendulum": UNIT | {"theta0_deg": 90, "r0": 0, "psidot0": 1},
    "falls to the level": UNIT | {"theta0_deg": 60, "r0": 2},
    "whirling": UNIT | {"theta0_deg": 60, "r0": 0, "thetadot0": -3},
    "over both poles, level": {
        **{"m": 1, "A": 0.768156916037697, "C": 1.536313832075394, "s": 1},
        **{"g": 9.568216420867499e-12, "r0": 0, "theta0_deg": 90, "thetadot0": -1.0977044923273465},
    },
    "from the upper pole": UNIT | {"theta0_deg": 0, "r0": 1, "thetadot0": 1},
    "from the lower pole": UNIT | {"theta0_deg": 180, "r0": 1, "thetadot0": -1},
    "back from the upper pole": UNIT | {"theta0_deg": 0, "r0": -2.93, "thetadot0": -0.5},
    "round from the lower pole": UNIT | {"theta0_deg": 180, "r0": 0.33, "thetadot0": 2.78},
    "pendulum from the lower pole": UNIT | {"theta0_deg": 180, "r0": 0, "thetadot0": -0.5},
    "pendulum from the upper pole": UNIT | {"theta0_deg": 0, "r0": 0, "thetadot0": 2.78},
    "without torque from the upper pole": UNIT
    | {"g": 0, "r0": 2, "theta0_deg": 0, "thetadot0": 2.78},
    "without torque from the lower pole": UNIT
    | {"g": 0, "r0": 0.33, "theta0_deg": 180, "thetadot0": -0.5},
    "cusp": UNIT | {"theta0_deg": 60, "r0": 2, "psidot0": 0.5, "thetadot0": 0.75},
    "separatrix": UNIT | {"theta0_deg": 60, "psidot0": 1, "r0": 1.5, "thetadot0": 0.5},
    "next to it": UNIT | {"theta0_deg": 60, "psidot0": 1, "r0": 1.5, "thetadot0": 0.5 + 1e-13},
    "separatrix in a plane": UNIT | {"A": 2, "r0": 0, "theta0_deg": 90, "thetadot0": 1},
    **{
        f"separatrix from the bottom, {kick}": UNIT
        | {"r0": 0, "theta0_deg": 180, "thetadot0": kick}
        for kick in (2, -2)
    },
    "separatrix from the level": UNIT | {"r0": -1, "theta0_deg": 90, "psidot0": -1, "thetadot0": 1},
    "steady": UNIT | {"theta0_deg": 60, "psidot0": 1, "r0": 1.5},
    "nearly steady": UNIT | {"theta0_deg": 60, "psidot0": 1, "r0": 1.5 + 1e-12},
    "sleeping": UNIT | {"theta0_deg": 0, "r0": 3},
    "hanging": UNIT | {"theta0_deg": 180, "r0": 3},
    "torque-free": UNIT | {"theta0_deg": 50, "g": 0, "r0": 2, "psidot0": 1, "thetadot0": 1},
    "torque-free at rest": UNIT | {"theta0_deg": 50, "g": 0, "r0": 2},
    "without torque over the poles": UNIT | {"theta0_deg": 31, "g": 0, "r0": 0, "thetadot0": 2},
    "without torque on a great circle": UNIT
    | {"theta0_deg": 50, "g": 0, "r0": 0, "psidot0": 1, "thetadot0": 0.5},
    "level and steady": UNIT | {"theta0_deg": 90, "r0": 2, "psidot0": 0.5},
    "level without spin": UNIT | {"theta0_deg": 90, "r0": 0},
    "upright, idle": UNIT | {"theta0_deg": 0, "r0": 0},
    "idle": UNIT | {"theta0_deg": 50, "g": 0, "r0": 0},
    "k = k'": UNIT | {"theta0_deg": 60, "r0": 2**0.5},
}
"""A scene of every kind of motion, and next to where one kind becomes another."""
