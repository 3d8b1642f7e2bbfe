"""Times as clocks write them: dates, hours and minutes, counts since 1970, rounded times."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta
from decimal import Decimal

import numpy as np

from ..arithmetic.types import Array
from ..top.units import UNITS

_HOURS = re.compile(r"(?:(\d{1,4}):)?(\d{1,2}):(\d\d(?:[.,]\d{1,18})?)", re.ASCII)
_DATE = re.compile(
    r"(\d{4}[-/]\d\d[-/]\d\d[T ]\d\d:\d\d:\d\d)(?:[.,](\d{1,18}))?\s*(Z|UTC|[+-]\d\d:?\d\d)?",
    re.ASCII,
)
_1970 = datetime(1970, 1, 1, tzinfo=UTC)
_2000, _2100 = 946_684_800, 4_102_444_800
"""Seconds from 1970 to the years between which a recording may have been made."""
_SINCE_1970 = ("ms", "us", "ns")
"""The units in which clocks count the time since 1970."""
_WHOLE, _ROUNDED = 1e-4, 0.6
"""Deviations of rounded times in units: from whole units, and from even times."""


def seconds_of(text: object) -> Decimal | None:
    """Return the seconds since midnight of hh:mm:ss, or since 1970 of a date; else None.

    mm:ss counts, too.  A date is one of ISO 8601, in UTC unless it has a zone.
    """
    text = str(text).strip()
    if match := _HOURS.fullmatch(text):
        hours, minutes, seconds = match.groups()
        return 3600 * int(hours or 0) + 60 * int(minutes) + Decimal(seconds.replace(",", "."))
    if not (match := _DATE.fullmatch(text)):
        return None
    date, fraction, zone = match.groups()
    try:
        zone = "" if zone in {None, "Z", "UTC"} else zone
        found = datetime.fromisoformat(date.replace("/", "-") + (zone or "+00:00"))
    except ValueError:  # such as a 13th month
        return None
    return (found - _1970) // timedelta(seconds=1) + Decimal(f"0.{fraction or 0}")


def unit_since_1970(t: Array) -> str:
    """Return the unit of whole numbers that count ms, us or ns since 1970, empty for others."""
    first, last = float(np.min(t)), float(np.max(t))
    sizes = {x: float(UNITS[x].size) for x in _SINCE_1970}
    units = [x for x, size in sizes.items() if _2000 < first * size <= last * size < _2100]
    return units[0] if units and (t == np.rint(t)).all() else ""


def frames_of(t: Array, frame: float) -> Array:
    """Return the number of the frame of each time, the first 0, for a rough length of a frame."""
    return np.concatenate([[0.0], np.cumsum(np.round(np.diff(t) / frame))])


def even_times(t: Array) -> Array | None:
    """Return even times that are these after rounding to some digits, None if there are none."""
    sizes = (10.0**-k for k in range(9))
    unit = next((x for x in sizes if np.abs(t / x - np.round(t / x)).max() < _WHOLE), 0.0)
    if not unit or t.size < 3 or np.ptp(np.diff(t)) < unit / 2:
        return None
    frames = np.arange(t.size, dtype=float)
    for _ in range(4):
        step, start = np.polyfit(frames, t - t[0], 1)
        even: Array = t[0] + start + step * frames
        off = np.abs(t - even)
        if unit / 10 < np.median(off) and off.max() < _ROUNDED * unit:
            return even
        frames = frames_of(t, step)  # some are missing
    return None
