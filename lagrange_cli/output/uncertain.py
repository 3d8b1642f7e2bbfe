"""Numbers with their uncertainty as text: 319.27(15) stands for 319.27 +- 0.15."""

from __future__ import annotations

import math

_LARGEST, _SMALLEST = 1e7, 1e-4
"""Sizes between which no power of ten is written."""


def with_uncertainty(value: float, deviation: float) -> str:
    """Return a number with two digits of its standard deviation in parentheses."""
    if not (math.isfinite(value) and math.isfinite(deviation) and deviation > 0):
        return f"{value:.8g}"
    size = max(abs(value), deviation)
    if not _SMALLEST <= size < _LARGEST:
        power = math.floor(math.log10(size))
        scale = 10.0**-power
        return f"{with_uncertainty(value * scale, deviation * scale)}e{power}"
    places = 1 - math.floor(math.log10(deviation))
    if round(deviation * 10.0**places) >= 100:  # 0.0996 is rounded to 0.10
        places -= 1
    if places <= 0:
        return f"{round(value, places):.0f}({round(deviation, places):.0f})"
    return f"{value:.{places}f}({round(deviation * 10.0**places)})"
