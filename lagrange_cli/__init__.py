"""Lagrange top in closed form: `solve(Top(theta0_deg=30)).angles([0.0, 0.1])`.

Examples in docstrings follow `from lagtop import *`, `import numpy as np` and `import warnings`.
"""

from __future__ import annotations

TYPE_CHECKING = False  # start-up: Ctrl-C while `typing` is imported gives a traceback
if TYPE_CHECKING:
    from typing import Any

__version__ = "0.1.0"
_MODULES = {
    "AbsentError": "errors",
    "CannotWriteError": "errors",
    "Comparison": "comparison.compare",
    "DataError": "errors",
    "LagtopError": "errors",
    "MixedBodyWarning": "errors",
    "Motion": "solver.solve",
    "Outcome": "inverse.outcome",
    "OutOfRangeError": "errors",
    "OutOfRangeWarning": "errors",
    "Regime": "solver.facts",
    "Results": "sweeps.results",
    "SceneError": "errors",
    "Top": "top.top",
    "UnavailableError": "errors",
    "compare": "comparison.compare",
    "draw": "plot",
    "draw_outcome": "plot",
    "find": "sweeps.find",
    "fit": "inverse.fit",
    "read_scene": "top.given",
    "sensitivities": "account.spread",
    "solve": "solver.solve",
    "sweep": "sweeps.records",
    "view": "plot.browser.view",
}
"""The module of each public name; it is imported when the name is first used.

Methods that draw, such as `Motion.plot`, take their functions from here: only this table may name a
subpackage above theirs.
"""
__all__ = [*_MODULES, "__version__"]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    """Return a public name; its module is imported on first use."""
    if name not in _MODULES:
        raise AttributeError(f"module 'lagtop' has no attribute {name!r}")
    from importlib import import_module  # start-up, too

    value = globals()[name] = getattr(import_module(f".{_MODULES[name]}", __name__), name)
    return value


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
