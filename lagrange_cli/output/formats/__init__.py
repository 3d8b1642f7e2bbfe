"""The formats of documents and of rows.

A format is one file in this folder and one row of `FORMATS`: `--format`, the extensions, the help
and the refusal of other names take it from here.  Its module has a `FORMAT` (see `base.Format`),
and is imported when it is used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from .base import Format


class Row(NamedTuple):
    """What is known of a format before it is imported."""

    extension: str = ""
    """The extension of its files; a format without one is chosen by its name only."""
    only_rows: bool = False
    """Whether it holds rows of numbers but no other document."""


FORMATS = {
    "table": Row(),
    "csv": Row("csv"),
    "json": Row("json"),
    "ndjson": Row("ndjson"),
    "parquet": Row("parquet", only_rows=True),
    "markdown": Row("md"),
}


def format_of(name: str) -> Format:
    """Return the format with a name."""
    found: Format = import_module(f".{name}", __package__).FORMAT
    return found
