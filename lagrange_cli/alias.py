"""Lagrange top in closed form: `solve(Top(theta0_deg=30)).angles([0.0, 0.1])`.

The build installs this file as `lagtop.py`, the one module that users import.
"""

from typing import Any

import lagrange_cli
from lagrange_cli import __all__, __dir__, __version__  # noqa: F401


def __getattr__(name: str) -> Any:
    """Return a public name; its module is imported on first use."""
    value = globals()[name] = lagrange_cli.__getattr__(name)
    return value
