"""Times as clocks write them: dates, hours and minutes, and counts since 1970."""

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
