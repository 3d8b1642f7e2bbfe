"""Files that are read, or standard input for `-`: their names, and the error where they cannot be.

Whatever is wrong with a file of inputs is a DataError, that it is not there among it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedIOBase, BytesIO
from typing import cast

from ..errors import DataError


@contextmanager
def opened(path: str) -> Iterator[BufferedIOBase]:
    """Open a file for reading bytes, or standard input for `-`.

    Raises DataError where it cannot be opened, and where it cannot be read inside.
    """
    try:
        if path == "-":
            yield cast(BufferedIOBase, sys.stdin.buffer) if sys.stdin else BytesIO()
            return
        with open(path, "rb") as file:
            yield file
    except OSError as error:
        raise DataError(f"{shown_path(path)}: {error.strerror or error}") from None


def shown_path(path: str) -> str:
    """Return what a file is called in messages."""
    return "standard input" if path == "-" else path or "''"
