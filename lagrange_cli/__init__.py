"""Lagrange top in closed form: `solve(Top(theta0_deg=30)).angles([0.0, 0.1])`."""

from typing import TYPE_CHECKING, Any

from .errors import LagtopError
from .inputs.top import Top
from .motion.record import Regime
from .motion.solve import Motion, solve

if TYPE_CHECKING:
    from .sweeps.records import sweep

__version__ = "0.1.0"
__all__ = ["LagtopError", "Motion", "Regime", "Top", "__version__", "solve", "sweep"]


def __getattr__(name: str) -> Any:
    """`sweep`, which needs NumPy, when it is asked for."""
    if name != "sweep":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .sweeps.records import sweep

    return sweep
