"""Lagrange top in closed form: `solve(Top(theta0_deg=30)).angles([0.0, 0.1])`.

Examples in docstrings follow `from lagtop import *`, `import numpy as np` and `import warnings`.
"""

from importlib import import_module
from typing import Any

__version__ = "0.1.0"
__all__ = [
    "Comparison",
    "LagtopError",
    "MixedBodyWarning",
    "Motion",
    "Regime",
    "Top",
    "__version__",
    "compare",
    "draw",
    "draw_outcome",
    "find",
    "fit",
    "read_scene",
    "sensitivities",
    "solve",
    "sweep",
    "view",
]

_MODULES = {
    "Comparison": "comparison.compare",
    "LagtopError": "errors",
    "MixedBodyWarning": "errors",
    "Motion": "solver.solve",
    "Regime": "solver.regime",
    "Top": "top.top",
    "compare": "comparison.compare",
    "draw": "plot",
    "draw_outcome": "plot.reports",
    "find": "inverse.find",
    "fit": "inverse.fit",
    "read_scene": "top.given",
    "sensitivities": "solver.derivatives",
    "solve": "solver.solve",
    "sweep": "sweeps.records",
    "view": "plot.browser.view",
}
"""The module of each public name; it is imported when the name is first used.

Methods that draw, such as `Motion.plot`, take their functions from here: only this table may name a
subpackage above theirs.
"""


def __getattr__(name: str) -> Any:
    """Return a public name.

    Import it from `lagtop`: here `sweep`, `find`, `fit` and `compare` are also subpackages.
    """
    if name not in _MODULES:
        raise AttributeError(f"module 'lagtop' has no attribute {name!r}")
    return getattr(import_module(f".{_MODULES[name]}", __name__), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
