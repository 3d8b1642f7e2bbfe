"""Degrees and radians as doubles."""

from __future__ import annotations

import math

PER_RADIAN = 180 / math.pi
"""Degrees in a radian."""


def per_radian(*, radians: bool) -> float:
    """Return how many of the unit of angles in use, radians or degrees, a radian is."""
    return 1.0 if radians else PER_RADIAN


def unit_in_radians(*, radians: bool) -> float:
    """Return how many radians the unit of angles in use, a radian or a degree, is."""
    return 1.0 if radians else math.pi / 180
