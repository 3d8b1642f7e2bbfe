"""Lagrange top in closed form: `solve(Top(theta0_deg=30)).angles([0.0, 0.1])`."""

from .errors import LagtopError
from .motion import Motion, solve
from .record import Regime
from .top import Top

__version__ = "0.1.0"
__all__ = ["LagtopError", "Motion", "Regime", "Top", "__version__", "solve"]
