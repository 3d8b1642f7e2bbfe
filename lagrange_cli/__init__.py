"""Lagrange top in closed form: `solve(Top(theta0_deg=30)).angles([0.0, 0.1])`.

Examples in docstrings follow `from lagtop import *`, `import numpy as np` and `import warnings`.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .errors import LagtopError, MixedBodyWarning
    from .fits.find import find
    from .fits.fit import fit
    from .inputs.given import read_scene
    from .inputs.top import Top
    from .judge.compare import compare
    from .judge.judgement import Judgement
    from .motion.regime import Regime
    from .motion.sensitivity.angle_sensitivities import angle_sensitivities
    from .motion.sensitivity.sensitivities import sensitivities
    from .motion.solve import Motion, solve
    from .plot import draw
    from .plot.browser import view
    from .plot.reports import draw_outcome
    from .sweeps.angles import sweep_angles
    from .sweeps.records import sweep

__version__ = "0.1.0"
__all__ = [
    "Judgement",
    "LagtopError",
    "MixedBodyWarning",
    "Motion",
    "Regime",
    "Top",
    "__version__",
    "angle_sensitivities",
    "compare",
    "draw",
    "draw_outcome",
    "find",
    "fit",
    "read_scene",
    "sensitivities",
    "solve",
    "sweep",
    "sweep_angles",
    "view",
]

_MODULES = {
    "Judgement": "judge.judgement",
    "LagtopError": "errors",
    "MixedBodyWarning": "errors",
    "Motion": "motion.solve",
    "Regime": "motion.regime",
    "Top": "inputs.top",
    "angle_sensitivities": "motion.sensitivity.angle_sensitivities",
    "compare": "judge.compare",
    "draw": "plot",
    "draw_outcome": "plot.reports",
    "find": "fits.find",
    "fit": "fits.fit",
    "read_scene": "inputs.given",
    "sensitivities": "motion.sensitivity.sensitivities",
    "solve": "motion.solve",
    "sweep": "sweeps.records",
    "sweep_angles": "sweeps.angles",
    "view": "plot.browser",
}
"""The module of each public name; it is imported when the name is first used.

Methods that draw, such as `Motion.plot`, take their functions from here: only this table may name a
subpackage above theirs.
"""


def __getattr__(name: str) -> Any:
    """Return a public name of the package."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(f".{_MODULES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
