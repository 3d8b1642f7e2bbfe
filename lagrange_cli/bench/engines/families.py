"""The engines that take part, by their packages; another one, or another scheme, is one entry."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

from ..method import Method
from .process import engine_sample

STEPS = [50, 200, 800, 3200]
MANY_STEPS = [200, 800, 3200, 12800]
"""Steps per nutation period of schemes with a fixed step; many for those of order 1."""


class Scheme(NamedTuple):
    """An integrator of an engine, and the settings that it is tried at."""

    name: str
    settings: Sequence[Any] = STEPS
    """Steps per nutation period, or tolerances."""


FAMILIES: dict[str, dict[str, Scheme]] = {
    "mujoco": {"euler": Scheme("Euler", MANY_STEPS), "rk4": Scheme("RK4")},
    "exudyn": {
        "rk44": Scheme("RK44"),
        "rk67": Scheme("RK67"),
        "alpha": Scheme("GeneralizedAlpha"),
    },
    "pybullet": {"": Scheme("", MANY_STEPS)},
    "drake": {
        "rk3": Scheme("runge_kutta3", [1e-2, 1e-4, 1e-6, 1e-8]),
        "rk5": Scheme("runge_kutta5", [1e-6, 1e-9, 1e-12, 1e-14]),
        "discrete": Scheme("discrete", MANY_STEPS),
    },
}
"""Schemes of each engine, by the module of this folder that runs it: that of its package."""

IMPORTS = {"drake": "pydrake"}
"""Modules of packages, where they have another name than the package."""


def engines(limit: float) -> dict[str, Method]:
    """Return each engine with each of its schemes by name; a run may take `limit` seconds."""
    return {
        f"{package}-{short}".rstrip("-"): Method(
            scheme.settings,
            partial(engine_sample, package, scheme.name, limit=limit),
            IMPORTS.get(package, package),
            whole_turns=False,
            engine=package,
        )
        for package, schemes in FAMILIES.items()
        for short, scheme in schemes.items()
    }
