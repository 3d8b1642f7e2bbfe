"""The delimiter and the decimal mark that a user asks for, until all readers take `decimal`."""

from __future__ import annotations

from typing import NamedTuple


class Dialect(NamedTuple):
    """The decimal mark of a table; an empty text means that the file decides."""

    delimiter: str = ""
    decimal: str = ""


UNDECIDED = Dialect()
